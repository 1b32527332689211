/*
 * Bookkeeping of resident chunks. Sorting by distance is done again only after the eye has moved RESORT_MM; per frame
 * the cost is a walk over the chunks.
 */
#include "assets/residency.h"

#include <assert.h>
#include <errno.h>

#include "platform/base/log.h"

#define RESORT_MM 16000
#define ROUNDS_MAX 8

void residency_totals(const struct pkg *pkg, uint64_t *vertices, uint64_t *indices)
{
	*vertices = *indices = 0;
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		*vertices += pkg->chunks[i].vertex_count;
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			*indices += pkg->chunks[i].index_count[pass];
	}
}

static uint32_t chunk_indices(const struct pkg_chunk *chunk)
{
	uint32_t sum = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		sum += chunk->index_count[pass];
	return sum;
}

static uint64_t chunk_bytes(const struct pkg_chunk *chunk)
{
	return (uint64_t)chunk->vertex_count * sizeof(struct pkg_mesh_vertex) + (uint64_t)chunk_indices(chunk) * 2;
}

/* Place along a Hilbert curve of order 16 (Hilbert 1891; the usual quadrant walk). */
static uint64_t hilbert(uint32_t x, uint32_t y)
{
	uint64_t d = 0;
	for (uint32_t s = 1u << 15; s; s >>= 1) {
		uint32_t rx = (x & s) != 0, ry = (y & s) != 0;
		d += (uint64_t)s * s * ((3 * rx) ^ ry);
		if (!ry) {
			if (rx) {
				x = 0xFFFF - x;
				y = 0xFFFF - y;
			}
			uint32_t t = x;
			x = y;
			y = t;
		}
	}
	return d;
}

static uint64_t curve_key(const struct pkg *pkg, const struct pkg_chunk *chunk)
{
	uint32_t at[2];
	for (int axis = 0; axis < 2; axis++) {
		int64_t span = (int64_t)pkg->meta->max_mm[axis] - pkg->meta->min_mm[axis] + 1;
		int64_t middle = ((int64_t)chunk->min_mm[axis] + chunk->max_mm[axis]) / 2 - pkg->meta->min_mm[axis];
		middle = middle < 0 ? 0 : middle >= span ? span - 1 : middle;
		at[axis] = (uint32_t)(middle * 0xFFFF / span);
	}
	return hilbert(at[0], at[1]);
}

/* Squared distance from the eye to the chunk's box, m^2. */
static uint64_t distance_key(const struct pkg_chunk *chunk, const int64_t eye_mm[3])
{
	uint64_t sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		int64_t low = chunk->min_mm[axis] - eye_mm[axis], high = eye_mm[axis] - chunk->max_mm[axis];
		int64_t out = low > 0 ? low : high > 0 ? high : 0;
		uint64_t m = (uint64_t)(out / 1000);
		sum += m * m;
	}
	return sum;
}

static void swap_places(struct residency *residency, uint32_t a, uint32_t b)
{
	uint32_t id = residency->order[a];
	residency->order[a] = residency->order[b];
	residency->order[b] = id;
	uint64_t key = residency->key[a];
	residency->key[a] = residency->key[b];
	residency->key[b] = key;
}

/* Ties go by chunk id, so the order depends on nothing but the input. */
static bool comes_before(const struct residency *residency, uint32_t a, uint32_t b)
{
	if (residency->key[a] != residency->key[b])
		return residency->key[a] < residency->key[b];
	return residency->order[a] < residency->order[b];
}

static void sift_down(struct residency *residency, uint32_t at, uint32_t count)
{
	for (;;) {
		uint32_t child = at * 2 + 1;
		if (child >= count)
			return;
		if (child + 1 < count && comes_before(residency, child, child + 1))
			child++;
		if (!comes_before(residency, at, child))
			return;
		swap_places(residency, at, child);
		at = child;
	}
}

/* Heap sort: in place, no allocation, never quadratic (qsort() may call malloc). */
static void sort_order(struct residency *residency)
{
	uint32_t count = residency->pkg->chunk_count;
	for (uint32_t i = count / 2; i-- > 0;)
		sift_down(residency, i, count);
	for (uint32_t end = count; end-- > 1;) {
		swap_places(residency, 0, end);
		sift_down(residency, 0, end);
	}
}

