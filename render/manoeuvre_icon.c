/* Shapes are given in a square from -1 to 1, y up; a few hundred vertices each. */
#include "render/manoeuvre_icon.h"

#include <math.h>
#include <stdio.h>

#define PATH_MAX_POINTS 40
#define STROKE 0.25f
#define HEAD_LENGTH 0.46f
#define HEAD_HALF_WIDTH 0.40f

struct drawing {
	struct canvas *canvas;
	struct vec2 center;
	float unit_px;
	struct rgba color;
	struct vec2 points[PATH_MAX_POINTS]; /* the pen's path, in pixels */
	uint32_t count;
};

static struct vec2 to_px(const struct drawing *drawing, float x, float y)
{
	return (struct vec2){ drawing->center.x + x * drawing->unit_px, drawing->center.y - y * drawing->unit_px };
}

static void line_to(struct drawing *drawing, float x, float y)
{
	if (drawing->count < PATH_MAX_POINTS)
		drawing->points[drawing->count++] = to_px(drawing, x, y);
}

/* Quadratic curve from (x0, y0), already the last point, by (x1, y1). */
static void curve_to(struct drawing *drawing, float x0, float y0, float x1, float y1, float x2, float y2)
{
	for (int i = 1; i <= 10; i++) {
		float t = (float)i / 10.0f, u = 1.0f - t;
		line_to(drawing, u * u * x0 + 2.0f * u * t * x1 + t * t * x2, u * u * y0 + 2.0f * u * t * y1 + t * t * y2);
	}
}

static void finish_stroke(struct drawing *drawing)
{
	canvas_stroke(drawing->canvas, drawing->points, drawing->count, STROKE * drawing->unit_px, drawing->color);
	drawing->count = 0;
}

/* The path ends in a head whose tip lies HEAD_LENGTH beyond the last point, in the path's last direction. */
static void finish_arrow(struct drawing *drawing)
{
	struct vec2 end = drawing->points[drawing->count - 1], before = drawing->points[drawing->count - 2];
	float length = hypotf(end.x - before.x, end.y - before.y);
	float dx = (end.x - before.x) / length, dy = (end.y - before.y) / length, unit = drawing->unit_px;
	float back = 0.06f * unit;
	struct vec2 base = { end.x - dx * back, end.y - dy * back };
	const struct vec2 head[3] = {
		{ base.x - dy * HEAD_HALF_WIDTH * unit, base.y + dx * HEAD_HALF_WIDTH * unit },
		{ base.x + dy * HEAD_HALF_WIDTH * unit, base.y - dx * HEAD_HALF_WIDTH * unit },
		{ end.x + dx * HEAD_LENGTH * unit, end.y + dy * HEAD_LENGTH * unit },
	};
	finish_stroke(drawing);
	canvas_convex(drawing->canvas, head, 3, 1.0f, drawing->color);
}

/* From below, up to a bend at (stem_x, bend_y), then `reach` towards `turn_deg` (clockwise from up). */
static void draw_turn(struct drawing *drawing, float stem_x, float bend_y, float turn_deg, float reach)
{
	float angle = turn_deg * (float)BLVD_PI / 180.0f, cut = 0.3f;
	float dx = sinf(angle), dy = cosf(angle);
	line_to(drawing, stem_x, -0.92f);
	line_to(drawing, stem_x, bend_y - cut);
	curve_to(drawing, stem_x, bend_y - cut, stem_x, bend_y, stem_x + dx * cut, bend_y + dy * cut);
	line_to(drawing, stem_x + dx * reach, bend_y + dy * reach);
	finish_arrow(drawing);
}

static void draw_straight(struct drawing *drawing)
{
	line_to(drawing, 0.0f, -0.92f);
	line_to(drawing, 0.0f, 0.46f);
	finish_arrow(drawing);
}

static void draw_u_turn(struct drawing *drawing, float side)
{
	const float radius = 0.36f;
	line_to(drawing, side * radius, -0.92f);
	for (int i = 0; i <= 16; i++) {
		float angle = (float)BLVD_PI * (float)i / 16.0f;
		line_to(drawing, side * radius * cosf(angle), 0.42f + radius * sinf(angle));
	}
	line_to(drawing, -side * radius, -0.22f);
	finish_arrow(drawing);
}

static void draw_keep(struct drawing *drawing, const struct manoeuvre_icon *icon, float side)
{
	drawing->color = icon->rest;
	line_to(drawing, 0.0f, -0.35f);
	curve_to(drawing, 0.0f, -0.35f, 0.0f, 0.1f, -side * 0.34f, 0.4f);
	line_to(drawing, -side * 0.5f, 0.56f);
	finish_stroke(drawing);
	drawing->color = icon->color;
	line_to(drawing, 0.0f, -0.92f);
	line_to(drawing, 0.0f, -0.45f);
	curve_to(drawing, 0.0f, -0.45f, 0.0f, -0.05f, side * 0.38f, 0.22f);
	curve_to(drawing, side * 0.38f, 0.22f, side * 0.42f, 0.28f, side * 0.42f, 0.46f);
	finish_arrow(drawing);
}

static void draw_merge(struct drawing *drawing, const struct manoeuvre_icon *icon)
{
	float side = icon->right_hand ? 1.0f : -1.0f;
	drawing->color = icon->rest;
	line_to(drawing, -side * 0.2f, -0.92f);
	line_to(drawing, -side * 0.2f, 0.3f);
	finish_stroke(drawing);
	drawing->color = icon->color;
	line_to(drawing, side * 0.6f, -0.92f);
	curve_to(drawing, side * 0.6f, -0.92f, side * 0.52f, -0.4f, side * 0.16f, -0.2f);
	curve_to(drawing, side * 0.16f, -0.2f, -side * 0.2f, -0.02f, -side * 0.2f, 0.3f);
	line_to(drawing, -side * 0.2f, 0.46f);
	finish_arrow(drawing);
}

