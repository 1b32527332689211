#include "render/cell_store.h"

#include <assert.h>
#include <errno.h>

static_assert(sizeof(struct impostor_block) == 32 * 16, "std140");
static_assert(PKG_IMPOSTOR_VIEWS_MAX == 32, "impostor.vert");

static int make_buffer(struct cell_store *store, enum gfx_buffer_kind kind, uint64_t bytes, gfx_buffer *out)
{
	struct gfx_buffer_desc desc = { .kind = kind, .bytes = (uint32_t)bytes };
	if (bytes > UINT32_MAX)
		return -ENOMEM;
	return bytes ? gfx_buffer_create(store->gfx, &desc, out) : 0;
}

static int make_buffers(struct cell_store *store, bool lines)
{
	const struct cell_limits *limits = &store->limits;
	uint64_t slots = store->slot_count;
	const struct {
		enum gfx_buffer_kind kind;
		uint64_t bytes;
		gfx_buffer *out;
	} wanted[] = {
		{ GFX_BUFFER_INDEX, slots * ((uint64_t)limits->local_indices + limits->pvs_indices) * 2, &store->set_indices },
		{ GFX_BUFFER_VERTEX, slots * limits->pvs_vertices * sizeof(struct pkg_mesh_vertex), &store->set_vertices },
		{ GFX_BUFFER_VERTEX, slots * limits->impostor_vertices * sizeof(struct pkg_impostor_vertex),
			&store->impostor_vertices },
		{ GFX_BUFFER_INDEX, slots * limits->impostor_indices * 2, &store->impostor_indices },
		{ GFX_BUFFER_INDEX, lines ? slots * limits->impostor_indices * 4 : 0, &store->impostor_lines },
	};
	int err = 0;
	for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]) && !err; i++)
		err = make_buffer(store, wanted[i].kind, wanted[i].bytes, wanted[i].out);
	for (uint32_t i = 0; i < store->slot_count * 2 && limits->impostor_pages && !err; i++)
		err = make_buffer(
			store, GFX_BUFFER_UNIFORM, sizeof(struct impostor_block), &store->slots[i / 2].impostor[i % 2].block);
	return err;
}

static int make_pages(struct cell_store *store)
{
	uint64_t layers = (uint64_t)store->slot_count * store->limits.impostor_pages;
	if (!layers)
		return 0;
	if (layers > gfx_caps(store->gfx)->max_array_layers)
		return -ENOMEM;
	struct gfx_texture_desc desc = { .format = GFX_ETC2_RGBA8,
		.width = PKG_PAGE_PX,
		.height = PKG_PAGE_PX,
		.layers = (uint32_t)layers,
		.filter = GFX_LINEAR };
	return gfx_texture_create(store->gfx, &desc, &store->pages);
}

uint64_t cell_store_slot_bytes(const struct cell_limits *limits)
{
	return ((uint64_t)limits->local_indices + limits->pvs_indices + limits->impostor_indices) * 2 +
		   (uint64_t)limits->pvs_vertices * sizeof(struct pkg_mesh_vertex) +
		   (uint64_t)limits->impostor_vertices * sizeof(struct pkg_impostor_vertex) +
		   (uint64_t)limits->impostor_pages * PKG_PAGE_BYTES +
		   (limits->impostor_pages ? 2 * sizeof(struct impostor_block) : 0);
}

int cell_store_init(struct cell_store *store, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	const struct cell_limits *limits, uint32_t slot_count, bool lines)
{
	uint64_t before = gfx_stats(gfx)->bytes;
	*store = (struct cell_store){ .gfx = gfx, .pkg = pkg, .limits = *limits, .slot_count = slot_count };
	store->slots = ARENA_ARRAY(arena, struct stored_slot, slot_count);
	if (!store->slots)
		return -ENOMEM;
	int err = make_buffers(store, lines);
	if (!err)
		err = make_pages(store);
	store->bytes = gfx_stats(gfx)->bytes - before;
	return err;
}

void cell_store_finish(struct cell_store *store)
{
	if (!store->gfx)
		return;
	gfx_texture_destroy(store->gfx, store->pages);
	for (uint32_t i = 0; store->slots && i < store->slot_count * 2; i++)
		gfx_buffer_destroy(store->gfx, store->slots[i / 2].impostor[i % 2].block);
	gfx_buffer_destroy(store->gfx, store->impostor_lines);
	gfx_buffer_destroy(store->gfx, store->impostor_indices);
	gfx_buffer_destroy(store->gfx, store->impostor_vertices);
	gfx_buffer_destroy(store->gfx, store->set_vertices);
	gfx_buffer_destroy(store->gfx, store->set_indices);
	*store = (struct cell_store){ 0 };
}

void cell_store_follow(struct cell_store *store, const struct cell_cache *cache)
{
	for (uint32_t i = 0; i < store->slot_count; i++) {
		const struct cell_slot *slot = cell_cache_slot(cache, i);
		if (store->slots[i].generation == slot->generation)
			continue;
		store->slots[i].generation = slot->generation;
		store->slots[i].step = STORED_NOTHING;
		store->slots[i].pages_done = 0;
	}
}

