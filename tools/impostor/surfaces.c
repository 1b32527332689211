/*
 * Joining of seeds, best fit first: a heap of borders keyed by the largest residual that the union would have. A border
 * is looked at again only when it comes up, so a join costs no look at the neighbours' neighbours; a union that does
 * not fit is not tried again, as more pixels will not make it fit. About 0.5 us a trial.
 */
#include "tools/impostor/surfaces.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "tools/impostor/oct_normal.h"
#include "tools/impostor/surface_merger.h"

#define TINY_PX2 15.0 /* of the screen */
#define SMALL_PX2 40.0
#define NORMALS_DOT 0.9
#define PIECE_TRIES 32  /* neighbours of a piece that are looked at */
#define STALE_SLACK 1.1 /* a border that got this much worse since it was queued goes back in the queue */

static bool before(const struct merge_candidate *a, const struct merge_candidate *b)
{
	if (a->error != b->error)
		return a->error < b->error;
	return a->a != b->a ? a->a < b->a : a->b < b->b;
}

static void push(struct merger *merger, struct merge_candidate candidate)
{
	ARRAY_PUSH(&merger->heap, candidate);
	struct merge_candidate *heap = merger->heap.items;
	size_t at = merger->heap.count - 1;
	for (; at && before(&candidate, &heap[(at - 1) / 2]); at = (at - 1) / 2)
		heap[at] = heap[(at - 1) / 2];
	heap[at] = candidate;
}

static struct merge_candidate pop(struct merger *merger)
{
	struct merge_candidate *heap = merger->heap.items, top = heap[0];
	size_t count = --merger->heap.count, at = 0;
	struct merge_candidate last = heap[count];
	for (size_t child; (child = 2 * at + 1) < count; at = child) {
		if (child + 1 < count && before(&heap[child + 1], &heap[child]))
			child++;
		if (!before(&heap[child], &last))
			break;
		heap[at] = heap[child];
	}
	if (count)
		heap[at] = last;
	return top;
}

/* Kinds that are lit alike. */
static int light_class(uint8_t kind)
{
	switch (kind) {
	case PKG_MATERIAL_MARKING:
		return PKG_MATERIAL_GROUND;
	case PKG_MATERIAL_ROOF:
		return PKG_MATERIAL_SOLID;
	default:
		return kind;
	}
}

static bool may_join(const struct merger *merger, uint32_t a, uint32_t b)
{
	uint32_t pixels_a = merger->seeds.fits.items[a].pixels, pixels_b = merger->seeds.fits.items[b].pixels;
	uint32_t smaller = pixels_a < pixels_b ? pixels_a : pixels_b;
	if (smaller <= TINY_PX2 * merger->per_px2)
		return true;
	const struct capture_pixel *kind_a = &merger->seeds.kinds.items[a], *kind_b = &merger->seeds.kinds.items[b];
	if (light_class(kind_a->kind) != light_class(kind_b->kind))
		return false;
	bool crown = kind_a->kind == PKG_MATERIAL_FOLIAGE && kind_a->object == kind_b->object;
	if (smaller <= SMALL_PX2 * merger->per_px2 || crown || memcmp(kind_a->normal_oct, kind_b->normal_oct, 2) == 0)
		return true;
	struct dvec3 m = oct_unit_normal(kind_a->normal_oct), n = oct_unit_normal(kind_b->normal_oct);
	return m.x * n.x + m.y * n.y + m.z * n.z >= NORMALS_DOT;
}

static void join(struct merger *merger, uint32_t a, uint32_t b, const struct plane *plane)
{
	if (b < a) {
		uint32_t swap = a;
		a = b;
		b = swap;
	}
	merger->parent.items[b] = a;
	if (merger->largest.items[b] > merger->largest.items[a]) {
		merger->largest.items[a] = merger->largest.items[b];
		merger->seeds.kinds.items[a] = merger->seeds.kinds.items[b];
	}
	plane_fit_join(&merger->seeds.fits.items[a], &merger->seeds.fits.items[b], plane);
}

static void try_border(struct merger *merger, uint32_t a, uint32_t b)
{
	if (!may_join(merger, a, b))
		return;
	double error;
	plane_fit_try(&merger->seeds.fits.items[a], &merger->seeds.fits.items[b], &error);
	if (error <= 1)
		push(merger, (struct merge_candidate){ (float)error, a, b });
}

