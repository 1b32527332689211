/* The bound on displacement over a view cell: a table of gains, made block by block when first asked for. */
#include "tools/impostor/displacement.h"

#include "tools/city/pool.h"
#include "tools/impostor/parallax.h"

#define REMAINING_MIN 0.05
#define BLOCK_MIN_PX 8
#define TOLERANCE_MAX 1e3 /* 1/m; what has no parallax */

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

void displacement_init(struct displacement *displacement, const struct view_cell *cell, const struct capture_view *view,
	double focal_px, double disparity_max)
{
	*displacement = (struct displacement){
		.focal_px = focal_px,
		.capture_focal_px = view->focal_px,
		.centre_x = view->centre_x,
		.centre_y = view->centre_y,
		.disparity_max = fmax(disparity_max * 1.05, 1e-9),
		.block_px = BLOCK_MIN_PX,
	};
	while (displacement->block_px * 64 < view->focal_px)
		displacement->block_px *= 2;
	struct dvec3 corners[VIEW_CELL_CORNERS];
	view_cell_corners(cell, corners);
	for (int i = 0; i < VIEW_CELL_CORNERS; i++) {
		struct dvec3 o = { corners[i].x - view->eye.x, corners[i].y - view->eye.y, corners[i].z - view->eye.z };
		displacement->corners[i] = (struct dvec3){ dot(o, view->right), dot(o, view->up), dot(o, view->forward) };
	}
	displacement->blocks_x = view->width / displacement->block_px + 1;
	displacement->blocks_y = view->height / displacement->block_px + 1;
	size_t count = (size_t)displacement->blocks_x * displacement->blocks_y * DISPLACEMENT_KNOTS, capacity = 0;
	displacement->gains = array_grow(NULL, &capacity, count, sizeof(float));
	for (size_t i = 0; i < count; i += DISPLACEMENT_KNOTS)
		displacement->gains[i] = -1;
}

void displacement_finish(struct displacement *displacement)
{
	array_free(displacement->gains);
	displacement->gains = NULL;
}

/* What a corner means for the rays within `spread` (of the direction, at forward 1) of a block's middle: no ray has
 * more. `across` and `along` are over the ray's length. */
struct reach {
	double across, along;
};

static struct dvec3 direction(const struct displacement *displacement, double x, double y)
{
	return (struct dvec3){ (x - displacement->centre_x) / displacement->capture_focal_px,
		(displacement->centre_y - y) / displacement->capture_focal_px, 1 };
}

static struct reach reach_of(struct dvec3 corner, struct dvec3 ray, double spread)
{
	double length = sqrt(dot(ray, ray)), distance = sqrt(dot(corner, corner));
	double slack = distance * spread / (length - spread);
	double along = dot(corner, ray) / length;
	double across = sqrt(fmax(distance * distance - along * along, 0)) + slack;
	along += slack;
	return (struct reach){ across / (length - spread), along / (along > 0 ? length - spread : length + spread) };
}

/* Corners in the order of view_cell_corners(): bit 0 left, bit 1 up, bit 2 the end. */
static const uint8_t edges[12][2] = { { 0, 4 }, { 1, 5 }, { 2, 6 }, { 3, 7 }, { 0, 1 }, { 2, 3 }, { 4, 5 }, { 6, 7 },
	{ 0, 2 }, { 1, 3 }, { 4, 6 }, { 5, 7 } };

/* Both factors are convex along an edge of the box, so the product of their chords is an upper bound; where one rises
 * and the other falls, it is largest in between. */
static double largest_gain(const struct reach reach[8], double w)
{
	double shrink[8], largest = 0;
	for (int i = 0; i < 8; i++) {
		double remaining = fmax(1 - reach[i].along * w, REMAINING_MIN);
		shrink[i] = 1 / (remaining * remaining);
		largest = fmax(largest, reach[i].across * shrink[i]);
	}
	for (int i = 0; i < 12; i++) {
		int from = edges[i][0], to = edges[i][1];
		double a = reach[from].across, b = reach[to].across - a, c = shrink[from], d = shrink[to] - c;
		double curve = b * d, slope = a * d + b * c;
		if (curve < 0 && slope > 0 && slope < -2 * curve)
			largest = fmax(largest, a * c - slope * slope / (4 * curve));
	}
	return largest;
}