static void draw_exit_number(
	struct drawing *drawing, const struct text_font *font, const struct manoeuvre_icon *icon, struct vec2 center)
{
	char number[16];
	if (!font || !icon->exit || icon->exit > 99)
		return;
	snprintf(number, sizeof(number), "%u", icon->exit);
	float size = 0.62f * drawing->unit_px;
	struct text_style style = { .size_px = size, .fill = icon->color, .weight = 0.03f, .align = TEXT_CENTER };
	struct text_line line = text_line_utf8(number);
	text_draw(drawing->canvas, font, &line, center.x, center.y + text_middle(font, size), &style);
}

static void draw_roundabout(struct drawing *drawing, const struct text_font *font, const struct manoeuvre_icon *icon)
{
	const float radius = 0.44f, pi = (float)BLVD_PI;
	float unit = drawing->unit_px, exit_angle = (float)bam_to_rad(icon->angle_bam);
	/* the ring gives way to the arrow that leaves it */
	float ring_x = -0.22f * sinf(exit_angle), ring_y = -0.02f - 0.12f * cosf(exit_angle);
	struct vec2 ring = to_px(drawing, ring_x, ring_y);
	float sweep = icon->right_hand ? exit_angle - pi : exit_angle + pi;
	sweep = fabsf(sweep) < 0.35f ? (icon->right_hand ? -2.0f * pi : 2.0f * pi) : sweep;
	canvas_arc(drawing->canvas, ring, radius * unit, STROKE * unit, 0.0f, 2.0f * pi, icon->rest);
	line_to(drawing, ring_x, -0.98f);
	line_to(drawing, ring_x, ring_y - radius);
	finish_stroke(drawing);
	canvas_arc(drawing->canvas, ring, radius * unit, STROKE * unit, icon->right_hand ? pi : -pi, sweep, icon->color);
	float dx = sinf(exit_angle), dy = cosf(exit_angle);
	line_to(drawing, ring_x + dx * radius, ring_y + dy * radius);
	line_to(drawing, ring_x + dx * (radius + 0.3f), ring_y + dy * (radius + 0.3f));
	finish_arrow(drawing);
	draw_exit_number(drawing, font, icon, ring);
}

/* A pin on its point. */
static void draw_destination(struct drawing *drawing, const struct manoeuvre_icon *icon)
{
	float unit = drawing->unit_px;
	struct vec2 head = to_px(drawing, 0.0f, 0.3f);
	const struct vec2 tip[3] = { to_px(drawing, -0.47f, 0.06f), to_px(drawing, 0.47f, 0.06f),
		to_px(drawing, 0.0f, -0.9f) };
	canvas_convex(drawing->canvas, tip, 3, 1.0f, icon->color);
	canvas_arc(drawing->canvas, head, 0.37f * unit, 0.32f * unit, 0.0f, 2.0f * (float)BLVD_PI, icon->color);
}

void manoeuvre_icon_draw(struct canvas *canvas, const struct text_font *font, const struct manoeuvre_icon *icon,
	struct vec2 center, float size_px)
{
	struct drawing drawing = { .canvas = canvas, .center = center, .unit_px = size_px / 2.0f, .color = icon->color };
	switch (icon->manoeuvre) {
	case NAV_MANOEUVRE_NONE:
		break;
	case NAV_MANOEUVRE_STRAIGHT:
		draw_straight(&drawing);
		break;
	case NAV_MANOEUVRE_SLIGHT_LEFT:
		draw_turn(&drawing, 0.24f, -0.1f, -42.0f, 0.66f);
		break;
	case NAV_MANOEUVRE_SLIGHT_RIGHT:
		draw_turn(&drawing, -0.24f, -0.1f, 42.0f, 0.66f);
		break;
	case NAV_MANOEUVRE_LEFT:
		draw_turn(&drawing, 0.36f, 0.34f, -90.0f, 0.72f);
		break;
	case NAV_MANOEUVRE_RIGHT:
		draw_turn(&drawing, -0.36f, 0.34f, 90.0f, 0.72f);
		break;
	case NAV_MANOEUVRE_SHARP_LEFT:
		draw_turn(&drawing, 0.36f, 0.66f, -135.0f, 0.78f);
		break;
	case NAV_MANOEUVRE_SHARP_RIGHT:
		draw_turn(&drawing, -0.36f, 0.66f, 135.0f, 0.78f);
		break;
	case NAV_MANOEUVRE_U_TURN:
		draw_u_turn(&drawing, icon->right_hand ? 1.0f : -1.0f);
		break;
	case NAV_MANOEUVRE_ROUNDABOUT:
		draw_roundabout(&drawing, font, icon);
		break;
	case NAV_MANOEUVRE_KEEP_LEFT:
		draw_keep(&drawing, icon, -1.0f);
		break;
	case NAV_MANOEUVRE_KEEP_RIGHT:
		draw_keep(&drawing, icon, 1.0f);
		break;
	case NAV_MANOEUVRE_MERGE:
		draw_merge(&drawing, icon);
		break;
	case NAV_MANOEUVRE_ARRIVE:
		draw_destination(&drawing, icon);
		break;
	}
}
