/* The path is that of a bicycle with the car's wheelbase (Ackermann): radius of the rear axle's middle L / tan(angle).
 */
#include "render/guide.h"

#include <math.h>
#include <stdio.h>

#include "render/stroke_font.h"

#define POINTS 40 /* of one line */
#define REACH_M 3.0
#define STRAIGHT_PER_M 1e-4 /* a smaller curvature is none */
#define ANGLE_MAX_RAD 0.9

struct band { /* of the static lines */
	double from_m, to_m;
	uint32_t rgb;
};
static const struct band bands[] = { { 0.0, 1.0, 0xFF3B30 }, { 1.0, 2.0, 0xFFCC00 }, { 2.0, 3.0, 0x34C759 } };
static const struct {
	double at_m;
	const char *text;
	uint32_t rgb;
} marks[] = { { 0.5, "0.5", 0xFF3B30 }, { 1.0, "1", 0xFF3B30 }, { 2.0, "2", 0xFFCC00 }, { 3.0, "3 M", 0x34C759 } };
#define PATH_RGB 0x5AC8FA

struct pen {
	struct canvas *canvas;
	const struct guide_config *config;
	const struct box *picture;
	double angle_rad;
	float scale, brightness;
};

bool guide_place(const struct guide_config *config, const struct box *picture, double back_m, double right_m,
	double up_m, struct vec2 *out)
{
	struct dvec2 at;
	if (!lens_project(&config->lens, camera_from_car(&config->mount, back_m, right_m, up_m), &at))
		return false;
	double width = picture->x1 - picture->x0;
	out->x = (float)((picture->x0 + picture->x1) / 2.0 + (config->mirror ? -at.x : at.x) * width);
	out->y = (float)((picture->y0 + picture->y1) / 2.0 + at.y * width);
	return out->x >= picture->x0 && out->x <= picture->x1 && out->y >= picture->y0 && out->y <= picture->y1;
}

struct dvec2 guide_moved(
	const struct guide_config *config, double angle_rad, double travel_m, double back_m, double right_m)
{
	double limited = fmin(fmax(angle_rad, -ANGLE_MAX_RAD), ANGLE_MAX_RAD);
	double curvature = config->wheelbase_m > 0.0 ? tan(limited) / config->wheelbase_m : 0.0;
	if (fabs(curvature) < STRAIGHT_PER_M)
		return (struct dvec2){ right_m, back_m + travel_m };
	double radius = 1.0 / curvature, turn = travel_m * curvature, from_centre = right_m - radius;
	return (struct dvec2){ radius + from_centre * cos(turn) + back_m * sin(turn),
		back_m * cos(turn) - from_centre * sin(turn) };
}

/* A place behind the bumper: `away_m` along the path that the bumper's middle takes, `right_m` off it. */
static bool place(const struct pen *pen, bool moving, double away_m, double right_m, struct vec2 *out)
{
	const struct guide_config *config = pen->config;
	struct dvec2 at = { right_m, config->overhang_m + away_m };
	if (moving) {
		double across =
			config->wheelbase_m > 0.0 ? tan(pen->angle_rad) / config->wheelbase_m * config->overhang_m : 0.0;
		at = guide_moved(config, pen->angle_rad, away_m / hypot(1.0, across), config->overhang_m, right_m);
	}
	return guide_place(config, pen->picture, at.y, at.x, 0.0, out);
}

static void stroke(const struct pen *pen, const struct vec2 *points, uint32_t count, float width, uint32_t rgb)
{
	if (count < 2)
		return;
	struct rgba color = rgba_hex(rgb, 1.0f);
	color.r *= pen->brightness;
	color.g *= pen->brightness;
	color.b *= pen->brightness;
	canvas_stroke(pen->canvas, points, count, width + 4.0f * pen->scale, rgba_hex(0x000000, 0.55f));
	canvas_stroke(pen->canvas, points, count, width, color);
}

/* From one place to another, both behind the bumper; what the picture does not show is left out. */
static void line(
	const struct pen *pen, bool moving, const double from[2], const double to[2], float width, uint32_t rgb)
{
	struct vec2 points[POINTS + 1];
	uint32_t count = 0;
	for (int i = 0; i <= POINTS; i++) {
		double part = (double)i / POINTS;
		if (place(pen, moving, from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part, &points[count]))
			count++;
		else if (count) {
			stroke(pen, points, count, width, rgb);
			count = 0;
		}
	}
	stroke(pen, points, count, width, rgb);
}

/* Marks are brackets on both sides, so that what stands in the middle stays visible; the nearest is a whole line. */
static void draw_width(const struct pen *pen)
{
	double half = pen->config->width_m / 2.0;
	float wide = 6.0f * pen->scale;
	for (int side = -1; side <= 1; side += 2) {
		for (size_t i = 0; i < sizeof(bands) / sizeof(*bands); i++)
			line(pen, false, (double[]){ bands[i].from_m, side * half }, (double[]){ bands[i].to_m, side * half }, wide,
				bands[i].rgb);
		for (size_t i = 0; i < sizeof(marks) / sizeof(*marks); i++)
			line(pen, false, (double[]){ marks[i].at_m, side * half },
				(double[]){ marks[i].at_m, side * half * (i == 0 ? 0.0 : 0.62) }, wide, marks[i].rgb);
	}
}

static void draw_path(const struct pen *pen)
{
	double half = pen->config->width_m / 2.0;
	float wide = 12.0f * pen->scale; /* straight, it is seen on both sides of the width */
	for (int side = -1; side <= 1; side += 2)
		line(pen, true, (double[]){ 0.0, side * half }, (double[]){ REACH_M, side * half }, wide, PATH_RGB);
	for (size_t i = 1; i < sizeof(marks) / sizeof(*marks); i++)
		line(pen, true, (double[]){ marks[i].at_m, -half }, (double[]){ marks[i].at_m, half }, 3.0f * pen->scale,
			PATH_RGB);
}

/* Beside the marks, outside the car's width, on the side of the screen's right. */
static void draw_texts(const struct pen *pen)
{
	double half = pen->config->width_m / 2.0, side = pen->config->mirror ? 1.0 : -1.0;
	struct stroke_style style = {
		.cap_px = 20.0f * pen->scale,
		.halo = rgba_hex(0x000000, 0.6f),
		.halo_px = 3.0f * pen->scale,
		.align = TEXT_LEFT,
	};
	for (size_t i = 0; i < sizeof(marks) / sizeof(*marks); i++) {
		struct vec2 at;
		if (!place(pen, false, marks[i].at_m, side * half, &at))
			continue;
		style.color = rgba_hex(marks[i].rgb, 1.0f);
		style.color.r *= pen->brightness;
		style.color.g *= pen->brightness;
		style.color.b *= pen->brightness;
		stroke_font_draw(pen->canvas, marks[i].text, at.x + 18.0f * pen->scale, at.y, &style);
	}
}

void guide_draw(struct canvas *canvas, const struct guide_config *config, const struct box *picture, bool angle_known,
	double angle_rad, float scale, float brightness)
{
	struct pen pen = { .canvas = canvas,
		.config = config,
		.picture = picture,
		.angle_rad = fmin(fmax(angle_rad, -ANGLE_MAX_RAD), ANGLE_MAX_RAD),
		.scale = scale,
		.brightness = brightness };
	if (angle_known && config->wheelbase_m > 0.0)
		draw_path(&pen);
	draw_width(&pen);
	draw_texts(&pen);
}
