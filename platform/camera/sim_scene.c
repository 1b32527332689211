#include "platform/camera/sim_scene.h"

#include <math.h>

struct colour { /* BT.601, limited range */
	uint8_t y, u, v;
};

static struct colour colour(double r, double g, double b)
{
	double y = 0.299 * r + 0.587 * g + 0.114 * b;
	return (struct colour){ (uint8_t)lrint(16.0 + 219.0 * y), (uint8_t)lrint(128.0 + 224.0 * 0.5643 * (b - y)),
		(uint8_t)lrint(128.0 + 224.0 * 0.7133 * (r - y)) };
}

static uint8_t level(double value)
{
	return (uint8_t)lrint(255.0 * fmin(fmax(value, 0.0), 1.0));
}

static void put_rgb(uint8_t *at, struct colour c, bool blue_first)
{
	double y = (c.y - 16.0) / 219.0, u = (c.u - 128.0) / 224.0, v = (c.v - 128.0) / 224.0;
	uint8_t r = level(y + 1.402 * v), b = level(y + 1.772 * u);
	at[0] = blue_first ? b : r;
	at[1] = level(y - 0.344 * u - 0.714 * v);
	at[2] = blue_first ? r : b;
	at[3] = 255;
}

static void put(const struct camera_frame *frame, uint8_t *memory, uint32_t x, uint32_t y, struct colour c)
{
	uint8_t *row = memory + (size_t)y * frame->stride[0], *pair = row + (size_t)(x & ~1u) * 2;
	uint8_t *chroma;
	switch (frame->format) {
	case CAMERA_YUYV:
		row[2 * x] = c.y;
		pair[1] = c.u;
		pair[3] = c.v;
		return;
	case CAMERA_UYVY:
		row[2 * x + 1] = c.y;
		pair[0] = c.u;
		pair[2] = c.v;
		return;
	case CAMERA_NV12:
		row[x] = c.y;
		chroma = memory + (frame->plane[1] - frame->plane[0]) + (size_t)(y / 2) * frame->stride[1] + (x & ~1u);
		chroma[0] = c.u;
		chroma[1] = c.v;
		return;
	default:
		put_rgb(row + (size_t)x * 4, c, frame->format == CAMERA_BGRX);
	}
}

/* Share of a pixel covered by a line of half width `half`, `off` from its middle, when a pixel spans `span`. */
static double covered(double off, double half, double span)
{
	return fmin(fmax((half - fabs(off)) / span + 0.5, 0.0), 1.0);
}

#define BAY_M 2.5     /* between two lines */
#define BAY_END_M 5.6 /* of the lines, from the rear axle */
#define KERB_M 6.2

/* Asphalt in metre tiles, white bay lines, a kerb, grass behind it. `span` is what a pixel spans. */
static struct colour ground(double back, double right, double span)
{
	double tile = ((int)floor(back) + (int)floor(right)) & 1 ? 0.025 : 0.0;
	double far_tile = fmax(0.0, 1.0 - span);
	double grey = 0.30 + tile * far_tile;
	if (back > KERB_M + 0.25)
		return colour(0.26, 0.42 + 0.04 * sin(back * 2.0), 0.20);
	if (back > KERB_M)
		return colour(0.62, 0.61, 0.58);
	double bay = right - BAY_M * floor(right / BAY_M) - BAY_M / 2.0; /* the car stands in the middle of one */
	double line = back < BAY_END_M && fabs(right) < 4.0 * BAY_M ? covered(bay, 0.06, span) : 0.0;
	line = fmax(line, covered(back - BAY_END_M, 0.06, span) * (fabs(right) < 4.0 * BAY_M));
	return colour(grey + 0.58 * line, grey + 0.58 * line, grey + 0.02 + 0.55 * line);
}

static struct colour sky(double up)
{
	if (up < 0.06)
		return colour(0.45, 0.40, 0.36); /* a wall at the end */
	return colour(0.60 - 0.25 * up, 0.72 - 0.2 * up, 0.86);
}

void sim_scene_draw(const struct camera_config *config, const struct camera_frame *into, uint8_t *memory)
{
	double pixel = 1.0 / into->width, focal = lens_focal(&config->lens);
	for (uint32_t y = 0; y < into->height; y++) {
		for (uint32_t x = 0; x < into->width; x++) {
			struct dvec2 at = { (x + 0.5) * pixel - 0.5, (y + 0.5 - into->height / 2.0) * pixel };
			struct dvec3 ray;
			double back = 0.0, right = 0.0;
			struct colour c = colour(0.0, 0.0, 0.0);
			if (lens_unproject(&config->lens, at, &ray)) {
				double distance = ground_from_camera(&config->mount, ray, &back, &right)
									  ? hypot(back - config->mount.back_m, config->mount.height_m)
									  : 1e9;
				double up = ray.z * -sin(config->mount.pitch_rad) - ray.y * cos(config->mount.pitch_rad);
				c = distance < 25.0
						? ground(back, right, distance * distance * pixel / (focal * config->mount.height_m))
						: sky(up);
			}
			put(into, memory, x, y, c);
		}
	}
}

/* Seven segments: top, upper right, lower right, bottom, lower left, upper left, middle. */
static const uint8_t digit_segments[10] = { 0x3F, 0x06, 0x5B, 0x4F, 0x66, 0x6D, 0x7D, 0x07, 0x7F, 0x6F };

static bool in_digit(uint32_t digit, double x, double y) /* x 0 to 1, y 0 to 2 */
{
	const double t = 0.22;
	static const double boxes[7][4] = { { 0, 0, 1, 0 }, { 1, 0, 1, 1 }, { 1, 1, 1, 2 }, { 0, 2, 1, 2 }, { 0, 1, 0, 2 },
		{ 0, 0, 0, 1 }, { 0, 1, 1, 1 } };
	for (int i = 0; i < 7; i++) {
		const double *b = boxes[i];
		if ((digit_segments[digit] >> i & 1) && x > b[0] * (1 - t) && x < b[2] * (1 - t) + t &&
			y > b[1] * (1 - t / 2) && y < b[3] * (1 - t / 2) + t)
			return true;
	}
	return false;
}

void sim_scene_number(const struct camera_frame *into, uint8_t *memory, uint32_t number)
{
	const struct colour ink = colour(1.0, 0.95, 0.2), paper = colour(0.05, 0.05, 0.05);
	uint32_t unit = into->height / 16 ? into->height / 16 : 1, digits = 6, left = unit / 2, top = unit / 2;
	for (uint32_t y = 0; y < 3 * unit && top + y < into->height; y++) {
		uint32_t value = number;
		for (uint32_t i = digits; i-- > 0; value /= 10) {
			for (uint32_t x = 0; x < unit * 3 / 2; x++) {
				uint32_t px = left + i * unit * 3 / 2 + x;
				double fx = (double)x / unit - 0.25, fy = (double)y / unit - 0.5;
				if (px < into->width)
					put(into, memory, px, top + y, in_digit(value % 10, fx, fy) ? ink : paper);
			}
		}
	}
	uint32_t bar = into->width / 30 ? into->width / 30 : 1, at = number % 30 * bar;
	for (uint32_t y = 0; y < left && y < into->height; y++)
		for (uint32_t x = 0; x < into->width; x++)
			put(into, memory, x, y, x >= at && x < at + bar ? ink : paper);
}