static double knot(const struct displacement *displacement, int index)
{
	return displacement->disparity_max * index / (DISPLACEMENT_KNOTS - 1);
}

/* What the corners mean for all rays of a block. */
static void reach_block(const struct displacement *displacement, uint32_t column, uint32_t row, struct reach reach[8])
{
	double half = 0.5 * displacement->block_px;
	struct dvec3 ray = direction(displacement, column * (2 * half) + half, row * (2 * half) + half);
	double spread = (half + 0.5) * 1.4143 / displacement->capture_focal_px;
	/* Narrow images of wide angles: a block is never more than a third of the ray. */
	spread = fmin(spread, sqrt(dot(ray, ray)) / 3);
	for (int i = 0; i < 8; i++)
		reach[i] = reach_of(displacement->corners[i], ray, spread);
}

static void make_block(const struct displacement *displacement, uint32_t column, uint32_t row, float *gains)
{
	struct reach reach[8];
	reach_block(displacement, column, row, reach);
	for (int i = 0; i < DISPLACEMENT_KNOTS; i++)
		gains[i] = (float)(largest_gain(reach, knot(displacement, i)) * (1 + 1e-6));
}

static uint32_t block_index(double at, uint32_t block_px, uint32_t count)
{
	double index = at / block_px;
	return index <= 0 ? 0 : index >= count ? count - 1 : (uint32_t)index;
}

/* gain is convex in the disparity: chords between knots are above it. */
static double gain(struct displacement *displacement, double x, double y, double w)
{
	uint32_t column = block_index(x, displacement->block_px, displacement->blocks_x);
	uint32_t row = block_index(y, displacement->block_px, displacement->blocks_y);
	if (w < 0 || w >= displacement->disparity_max) {
		struct reach reach[8];
		reach_block(displacement, column, row, reach);
		return largest_gain(reach, w) * (1 + 1e-6);
	}
	float *gains = displacement->gains + ((size_t)row * displacement->blocks_x + column) * DISPLACEMENT_KNOTS;
	if (gains[0] < 0)
		make_block(displacement, column, row, gains);
	double at = w / displacement->disparity_max * (DISPLACEMENT_KNOTS - 1);
	int low = (int)at;
	return gains[low] + (at - low) * (gains[low + 1] - gains[low]);
}

double displacement_px(struct displacement *displacement, double x, double y, double w, double drawn)
{
	double mean = 0.5 * (gain(displacement, x, y, w) + gain(displacement, x, y, drawn));
	double sine = fabs(w - drawn) * mean;
	if (sine >= 1)
		return BLVD_PI * displacement->focal_px;
	/* asin(s) <= s + (pi / 2 - 1) s^3 */
	return sine * (1 + (0.5 * BLVD_PI - 1) * sine * sine) * displacement->focal_px;
}

double displacement_tolerance(struct displacement *displacement, double x, double y, double w, double px)
{
	double angle = px / displacement->focal_px;
	double sine = angle < 0.5 ? angle / (1 + (0.5 * BLVD_PI - 1) * angle * angle) : 0.4;
	double here = gain(displacement, x, y, w);
	if (here * TOLERANCE_MAX <= sine)
		return TOLERANCE_MAX;
	double first = fmin(sine / here, fabs(w));
	double there = fmax(here, fmax(gain(displacement, x, y, w + first), gain(displacement, x, y, w - first)));
	return fmin(sine / (0.5 * (here + there)), first);
}

double displacement_scale(const struct displacement *displacement, double x, double y, double w)
{
	struct dvec3 ray = direction(displacement, x, y);
	double remaining = 1;
	for (int i = 0; i < 8; i++)
		remaining = fmin(remaining, 1 - reach_of(displacement->corners[i], ray, 0).along * w);
	double length = sqrt(dot(ray, ray));
	return displacement->focal_px / (displacement->capture_focal_px * length * fmax(remaining, REMAINING_MIN));
}
