/*
 * From every sample of a view cell's floor a horizon is raised, and all that is not known to be seen yet is asked
 * about: chunks, then objects, then triangles. Triangles that no eye faces are left out before. Cost: about a
 * millisecond a sample.
 */
#include "tools/impostor/visibility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/impostor/eye_box.h"
#include "tools/impostor/solid_map.h"

struct visibility {
	const struct pkg *pkg;
	struct solid_map solids;
};

struct visibility *visibility_new(const struct pkg *pkg)
{
	struct visibility *out = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*out));
	out->pkg = pkg;
	solid_map_build(&out->solids, pkg);
	return out;
}

void visibility_free(struct visibility *visibility)
{
	if (!visibility)
		return;
	solid_map_finish(&visibility->solids);
	array_free(visibility);
}

void visible_sets_finish(struct visible_sets *sets)
{
	triangle_set_finish(&sets->near_set);
	triangle_set_finish(&sets->far_set);
	sets->near_candidates = 0;
}

/* ---- a search ---- */

/* A triangle that some eye faces. */
struct target {
	float corners[3][3]; /* m from the search's origin */
	uint32_t triangle;   /* bit 31: near */
};
#define TARGET_NEAR (1U << 31)

/* An object within reach. Its targets are listed when it is first not hidden as a whole; those seen are moved behind
 * the others. */
struct candidate {
	uint32_t object;
	bool listed;
	size_t first;
	uint32_t hidden, count;
};

struct chunk_candidates {
	uint32_t chunk;
	uint32_t first, count; /* candidates */
	uint32_t open;         /* of them, not seen whole */
};

struct search {
	const struct pkg *pkg;
	struct eye_box box;
	struct dvec3 origin;
	double near_m, far_m;
	ARRAY(struct chunk_candidates) chunks;
	ARRAY(struct candidate) candidates;
	ARRAY(struct target) targets;
	tile_list tiles;
	struct horizon horizon;
};

struct reach {
	double nearest, farthest;
};

static struct reach reach_of(const struct eye_box *box, const int32_t min_mm[3], const int32_t max_mm[3])
{
	double x0 = min_mm[0] * 1e-3, y0 = min_mm[1] * 1e-3, x1 = max_mm[0] * 1e-3, y1 = max_mm[1] * 1e-3;
	const struct dvec2 corners[4] = { { x0, y0 }, { x1, y0 }, { x1, y1 }, { x0, y1 } };
	return (struct reach){ eye_box_distance(box, corners, 4), eye_box_reach(box, corners, 4) };
}

static void read_triangle(const struct pkg *pkg, uint32_t object, uint32_t triangle, struct dvec3 out[3])
{
	int64_t mm[3][3];
	triangle_set_corners(pkg, object, triangle, mm);
	for (int i = 0; i < 3; i++)
		out[i] = (struct dvec3){ (double)mm[i][0] * 1e-3, (double)mm[i][1] * 1e-3, (double)mm[i][2] * 1e-3 };
}

static double triangle_distance(const struct eye_box *box, const struct dvec3 corner[3])
{
	const struct dvec2 flat[3] = { { corner[0].x, corner[0].y }, { corner[1].x, corner[1].y },
		{ corner[2].x, corner[2].y } };
	return eye_box_distance(box, flat, 3);
}

static uint32_t count_near(const struct search *search, uint32_t object, struct reach reach)
{
	uint32_t size = triangle_set_object_size(&search->pkg->objects[object]), sum = 0;
	if (reach.nearest >= search->near_m)
		return 0;
	if (reach.farthest < search->near_m)
		return size;
	for (uint32_t i = 0; i < size; i++) {
		struct dvec3 corner[3];
		read_triangle(search->pkg, object, i, corner);
		sum += triangle_distance(&search->box, corner) < search->near_m;
	}
	return sum;
}

/* Everything within far_m; returns how many triangles are within near_m. */
static uint32_t list_candidates(struct search *search)
{
	const struct pkg *pkg = search->pkg;
	uint32_t near = 0;
	for (uint32_t c = 0; c < pkg->chunk_count; c++) {
		const struct pkg_chunk *chunk = &pkg->chunks[c];
		if (reach_of(&search->box, chunk->min_mm, chunk->max_mm).nearest > search->far_m)
			continue;
		struct chunk_candidates out = { .chunk = c, .first = (uint32_t)search->candidates.count };
		for (uint32_t o = chunk->first_object; o < chunk->first_object + chunk->object_count; o++) {
			struct reach reach = reach_of(&search->box, pkg->objects[o].min_mm, pkg->objects[o].max_mm);
			if (reach.nearest > search->far_m)
				continue;
			near += count_near(search, o, reach);
			ARRAY_PUSH(&search->candidates, (struct candidate){ .object = o });
			out.count++;
		}
		out.open = out.count;
		if (out.count)
			ARRAY_PUSH(&search->chunks, out);
	}
	return near;
}

