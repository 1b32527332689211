#include "tools/impostor/solid_map.h"

#include <math.h>
#include <stdlib.h>

#include "tools/impostor/extremes.h"

#define TILE_M 96.0
#define OUTLINE_POINTS_MAX 4096 /* of an outline that is worth raising */

/* ---- building ---- */

static void grow_box(struct solid_box *box, const struct solid_box *by)
{
	box->min = (struct dvec2){ smaller(box->min.x, by->min.x), smaller(box->min.y, by->min.y) };
	box->max = (struct dvec2){ larger(box->max.x, by->max.x), larger(box->max.y, by->max.y) };
	box->top = larger(box->top, by->top);
}

static bool same_place(const int32_t a[2], const int32_t b[2])
{
	return a[0] == b[0] && a[1] == b[1];
}

/* Takes the outline that starts at a wall, if it closes; returns the number of walls in it. */
static uint32_t take_outline(
	struct solid_map *map, const struct pkg_occluder *walls, uint32_t count, struct mapped_solid *solid)
{
	uint32_t length = 1;
	while (length < count && walls[length].solid == walls[0].solid && walls[length].top_mm == walls[0].top_mm &&
		   same_place(walls[length].from_mm, walls[length - 1].to_mm) &&
		   !same_place(walls[length - 1].to_mm, walls[0].from_mm))
		length++;
	if (length < 3 || length > OUTLINE_POINTS_MAX || !same_place(walls[length - 1].to_mm, walls[0].from_mm))
		return length;
	ARRAY_PUSH(&map->outlines, (struct solid_outline){ (uint32_t)map->points.count, length });
	solid->outline_count++;
	for (uint32_t i = 0; i < length; i++) {
		struct dvec2 at = { walls[i].from_mm[0] * 1e-3, walls[i].from_mm[1] * 1e-3 };
		ARRAY_PUSH(&map->points, at);
		grow_box(&solid->box, &(struct solid_box){ at, at, walls[0].top_mm * 1e-3 });
	}
	return length;
}

struct placed_solid {
	int64_t tile[2];
	uint32_t order;
	struct mapped_solid solid;
};

static int compare_placed(const void *left, const void *right)
{
	const struct placed_solid *a = left, *b = right;
	for (int axis = 0; axis < 2; axis++)
		if (a->tile[axis] != b->tile[axis])
			return a->tile[axis] < b->tile[axis] ? -1 : 1;
	return a->order < b->order ? -1 : a->order > b->order;
}

void solid_map_build(struct solid_map *map, const struct pkg *pkg)
{
	*map = (struct solid_map){ 0 };
	ARRAY(struct placed_solid) placed = { 0 };
	for (uint32_t i = 0; i < pkg->occluder_count;) {
		const struct pkg_occluder *walls = pkg->occluders;
		struct placed_solid out = { .order = i };
		out.solid.box = (struct solid_box){ { INFINITY, INFINITY }, { -INFINITY, -INFINITY }, -INFINITY };
		out.solid.first_outline = (uint32_t)map->outlines.count;
		for (uint32_t first = i; i < pkg->occluder_count && walls[i].solid == walls[first].solid;)
			i += take_outline(map, &walls[i], pkg->occluder_count - i, &out.solid);
		if (!out.solid.outline_count)
			continue;
		out.tile[0] = (int64_t)floor((out.solid.box.min.x + out.solid.box.max.x) / 2.0 / TILE_M);
		out.tile[1] = (int64_t)floor((out.solid.box.min.y + out.solid.box.max.y) / 2.0 / TILE_M);
		ARRAY_PUSH(&placed, out);
	}
	ARRAY_SORT(&placed, compare_placed);
	for (size_t i = 0; i < placed.count; i++) {
		const struct placed_solid *at = &placed.items[i];
		if (!i || at->tile[0] != at[-1].tile[0] || at->tile[1] != at[-1].tile[1])
			ARRAY_PUSH(&map->tiles, (struct solid_tile){ at->solid.box, (uint32_t)i, 0 });
		struct solid_tile *tile = &map->tiles.items[map->tiles.count - 1];
		grow_box(&tile->box, &at->solid.box);
		tile->count++;
		ARRAY_PUSH(&map->solids, at->solid);
	}
	ARRAY_FINISH(&placed);
}

