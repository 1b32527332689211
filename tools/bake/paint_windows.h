/* Windows, doors and wall faces for paint_walls.c: what several wall textures share. Lengths in metres of the canvas.
 */
#ifndef BLVD_TOOLS_BAKE_PAINT_WINDOWS_H
#define BLVD_TOOLS_BAKE_PAINT_WINDOWS_H

#include <stdbool.h>

#include "tools/bake/facade_canvas.h"

enum wall_face {
	FACE_PLASTER,
	FACE_BRICK,
	FACE_ASHLAR,
	FACE_RUSTIC,
	FACE_CONCRETE,
	FACE_PANELS,
	FACE_BOARDS,
	FACE_RIBS
};
void paint_face(struct canvas *canvas, enum wall_face face, struct box box);

struct window_look {
	struct tone frame;
	float frame_m; /* width of frame and bars */
	int columns;   /* casements side by side */
	float transom; /* height of a cross bar as a share of the opening; 0 none */
	int bars;      /* thin horizontal glazing bars in each casement */
	float arch_m;  /* rise of a round top */
	float reveal_m;
	bool curtains;
};
/* The opening with its reveal, frame and panes. */
void paint_window(struct canvas *canvas, struct box box, const struct window_look *look);
void paint_pane(struct canvas *canvas, struct box box);

/* A raised band around or below an opening: light from above, shadow beneath. */
void paint_surround(struct canvas *canvas, struct box opening, float width_m, float light);
void paint_ledge(struct canvas *canvas, struct box box, float light);
void paint_shutter(struct canvas *canvas, struct box box, struct tone tone);
void paint_railing(struct canvas *canvas, struct box box, struct tone tone, int bars);
/* A leaf with raised panels; `rows` of them. */
void paint_leaf(struct canvas *canvas, struct box box, struct tone tone, int rows);

#endif
