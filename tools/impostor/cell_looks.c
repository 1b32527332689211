/*
 * Side streets are narrow gaps, and the view through one sweeps over the distance while the eye passes: hence a look
 * every STEP_M along the axis, by turns left, right and in the middle, and both sides at either end. Four faces serve
 * both of the stretch's cells.
 */
#include "tools/impostor/cell_looks.h"

#include <errno.h>
#include <string.h>

#define STEP_M 5.0
#define NEAR_PLANE_M 0.3

void cell_looks_finish(struct cell_looks *looks)
{
	for (size_t i = 0; i < looks->images.count; i++)
		capture_image_finish(&looks->images.items[i]);
	ARRAY_FINISH(&looks->images);
	ARRAY_FINISH(&looks->corners);
	ARRAY_FINISH(&looks->item_of);
	capture_image_finish(&looks->scratch);
	looks->count = 0;
}

void cell_looks_mark(struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, bool mark)
{
	if (looks->item_of.count < pkg->object_count) {
		ARRAY_RESERVE(&looks->item_of, pkg->object_count);
		memset(looks->item_of.items, 0, pkg->object_count * sizeof(*looks->item_of.items));
		looks->item_of.count = pkg->object_count;
	}
	for (size_t i = 0; i < set->items.count; i++)
		looks->item_of.items[set->items.items[i].object] = mark ? (uint32_t)i + 1 : 0;
}

uint32_t cell_looks_item(
	const struct cell_looks *looks, const struct triangle_set *set, const struct capture_pixel *pixel)
{
	if (!pixel->object || pixel->object > looks->item_of.count)
		return 0;
	uint32_t item = looks->item_of.items[pixel->object - 1];
	if (!item || pixel->triangle == PKG_NONE)
		return item;
	const uint64_t *words = &set->words.items[set->items.items[item - 1].first_word];
	return words[pixel->triangle / 64] >> (pixel->triangle % 64) & 1 ? item : 0;
}

struct extent {
	uint32_t min_x, min_y, max_x, max_y; /* both included; max < min: empty */
};

static struct extent far_extent(
	const struct capture_image *image, const struct triangle_set *set, const struct cell_looks *looks)
{
	struct extent out = { UINT32_MAX, UINT32_MAX, 0, 0 };
	const struct capture_pixel *pixel = image->pixels;
	for (uint32_t y = 0; y < image->view.height; y++) {
		for (uint32_t x = 0; x < image->view.width; x++, pixel++) {
			if (!cell_looks_item(looks, set, pixel))
				continue;
			out.min_x = x < out.min_x ? x : out.min_x;
			out.max_x = x > out.max_x ? x : out.max_x;
			out.min_y = y < out.min_y ? y : out.min_y;
			out.max_y = y;
		}
	}
	return out;
}

/* Keeps the part of the scratch image that shows the far set as one more look. */
static void keep_extent(struct cell_looks *looks, struct extent extent)
{
	const struct capture_image *from = &looks->scratch;
	uint32_t width = extent.max_x - extent.min_x + 1, height = extent.max_y - extent.min_y + 1;
	if (looks->count == looks->images.count)
		ARRAY_PUSH(&looks->images, (struct capture_image){ 0 });
	struct capture_image *out = &looks->images.items[looks->count++];
	capture_image_finish(out);
	out->view = from->view;
	out->view.width = width;
	out->view.height = height;
	out->view.centre_x -= extent.min_x;
	out->view.centre_y -= extent.min_y;
	out->pixels = array_grow(NULL, &(size_t){ 0 }, (size_t)width * height, sizeof(*out->pixels));
	for (uint32_t y = 0; y < height; y++)
		memcpy(out->pixels + (size_t)y * width,
			from->pixels + (size_t)(extent.min_y + y) * from->view.width + extent.min_x, width * sizeof(*out->pixels));
}

static int look_around(struct cell_looks *looks, struct capturer *capturer, const struct view_cell *cell,
	const struct triangle_set *far_set, const struct cell_pose *pose, double focal_px, double far_m)
{
	static const enum cell_face faces[] = { CELL_FRONT, CELL_LEFT, CELL_RIGHT, CELL_BACK };
	struct dvec3 eye = cell_eye(cell, pose);
	for (size_t i = 0; i < sizeof(faces) / sizeof(faces[0]); i++) {
		struct capture_view view = cell_face_view(cell, eye, faces[i], false, focal_px);
		view.near_m = NEAR_PLANE_M;
		view.far_m = far_m;
		if (!view_crop(&view, &looks->corners))
			continue;
		int err = capturer_draw(capturer, &view, false, &looks->scratch);
		if (err)
			return err;
		struct extent extent = far_extent(&looks->scratch, far_set, looks);
		if (extent.max_x >= extent.min_x && extent.max_y >= extent.min_y)
			keep_extent(looks, extent);
	}
	return 0;
}

static int look_along(struct cell_looks *looks, struct capturer *capturer, const struct view_cell *cell,
	const struct triangle_set *far_set, double focal_px, double far_m)
{
	static const struct cell_pose turns[] = { { .aside = 0, .height = 0.4 }, { .aside = -1, .height = 1 },
		{ .aside = 1, .height = 1 } };
	double length = hypot(cell->end.x - cell->start.x, cell->end.y - cell->start.y);
	int steps = (int)fmin(fmax(ceil(length / STEP_M), 1.0), 64.0);
	for (int step = 0; step <= steps; step++) {
		bool end = step == 0 || step == steps;
		for (int turn = 0; turn < 3; turn++) {
			struct cell_pose pose = turns[turn];
			if (!end && turn != step % 3)
				continue;
			pose.along = (double)step / steps;
			pose.behind = step == 0;
			pose.beyond = step == steps;
			int err = look_around(looks, capturer, cell, far_set, &pose, focal_px, far_m);
			if (err)
				return err;
		}
	}
	return 0;
}

int cell_looks_draw(struct cell_looks *looks, struct capturer *capturer, const struct pkg *pkg,
	const struct view_cell *cell, const struct triangle_set *far_set, const struct triangle_set *occluders,
	double focal_px, double far_m)
{
	struct triangle_set all = { 0 };
	looks->count = 0;
	triangle_set_combine(far_set, occluders, TRIANGLE_SET_OR, pkg, &all);
	capturer_use(capturer, &all);
	triangle_set_finish(&all);
	set_corners(pkg, far_set, &looks->corners);
	cell_looks_mark(looks, pkg, far_set, true);
	int err = look_along(looks, capturer, cell, far_set, focal_px, far_m);
	cell_looks_mark(looks, pkg, far_set, false);
	return err;
}

void cell_looks_seen(
	struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, struct triangle_set *out)
{
	struct pool pool = { 0 };
	uint8_t *seen = POOL_ARRAY(&pool, uint8_t, set->items.count + 1);
	cell_looks_mark(looks, pkg, set, true);
	for (size_t i = 0; i < looks->count; i++) {
		const struct capture_image *image = &looks->images.items[i];
		size_t pixels = (size_t)image->view.width * image->view.height;
		for (size_t k = 0; k < pixels; k++)
			seen[cell_looks_item(looks, set, &image->pixels[k])] = 1;
	}
	cell_looks_mark(looks, pkg, set, false);
	triangle_set_clear(out);
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		size_t words = (triangle_set_object_size(&pkg->objects[item->object]) + 63) / 64;
		if (seen[i + 1])
			memcpy(triangle_set_add(out, pkg, item->object), &set->words.items[item->first_word],
				words * sizeof(uint64_t));
	}
	triangle_set_tidy(out, pkg);
	pool_finish(&pool);
}
