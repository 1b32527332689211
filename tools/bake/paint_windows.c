#include "tools/bake/paint_windows.h"

static const struct tone glass_low = { 0.27f, 0.32f, 0.37f };
static const struct tone glass_high = { 0.45f, 0.53f, 0.60f };

static void paint_courses(struct canvas *canvas, struct box box, struct courses courses)
{
	canvas_courses(canvas, box, &courses);
}

static void paint_panels(struct canvas *canvas, struct box box, float joint_m)
{
	canvas_shade(canvas, box_of(box.x0, box.y0, box.x1, box.y0 + joint_m), 0.80f);
	canvas_shade(canvas, box_of(box.x0, box.y0, box.x0 + joint_m, box.y1), 0.84f);
}

void paint_face(struct canvas *canvas, enum wall_face face, struct box box)
{
	int rows_low = (int)((box.y1 - box.y0) / 0.42f + 0.5f), rows_brick = (int)((box.y1 - box.y0) / 0.083f + 0.5f);
	switch (face) {
	case FACE_PLASTER:
		canvas_grain(canvas, 5, 0.035f, 11);
		break;
	case FACE_BRICK:
		paint_courses(canvas, box,
			(struct courses){ rows_brick & ~1, (int)((box.x1 - box.x0) / 0.25f), 0.012f, 0.16f, 0.09f, 3 });
		canvas_grain(canvas, 4, 0.05f, 12);
		break;
	case FACE_ASHLAR:
		paint_courses(canvas, box,
			(struct courses){ rows_low & ~1, (int)((box.x1 - box.x0) / 0.8f + 0.5f), 0.014f, 0.13f, 0.025f, 5 });
		canvas_grain(canvas, 5, 0.03f, 13);
		break;
	case FACE_RUSTIC:
		paint_courses(canvas, box,
			(struct courses){ rows_low & ~1, (int)((box.x1 - box.x0) / 0.9f + 0.5f), 0.045f, 0.24f, 0.03f, 7 });
		canvas_grain(canvas, 7, 0.05f, 14);
		break;
	case FACE_CONCRETE:
		canvas_grain(canvas, 3, 0.045f, 15);
		break;
	case FACE_PANELS:
		canvas_grain(canvas, 3, 0.02f, 16);
		paint_panels(canvas, box, 0.03f);
		break;
	case FACE_BOARDS:
		canvas_boards(canvas, box, (int)((box.y1 - box.y0) / 0.17f + 0.5f), 0.16f);
		canvas_grain(canvas, 4, 0.025f, 17);
		break;
	case FACE_RIBS:
		canvas_ribs(canvas, box, (int)((box.x1 - box.x0) / 0.25f + 0.5f), 0.16f);
		break;
	}
}

void paint_pane(struct canvas *canvas, struct box box)
{
	canvas_gradient(canvas, box, glass_low, glass_high, 1.0f);
}

static void paint_curtains(struct canvas *canvas, struct box box)
{
	float width = (box.x1 - box.x0) * 0.2f;
	struct tone cloth = { 0.62f, 0.63f, 0.62f };
	canvas_rect(canvas, box_of(box.x0, box.y0, box.x0 + width, box.y1), cloth, 0.55f, 1.0f);
	canvas_rect(canvas, box_of(box.x1 - width, box.y0, box.x1, box.y1), cloth, 0.55f, 1.0f);
}

static void paint_bars(struct canvas *canvas, struct box glass, const struct window_look *look)
{
	float width = (glass.x1 - glass.x0) / (float)look->columns, half = look->frame_m * 0.6f;
	for (int i = 1; i < look->columns; i++) {
		float x = glass.x0 + width * (float)i;
		canvas_rect(canvas, box_of(x - half, glass.y0, x + half, glass.y1), look->frame, 1.0f, 0.0f);
	}
	if (look->transom > 0.0f) {
		float y = glass.y0 + (glass.y1 - glass.y0) * look->transom;
		canvas_rect(canvas, box_of(glass.x0, y - half, glass.x1, y + half), look->frame, 1.0f, 0.0f);
	}
	for (int i = 1; i <= look->bars; i++) {
		float y = glass.y0 + (glass.y1 - glass.y0) * (float)i / (float)(look->bars + 1);
		canvas_rect(canvas, box_of(glass.x0, y - 0.014f, glass.x1, y + 0.014f), look->frame, 0.9f, 0.0f);
	}
}

