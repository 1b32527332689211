/*
 * The wall textures: one tile is one bay by one storey (a cornice: its whole height; a church: its whole wall). Walls
 * are painted near white and tinted by the vertex colour; glass keeps its own colour. About 60 layers, each a few
 * strokes on a canvas in metres; all together well under a second.
 */
#include "tools/bake/bake.h"
#include "tools/bake/paint_windows.h"

#include <stdlib.h>

static const struct tone white_frame = { 0.97f, 0.97f, 0.96f };
static const struct tone dark_frame = { 0.30f, 0.31f, 0.33f };
static const struct tone iron = { 0.20f, 0.21f, 0.23f };
static const struct tone wall_tone = { 0.93f, 0.93f, 0.92f };

enum lintel { LINTEL_NONE, LINTEL_LEDGE, LINTEL_GABLE, LINTEL_STONE };

/* What most windows have in common. */
struct wall_look {
	int material;
	float bay_m, storey_m;
	enum wall_face face;
	float width_m, sill_m, top_m; /* the opening, in the middle of the bay */
	struct window_look window;
	float surround_m;
	bool sill, belt; /* a ledge below the window; a string course at the floor line */
	enum lintel lintel;
	struct tone shutter; /* black: none */
	float railing_m;     /* height above the sill */
	float pair_m;        /* two openings, this far apart */
};

#define CASEMENT(...)                                                                                                  \
	{                                                                                                                  \
		.frame_m = 0.06f, .columns = 2, .reveal_m = 0.05f, .curtains = true, __VA_ARGS__                               \
	}
#define WHITE .frame = { 0.97f, 0.97f, 0.96f }
#define DARK .frame = { 0.30f, 0.31f, 0.33f }

static const struct wall_look looks[] = {
	{ MATERIAL_WALL_TALL, 2.9f, 3.3f, FACE_PLASTER, 1.15f, 0.75f, 2.75f, CASEMENT(WHITE, .transom = 0.72f),
		.surround_m = 0.16f, .sill = true, .belt = true, .lintel = LINTEL_LEDGE },
	{ MATERIAL_WALL_SHUTTER_GREEN, 3.2f, 3.1f, FACE_PLASTER, 1.1f, 0.8f, 2.55f, CASEMENT(WHITE, .bars = 2),
		.surround_m = 0.1f, .sill = true, .shutter = { 0.42f, 0.50f, 0.44f } },
	{ MATERIAL_WALL_SHUTTER_GREY, 3.1f, 3.1f, FACE_PLASTER, 1.1f, 0.75f, 2.6f, CASEMENT(WHITE, .bars = 2),
		.surround_m = 0.1f, .sill = true, .shutter = { 0.66f, 0.70f, 0.73f } },
	{ MATERIAL_WALL_SHUTTER_BROWN, 3.2f, 3.1f, FACE_PLASTER, 1.1f, 0.8f, 2.55f, CASEMENT(WHITE, .bars = 1),
		.surround_m = 0.09f, .sill = true, .belt = true, .shutter = { 0.52f, 0.43f, 0.36f } },
	{ MATERIAL_WALL_FRENCH, 2.9f, 3.2f, FACE_PLASTER, 1.25f, 0.25f, 2.65f, CASEMENT(WHITE, .transom = 0.8f),
		.surround_m = 0.13f, .sill = true, .railing_m = 0.95f },
	{ MATERIAL_WALL_ASHLAR, 2.7f, 3.2f, FACE_ASHLAR, 1.2f, 0.35f, 2.75f, CASEMENT(WHITE, .transom = 0.78f),
		.surround_m = 0.14f, .sill = true, .belt = true, .lintel = LINTEL_STONE, .railing_m = 0.9f },
	{ MATERIAL_WALL_PEDIMENT, 3.1f, 3.5f, FACE_PLASTER, 1.2f, 0.75f, 2.65f, CASEMENT(WHITE, .transom = 0.72f),
		.surround_m = 0.18f, .sill = true, .belt = true, .lintel = LINTEL_GABLE },
	{ MATERIAL_WALL_VILLA, 3.3f, 2.9f, FACE_PLASTER, 1.35f, 0.85f, 2.3f, CASEMENT(WHITE), .surround_m = 0.07f,
		.sill = true },
	{ MATERIAL_WALL_PAIR, 3.4f, 3.1f, FACE_PLASTER, 0.8f, 0.8f, 2.55f,
		{ WHITE, .frame_m = 0.06f, .columns = 1, .transom = 0.7f, .reveal_m = 0.05f }, .surround_m = 0.1f, .sill = true,
		.belt = true, .pair_m = 1.15f },
	{ MATERIAL_WALL_SMALL, 3.4f, 2.9f, FACE_PLASTER, 0.85f, 0.95f, 2.15f, CASEMENT(WHITE), .sill = true },
	{ MATERIAL_WALL_WIDE, 3.6f, 2.85f, FACE_PLASTER, 2.1f, 0.9f, 2.35f,
		{ WHITE, .frame_m = 0.06f, .columns = 3, .reveal_m = 0.06f, .curtains = true }, .sill = true },
	{ MATERIAL_WALL_BRICK_SASH, 2.8f, 3.1f, FACE_BRICK, 1.1f, 0.75f, 2.6f,
		{ WHITE, .frame_m = 0.06f, .columns = 1, .transom = 0.5f, .reveal_m = 0.06f, .curtains = true }, .sill = true,
		.lintel = LINTEL_STONE },
	{ MATERIAL_WALL_BRICK_WIDE, 3.4f, 3.1f, FACE_BRICK, 1.9f, 0.7f, 2.5f,
		{ DARK, .frame_m = 0.06f, .columns = 2, .reveal_m = 0.07f }, .sill = true },
	{ MATERIAL_WALL_CIVIC, 3.4f, 3.9f, FACE_ASHLAR, 1.5f, 0.8f, 3.2f,
		{ WHITE, .frame_m = 0.07f, .columns = 2, .transom = 0.68f, .arch_m = 0.5f, .reveal_m = 0.08f },
		.surround_m = 0.0f, .sill = true, .belt = true },
	{ MATERIAL_WALL_SCHOOL, 3.4f, 3.4f, FACE_CONCRETE, 2.7f, 0.95f, 2.75f,
		{ WHITE, .frame_m = 0.07f, .columns = 3, .transom = 0.7f, .reveal_m = 0.06f }, .sill = true },
	{ MATERIAL_WALL_BOARDS, 2.9f, 3.0f, FACE_BOARDS, 1.05f, 0.75f, 2.4f,
		{ WHITE, .frame_m = 0.06f, .columns = 1, .transom = 0.5f, .curtains = true }, .surround_m = 0.13f, .sill = true,
		.lintel = LINTEL_LEDGE },
	{ MATERIAL_GROUND_PLASTER, 2.9f, 3.4f, FACE_PLASTER, 1.15f, 0.95f, 2.6f, CASEMENT(WHITE, .bars = 2),
		.surround_m = 0.12f, .sill = true },
	{ MATERIAL_GROUND_RUSTIC, 2.9f, 3.8f, FACE_RUSTIC, 1.3f, 0.95f, 2.85f,
		CASEMENT(WHITE, .arch_m = 0.55f, .transom = 0.62f), .surround_m = 0.0f },
	{ MATERIAL_GROUND_BRICK, 2.9f, 3.3f, FACE_BRICK, 1.15f, 0.85f, 2.55f,
		{ WHITE, .frame_m = 0.06f, .columns = 1, .transom = 0.5f, .reveal_m = 0.06f, .curtains = true }, .sill = true,
		.lintel = LINTEL_STONE },
	{ MATERIAL_GROUND_BOARDS, 2.9f, 3.2f, FACE_BOARDS, 1.1f, 0.85f, 2.4f,
		{ WHITE, .frame_m = 0.06f, .columns = 1, .transom = 0.5f, .curtains = true }, .surround_m = 0.12f,
		.sill = true },
	{ MATERIAL_GROUND_MODERN, 3.4f, 3.3f, FACE_CONCRETE, 2.2f, 0.75f, 2.6f,
		{ DARK, .frame_m = 0.06f, .columns = 2, .reveal_m = 0.06f }, .surround_m = 0.0f },
};