/* Every chunk's place when all have one: neighbours in the city are neighbours in memory. */
static void place_all(struct residency *residency)
{
	uint32_t vertex = 0, index = 0;
	for (uint32_t i = 0; i < residency->pkg->chunk_count; i++)
		residency->key[i] = curve_key(residency->pkg, &residency->pkg->chunks[i]);
	sort_order(residency);
	for (uint32_t i = 0; i < residency->pkg->chunk_count; i++) {
		struct residency_chunk *chunk = &residency->chunks[residency->order[i]];
		chunk->first_vertex = vertex;
		chunk->first_index = index;
		vertex += residency->pkg->chunks[residency->order[i]].vertex_count;
		index += chunk->index_count;
		residency->pending_bytes += chunk_bytes(&residency->pkg->chunks[residency->order[i]]);
	}
}

uint64_t residency_arena_bytes(const struct pkg *pkg)
{
	const uint64_t chunk = sizeof(struct residency_chunk) + 2 * sizeof(uint32_t) + sizeof(uint64_t);
	return pkg->chunk_count * chunk + 2 * range_pool_bytes(pkg->chunk_count);
}

int residency_init(struct residency *residency, struct arena *arena, const struct pkg *pkg, uint32_t vertex_capacity,
	uint32_t index_capacity)
{
	uint64_t vertices, indices;
	residency_totals(pkg, &vertices, &indices);
	uint32_t count = pkg->chunk_count;
	*residency = (struct residency){
		.pkg = pkg,
		.chunks = ARENA_ARRAY(arena, struct residency_chunk, count),
		.order = ARENA_ARRAY(arena, uint32_t, count),
		.key = ARENA_ARRAY(arena, uint64_t, count),
		.listed = ARENA_ARRAY(arena, uint32_t, count),
		.whole = vertices <= vertex_capacity && indices <= index_capacity,
	};
	if (!residency->chunks || !residency->order || !residency->key || !residency->listed ||
		range_pool_init(&residency->vertices, arena, vertex_capacity, count) ||
		range_pool_init(&residency->indices, arena, index_capacity, count))
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++) {
		residency->order[i] = i;
		residency->chunks[i].index_count = chunk_indices(&pkg->chunks[i]);
	}
	if (residency->whole)
		place_all(residency);
	return 0;
}

static void resort(struct residency *residency, const int64_t eye_mm[3])
{
	bool moved = !residency->sorted;
	for (int axis = 0; axis < 3; axis++) {
		int64_t d = eye_mm[axis] - residency->sorted_at_mm[axis];
		moved = moved || d > RESORT_MM || d < -RESORT_MM;
	}
	if (!moved)
		return;
	for (uint32_t i = 0; i < residency->pkg->chunk_count; i++) {
		const struct pkg_chunk *chunk = &residency->pkg->chunks[residency->order[i]];
		residency->key[i] = distance_key(chunk, eye_mm);
	}
	sort_order(residency);
	residency->sorted = true;
	for (int axis = 0; axis < 3; axis++)
		residency->sorted_at_mm[axis] = eye_mm[axis];
}

static void unplace(struct residency *residency, uint32_t id)
{
	const struct residency_chunk *chunk = &residency->chunks[id];
	range_pool_give(&residency->vertices, chunk->first_vertex, residency->pkg->chunks[id].vertex_count);
	range_pool_give(&residency->indices, chunk->first_index, chunk->index_count);
}

static void evict(struct residency *residency, uint32_t id)
{
	unplace(residency, id);
	residency->chunks[id].state = RESIDENCY_ABSENT;
	residency->present--;
	residency->evicted++;
}

static bool place(struct residency *residency, uint32_t id)
{
	struct residency_chunk *chunk = &residency->chunks[id];
	uint32_t vertices = residency->pkg->chunks[id].vertex_count;
	uint32_t first = range_pool_take(&residency->vertices, vertices);
	if (first == RANGE_NONE)
		return false;
	chunk->first_index = range_pool_take(&residency->indices, chunk->index_count);
	if (chunk->first_index == RANGE_NONE) {
		range_pool_give(&residency->vertices, first, vertices);
		return false;
	}
	chunk->first_vertex = first;
	return true;
}

/* Places the chunk at order[at], which is wanted; chunks that are not, and chunks clearly farther away (10 % and 50 m,
 * against to and fro), make room for it. */