void paint_window(struct canvas *canvas, struct box box, const struct window_look *look)
{
	struct tone deep = tone_grey(0.50f);
	if (look->reveal_m > 0.0f)
		canvas_arch(canvas, box, look->arch_m, deep, deep, 0.0f);
	struct box frame = { box.x0 + look->reveal_m, box.y0, box.x1 - look->reveal_m * 0.4f, box.y1 - look->reveal_m };
	canvas_arch(canvas, frame, look->arch_m, look->frame, look->frame, 0.0f);
	struct box glass = box_grow(frame, -look->frame_m);
	canvas_arch(canvas, glass, look->arch_m > 0.0f ? look->arch_m - look->frame_m : 0.0f, glass_low, glass_high, 1.0f);
	if (look->curtains)
		paint_curtains(canvas, glass);
	canvas_shadow(canvas, box_of(glass.x0, glass.y1 - 0.22f, glass.x1, glass.y1), 0.38f);
	paint_bars(canvas, glass, look);
}

void paint_ledge(struct canvas *canvas, struct box box, float light)
{
	canvas_rect(canvas, box, tone_grey(0.93f * light), 0.85f, 0.0f);
	canvas_shade(canvas, box_of(box.x0, box.y1 - (box.y1 - box.y0) * 0.3f, box.x1, box.y1), 1.06f);
	float drop = (box.y1 - box.y0) * 0.9f;
	canvas_shadow(canvas, box_of(box.x0 + 0.03f, box.y0 - drop, box.x1, box.y0), 0.26f);
}

void paint_surround(struct canvas *canvas, struct box opening, float width_m, float light)
{
	struct box outer = { opening.x0 - width_m, opening.y0, opening.x1 + width_m, opening.y1 + width_m };
	canvas_shade(canvas, box_of(outer.x1, outer.y0, outer.x1 + 0.03f, outer.y1), 0.86f);
	canvas_rect(canvas, outer, tone_grey(0.95f * light), 0.75f, 0.0f);
	canvas_shade(canvas, box_of(outer.x0, outer.y0, outer.x0 + 0.02f, outer.y1), 1.05f);
}

void paint_shutter(struct canvas *canvas, struct box box, struct tone tone)
{
	canvas_shade(canvas, box_of(box.x0 + 0.03f, box.y0 - 0.04f, box.x1 + 0.04f, box.y1 - 0.03f), 0.78f);
	canvas_rect(canvas, box, tone, 1.0f, 0.0f);
	canvas_shade(canvas, box, 1.0f);
	struct box slats = box_grow(box, -0.05f);
	float middle = (slats.y0 + slats.y1) / 2.0f;
	canvas_boards(canvas, box_of(slats.x0, slats.y0, slats.x1, middle - 0.04f), 10, 0.30f);
	canvas_boards(canvas, box_of(slats.x0, middle + 0.04f, slats.x1, slats.y1), 10, 0.30f);
}

void paint_railing(struct canvas *canvas, struct box box, struct tone tone, int bars)
{
	canvas_rect(canvas, box_of(box.x0, box.y1 - 0.05f, box.x1, box.y1), tone, 1.0f, 0.0f);
	canvas_rect(canvas, box_of(box.x0, box.y0, box.x1, box.y0 + 0.04f), tone, 1.0f, 0.0f);
	for (int i = 0; i <= bars; i++) {
		float x = box.x0 + (box.x1 - box.x0 - 0.02f) * (float)i / (float)bars;
		canvas_rect(canvas, box_of(x, box.y0, x + 0.022f, box.y1), tone, 0.85f, 0.0f);
	}
}

void paint_leaf(struct canvas *canvas, struct box box, struct tone tone, int rows)
{
	canvas_rect(canvas, box, tone, 1.0f, 0.0f);
	float step = (box.y1 - box.y0) / (float)rows;
	for (int i = 0; i < rows; i++) {
		struct box panel = { box.x0 + 0.09f, box.y0 + step * (float)i + 0.07f, box.x1 - 0.09f,
			box.y0 + step * (float)(i + 1) - 0.07f };
		canvas_shade(canvas, panel, 0.80f);
		canvas_shade(canvas, box_grow(panel, -0.03f), 1.22f);
	}
	canvas_shade(canvas, box_of(box.x0, box.y0, box.x0 + 0.02f, box.y1), 0.7f);
}
