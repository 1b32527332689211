/*
 * What lies on the picture: flat shapes and glyphs in screen pixels (x right, y down from the top left corner),
 * gathered during the frame into one vertex buffer of fixed capacity and drawn in the order in which they were added,
 * with one call for each run of shapes or glyphs: shapes need no texture. Edges are smoothed by a fringe that fades to
 * nothing, so no multisampling is needed.
 *
 * Stage: front end fills it every frame; nothing is allocated after canvas_init(). A full canvas drops the shape and
 * counts it.
 */
#ifndef BLVD_RENDER_CANVAS_H
#define BLVD_RENDER_CANVAS_H

#include <stdint.h>

#include "assets/pkg.h"
#include "platform/base/arena.h"
#include "platform/base/vec.h"
#include "render/gfx.h"

struct rgba { /* sRGB, alpha not multiplied in; 0 to 1 */
	float r, g, b, a;
};

static inline struct rgba rgba_hex(uint32_t rgb, float alpha)
{
	return (struct rgba){ (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f,
		(float)(rgb & 255) / 255.0f, alpha };
}

static inline struct rgba rgba_fade(struct rgba color, float factor)
{
	color.a *= factor;
	return color;
}

struct box { /* screen pixels */
	float x0, y0, x1, y1;
};

struct canvas_vertex {
	float x, y;
	float u, v; /* atlas texture; unused by shapes */
	uint8_t fill[4], halo[4];
	float range_px; /* screen pixels between the ends of the distance field; 0: a shape */
	float halo_px;  /* width of the halo */
	float grow_px;  /* strokes are made wider by this on each side */
};

enum canvas_kind { CANVAS_SHAPES, CANVAS_GLYPHS, CANVAS_KIND_COUNT };
struct canvas_run { /* ends where the next begins */
	uint32_t first_index;
	enum canvas_kind kind;
};
#define CANVAS_RUNS_MAX 64 /* what comes after the last goes with the glyphs, which draw shapes as well */

struct canvas {
	struct canvas_vertex *vertices;
	uint16_t *indices;
	uint32_t vertex_capacity, index_capacity;
	uint32_t vertex_count, index_count;
	struct canvas_run runs[CANVAS_RUNS_MAX];
	uint32_t run_count;
	uint32_t dropped; /* shapes that found no room, since start */
	float width, height;
	struct gfx *gfx; /* NULL: nothing is drawn (tests) */
	gfx_program programs[CANVAS_KIND_COUNT];
	gfx_pipeline pipelines[CANVAS_KIND_COUNT];
	gfx_buffer vertex_buffer, index_buffer;
	gfx_texture atlas;
};

/* `pkg` gives the font's atlas; its font may be NULL: no text. `scratch` is released again. `gfx` may be NULL.
 * `vertices` 0 takes 8,192. Returns 0, -ENOMEM, -EINVAL (shader). */
int canvas_init(struct canvas *canvas, struct arena *arena, struct gfx *gfx, const struct pkg *pkg, uint32_t vertices);
void canvas_finish(struct canvas *canvas);

void canvas_begin(struct canvas *canvas, uint32_t width, uint32_t height);
/* Uploads what was added since canvas_begin(). Outside of passes. */
void canvas_upload(struct canvas *canvas);
/* Inside a pass. */
void canvas_draw(const struct canvas *canvas);

/* A convex polygon of 3 to CANVAS_POINTS_MAX points, either way round. `feather_px` is the width of its soft edge, half
 * of it outside; 1 is a smooth edge, more is a shadow. */
#define CANVAS_POINTS_MAX 96
void canvas_convex(
	struct canvas *canvas, const struct vec2 *points, uint32_t count, float feather_px, struct rgba color);
void canvas_rounded_box(struct canvas *canvas, struct box box, float radius, float feather_px, struct rgba color);
void canvas_disc(struct canvas *canvas, struct vec2 center, float radius, struct rgba color);
/* `width` is centred on `radius`; from `start_rad` clockwise (from up) over `sweep_rad`; a full turn closes. */
void canvas_arc(struct canvas *canvas, struct vec2 center, float radius, float width, float start_rad, float sweep_rad,
	struct rgba color);
/* A line of constant width with mitred corners and flat ends. */
void canvas_stroke(struct canvas *canvas, const struct vec2 *points, uint32_t count, float width, struct rgba color);
/* One rectangle of the atlas; corners clockwise from the top left. `shape` gives colours and field parameters. */
void canvas_glyph(
	struct canvas *canvas, const struct vec2 corners[4], const struct box *uv, const struct canvas_vertex *shape);

void canvas_color(uint8_t out[4], struct rgba color);

#endif