static bool place_nearer(struct residency *residency, uint32_t at, uint64_t far_key, uint32_t *last)
{
	uint64_t key = residency->key[at], farther = key + key / 4 + 2500;
	farther = farther < far_key ? farther : far_key;
	while (!place(residency, residency->order[at])) {
		while (*last > at && residency->chunks[residency->order[*last]].state != RESIDENCY_PRESENT)
			--*last;
		if (*last <= at || residency->key[*last] <= farther)
			return false;
		evict(residency, residency->order[*last]);
	}
	return true;
}

static bool sound(struct residency *residency, uint32_t id)
{
	struct pkg_fault fault;
	if (!pkg_chunk_check(residency->pkg, id, &fault))
		return true;
	residency->chunks[id].state = RESIDENCY_DAMAGED;
	residency->damaged++;
	if (residency->whole)
		residency->pending_bytes -= chunk_bytes(&residency->pkg->chunks[id]);
	log_warn("chunk %u is damaged and left out: %s", (unsigned)id, fault.text);
	return false;
}

/* The GPU has it now. */
static void let_go(const struct pkg *pkg, const struct pkg_chunk *chunk)
{
	const uint64_t indices = (uint64_t)chunk->index_count[PKG_PASS_OPAQUE] + chunk->index_count[PKG_PASS_DECAL];
	file_map_let_go(
		&pkg->map, pkg_chunk_vertices(pkg, chunk), (size_t)chunk->vertex_count * sizeof(struct pkg_mesh_vertex));
	file_map_let_go(&pkg->map, pkg_chunk_indices(pkg, chunk), (size_t)indices * sizeof(uint16_t));
}

static bool load_placed(struct residency *residency, uint32_t id, residency_upload upload, void *context)
{
	if (!sound(residency, id))
		return false;
	residency->chunks[id].state = RESIDENCY_PRESENT;
	residency->present++;
	if (residency->whole)
		residency->pending_bytes -= chunk_bytes(&residency->pkg->chunks[id]);
	upload(context, id, &residency->chunks[id]);
	let_go(residency->pkg, &residency->pkg->chunks[id]);
	return true;
}

/* One pool's part of a chunk. */
struct extent {
	uint32_t first, count;
};

static struct extent extent_of(const struct residency *residency, uint32_t id, bool of_indices)
{
	const struct residency_chunk *chunk = &residency->chunks[id];
	return of_indices ? (struct extent){ chunk->first_index, chunk->index_count }
					  : (struct extent){ chunk->first_vertex, residency->pkg->chunks[id].vertex_count };
}

static bool overlap(struct extent a, struct extent b)
{
	return a.first < b.first + b.count && b.first < a.first + a.count;
}

/* Do all chunks that are wanted fit, but for the holes between them? */
static bool all_fit(const struct residency *residency, uint64_t far_key)
{
	uint64_t vertices = 0, indices = 0;
	for (uint32_t i = 0; i < residency->pkg->chunk_count && residency->key[i] <= far_key; i++) {
		vertices += residency->pkg->chunks[residency->order[i]].vertex_count;
		indices += residency->chunks[residency->order[i]].index_count;
	}
	return vertices <= residency->vertices.capacity && indices <= residency->indices.capacity;
}

static uint32_t list_present(struct residency *residency)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < residency->pkg->chunk_count && count < residency->present; i++)
		if (residency->chunks[residency->order[i]].state == RESIDENCY_PRESENT)
			residency->listed[count++] = residency->order[i];
	return count;
}

/* Units that are in use in a stretch of a pool; UINT64_MAX when a chunk in it is not smaller than the stretch. */
static uint64_t units_in(const struct residency *residency, uint32_t listed, struct extent stretch, bool of_indices)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < listed; i++) {
		struct extent extent = extent_of(residency, residency->listed[i], of_indices);
		if (!overlap(extent, stretch))
			continue;
		if (extent.count >= stretch.count)
			return UINT64_MAX;
		sum += extent.count;
	}
	return sum;
}

/* Empties the stretch of a pool that is long enough and holds least, only of smaller chunks, so that this comes to an
 * end: they are wanted as well, and find room between others. Returns false when there is none. */
static bool empty_stretch(struct residency *residency, uint32_t units, bool of_indices)
{
	const struct range_pool *pool = of_indices ? &residency->indices : &residency->vertices;
	uint32_t listed = list_present(residency);
	struct extent best = { 0, 0 };
	uint64_t least = UINT64_MAX;
	for (uint32_t i = 0; i <= listed; i++) {
		struct extent before = i < listed ? extent_of(residency, residency->listed[i], of_indices) : best;
		struct extent stretch = { i < listed ? before.first + before.count : 0, units };
		if (stretch.first > pool->capacity - units)
			continue;
		uint64_t held = units_in(residency, listed, stretch, of_indices);
		if (held < least) {
			least = held;
			best = stretch;
		}
	}
	for (uint32_t i = 0; i < listed && least != UINT64_MAX; i++)
		if (overlap(extent_of(residency, residency->listed[i], of_indices), best))
			evict(residency, residency->listed[i]);
	return least != UINT64_MAX;
}