static void paint_shutters(struct canvas *canvas, const struct wall_look *look, struct box opening)
{
	float width = look->width_m * 0.5f;
	paint_shutter(
		canvas, box_of(opening.x0 - width - 0.03f, opening.y0, opening.x0 - 0.03f, opening.y1), look->shutter);
	paint_shutter(
		canvas, box_of(opening.x1 + 0.03f, opening.y0, opening.x1 + width + 0.03f, opening.y1), look->shutter);
}

static void paint_lintel(struct canvas *canvas, const struct wall_look *look, struct box opening)
{
	float y = opening.y1 + look->surround_m, out = look->surround_m + 0.07f;
	struct box ledge = { opening.x0 - out, y, opening.x1 + out, y + 0.11f };
	switch (look->lintel) {
	case LINTEL_NONE:
		break;
	case LINTEL_LEDGE:
		paint_ledge(canvas, ledge, 1.04f);
		break;
	case LINTEL_GABLE:
		canvas_gable(canvas, box_of(ledge.x0, ledge.y1, ledge.x1, ledge.y1 + 0.36f), tone_grey(0.99f), 0.9f);
		canvas_gable(canvas, box_of(ledge.x0 + 0.2f, ledge.y1 + 0.02f, ledge.x1 - 0.2f, ledge.y1 + 0.27f),
			tone_grey(0.84f), 0.8f);
		paint_ledge(canvas, ledge, 1.04f);
		break;
	case LINTEL_STONE:
		canvas_rect(canvas, box_of(opening.x0 - 0.16f, y, opening.x1 + 0.16f, y + 0.2f), tone_grey(0.97f), 0.8f, 0.0f);
		canvas_shade(canvas, box_of(opening.x0 - 0.16f, y, opening.x1 + 0.16f, y + 0.025f), 0.85f);
		break;
	}
}

static void paint_opening(struct canvas *canvas, const struct wall_look *look, float middle)
{
	struct box opening = { middle - look->width_m / 2.0f, look->sill_m, middle + look->width_m / 2.0f, look->top_m };
	if (look->surround_m > 0.0f)
		paint_surround(canvas, opening, look->surround_m, 1.02f);
	paint_lintel(canvas, look, opening);
	paint_window(canvas, opening, &look->window);
	if (look->sill) {
		float out = look->surround_m + 0.05f;
		paint_ledge(canvas, box_of(opening.x0 - out, opening.y0 - 0.1f, opening.x1 + out, opening.y0), 1.04f);
	}
	if (look->shutter.r > 0.0f)
		paint_shutters(canvas, look, opening);
	if (look->railing_m > 0.0f)
		paint_railing(
			canvas, box_of(opening.x0 - 0.06f, opening.y0, opening.x1 + 0.06f, opening.y0 + look->railing_m), iron, 11);
}

static void paint_look(struct canvas *canvas, const struct wall_look *look)
{
	paint_face(canvas, look->face, canvas_box(canvas));
	if (look->belt)
		paint_ledge(canvas, box_of(0.0f, 0.03f, look->bay_m, 0.2f), 1.03f);
	float middle = look->bay_m / 2.0f;
	if (look->pair_m > 0.0f)
		paint_opening(canvas, look, middle - look->pair_m / 2.0f);
	paint_opening(canvas, look, middle + look->pair_m / 2.0f);
}

