/*
 * From every sample of a view cell's floor a horizon is raised, and all that is not known to be seen yet is asked
 * about: chunks, then objects, then triangles. Triangles that no eye faces are left out before. Cost: about a
 * millisecond a sample.
 */
#include "tools/impostor/visibility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/impostor/extremes.h"
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
	uint32_t code;       /* of its place */
};
#define TARGET_NEAR (1U << 31)

/* Some targets of one object that are near each other, the hidden ones first. */
#define CLUSTER_TARGETS 16
struct cluster {
	size_t first;
	uint32_t hidden, count;
	struct dvec3 min, max; /* m from the search's origin */
};

/* An object within reach. Its targets are listed when it is first not hidden as a whole. */
struct candidate {
	uint32_t object;
	bool listed;
	size_t first;
	uint32_t clusters;
	uint32_t hidden; /* targets */
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
	ARRAY(struct cluster) clusters;
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

/* Bits of both numbers in turn: close places have close codes. */
static uint32_t interleave(uint32_t x, uint32_t y)
{
	uint32_t out = 0;
	for (uint32_t bit = 0; bit < 15; bit++)
		out |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
	return out;
}

static uint32_t code_of(const float (*corners)[3])
{
	uint32_t at[2];
	for (int axis = 0; axis < 2; axis++) {
		double middle = ((double)corners[0][axis] + (double)corners[1][axis] + (double)corners[2][axis]) / 3.0;
		at[axis] = (uint32_t)((int32_t)lrint(middle) + (1 << 28)) & 0x7FFF;
	}
	return interleave(at[0], at[1]);
}

static int compare_targets(const void *left, const void *right)
{
	const struct target *a = left, *b = right;
	if (a->code != b->code)
		return a->code < b->code ? -1 : 1;
	return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static void gather_clusters(struct search *search, size_t first, struct candidate *candidate)
{
	struct target *targets = search->targets.items + first;
	uint32_t count = (uint32_t)(search->targets.count - first);
	if (count > CLUSTER_TARGETS)
		qsort(targets, count, sizeof(*targets), compare_targets);
	candidate->first = search->clusters.count;
	candidate->hidden = count;
	for (uint32_t i = 0; i < count; i += CLUSTER_TARGETS) {
		uint32_t size = count - i < CLUSTER_TARGETS ? count - i : CLUSTER_TARGETS;
		struct cluster out = { .first = first + i, .hidden = size, .count = size };
		out.min = (struct dvec3){ INFINITY, INFINITY, INFINITY };
		out.max = (struct dvec3){ -INFINITY, -INFINITY, -INFINITY };
		for (uint32_t k = 0; k < size * 3; k++) {
			const float *at = targets[i + k / 3].corners[k % 3];
			out.min.x = smaller(out.min.x, (double)at[0]);
			out.min.y = smaller(out.min.y, (double)at[1]);
			out.max.x = larger(out.max.x, (double)at[0]);
			out.max.y = larger(out.max.y, (double)at[1]);
			out.max.z = larger(out.max.z, (double)at[2]);
		}
		ARRAY_PUSH(&search->clusters, out);
		candidate->clusters++;
	}
}

static void list_targets(struct search *search, struct candidate *candidate)
{
	const struct pkg_object *object = &search->pkg->objects[candidate->object];
	struct reach reach = reach_of(&search->box, object->min_mm, object->max_mm);
	bool all_near = reach.farthest < search->near_m, mixed = reach.nearest < search->near_m && !all_near;
	mixed |= reach.farthest > search->far_m;
	candidate->listed = true;
	size_t first = search->targets.count;
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
		target.code = code_of((const float(*)[3])target.corners);
		ARRAY_PUSH(&search->targets, target);
	}
	gather_clusters(search, first, candidate);
}

/* A box in the frame of the eye, as far as horizons care. */
struct bounds {
	struct dvec2 min, max;
	double top;
};

static struct bounds bounds_of(const struct horizon *horizon, const int32_t min_mm[3], const int32_t max_mm[3])
{
	const struct dvec3 *eye = &horizon->eye;
	return (struct bounds){ { min_mm[0] * 1e-3 - eye->x, min_mm[1] * 1e-3 - eye->y },
		{ max_mm[0] * 1e-3 - eye->x, max_mm[1] * 1e-3 - eye->y }, max_mm[2] * 1e-3 - eye->z };
}

static bool hides(struct horizon *horizon, const struct bounds *bounds, double floor)
{
	return horizon_hides_box(horizon, bounds->min, bounds->max, bounds->top, floor);
}

static bool target_hidden(struct horizon *horizon, const struct target *target, struct dvec3 shift, double floor)
{
	struct dvec3 corners[3];
	for (int i = 0; i < 3; i++)
		corners[i] = (struct dvec3){ (double)target->corners[i][0] - shift.x, (double)target->corners[i][1] - shift.y,
			(double)target->corners[i][2] - shift.z };
	return horizon_hides(horizon, corners, 3, floor);
}

/* Returns how many were seen. */
static uint32_t look_at_cluster(struct search *search, struct cluster *cluster)
{
	struct horizon *horizon = &search->horizon;
	struct dvec3 shift = { horizon->eye.x - search->origin.x, horizon->eye.y - search->origin.y,
		horizon->eye.z - search->origin.z };
	struct bounds bounds = { { cluster->min.x - shift.x, cluster->min.y - shift.y },
		{ cluster->max.x - shift.x, cluster->max.y - shift.y }, cluster->max.z - shift.z };
	double floor = cluster->hidden > 1 ? horizon_floor(horizon, bounds.min, bounds.max) : -INFINITY;
	if (cluster->hidden > 1 && hides(horizon, &bounds, floor))
		return 0;
	uint32_t before = cluster->hidden;
	struct target *targets = &search->targets.items[cluster->first];
	for (uint32_t i = 0; i < cluster->hidden;) {
		if (target_hidden(horizon, &targets[i], shift, floor)) {
			i++;
			continue;
		}
		struct target seen = targets[i];
		targets[i] = targets[--cluster->hidden];
		targets[cluster->hidden] = seen;
	}
	return before - cluster->hidden;
}

static void look_at_candidate(struct search *search, struct candidate *candidate, double floor)
{
	const struct pkg_object *object = &search->pkg->objects[candidate->object];
	struct bounds bounds = bounds_of(&search->horizon, object->min_mm, object->max_mm);
	if (hides(&search->horizon, &bounds, floor))
		return;
	if (!candidate->listed)
		list_targets(search, candidate);
	for (size_t c = candidate->first; c < candidate->first + candidate->clusters; c++)
		if (search->clusters.items[c].hidden)
			candidate->hidden -= look_at_cluster(search, &search->clusters.items[c]);
}

static void look_at_chunk(struct search *search, struct chunk_candidates *chunk)
{
	const struct pkg_chunk *box = &search->pkg->chunks[chunk->chunk];
	struct bounds bounds = bounds_of(&search->horizon, box->min_mm, box->max_mm);
	if (!chunk->open)
		return;
	double floor = horizon_floor(&search->horizon, bounds.min, bounds.max);
	if (hides(&search->horizon, &bounds, floor))
		return;
	chunk->open = 0;
	for (uint32_t i = chunk->first; i < chunk->first + chunk->count; i++) {
		struct candidate *candidate = &search->candidates.items[i];
		if (!candidate->listed || candidate->hidden)
			look_at_candidate(search, candidate, floor);
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
	for (size_t c = candidate->first; c < candidate->first + candidate->clusters; c++) {
		const struct cluster *cluster = &search->clusters.items[c];
		for (uint32_t i = cluster->hidden; i < cluster->count; i++) {
			uint32_t triangle = search->targets.items[cluster->first + i].triangle;
			if (((triangle & TARGET_NEAR) != 0) != near)
				continue;
			if (!words)
				words = triangle_set_add(out, search->pkg, candidate->object);
			triangle &= ~TARGET_NEAR;
			words[triangle / 64] |= UINT64_C(1) << (triangle % 64);
		}
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
	ARRAY_FINISH(&search->clusters);
	ARRAY_FINISH(&search->tiles);
	array_free(search);
}