static void list_targets(struct search *search, struct candidate *candidate)
{
	const struct pkg_object *object = &search->pkg->objects[candidate->object];
	struct reach reach = reach_of(&search->box, object->min_mm, object->max_mm);
	bool all_near = reach.farthest < search->near_m, mixed = reach.nearest < search->near_m && !all_near;
	mixed |= reach.farthest > search->far_m;
	candidate->listed = true;
	candidate->first = search->targets.count;
	uint32_t size = triangle_set_object_size(object);
	for (uint32_t i = 0; i < size; i++) {
		struct dvec3 corner[3];
		read_triangle(search->pkg, candidate->object, i, corner);
		if (!eye_box_faces(&search->box, corner))
			continue;
		double distance = mixed ? triangle_distance(&search->box, corner) : 0.0;
		if (mixed && distance > search->far_m)
			continue;
		struct target target = { .triangle = i };
		if (all_near || (mixed && distance < search->near_m))
			target.triangle |= TARGET_NEAR;
		for (int k = 0; k < 3; k++) {
			target.corners[k][0] = (float)(corner[k].x - search->origin.x);
			target.corners[k][1] = (float)(corner[k].y - search->origin.y);
			target.corners[k][2] = (float)(corner[k].z - search->origin.z);
		}
		ARRAY_PUSH(&search->targets, target);
	}
	candidate->hidden = candidate->count = (uint32_t)(search->targets.count - candidate->first);
}

static bool hides_bounds(struct horizon *horizon, const int32_t min_mm[3], const int32_t max_mm[3])
{
	struct dvec2 min = { min_mm[0] * 1e-3 - horizon->eye.x, min_mm[1] * 1e-3 - horizon->eye.y };
	struct dvec2 max = { max_mm[0] * 1e-3 - horizon->eye.x, max_mm[1] * 1e-3 - horizon->eye.y };
	return horizon_hides_box(horizon, min, max, max_mm[2] * 1e-3 - horizon->eye.z);
}

static bool target_hidden(struct horizon *horizon, const struct target *target, struct dvec3 shift)
{
	struct dvec3 corners[3];
	for (int i = 0; i < 3; i++)
		corners[i] = (struct dvec3){ (double)target->corners[i][0] - shift.x, (double)target->corners[i][1] - shift.y,
			(double)target->corners[i][2] - shift.z };
	return horizon_hides(horizon, corners, 3);
}

static void look_at_targets(struct search *search, struct candidate *candidate)
{
	struct dvec3 eye = search->horizon.eye;
	struct dvec3 shift = { eye.x - search->origin.x, eye.y - search->origin.y, eye.z - search->origin.z };
	struct target *targets = &search->targets.items[candidate->first];
	for (uint32_t i = 0; i < candidate->hidden;) {
		if (target_hidden(&search->horizon, &targets[i], shift)) {
			i++;
			continue;
		}
		struct target seen = targets[i];
		targets[i] = targets[--candidate->hidden];
		targets[candidate->hidden] = seen;
	}
}

static void look_at_chunk(struct search *search, struct chunk_candidates *chunk)
{
	const struct pkg_chunk *bounds = &search->pkg->chunks[chunk->chunk];
	if (!chunk->open || hides_bounds(&search->horizon, bounds->min_mm, bounds->max_mm))
		return;
	chunk->open = 0;
	for (uint32_t i = chunk->first; i < chunk->first + chunk->count; i++) {
		struct candidate *candidate = &search->candidates.items[i];
		const struct pkg_object *object = &search->pkg->objects[candidate->object];
		if (candidate->listed && !candidate->hidden)
			continue;
		if (!hides_bounds(&search->horizon, object->min_mm, object->max_mm)) {
			if (!candidate->listed)
				list_targets(search, candidate);
			look_at_targets(search, candidate);
		}
		chunk->open += !candidate->listed || candidate->hidden;
	}
}

static void look_around(struct search *search, const struct solid_map *solids)
{
	struct dvec2 middle = dvec2_scale(dvec2_add(search->box.start, search->box.end), 0.5);
	double half = dvec2_length(dvec2_sub(search->box.end, search->box.start)) / 2.0;
	solid_map_near(solids, middle, search->far_m + half, &search->tiles);
	for (size_t i = 0; i < search->box.samples.count; i++) {
		horizon_reset(&search->horizon, search->box.samples.items[i]);
		solid_map_raise(solids, &search->tiles, &search->horizon);
		for (size_t c = 0; c < search->chunks.count; c++)
			look_at_chunk(search, &search->chunks.items[c]);
	}
}

static void keep(const struct search *search, const struct candidate *candidate, bool near, struct triangle_set *out)
{
	uint64_t *words = NULL;
	for (uint32_t i = candidate->hidden; i < candidate->count; i++) {
		uint32_t triangle = search->targets.items[candidate->first + i].triangle;
		if (((triangle & TARGET_NEAR) != 0) != near)
			continue;
		if (!words)
			words = triangle_set_add(out, search->pkg, candidate->object);
		triangle &= ~TARGET_NEAR;
		words[triangle / 64] |= UINT64_C(1) << (triangle % 64);
	}
}

void visible_set(const struct visibility *visibility, const struct view_cell *cell, double near_m, double far_m,
	struct visible_sets *out)
{
	struct search *search = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*search));
	memset(search, 0, sizeof(*search));
	search->pkg = visibility->pkg;
	search->origin = cell->start;
	search->near_m = near_m;
	search->far_m = far_m;
	eye_box_init(&search->box, cell);
	out->near_candidates = list_candidates(search);
	look_around(search, &visibility->solids);
	triangle_set_clear(&out->near_set);
	triangle_set_clear(&out->far_set);
	for (size_t i = 0; i < search->candidates.count; i++) {
		keep(search, &search->candidates.items[i], true, &out->near_set);
		keep(search, &search->candidates.items[i], false, &out->far_set);
	}
	triangle_set_tidy(&out->near_set, search->pkg);
	triangle_set_tidy(&out->far_set, search->pkg);
	eye_box_finish(&search->box);
	ARRAY_FINISH(&search->chunks);
	ARRAY_FINISH(&search->candidates);
	ARRAY_FINISH(&search->targets);
	ARRAY_FINISH(&search->tiles);
	array_free(search);
}