static void join_what_fits(struct merger *merger)
{
	while (merger->heap.count) {
		struct merge_candidate top = pop(merger);
		uint32_t a = surface_region(merger, top.a), b = surface_region(merger, top.b);
		if (a == b || !may_join(merger, a, b))
			continue;
		double error;
		struct plane plane = plane_fit_try(&merger->seeds.fits.items[a], &merger->seeds.fits.items[b], &error);
		if (error > 1)
			continue;
		if (error > STALE_SLACK * (double)top.error + 0.01)
			push(merger, (struct merge_candidate){ (float)error, a, b });
		else
			join(merger, a, b, &plane);
	}
}

static void try_borders(struct merger *merger)
{
	for (size_t i = 0; i < merger->borders.items.count; i++)
		try_border(merger, merger->borders.items.items[i].a - 1, merger->borders.items.items[i].b - 1);
}

/* A region that may go on beyond what is in front of it. */
struct piece {
	uint64_t surface; /* only pieces of the same are looked at */
	float min_x, min_y, max_x, max_y;
	uint32_t region;
};

static int by_surface(const void *left, const void *right)
{
	const struct piece *a = left, *b = right;
	if (a->surface != b->surface)
		return a->surface < b->surface ? -1 : 1;
	if (a->min_x != b->min_x)
		return a->min_x < b->min_x ? -1 : 1;
	return (a->region > b->region) - (a->region < b->region);
}

static struct piece piece_of(const struct merger *merger, uint32_t region)
{
	const struct fit_sample *extreme = merger->seeds.fits.items[region].samples;
	const struct capture_pixel *kind = &merger->seeds.kinds.items[region];
	/* Ground is cut into objects by other rules than houses. */
	bool ground = light_class(kind->kind) == PKG_MATERIAL_GROUND;
	return (struct piece){ .surface = ground ? 0 : kind->object,
		.max_x = extreme[0].x,
		.max_y = extreme[2].y,
		.min_x = extreme[4].x,
		.min_y = extreme[6].y,
		.region = region };
}

/* Pieces of one object with something thin in front. */
static void try_pieces(struct merger *merger, float gap_px)
{
	ARRAY(struct piece) pieces = { 0 };
	for (uint32_t i = 0; i < merger->parent.count; i++)
		ARRAY_PUSH(&pieces, piece_of(merger, i));
	ARRAY_SORT(&pieces, by_surface);
	for (size_t i = 0; i < pieces.count; i++) {
		const struct piece *a = &pieces.items[i];
		int tries = 0;
		for (size_t k = i + 1; k < pieces.count && tries < PIECE_TRIES; k++) {
			const struct piece *b = &pieces.items[k];
			if (b->surface != a->surface || b->min_x > a->max_x + gap_px)
				break;
			if (b->min_y > a->max_y + gap_px || a->min_y > b->max_y + gap_px)
				continue;
			try_border(
				merger, a->region < b->region ? a->region : b->region, a->region < b->region ? b->region : a->region);
			tries++;
		}
	}
	ARRAY_FINISH(&pieces);
}

/* Replaces seeds by their regions, numbered in the order of their roots. */
static void relabel(struct merger *merger, uint32_t *label, size_t count)
{
	struct pool pool = { 0 };
	uint32_t *number = POOL_ARRAY(&pool, uint32_t, merger->parent.count + 1);
	uint32_t known = 0, seeds = (uint32_t)merger->parent.count;
	for (uint32_t i = 0; i < seeds; i++)
		if (merger->parent.items[i] == i && merger->seeds.fits.items[i].pixels)
			number[i] = known++;
	for (size_t i = 0; i < count; i++)
		if (label[i])
			label[i] = number[surface_region(merger, label[i] - 1)] + 1;
	for (uint32_t i = 0, to = 0; i < seeds; i++) {
		if (merger->parent.items[i] != i || !merger->seeds.fits.items[i].pixels)
			continue;
		merger->seeds.fits.items[to] = merger->seeds.fits.items[i];
		merger->seeds.kinds.items[to] = merger->seeds.kinds.items[i];
		merger->largest.items[to++] = merger->largest.items[i];
	}
	merger->seeds.fits.count = merger->seeds.kinds.count = merger->largest.count = merger->parent.count = known;
	for (uint32_t i = 0; i < known; i++)
		merger->parent.items[i] = i;
	pool_finish(&pool);
}

