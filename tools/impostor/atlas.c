/*
 * Texels for an impostor's patches, and the package's vertices. When the pages do not do, all texels are made coarser
 * by the same factor, found by halving. Colours take most of the time: about 20 ms for a million texels.
 */
#include <errno.h>
#include <string.h>

#include "tools/impostor/atlas_layout.h"

#define FACTOR_MIN (1.0 / 16)
#define HALVINGS 5
#define UV_STEPS 128 /* of a texel */
#define DISTANCE_STEP                                                                                                  \
	1.25 /* triangles within this ratio of distance keep their patches' order: indices pack better                     \
		  */

/* A triangle of the package, before sorting. */
struct placed {
	uint32_t corner[3]; /* into the impostor's vertices */
	int32_t ring;       /* of distance */
	uint32_t order;
};

struct assembly {
	const struct atlas_layout *layout;
	const struct impostor_mesh *mesh;
	const struct impostor_capture *captures;
	double middle_m[3]; /* of the view cell, from the origin */
	struct impostor *out;
	ARRAY(struct placed) triangles;
	uint32_t *slots; /* open addressing: index of a vertex + 1 */
	size_t slot_mask;
};

static bool make_layout(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, const struct impostor_options *options)
{
	atlas_layout_make(layout, mesh, cell, captures, options, 1);
	if (layout->page_count || !layout->shapes.count)
		return true;
	double low = FACTOR_MIN, high = 1;
	for (int i = 0; i < HALVINGS; i++) {
		double middle = sqrt(low * high);
		atlas_layout_make(layout, mesh, cell, captures, options, middle);
		*(layout->page_count ? &low : &high) = middle;
	}
	atlas_layout_make(layout, mesh, cell, captures, options, low);
	return layout->page_count > 0;
}

static uint32_t hash_of(const struct pkg_impostor_vertex *vertex)
{
	uint32_t words[sizeof(*vertex) / 4], hash = 0x9e3779b9;
	memcpy(words, vertex, sizeof(words));
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		hash = (hash ^ words[i]) * 0x85ebca6b;
		hash ^= hash >> 15;
	}
	return hash;
}

static uint32_t add_vertex(struct assembly *assembly, struct pkg_impostor_vertex vertex)
{
	size_t slot = hash_of(&vertex) & assembly->slot_mask;
	for (; assembly->slots[slot]; slot = (slot + 1) & assembly->slot_mask) {
		uint32_t found = assembly->slots[slot] - 1;
		if (!memcmp(&assembly->out->vertices.items[found], &vertex, sizeof(vertex)))
			return found;
	}
	ARRAY_PUSH(&assembly->out->vertices, vertex);
	assembly->slots[slot] = (uint32_t)assembly->out->vertices.count;
	return assembly->slots[slot] - 1;
}

static uint16_t texel_coordinate(double px, int32_t start_px, double scale, uint32_t start_block)
{
	double texel = (px - start_px) * scale + ATLAS_GUTTER + 4.0 * start_block;
	return (uint16_t)lround(fmin(fmax(texel, 0), PKG_PAGE_PX) * UV_STEPS);
}

static struct pkg_impostor_vertex make_vertex(
	const struct assembly *assembly, const struct atlas_piece *piece, const struct mesh_vertex *corner)
{
	const struct mesh_patch *patch = &assembly->mesh->patches.items[piece->patch];
	const struct atlas_cluster *cluster = &assembly->layout->clusters.items[piece->cluster];
	const struct pack_shape *shape = &assembly->layout->shapes.items[piece->cluster];
	struct dvec3 point =
		capture_point(&assembly->captures[patch->view].image.view, corner->x, corner->y, corner->disparity);
	const int32_t *origin = assembly->out->origin_mm;
	unsigned kind = patch->kind < 7 ? patch->kind : 7;
	return (struct pkg_impostor_vertex){
		.pos_mm = { (int32_t)llround(point.x * 1e3 - origin[0]), (int32_t)llround(point.y * 1e3 - origin[1]),
			(int32_t)llround(point.z * 1e3 - origin[2]) },
		.uv = { texel_coordinate(corner->x, cluster->left, cluster->scale, shape->x),
			texel_coordinate(corner->y, cluster->top, cluster->scale, shape->y) },
		.page = (uint8_t)shape->page,
		.view_kind = (uint8_t)(patch->view + PKG_IMPOSTOR_VIEWS_MAX * kind),
		.normal_oct = { patch->smooth ? corner->normal_oct[0] : patch->normal_oct[0],
			patch->smooth ? corner->normal_oct[1] : patch->normal_oct[1] },
	};
}