/* From here on: walls that are more than a window in a wall. */

static void paint_strip(struct canvas *c)
{
	paint_face(c, FACE_PANELS, canvas_box(c));
	struct box band = { 0.0f, 1.0f, c->width_m, 2.75f };
	canvas_rect(c, band, dark_frame, 1.0f, 0.0f);
	for (int i = 0; i < 2; i++) {
		float x = c->width_m * 0.5f * (float)i;
		paint_pane(c, box_of(x + 0.04f, 1.06f, x + c->width_m * 0.5f - 0.04f, 2.69f));
	}
	canvas_shadow(c, box_of(0.0f, 2.35f, c->width_m, 2.69f), 0.35f);
	paint_ledge(c, box_of(0.0f, 0.92f, c->width_m, 1.0f), 1.05f);
}

static void paint_grid(struct canvas *c)
{
	paint_face(c, FACE_CONCRETE, canvas_box(c));
	struct box hole = { 0.4f, 0.55f, c->width_m - 0.4f, 2.85f };
	canvas_rect(c, hole, tone_grey(0.52f), 1.0f, 0.0f);
	canvas_rect(c, box_of(hole.x0 + 0.16f, hole.y0 + 0.1f, hole.x1, hole.y1 - 0.2f), dark_frame, 1.0f, 0.0f);
	paint_pane(c, box_of(hole.x0 + 0.22f, hole.y0 + 0.16f, c->width_m / 2.0f + 0.03f, hole.y1 - 0.26f));
	paint_pane(c, box_of(c->width_m / 2.0f + 0.1f, hole.y0 + 0.16f, hole.x1 - 0.06f, hole.y1 - 0.26f));
	canvas_shade(c, box_of(hole.x0, hole.y0, hole.x1, hole.y0 + 0.1f), 1.6f);
	canvas_shade(c, box_of(0.0f, 0.0f, c->width_m, 0.03f), 0.86f);
}

static void paint_balcony(struct canvas *c)
{
	paint_face(c, FACE_PLASTER, canvas_box(c));
	struct window_look door = { DARK, .frame_m = 0.06f, .columns = 2, .reveal_m = 0.05f, .curtains = true };
	paint_window(c, box_of(0.55f, 0.2f, c->width_m - 0.75f, 2.5f), &door);
	canvas_shadow(c, box_of(0.0f, 2.2f, c->width_m, c->height_m), 0.42f);
	/* Slab and parapet in front; what is behind lies in their shade. */
	canvas_rect(c, box_of(0.0f, 0.0f, c->width_m, 0.22f), tone_grey(0.97f), 1.0f, 0.0f);
	canvas_shade(c, box_of(0.0f, 0.0f, c->width_m, 0.03f), 0.72f);
	canvas_rect(c, box_of(0.12f, 0.22f, c->width_m - 0.12f, 1.15f), tone_of(0.80f, 0.84f, 0.86f), 0.78f, 0.0f);
	canvas_rect(c, box_of(0.08f, 1.12f, c->width_m - 0.08f, 1.18f), dark_frame, 0.9f, 0.0f);
	canvas_rect(c, box_of(c->width_m - 0.14f, 0.22f, c->width_m - 0.02f, c->height_m), tone_grey(0.88f), 1.0f, 0.0f);
}

static void paint_curtain(struct canvas *c, struct tone tint, int columns, float spandrel_m, struct tone frame)
{
	canvas_rect(c, canvas_box(c), frame, 1.0f, 0.0f);
	float step = c->width_m / (float)columns;
	for (int i = 0; i < columns; i++) {
		float x0 = step * (float)i + 0.035f, x1 = step * (float)(i + 1) - 0.035f, light = i % 2 ? 0.96f : 1.03f;
		struct tone low = tone_scale(tint, 0.80f * light), high = tone_scale(tint, 1.12f * light);
		canvas_gradient(c, box_of(x0, spandrel_m, x1, c->height_m - 0.05f), low, high, 1.0f);
		canvas_rect(c, box_of(x0, 0.05f, x1, spandrel_m - 0.06f), tone_scale(tint, 0.72f), 1.0f, 0.8f);
	}
	canvas_shade(c, box_of(0.0f, c->height_m - 0.05f, c->width_m, c->height_m), 1.1f);
}

static void paint_curtain_blue(struct canvas *c)
{
	paint_curtain(c, tone_of(0.50f, 0.60f, 0.69f), 2, 0.9f, tone_grey(0.80f));
}
static void paint_curtain_grey(struct canvas *c)
{
	paint_curtain(c, tone_of(0.52f, 0.57f, 0.60f), 3, 0.75f, tone_grey(0.90f));
}
static void paint_curtain_dark(struct canvas *c)
{
	paint_curtain(c, tone_of(0.36f, 0.38f, 0.40f), 2, 1.0f, tone_grey(0.46f));
}

static void paint_pier(struct canvas *c)
{
	paint_face(c, FACE_ASHLAR, canvas_box(c));
	struct box slot = { c->width_m * 0.27f, 0.0f, c->width_m * 0.73f, c->height_m };
	canvas_rect(c, slot, tone_grey(0.66f), 1.0f, 0.0f);
	canvas_shade(c, box_of(slot.x0, 0.0f, slot.x0 + 0.06f, c->height_m), 0.72f);
	canvas_ribs(c, box_of(slot.x0 + 0.1f, 0.1f, slot.x1 - 0.05f, 0.85f), 4, 0.12f);
	struct window_look window = { DARK, .frame_m = 0.05f, .columns = 2, .transom = 0.5f };
	paint_window(c, box_of(slot.x0 + 0.07f, 0.95f, slot.x1 - 0.02f, 2.85f), &window);
}

