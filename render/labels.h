/*
 * Street names in the scene. A label belongs to a place of the city (a junction's arm, or the middle of an edge in an
 * overview) and keeps it as long as it lives: it is never re-chosen from frame to frame. It stands level with the
 * screen (in overviews along its street), fades in and out, and never lies on another label or on a taken box.
 *
 * Candidates are looked for five times a second of simulated time; places on the screen and fading are done every
 * frame. Fixed pools; what finds no room is counted. The same drive gives the same labels.
 */
#ifndef BLVD_RENDER_LABELS_H
#define BLVD_RENDER_LABELS_H

#include <stdbool.h>
#include <stdint.h>

#include "nav/nav.h"
#include "render/camera.h"
#include "render/palette.h"
#include "render/text.h"
#include "render/view.h"

#define LABELS_MAX 32
#define LABEL_CANDIDATES_MAX 128

enum label_rank {    /* greater wins */
	LABEL_STREET,    /* any; better street classes first */
	LABEL_CURRENT,   /* the street being driven */
	LABEL_MANOEUVRE, /* the street to turn into next */
};

/* A place that could carry a name. */
struct label_candidate {
	uint64_t key; /* of the place and the name */
	uint32_t string;
	enum label_rank rank;
	uint32_t order; /* within the rank: smaller wins */
	int32_t at_mm[3];
	int32_t towards_mm[3]; /* another point of its street, for labels along it */
	bool along;            /* turned along the street, else level */
	uint32_t edge;         /* of a label along it */
};

struct label {
	struct label_candidate what;
	bool used, wanted, on;
	bool evicted;      /* has to make room for the next manoeuvre's street */
	float room_px;     /* free space around it at the last frame, px at 720 */
	float closing_pps; /* how fast that shrinks, px a second, smoothed */
	float strength;    /* 0 an ordinary label to 1 the next manoeuvre's street */
	bool flipped;      /* along: read in the other direction of the street */
	float alpha;       /* of the fade */
	float shown;       /* alpha times what the surroundings allow; what is drawn */
	int64_t eligible_since_ns, off_since_ns, on_since_ns;
	struct box box; /* on the screen, meaningful when shown > 0 */
	float x, y, angle_rad, size_px;
	float depth_m;
};

struct labels_stats {
	uint64_t appeared, disappeared;
	uint64_t dropped;         /* candidates that found the pool full */
	int64_t shortest_life_ns; /* from switching on to switching off; INT64_MAX before the first */
};

struct labels {
	const struct pkg *pkg;
	const struct text_font *font;
	struct label slots[LABELS_MAX];
	struct label_candidate candidates[LABEL_CANDIDATES_MAX];
	uint32_t candidate_count;
	int64_t refreshed_ns, updated_ns;
	bool started;
	enum camera_kind kind;
	bool turning;      /* the picture turns, or is about to: what appears now would not stay */
	struct vec3 right; /* of the view at the last frame */
	struct labels_stats stats;
	/* edges with names by the square in which their middle lies, for overviews */
	uint32_t *cell_first; /* columns * rows + 1 */
	uint32_t *cell_edges;
	int32_t grid_mm[2];
	uint32_t columns, rows;
	int32_t cell_mm;
};

struct labels_input {
	const struct view *view;
	const struct nav_view *nav;
	enum camera_kind kind;
	int64_t now_ns;          /* simulated; going back starts anew */
	float scale;             /* of a 720 px screen */
	const struct box *taken; /* screen boxes of other text, never covered */
	uint32_t taken_count;
};

/* Returns 0 or -ENOMEM. `pkg` and `font` are borrowed. */
int labels_init(struct labels *labels, struct arena *arena, const struct pkg *pkg, const struct text_font *font);
void labels_update(struct labels *labels, const struct labels_input *input);
void labels_draw(const struct labels *labels, struct canvas *canvas, const struct palette *palette);

/* label_candidates.c: fills labels->candidates for this place and camera, best first. */
int label_grid_init(struct labels *labels, struct arena *arena);
void label_candidates_find(struct labels *labels, const struct labels_input *input);

#endif