static int32_t ring_of(const struct assembly *assembly, const uint32_t corner[3])
{
	double least = INFINITY;
	for (int i = 0; i < 3; i++) {
		const int32_t *pos = assembly->out->vertices.items[corner[i]].pos_mm;
		double off[3];
		for (int k = 0; k < 3; k++)
			off[k] = pos[k] * 1e-3 - assembly->middle_m[k];
		least = fmin(least, off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
	}
	return (int32_t)floor(log(fmax(least, 1)) / (2 * log(DISTANCE_STEP)));
}

static void add_piece(struct assembly *assembly, const struct atlas_piece *piece)
{
	const struct mesh_vertex *corners = &assembly->layout->corners.items[piece->first_corner];
	for (uint32_t i = 0; i < piece->corner_count; i += 3) {
		struct placed placed = { .order = (uint32_t)assembly->triangles.count };
		for (uint32_t k = 0; k < 3; k++)
			placed.corner[k] = add_vertex(assembly, make_vertex(assembly, piece, &corners[i + k]));
		if (placed.corner[0] == placed.corner[1] || placed.corner[1] == placed.corner[2] ||
			placed.corner[2] == placed.corner[0])
			continue;
		placed.ring = ring_of(assembly, placed.corner);
		ARRAY_PUSH(&assembly->triangles, placed);
	}
}

static int nearest_first(const void *left, const void *right)
{
	const struct placed *a = left, *b = right;
	if (a->ring != b->ring)
		return a->ring < b->ring ? -1 : 1;
	return (a->order > b->order) - (a->order < b->order);
}

/* Vertices in the order of their first use, indices by distance. */
static void write_triangles(struct assembly *assembly)
{
	struct impostor *out = assembly->out;
	struct pool pool = { 0 };
	uint32_t *renamed = POOL_ARRAY(&pool, uint32_t, out->vertices.count);
	struct pkg_impostor_vertex *before = pool_copy(&pool, out->vertices.items, sizeof(*before) * out->vertices.count);
	out->vertices.count = 0;
	ARRAY_SORT(&assembly->triangles, nearest_first);
	for (size_t i = 0; i < assembly->triangles.count; i++) {
		for (int k = 0; k < 3; k++) {
			uint32_t corner = assembly->triangles.items[i].corner[k];
			if (!renamed[corner]) {
				ARRAY_PUSH(&out->vertices, before[corner]);
				renamed[corner] = (uint32_t)out->vertices.count;
			}
			ARRAY_PUSH(&out->indices, (uint16_t)(renamed[corner] - 1));
		}
	}
	pool_finish(&pool);
}

/* False when indices do not do. */
static bool assemble(const struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, struct impostor *out)
{
	struct pool pool = { 0 };
	struct assembly assembly = { .layout = layout, .mesh = mesh, .captures = captures, .out = out };
	const double middle[3] = { (cell->start.x + cell->end.x) / 2, (cell->start.y + cell->end.y) / 2,
		(cell->start.z + cell->end.z) / 2 };
	for (int k = 0; k < 3; k++)
		assembly.middle_m[k] = middle[k] - out->origin_mm[k] * 1e-3;
	size_t slots = 64;
	while (slots < 2 * layout->corners.count)
		slots *= 2;
	assembly.slots = POOL_ARRAY(&pool, uint32_t, slots);
	assembly.slot_mask = slots - 1;
	for (size_t i = 0; i < layout->pieces.count; i++)
		add_piece(&assembly, &layout->pieces.items[i]);
	bool is_small = out->vertices.count <= UINT16_MAX;
	if (is_small)
		write_triangles(&assembly);
	ARRAY_FINISH(&assembly.triangles);
	pool_finish(&pool);
	return is_small;
}

static void add_view(const struct capture_view *view, struct impostor *out)
{
	struct dvec3 forward = view->forward;
	double at_origin = forward.x * (out->origin_mm[0] * 1e-3 - view->eye.x) +
					   forward.y * (out->origin_mm[1] * 1e-3 - view->eye.y) +
					   forward.z * (out->origin_mm[2] * 1e-3 - view->eye.z);
	ARRAY_PUSH(&out->views,
		(struct pkg_impostor_view){ { (float)forward.x, (float)forward.y, (float)forward.z, (float)at_origin } });
}

int impostor_atlas(const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, size_t count, const struct impostor_options *options, struct impostor *out)
{
	struct atlas_layout layout = { 0 };
	int result = 0;
	*out = (struct impostor){ .error_px = mesh->error_px, .over_share = mesh->over_share };
	const double start[3] = { cell->start.x, cell->start.y, cell->start.z };
	for (int k = 0; k < 3; k++)
		out->origin_mm[k] = (int32_t)lround(start[k] * 1e3);
	if (count > PKG_IMPOSTOR_VIEWS_MAX)
		return -E2BIG;
	for (size_t i = 0; i < count; i++)
		add_view(&captures[i].image.view, out);
	if (!make_layout(&layout, mesh, cell, captures, options) || !assemble(&layout, mesh, cell, captures, out)) {
		impostor_finish(out);
		result = -E2BIG;
	} else {
		size_t texels = (size_t)layout.page_count * PKG_PAGE_PX * PKG_PAGE_PX, capacity = 0;
		out->page_count = layout.page_count;
		out->pages = array_grow(NULL, &capacity, texels + 1, 4);
		memset(out->pages, 0, 4 * texels);
		if (options->truth) {
			capacity = 0;
			out->truth = array_grow(NULL, &capacity, texels + 1, sizeof(*out->truth));
			memset(out->truth, 0, sizeof(*out->truth) * texels);
		}
		atlas_paint(&layout, mesh, captures, out);
	}
	atlas_layout_finish(&layout);
	return result;
}