static void paint_industrial(struct canvas *c)
{
	paint_face(c, FACE_RIBS, canvas_box(c));
	struct box band = { 0.0f, c->height_m - 1.45f, c->width_m, c->height_m - 0.45f };
	canvas_rect(c, band, tone_grey(0.6f), 1.0f, 0.0f);
	for (int i = 0; i < 4; i++) {
		float x = c->width_m * 0.25f * (float)i;
		paint_pane(c, box_of(x + 0.04f, band.y0 + 0.06f, x + c->width_m * 0.25f - 0.04f, band.y1 - 0.06f));
	}
}

static void paint_church_wall(struct canvas *c)
{
	paint_face(c, FACE_ASHLAR, canvas_box(c));
	/* A buttress on the seam of two bays. */
	float edge = 0.42f;
	canvas_shade(c, box_of(0.0f, 0.0f, edge, c->height_m * 0.9f), 1.04f);
	canvas_shade(c, box_of(c->width_m - edge, 0.0f, c->width_m, c->height_m * 0.9f), 1.04f);
	canvas_shade(c, box_of(edge, 0.0f, edge + 0.12f, c->height_m * 0.9f), 0.80f);
	struct box opening = { c->width_m * 0.32f, c->height_m * 0.24f, c->width_m * 0.68f, c->height_m * 0.84f };
	float rise = c->height_m * 0.14f;
	canvas_arch(c, box_grow(opening, 0.22f), rise + 0.2f, tone_grey(0.98f), tone_grey(0.98f), 0.0f);
	canvas_arch(c, box_grow(opening, 0.06f), rise, tone_grey(0.55f), tone_grey(0.55f), 0.0f);
	canvas_arch(c, opening, rise, tone_of(0.22f, 0.25f, 0.30f), tone_of(0.33f, 0.37f, 0.43f), 1.0f);
	float middle = c->width_m / 2.0f;
	canvas_rect(
		c, box_of(middle - 0.05f, opening.y0, middle + 0.05f, opening.y1 - rise * 0.5f), tone_grey(0.78f), 1.0f, 0.0f);
	for (int i = 1; i < 6; i++) {
		float y = opening.y0 + (opening.y1 - rise - opening.y0) * (float)i / 5.0f;
		canvas_rect(c, box_of(opening.x0, y - 0.03f, opening.x1, y + 0.03f), tone_grey(0.6f), 0.8f, 0.0f);
	}
}

static void paint_belfry(struct canvas *c)
{
	paint_face(c, FACE_ASHLAR, canvas_box(c));
	struct box opening = { c->width_m * 0.28f, c->height_m * 0.16f, c->width_m * 0.72f, c->height_m * 0.84f };
	canvas_arch(c, box_grow(opening, 0.16f), c->height_m * 0.24f, tone_grey(0.98f), tone_grey(0.98f), 0.0f);
	canvas_arch(c, opening, c->height_m * 0.22f, tone_grey(0.30f), tone_grey(0.30f), 0.0f);
	for (int i = 0; i < 8; i++) {
		float y = opening.y0 + (opening.y1 - opening.y0) * ((float)i + 0.2f) / 9.5f;
		canvas_rect(c, box_of(opening.x0 + 0.08f, y, opening.x1 - 0.08f, y + 0.09f), tone_grey(0.58f), 1.0f, 0.0f);
	}
	paint_ledge(c, box_of(0.0f, 0.05f, c->width_m, 0.3f), 1.03f);
	paint_ledge(c, box_of(0.0f, c->height_m - 0.3f, c->width_m, c->height_m - 0.05f), 1.03f);
}

static void paint_bay_window(struct canvas *c)
{
	paint_face(c, FACE_BOARDS, canvas_box(c));
	struct window_look sash = { WHITE, .frame_m = 0.055f, .columns = 1, .transom = 0.5f, .curtains = true };
	struct box bay = { 0.3f, 0.0f, c->width_m - 0.3f, c->height_m };
	canvas_shade(c, box_of(bay.x0, 0.0f, bay.x0 + 0.5f, c->height_m), 1.05f);
	canvas_shade(c, box_of(bay.x1 - 0.5f, 0.0f, bay.x1, c->height_m), 0.86f);
	canvas_shade(c, box_of(bay.x1, 0.0f, bay.x1 + 0.12f, c->height_m), 0.74f);
	paint_window(c, box_of(bay.x0 + 0.08f, 0.7f, bay.x0 + 0.44f, 2.45f), &sash);
	paint_window(c, box_of(bay.x0 + 0.6f, 0.7f, bay.x1 - 0.6f, 2.45f), &sash);
	paint_window(c, box_of(bay.x1 - 0.44f, 0.7f, bay.x1 - 0.08f, 2.45f), &sash);
	paint_ledge(c, box_of(bay.x0, 2.58f, bay.x1, 2.74f), 1.05f);
	paint_ledge(c, box_of(bay.x0, 0.52f, bay.x1, 0.64f), 1.05f);
}

static void paint_greenhouse(struct canvas *c)
{
	paint_curtain(c, tone_of(0.66f, 0.74f, 0.74f), 3, 0.5f, tone_grey(0.93f));
}

static void paint_blank(struct canvas *c, enum wall_face face)
{
	paint_face(c, face, canvas_box(c));
}
static void paint_blank_plaster(struct canvas *c)
{
	paint_blank(c, FACE_PLASTER);
}
static void paint_blank_brick(struct canvas *c)
{
	paint_blank(c, FACE_BRICK);
}
static void paint_blank_stone(struct canvas *c)
{
	paint_blank(c, FACE_ASHLAR);
}
static void paint_blank_concrete(struct canvas *c)
{
	paint_blank(c, FACE_PANELS);
}
static void paint_blank_boards(struct canvas *c)
{
	paint_blank(c, FACE_BOARDS);
}
static void paint_blank_metal(struct canvas *c)
{
	paint_blank(c, FACE_RIBS);
}