static void describe(struct surfaces *surfaces, const struct merger *merger, const struct capture_pixel *pixels)
{
	surfaces->items.count = 0;
	for (size_t i = 0; i < merger->seeds.fits.count; i++) {
		const struct capture_pixel *kind = &merger->seeds.kinds.items[i];
		ARRAY_PUSH(&surfaces->items, (struct surface){ .plane = plane_fit_solve(&merger->seeds.fits.items[i]),
										 .object = kind->object,
										 .normal_oct = { kind->normal_oct[0], kind->normal_oct[1] },
										 .kind = kind->kind,
										 .least_disparity = INFINITY,
										 .least_fitted = INFINITY,
										 .min_x = UINT16_MAX,
										 .min_y = UINT16_MAX });
	}
	for (uint32_t y = 0, i = 0; y < surfaces->height; y++) {
		for (uint32_t x = 0; x < surfaces->width; x++, i++) {
			if (!surfaces->label[i])
				continue;
			struct surface *surface = &surfaces->items.items[surfaces->label[i] - 1];
			surface->pixels++;
			surface->least_disparity = fminf(surface->least_disparity, pixels[i].disparity);
			surface->least_fitted = fminf(surface->least_fitted, (float)plane_at(&surface->plane, x + 0.5, y + 0.5));
			surface->min_x = (uint16_t)(x < surface->min_x ? x : surface->min_x);
			surface->max_x = (uint16_t)(x > surface->max_x ? x : surface->max_x);
			surface->min_y = (uint16_t)(y < surface->min_y ? y : surface->min_y);
			surface->max_y = (uint16_t)(y > surface->max_y ? y : surface->max_y);
		}
	}
}

/* From seeds to regions. */
static void grow(struct merger *merger, const struct surfaces_input *input, struct surfaces *surfaces)
{
	size_t count = (size_t)surfaces->width * surfaces->height;
	borders_find(&merger->borders, surfaces->label, surfaces->width, surfaces->height);
	try_borders(merger);
	join_what_fits(merger);
	relabel(merger, surfaces->label, count);
	try_pieces(merger, input->gap_px);
	join_what_fits(merger);
	relabel(merger, surfaces->label, count);
	borders_find(&merger->borders, surfaces->label, surfaces->width, surfaces->height);
	surfaces_swallow(merger, input);
	relabel(merger, surfaces->label, count);
	surfaces_eject(merger, input, surfaces->label);
	relabel(merger, surfaces->label, count);
}

void surfaces_find(struct surfaces *surfaces, const struct surfaces_input *input)
{
	const struct capture_view *view = &input->image->view;
	*surfaces = (struct surfaces){ .width = view->width, .height = view->height };
	size_t count = (size_t)view->width * view->height, capacity = 0;
	surfaces->label = array_grow(NULL, &capacity, count + 1, sizeof(*surfaces->label));
	struct merger merger = { .per_px2 = input->per_px * input->per_px };
	surface_seeds_find(&merger.seeds, input, surfaces->label);
	for (uint32_t i = 0; i < merger.seeds.fits.count; i++) {
		ARRAY_PUSH(&merger.parent, i);
		ARRAY_PUSH(&merger.largest, merger.seeds.fits.items[i].pixels);
	}
	relabel(&merger, surfaces->label, count);
	if (!input->continuous)
		grow(&merger, input, surfaces);
	describe(surfaces, &merger, input->image->pixels);
	ARRAY_FINISH(&merger.parent);
	ARRAY_FINISH(&merger.largest);
	ARRAY_FINISH(&merger.heap);
	borders_finish(&merger.borders);
	surface_seeds_finish(&merger.seeds);
}

void surfaces_finish(struct surfaces *surfaces)
{
	array_free(surfaces->label);
	ARRAY_FINISH(&surfaces->items);
	*surfaces = (struct surfaces){ 0 };
}