static uint64_t upload_set(struct cell_store *store, const struct cell_set *set, uint32_t first_index,
	uint32_t first_vertex, struct draw_set *out)
{
	const uint32_t vertex_bytes = sizeof(struct pkg_mesh_vertex);
	bool own = set->vertex_count > 0;
	*out = (struct draw_set){
		.indices = store->set_indices, .first_index = first_index, .first_vertex = first_vertex, .cells = set
	};
	if (set->index_count)
		gfx_buffer_write(store->gfx, store->set_indices, first_index * 2, set->indices, set->index_count * 2);
	if (own) {
		out->vertices = store->set_vertices;
		gfx_buffer_write(store->gfx, store->set_vertices, first_vertex * vertex_bytes, set->vertices,
			set->vertex_count * vertex_bytes);
	}
	return (uint64_t)set->index_count * 2 + (own ? (uint64_t)set->vertex_count * vertex_bytes : 0);
}

static uint64_t upload_sets(struct cell_store *store, uint32_t index, const struct cell_slot *slot)
{
	const struct cell_limits *limits = &store->limits;
	struct stored_slot *out = &store->slots[index];
	uint32_t first = index * (limits->local_indices + limits->pvs_indices);
	uint64_t bytes = upload_set(store, &slot->local, first, 0, &out->local);
	return bytes +
		   upload_set(store, &slot->pvs, first + limits->local_indices, index * limits->pvs_vertices, &out->pvs);
}

static void write_block(struct cell_store *store, const struct stored_impostor *out, const struct impostor_view *from)
{
	struct impostor_block block = { 0 };
	for (uint32_t i = 0; i < from->head.view_count; i++)
		for (int k = 0; k < 4; k++)
			block.axis[i][k] = from->views[i].axis[k];
	gfx_buffer_write(store->gfx, out->block, 0, &block, sizeof(block));
}

/* Each triangle's three edges. */
static void write_lines(struct cell_store *store, uint32_t first_index, const struct impostor_view *from)
{
	for (uint32_t i = 0; store->impostor_lines.id && i + 2 < from->head.index_count; i += 3) {
		const uint16_t *t = &from->indices[i];
		const uint16_t lines[6] = { t[0], t[1], t[1], t[2], t[2], t[0] };
		gfx_buffer_write(store->gfx, store->impostor_lines, (first_index + i) * 4, lines, sizeof(lines));
	}
}

static uint64_t upload_triangles(struct cell_store *store, uint32_t index, const struct cell_slot *slot)
{
	struct stored_slot *out = &store->slots[index];
	uint32_t vertex = index * store->limits.impostor_vertices, at = index * store->limits.impostor_indices;
	uint32_t layer = index * store->limits.impostor_pages;
	uint64_t bytes = 0;
	for (int i = 0; i < 2; i++) {
		const struct impostor_view *from = &slot->impostor[i];
		uint32_t vertex_bytes = from->head.vertex_count * (uint32_t)sizeof(struct pkg_impostor_vertex);
		out->impostor[i].first_vertex = vertex;
		out->impostor[i].first_index = at;
		out->impostor[i].index_count = from->head.index_count;
		out->impostor[i].first_layer = layer;
		if (!from->head.index_count)
			continue;
		gfx_buffer_write(store->gfx, store->impostor_vertices, vertex * (uint32_t)sizeof(struct pkg_impostor_vertex),
			from->vertices, vertex_bytes);
		gfx_buffer_write(store->gfx, store->impostor_indices, at * 2, from->indices, from->head.index_count * 2);
		write_block(store, &out->impostor[i], from);
		write_lines(store, at, from);
		vertex += from->head.vertex_count;
		at += from->head.index_count;
		layer += from->head.page_count;
		bytes += vertex_bytes + from->head.index_count * 2;
	}
	return bytes;
}

static void upload_page(struct cell_store *store, uint32_t index, const struct cell_slot *slot)
{
	uint32_t page = store->slots[index].pages_done++, first = slot->impostor[0].head.page_count;
	struct gfx_region region = {
		.layer = index * store->limits.impostor_pages + page, .width = PKG_PAGE_PX, .height = PKG_PAGE_PX, .layers = 1
	};
	const uint8_t *pages = page < first ? slot->impostor[0].pages : slot->impostor[1].pages;
	page -= page < first ? 0 : first;
	gfx_texture_write(store->gfx, store->pages, &region, pages + (size_t)page * PKG_PAGE_BYTES);
}

/* One step; returns its bytes. */
static uint64_t upload_step(struct cell_store *store, uint32_t index, const struct cell_slot *slot)
{
	struct stored_slot *out = &store->slots[index];
	switch (out->step) {
	case STORED_NOTHING:
		out->step = STORED_SETS;
		return upload_sets(store, index, slot);
	case STORED_SETS:
		out->step = STORED_TRIANGLES;
		return upload_triangles(store, index, slot);
	default:
		if (out->pages_done == slot->impostor[0].head.page_count + slot->impostor[1].head.page_count) {
			out->step = STORED_ALL;
			return 0;
		}
		upload_page(store, index, slot);
		return PKG_PAGE_BYTES;
	}
}

bool cell_store_upload(struct cell_store *store, uint32_t index, const struct cell_slot *slot, uint64_t *left_bytes)
{
	struct stored_slot *out = &store->slots[index];
	assert(out->generation == slot->generation && slot->state == CELL_READY);
	do {
		uint64_t bytes = upload_step(store, index, slot);
		*left_bytes -= bytes < *left_bytes ? bytes : *left_bytes;
	} while (out->step != STORED_ALL && *left_bytes);
	return out->step == STORED_ALL;
}