static void paint_lobby(struct canvas *c)
{
	canvas_rect(c, canvas_box(c), tone_grey(0.86f), 1.0f, 0.0f);
	for (int i = 0; i < 2; i++) {
		float x = c->width_m * 0.5f * (float)i;
		paint_pane(c, box_of(x + 0.05f, 0.15f, x + c->width_m * 0.5f - 0.05f, 3.1f));
		canvas_rect(c, box_of(x + 0.05f, 2.35f, x + c->width_m * 0.5f - 0.05f, 2.41f), dark_frame, 1.0f, 0.0f);
	}
	canvas_shadow(c, box_of(0.05f, 2.6f, c->width_m - 0.05f, 3.1f), 0.3f);
}

static void paint_double_door(struct canvas *c, struct box box, struct tone tone, int rows)
{
	float middle = (box.x0 + box.x1) / 2.0f;
	paint_leaf(c, box_of(box.x0, box.y0, middle, box.y1), tone, rows);
	paint_leaf(c, box_of(middle, box.y0, box.x1, box.y1), tone, rows);
	canvas_shadow(c, box_of(box.x0, box.y1 - 0.3f, box.x1, box.y1), 0.35f);
}

static void paint_portal(struct canvas *c)
{
	paint_face(c, FACE_RUSTIC, canvas_box(c));
	float middle = c->width_m / 2.0f;
	struct box opening = { middle - 0.85f, 0.0f, middle + 0.85f, 2.95f };
	canvas_arch(c, box_of(opening.x0 - 0.22f, 0.0f, opening.x1 + 0.22f, 3.15f), 0.85f, tone_grey(0.97f),
		tone_grey(0.97f), 0.0f);
	canvas_arch(c, opening, 0.7f, tone_grey(0.45f), tone_grey(0.45f), 0.0f);
	canvas_arch(c, box_of(opening.x0 + 0.1f, 2.2f, opening.x1 - 0.05f, 2.85f), 0.62f, tone_of(0.24f, 0.28f, 0.32f),
		tone_of(0.36f, 0.42f, 0.47f), 1.0f);
	paint_double_door(c, box_of(opening.x0 + 0.1f, 0.0f, opening.x1 - 0.05f, 2.14f), tone_of(0.38f, 0.33f, 0.29f), 3);
}

static void paint_house_door(struct canvas *c, enum wall_face face, struct tone tone)
{
	paint_face(c, face, canvas_box(c));
	float middle = c->width_m / 2.0f;
	struct box opening = { middle - 0.55f, 0.0f, middle + 0.55f, 2.6f };
	paint_surround(c, opening, 0.15f, 1.03f);
	canvas_rect(c, opening, tone_grey(0.5f), 1.0f, 0.0f);
	struct box leaf = { opening.x0 + 0.06f, 0.08f, opening.x1 - 0.04f, 2.1f };
	paint_leaf(c, leaf, tone, 3);
	paint_pane(c, box_of(leaf.x0 + 0.05f, 2.2f, leaf.x1 - 0.05f, 2.5f));
	canvas_rect(c, box_of(opening.x0 - 0.2f, 0.0f, opening.x1 + 0.2f, 0.1f), tone_grey(0.85f), 1.0f, 0.0f);
	paint_ledge(c, box_of(opening.x0 - 0.3f, 2.76f, opening.x1 + 0.3f, 2.88f), 1.04f);
}
static void paint_door_panel(struct canvas *c)
{
	paint_house_door(c, FACE_PLASTER, tone_of(0.45f, 0.38f, 0.33f));
}
static void paint_door_brick(struct canvas *c)
{
	paint_house_door(c, FACE_BRICK, tone_of(0.28f, 0.33f, 0.36f));
}
static void paint_door_boards(struct canvas *c)
{
	paint_house_door(c, FACE_BOARDS, tone_of(0.40f, 0.45f, 0.50f));
}

static void paint_door_glass(struct canvas *c)
{
	paint_face(c, FACE_CONCRETE, canvas_box(c));
	float middle = c->width_m / 2.0f;
	struct box opening = { middle - 1.0f, 0.0f, middle + 1.0f, 2.6f };
	canvas_rect(c, opening, dark_frame, 1.0f, 0.0f);
	paint_pane(c, box_of(opening.x0 + 0.07f, 0.1f, middle - 0.04f, 2.15f));
	paint_pane(c, box_of(middle + 0.04f, 0.1f, opening.x1 - 0.07f, 2.15f));
	paint_pane(c, box_of(opening.x0 + 0.07f, 2.23f, opening.x1 - 0.07f, 2.53f));
	/* A canopy above. */
	paint_ledge(c, box_of(opening.x0 - 0.35f, 2.66f, opening.x1 + 0.35f, 2.84f), 0.95f);
	canvas_shadow(c, box_of(opening.x0, 2.1f, opening.x1, 2.6f), 0.4f);
}

static void paint_door_church(struct canvas *c)
{
	paint_face(c, FACE_ASHLAR, canvas_box(c));
	float middle = c->width_m / 2.0f;
	struct box opening = { middle - 1.05f, 0.0f, middle + 1.05f, 3.3f };
	for (int i = 3; i >= 1; i--) {
		float out = 0.15f * (float)i, light = i % 2 ? 0.80f : 0.98f;
		canvas_arch(c, box_of(opening.x0 - out, 0.0f, opening.x1 + out, opening.y1 + out), 1.3f + out, tone_grey(light),
			tone_grey(light), 0.0f);
	}
	canvas_arch(c, opening, 1.25f, tone_of(0.36f, 0.30f, 0.26f), tone_of(0.28f, 0.24f, 0.21f), 0.0f);
	canvas_ribs(c, box_of(opening.x0, 0.0f, opening.x1, 2.2f), 10, 0.2f);
	canvas_shade(c, box_of(middle - 0.03f, 0.0f, middle + 0.03f, 3.2f), 0.6f);
}