/* There is room enough for all that is wanted, but in pieces: places the chunk at order[at] at the cost of smaller
 * ones, which are absent until they are placed again. */
static bool place_by_moving(struct residency *residency, uint32_t at, uint64_t far_key)
{
	uint32_t id = residency->order[at];
	if (!all_fit(residency, far_key))
		return false;
	for (int of_indices = 0; of_indices < 2; of_indices++) {
		uint32_t units = of_indices ? residency->chunks[id].index_count : residency->pkg->chunks[id].vertex_count;
		if (place(residency, id))
			return true;
		if (units > (of_indices ? &residency->indices : &residency->vertices)->capacity ||
			!empty_stretch(residency, units, of_indices))
			return false;
	}
	return place(residency, id);
}

/* State of one residency_update(). */
struct update {
	uint64_t far_key, slice_bytes, used_bytes;
	uint32_t last;    /* nothing after order[last] is present */
	bool full, moved; /* a chunk found no place; found one at the cost of others */
};

/* Loads the chunk at order[at] if the slice lasts and there is room. */
static void load_chunk(
	struct residency *residency, uint32_t at, struct update *update, residency_upload upload, void *context)
{
	uint32_t id = residency->order[at];
	uint64_t bytes = chunk_bytes(&residency->pkg->chunks[id]);
	bool slice = !update->used_bytes || update->used_bytes + bytes <= update->slice_bytes;
	bool placed = slice && !update->full && place_nearer(residency, at, update->far_key, &update->last);
	if (slice && !update->full && !placed) {
		const uint64_t evicted = residency->evicted;
		placed = place_by_moving(residency, at, update->far_key);
		update->moved |= residency->evicted != evicted;
		update->full = !placed;
		residency->dropped += !placed;
	}
	if (!placed)
		residency->pending_bytes += bytes;
	else if (!load_placed(residency, id, upload, context))
		unplace(residency, id);
	else
		update->used_bytes += bytes;
}

bool residency_complete(const struct residency *residency)
{
	return residency->present + residency->damaged == residency->pkg->chunk_count;
}

void residency_load_now(struct residency *residency, uint32_t chunk, residency_upload upload, void *context)
{
	assert(residency->whole);
	if (residency->chunks[chunk].state == RESIDENCY_ABSENT)
		load_placed(residency, chunk, upload, context);
}

/* What nobody has asked for yet, along the curve. */
static void load_rest(struct residency *residency, uint64_t slice_bytes, residency_upload upload, void *context)
{
	uint64_t used_bytes = 0;
	uint32_t count = residency->pkg->chunk_count;
	for (; residency->rest_at < count && used_bytes < slice_bytes; residency->rest_at++) {
		uint32_t id = residency->order[residency->rest_at];
		if (residency->chunks[id].state == RESIDENCY_ABSENT && load_placed(residency, id, upload, context))
			used_bytes += chunk_bytes(&residency->pkg->chunks[id]);
	}
}

void residency_update(struct residency *residency, const int64_t eye_mm[3], int64_t far_mm, uint64_t slice_bytes,
	residency_upload upload, void *context)
{
	uint32_t count = residency->pkg->chunk_count;
	if (residency->whole) {
		load_rest(residency, slice_bytes, upload, context);
		return;
	}
	if (!count)
		return;
	resort(residency, eye_mm);
	uint64_t far_m = (uint64_t)(far_mm / 1000);
	struct update update = { .far_key = far_m * far_m, .slice_bytes = slice_bytes, .last = count - 1 };
	for (int round = 0; round == 0 || (update.moved && round < ROUNDS_MAX); round++) {
		update.moved = false;
		update.slice_bytes += round ? slice_bytes : 0; /* what was moved must be back in the same frame */
		residency->pending_bytes = 0;
		for (uint32_t i = 0; i < count && residency->key[i] <= update.far_key; i++)
			if (residency->chunks[residency->order[i]].state == RESIDENCY_ABSENT)
				load_chunk(residency, i, &update, upload, context);
	}
}