void solid_map_finish(struct solid_map *map)
{
	ARRAY_FINISH(&map->points);
	ARRAY_FINISH(&map->outlines);
	ARRAY_FINISH(&map->solids);
	ARRAY_FINISH(&map->tiles);
}

/* ---- use ---- */

struct tile_at {
	double distance;
	uint32_t tile;
};

static int compare_distance(const void *left, const void *right)
{
	const struct tile_at *a = left, *b = right;
	if (a->distance < b->distance || a->distance > b->distance)
		return a->distance < b->distance ? -1 : 1;
	return a->tile < b->tile ? -1 : a->tile > b->tile;
}

static double box_distance(const struct solid_box *box, struct dvec2 at)
{
	double x = larger(0.0, larger(box->min.x - at.x, at.x - box->max.x));
	double y = larger(0.0, larger(box->min.y - at.y, at.y - box->max.y));
	return hypot(x, y);
}

void solid_map_near(const struct solid_map *map, struct dvec2 at, double reach_m, tile_list *out)
{
	ARRAY(struct tile_at) found = { 0 };
	for (uint32_t i = 0; i < map->tiles.count; i++) {
		double distance = box_distance(&map->tiles.items[i].box, at);
		if (distance <= reach_m)
			ARRAY_PUSH(&found, (struct tile_at){ distance, i });
	}
	ARRAY_SORT(&found, compare_distance);
	out->count = 0;
	for (size_t i = 0; i < found.count; i++)
		ARRAY_PUSH(out, found.items[i].tile);
	ARRAY_FINISH(&found);
}

/* By all outlines together, so a courtyard is outside. */
static bool solid_holds(const struct solid_map *map, const struct mapped_solid *solid, struct dvec2 at)
{
	bool inside = false;
	for (uint32_t k = 0; k < solid->outline_count; k++) {
		const struct solid_outline *outline = &map->outlines.items[solid->first_outline + k];
		const struct dvec2 *p = &map->points.items[outline->first];
		for (uint32_t i = 0, j = outline->count - 1; i < outline->count; j = i++)
			if ((p[i].y > at.y) != (p[j].y > at.y) &&
				at.x < p[i].x + (at.y - p[i].y) / (p[j].y - p[i].y) * (p[j].x - p[i].x))
				inside = !inside;
	}
	return inside;
}

static bool box_hidden(struct horizon *horizon, const struct solid_box *box)
{
	struct dvec2 eye = { horizon->eye.x, horizon->eye.y };
	return horizon_hides_box(
		horizon, dvec2_sub(box->min, eye), dvec2_sub(box->max, eye), box->top - horizon->eye.z, -INFINITY);
}

static void raise_by(const struct solid_map *map, const struct mapped_solid *solid, struct horizon *horizon)
{
	struct dvec2 eye = { horizon->eye.x, horizon->eye.y };
	if (box_distance(&solid->box, eye) <= 0.0 && solid_holds(map, solid, eye))
		return;
	struct dvec2 points[OUTLINE_POINTS_MAX];
	for (uint32_t k = 0; k < solid->outline_count; k++) {
		const struct solid_outline *outline = &map->outlines.items[solid->first_outline + k];
		for (uint32_t i = 0; i < outline->count; i++)
			points[i] = dvec2_sub(map->points.items[outline->first + i], eye);
		horizon_add_outline(horizon, points, outline->count, solid->box.top - horizon->eye.z);
	}
}

void solid_map_raise(const struct solid_map *map, const tile_list *tiles, struct horizon *horizon)
{
	for (size_t i = 0; i < tiles->count; i++) {
		const struct solid_tile *tile = &map->tiles.items[tiles->items[i]];
		if (box_hidden(horizon, &tile->box))
			continue;
		for (uint32_t k = tile->first; k < tile->first + tile->count; k++)
			if (!box_hidden(horizon, &map->solids.items[k].box))
				raise_by(map, &map->solids.items[k], horizon);
	}
}