static void paint_gate(struct canvas *c, enum wall_face face, struct box box, int boards)
{
	paint_face(c, face, canvas_box(c));
	canvas_rect(c, box_of(box.x0 - 0.1f, box.y0, box.x1 + 0.1f, box.y1 + 0.1f), tone_grey(0.6f), 1.0f, 0.0f);
	canvas_rect(c, box, tone_grey(0.84f), 1.0f, 0.0f);
	canvas_boards(c, box, boards, 0.2f);
	canvas_shadow(c, box_of(box.x0, box.y1 - 0.4f, box.x1, box.y1), 0.4f);
}
static void paint_gate_garage(struct canvas *c)
{
	paint_gate(c, FACE_PLASTER, box_of(0.3f, 0.0f, c->width_m - 0.3f, 2.2f), 9);
}
static void paint_gate_industrial(struct canvas *c)
{
	paint_gate(c, FACE_RIBS, box_of(0.4f, 0.0f, c->width_m - 0.4f, 3.4f), 14);
}

/* A shop front: stall riser, panes, fascia for the name. */
struct front_look {
	struct tone frame, fascia, goods;
	float riser_m, glass_top_m, fascia_top_m;
	int panes;
	bool door;
};

static void paint_goods(struct canvas *c, struct box pane, struct tone tone)
{
	float width = pane.x1 - pane.x0, height = pane.y1 - pane.y0;
	canvas_rect(c, box_of(pane.x0, pane.y0, pane.x1, pane.y0 + height * 0.12f), tone_scale(tone, 0.8f), 0.7f, 1.0f);
	for (int i = 0; i < 3; i++) {
		float x = pane.x0 + width * (0.14f + 0.3f * (float)i), top = height * (0.3f + 0.1f * (float)((i * 2) % 3));
		canvas_rect(c, box_of(x, pane.y0 + height * 0.12f, x + width * 0.16f, pane.y0 + top),
			tone_scale(tone, 0.85f + 0.15f * (float)i), 0.55f, 1.0f);
	}
}

static void paint_front(struct canvas *c, const struct front_look *look)
{
	struct box front = { 0.14f, 0.0f, c->width_m - 0.14f, look->fascia_top_m };
	canvas_rect(c, front, look->frame, 1.0f, 0.0f);
	float width = (front.x1 - front.x0) / (float)look->panes;
	for (int i = 0; i < look->panes; i++) {
		bool door = look->door && i == look->panes - 1;
		struct box pane = { front.x0 + width * (float)i + 0.06f, door ? 0.1f : look->riser_m,
			front.x0 + width * (float)(i + 1) - 0.06f, look->glass_top_m };
		canvas_gradient(c, pane, tone_of(0.46f, 0.48f, 0.48f), tone_of(0.55f, 0.60f, 0.65f), 1.0f);
		if (door)
			canvas_rect(c, box_of(pane.x0, 2.12f, pane.x1, 2.2f), look->frame, 1.0f, 0.0f);
		else
			paint_goods(c, pane, look->goods);
	}
	canvas_shadow(c, box_of(front.x0, look->glass_top_m - 0.4f, front.x1, look->glass_top_m), 0.3f);
	struct box fascia = { front.x0, look->glass_top_m + 0.06f, front.x1, look->fascia_top_m };
	canvas_rect(c, fascia, look->fascia, 1.0f, 0.0f);
	canvas_shade(c, box_of(fascia.x0, fascia.y1 - 0.05f, fascia.x1, fascia.y1), 1.15f);
	canvas_shade(c, box_of(fascia.x0, fascia.y0, fascia.x1, fascia.y0 + 0.04f), 0.75f);
}

/* What a name looks like from across the street: a few light strokes. */
static void paint_lettering(struct canvas *c, float y, float height_m, struct tone tone)
{
	float x = c->width_m * 0.28f;
	for (int i = 0; i < 7; i++) {
		float width = 0.1f + 0.05f * (float)((i * 5) % 3);
		if (i != 3)
			canvas_rect(c, box_of(x, y, x + width, y + height_m * (i % 3 == 1 ? 1.0f : 0.8f)), tone, 0.8f, 0.0f);
		x += width + 0.07f;
	}
}

static void paint_classic(struct canvas *c, struct tone wood, struct tone name)
{
	paint_face(c, FACE_PLASTER, canvas_box(c));
	struct front_look look = { wood, tone_scale(wood, 0.9f), { 0.70f, 0.62f, 0.52f }, 0.55f, 2.55f, 3.15f, 3, true };
	paint_front(c, &look);
	paint_lettering(c, 2.75f, 0.24f, name);
}
static void paint_shop_classic(struct canvas *c)
{
	paint_classic(c, tone_of(0.37f, 0.44f, 0.41f), tone_of(0.88f, 0.84f, 0.72f));
}
static void paint_shop_blue(struct canvas *c)
{
	paint_classic(c, tone_of(0.36f, 0.42f, 0.50f), tone_of(0.90f, 0.90f, 0.88f));
}
static void paint_shop_red(struct canvas *c)
{
	paint_classic(c, tone_of(0.52f, 0.36f, 0.34f), tone_of(0.93f, 0.88f, 0.76f));
}
static void paint_shop_pale(struct canvas *c)
{
	paint_classic(c, tone_of(0.84f, 0.82f, 0.76f), tone_of(0.38f, 0.36f, 0.34f));
}
static void paint_shop_glass(struct canvas *c)
{
	paint_face(c, FACE_CONCRETE, canvas_box(c));
	struct front_look look = { dark_frame, { 0.86f, 0.87f, 0.88f }, { 0.62f, 0.63f, 0.66f }, 0.12f, 2.65f, 3.15f, 2,
		true };
	paint_front(c, &look);
	paint_lettering(c, 2.8f, 0.2f, tone_of(0.34f, 0.40f, 0.50f));
}
static void paint_shop_awning(struct canvas *c)
{
	paint_face(c, FACE_PLASTER, canvas_box(c));
	struct front_look look = { white_frame, { 0.80f, 0.79f, 0.76f }, { 0.60f, 0.62f, 0.52f }, 0.5f, 2.5f, 3.2f, 2,
		true };
	paint_front(c, &look);
	paint_lettering(c, 2.75f, 0.2f, tone_of(0.45f, 0.42f, 0.40f));
}
static void paint_shop_cafe(struct canvas *c)
{
	paint_face(c, FACE_PLASTER, canvas_box(c));
	struct tone wood = { 0.44f, 0.34f, 0.28f };
	struct front_look look = { wood, { 0.36f, 0.28f, 0.24f }, { 0.70f, 0.62f, 0.50f }, 0.8f, 2.5f, 3.1f, 3, true };
	paint_front(c, &look);
	paint_lettering(c, 2.7f, 0.24f, tone_of(0.92f, 0.86f, 0.74f));
}
static void paint_shop_stone(struct canvas *c)
{
	paint_face(c, FACE_ASHLAR, canvas_box(c));
	float edge = 0.4f;
	struct box opening = { edge, 0.0f, c->width_m - edge, 3.1f };
	canvas_arch(c, box_grow(opening, 0.04f), 0.6f, tone_grey(0.5f), tone_grey(0.5f), 0.0f);
	canvas_arch(c, opening, 0.6f, tone_of(0.30f, 0.31f, 0.32f), tone_of(0.30f, 0.31f, 0.32f), 0.0f);
	struct tone low = { 0.40f, 0.42f, 0.43f }, high = { 0.50f, 0.56f, 0.61f };
	struct box pane = { edge + 0.08f, 0.35f, c->width_m / 2.0f + 0.25f, 2.3f };
	canvas_gradient(c, pane, low, high, 1.0f);
	paint_goods(c, pane, tone_of(0.64f, 0.58f, 0.52f));
	canvas_gradient(c, box_of(pane.x1 + 0.1f, 0.1f, opening.x1 - 0.08f, 2.3f), low, high, 1.0f);
	canvas_arch(c, box_of(opening.x0 + 0.08f, 2.62f, opening.x1 - 0.08f, 3.02f), 0.36f, high, high, 1.0f);
	canvas_rect(c, box_of(opening.x0, 2.3f, opening.x1, 2.62f), tone_of(0.33f, 0.36f, 0.42f), 1.0f, 0.0f);
	paint_lettering(c, 2.38f, 0.16f, tone_of(0.86f, 0.84f, 0.78f));
}

static void paint_cornice(struct canvas *c)
{
	float h = c->height_m;
	paint_ledge(c, box_of(0.0f, h * 0.12f, c->width_m, h * 0.2f), 1.02f);
	canvas_shadow(c, box_of(0.0f, h * 0.2f, c->width_m, h * 0.62f), 0.38f);
	for (int i = 0; i < 5; i++) {
		float step = c->width_m / 5.0f, x = step * ((float)i + 0.25f);
		canvas_rect(c, box_of(x, h * 0.40f, x + step * 0.5f, h * 0.62f), tone_grey(0.93f), 1.0f, 0.0f);
		canvas_shade(c, box_of(x, h * 0.40f, x + step * 0.5f, h * 0.45f), 0.7f);
	}
	canvas_rect(c, box_of(0.0f, h * 0.62f, c->width_m, h), tone_grey(0.97f), 1.0f, 0.0f);
	canvas_shade(c, box_of(0.0f, h * 0.62f, c->width_m, h * 0.66f), 0.78f);
	canvas_shade(c, box_of(0.0f, h * 0.8f, c->width_m, h * 0.83f), 0.86f);
}

static void paint_trim(struct canvas *c)
{
	canvas_grain(c, 3, 0.02f, 31);
}

static void paint_dormer(struct canvas *c)
{
	canvas_rect(c, canvas_box(c), tone_grey(0.95f), 1.0f, 0.0f);
	struct window_look window = { WHITE, .frame_m = 0.06f, .columns = 2, .transom = 0.7f, .reveal_m = 0.03f,
		.curtains = true };
	paint_window(c, box_of(0.16f, 0.12f, c->width_m - 0.16f, c->height_m - 0.18f), &window);
}

/* Every second stripe keeps white; the others take the cloth's colour. */
static void paint_awning(struct canvas *c)
{
	for (int i = 0; i < 6; i++) {
		float step = c->width_m / 6.0f, x = step * (float)i, light = i % 2 ? 1.0f : 0.80f;
		canvas_gradient(
			c, box_of(x, c->height_m * 0.2f, x + step, c->height_m), tone_grey(0.90f * light), tone_grey(light), 0.0f);
		canvas_rect(c, box_of(x, 0.0f, x + step, c->height_m * 0.2f), tone_grey(0.86f * light), 1.0f, 0.0f);
	}
	canvas_shade(c, box_of(0.0f, c->height_m * 0.19f, c->width_m, c->height_m * 0.21f), 0.85f);
}

struct wall_painting {
	int material;
	float bay_m, storey_m;
	void (*paint)(struct canvas *canvas);
};

static const struct wall_painting paintings[] = {
	{ MATERIAL_WALL_STRIP, 3.0f, 3.3f, paint_strip },
	{ MATERIAL_WALL_GRID, 3.2f, 3.2f, paint_grid },
	{ MATERIAL_WALL_BALCONY, 4.0f, 2.9f, paint_balcony },
	{ MATERIAL_WALL_CURTAIN_BLUE, 3.0f, 3.6f, paint_curtain_blue },
	{ MATERIAL_WALL_CURTAIN_GREY, 3.0f, 3.5f, paint_curtain_grey },
	{ MATERIAL_WALL_CURTAIN_DARK, 3.0f, 3.6f, paint_curtain_dark },
	{ MATERIAL_WALL_PIER, 2.6f, 3.5f, paint_pier },
	{ MATERIAL_WALL_INDUSTRIAL, 5.0f, 4.5f, paint_industrial },
	{ MATERIAL_WALL_CHURCH, 4.5f, 10.0f, paint_church_wall },
	{ MATERIAL_WALL_BELFRY, 3.5f, 5.0f, paint_belfry },
	{ MATERIAL_WALL_BAY, 3.2f, 3.0f, paint_bay_window },
	{ MATERIAL_WALL_GREENHOUSE, 3.0f, 3.0f, paint_greenhouse },
	{ MATERIAL_BLANK_PLASTER, 3.0f, 3.0f, paint_blank_plaster },
	{ MATERIAL_BLANK_BRICK, 3.0f, 3.0f, paint_blank_brick },
	{ MATERIAL_BLANK_STONE, 3.0f, 3.0f, paint_blank_stone },
	{ MATERIAL_BLANK_CONCRETE, 3.0f, 3.0f, paint_blank_concrete },
	{ MATERIAL_BLANK_BOARDS, 3.0f, 3.0f, paint_blank_boards },
	{ MATERIAL_BLANK_METAL, 3.0f, 3.0f, paint_blank_metal },
	{ MATERIAL_GROUND_LOBBY, 3.2f, 4.0f, paint_lobby },
	{ MATERIAL_DOOR_PORTAL, 2.9f, 3.8f, paint_portal },
	{ MATERIAL_DOOR_PANEL, 2.9f, 3.4f, paint_door_panel },
	{ MATERIAL_DOOR_GLASS, 3.4f, 3.5f, paint_door_glass },
	{ MATERIAL_DOOR_BRICK, 2.9f, 3.3f, paint_door_brick },
	{ MATERIAL_DOOR_BOARDS, 2.9f, 3.2f, paint_door_boards },
	{ MATERIAL_DOOR_CHURCH, 4.0f, 4.8f, paint_door_church },
	{ MATERIAL_GATE_GARAGE, 3.0f, 2.8f, paint_gate_garage },
	{ MATERIAL_GATE_INDUSTRIAL, 4.5f, 4.5f, paint_gate_industrial },
	{ MATERIAL_SHOP_CLASSIC, 4.0f, 4.0f, paint_shop_classic },
	{ MATERIAL_SHOP_GLASS, 4.0f, 4.0f, paint_shop_glass },
	{ MATERIAL_SHOP_AWNING, 4.0f, 4.0f, paint_shop_awning },
	{ MATERIAL_SHOP_CAFE, 4.0f, 4.0f, paint_shop_cafe },
	{ MATERIAL_SHOP_CLASSIC_BLUE, 4.0f, 4.0f, paint_shop_blue },
	{ MATERIAL_SHOP_CLASSIC_RED, 4.0f, 4.0f, paint_shop_red },
	{ MATERIAL_SHOP_PALE, 4.0f, 4.0f, paint_shop_pale },
	{ MATERIAL_SHOP_STONE, 3.6f, 4.0f, paint_shop_stone },
	{ MATERIAL_CORNICE, 3.0f, 1.0f, paint_cornice },
	{ MATERIAL_TRIM, 2.0f, 2.0f, paint_trim },
	{ MATERIAL_DORMER, 1.4f, 1.6f, paint_dormer },
	{ MATERIAL_AWNING, 2.0f, 1.2f, paint_awning },
};

static bool glassy(int material)
{
	return material == MATERIAL_WALL_CURTAIN_BLUE || material == MATERIAL_WALL_CURTAIN_GREY ||
		   material == MATERIAL_WALL_CURTAIN_DARK || material == MATERIAL_WALL_GREENHOUSE ||
		   material == MATERIAL_GROUND_LOBBY;
}

static void finish_layer(struct material_layer *layers, int material, const struct canvas *canvas)
{
	struct material_layer *layer = &layers[material];
	bool shop = material >= MATERIAL_SHOP_CLASSIC && material <= MATERIAL_SHOP_STONE;
	layer->kind = shop ? PKG_MATERIAL_SHOP : PKG_MATERIAL_WALL;
	layer->gloss = glassy(material) ? 200 : shop ? 150 : 110;
	canvas_store(canvas, layer);
}

int paint_walls(struct material_layer *layers)
{
	float(*memory)[4] = malloc(sizeof(*memory) * MATERIAL_TEXTURE_PX * MATERIAL_TEXTURE_PX);
	if (!memory)
		return MATERIAL_WALL_FIRST;
	struct canvas canvas;
	for (size_t i = 0; i < sizeof(looks) / sizeof(looks[0]); i++) {
		canvas_start(&canvas, memory, looks[i].bay_m, looks[i].storey_m, wall_tone);
		paint_look(&canvas, &looks[i]);
		finish_layer(layers, looks[i].material, &canvas);
	}
	for (size_t i = 0; i < sizeof(paintings) / sizeof(paintings[0]); i++) {
		canvas_start(&canvas, memory, paintings[i].bay_m, paintings[i].storey_m, wall_tone);
		paintings[i].paint(&canvas);
		finish_layer(layers, paintings[i].material, &canvas);
	}
	free(memory);
	return MATERIAL_WALL_END;
}
