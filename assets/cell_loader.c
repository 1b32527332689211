/* Loading: read, unpack and check, then expand. About 20 ms for a stretch of 1 MiB. */
#include "assets/cell_loader.h"

#include <errno.h>
#include <string.h>

#include "assets/impostor_fold.h"

#define STAGING_ALIGN 64u

static uint64_t aligned(uint64_t bytes)
{
	return (bytes + STAGING_ALIGN - 1) / STAGING_ALIGN * STAGING_ALIGN;
}

bool cell_loader_wants_pvs(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t stretch)
{
	const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)stretch];
	bool needed = cells[0].kind == PKG_CELL_GEOMETRY || cells[1].kind == PKG_CELL_GEOMETRY;
	bool wanted = config->pvs == CELL_PVS_ALWAYS || (config->pvs == CELL_PVS_WHERE_NEEDED && needed);
	return wanted && pkg->stretches[stretch].pvs.stored_bytes;
}

uint64_t cell_loader_raw_bytes(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t index)
{
	const struct pkg_stretch *stretch = &pkg->stretches[index];
	const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)index];
	uint64_t sum = stretch->local.raw_bytes;
	if (cell_loader_wants_pvs(config, pkg, index))
		sum += stretch->pvs.raw_bytes;
	if (!config->without_impostors)
		sum += (uint64_t)cells[0].impostor.raw_bytes + cells[1].impostor.raw_bytes;
	return sum;
}

uint64_t cell_loader_staging_bytes(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t index)
{
	const struct pkg_stretch *stretch = &pkg->stretches[index];
	const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)index];
	const uint64_t triangle_bytes = 3 * sizeof(uint16_t);
	uint64_t sum = aligned(stretch->local_triangles * triangle_bytes);
	if (cell_loader_wants_pvs(config, pkg, index)) {
		sum += aligned(stretch->pvs_triangles * triangle_bytes);
		if (cell_loader_copies_pvs(config))
			sum += aligned((uint64_t)stretch->pvs_triangles * 3 * sizeof(struct pkg_mesh_vertex));
	}
	for (int side = 0; side < 2 && !config->without_impostors; side++)
		sum += aligned(cells[side].impostor.raw_bytes);
	return sum;
}

/* What the largest set takes as stored, or the largest impostor to be unfolded. */
static uint64_t scratch_bytes(const struct pkg *pkg, const struct cell_cache_config *config)
{
	uint64_t most = 0;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)i];
		if (cell_loader_staging_bytes(config, pkg, i) > config->staging_bytes)
			continue;
		most = stretch->local.raw_bytes > most ? stretch->local.raw_bytes : most;
		if (cell_loader_wants_pvs(config, pkg, i) && stretch->pvs.raw_bytes > most)
			most = stretch->pvs.raw_bytes;
		for (int side = 0; side < 2 && !config->without_impostors; side++) {
			uint64_t fold = impostor_fold_bytes(cells[side].vertex_count, cells[side].index_count);
			most = fold > most ? fold : most;
		}
	}
	return most;
}

uint64_t cell_loader_bytes(const struct pkg *pkg, const struct cell_cache_config *config)
{
	uint64_t most = scratch_bytes(pkg, config);
	return BLOB_READER_BYTES + most + set_expander_bytes(pkg, (uint32_t)(most / sizeof(struct pkg_set_object))) + 256;
}

int cell_loader_init(
	struct cell_loader *loader, struct arena *arena, const struct pkg *pkg, const struct cell_cache_config *config)
{
	uint64_t most = scratch_bytes(pkg, config);
	*loader = (struct cell_loader){
		.pkg = pkg,
		.config = config,
		.scratch = arena_alloc(arena, (size_t)most + 1, STAGING_ALIGN),
	};
	if (!loader->scratch || blob_reader_init(&loader->reader, arena) < 0)
		return -ENOMEM;
	return set_expander_init(
		&loader->expander, arena, pkg, config->look_of, (uint32_t)(most / sizeof(struct pkg_set_object)));
}

/* What is left of a staging buffer. */
struct staging {
	uint8_t *at;
	uint64_t left;
};

static void *take(struct staging *staging, uint64_t bytes)
{
	uint64_t whole = aligned(bytes);
	if (whole > staging->left)
		return NULL;
	uint8_t *at = staging->at;
	staging->at += whole;
	staging->left -= whole;
	return at;
}

static int load_set(struct cell_loader *loader, const struct pkg_blob *blob, uint32_t triangles, bool copied,
	struct set_room *room, struct staging *staging, struct cell_set *out)
{
	struct set_view set = { 0 };
	if (!blob->stored_bytes)
		return 0;
	int status = blob_read(loader->reader, loader->pkg, blob, loader->scratch);
	if (!status)
		status = set_view_open(&set, loader->pkg, loader->scratch, blob->raw_bytes);
	if (status < 0 || set.triangle_count != triangles)
		return -EBADMSG;
	room->index_capacity = triangles * 3;
	room->indices = take(staging, room->index_capacity * sizeof(uint16_t));
	if (copied) {
		room->vertex_capacity = triangles * 3;
		room->vertices = take(staging, (uint64_t)room->vertex_capacity * sizeof(struct pkg_mesh_vertex));
	}
	if (!room->indices || (copied && !room->vertices))
		return -E2BIG;
	return set_expand(&loader->expander, &set, room, out);
}

static int load_impostor(struct cell_loader *loader, uint32_t id, struct pkg_impostor_view *views,
	struct staging *staging, struct impostor_view *out)
{
	const struct pkg_cell *cell = &loader->pkg->cells[id];
	if (!cell->impostor.stored_bytes)
		return 0;
	void *raw = take(staging, cell->impostor.raw_bytes);
	if (!raw)
		return -E2BIG;
	int status = blob_read(loader->reader, loader->pkg, &cell->impostor, raw);
	if (!status)
		status = impostor_view_open(out, cell, raw, cell->impostor.raw_bytes, loader->scratch);
	if (status < 0)
		return status;
	memcpy(views, out->views, out->head.view_count * sizeof(*views));
	out->views = views;
	return 0;
}

int cell_loader_load(struct cell_loader *loader, uint32_t index, const struct cell_limits *limits,
	const struct cell_keep *keep, uint8_t *bytes, uint64_t staging_bytes, struct cell_slot *out)
{
	const struct pkg_stretch *stretch = &loader->pkg->stretches[index];
	struct staging staging = { .at = bytes, .left = staging_bytes };
	struct set_room local = { .ranges = keep->local_ranges,
		.parts = keep->local_parts,
		.range_capacity = limits->local_parts,
		.part_capacity = limits->local_parts };
	struct set_room pvs = { .ranges = keep->pvs_ranges,
		.parts = keep->pvs_parts,
		.range_capacity = limits->pvs_parts,
		.part_capacity = limits->pvs_parts };
	*out = (struct cell_slot){ .stretch = index };
	int status = load_set(loader, &stretch->local, stretch->local_triangles, false, &local, &staging, &out->local);
	if (!status && cell_loader_wants_pvs(loader->config, loader->pkg, index)) {
		out->has_pvs = true;
		status = load_set(loader, &stretch->pvs, stretch->pvs_triangles, cell_loader_copies_pvs(loader->config), &pvs,
			&staging, &out->pvs);
	}
	for (uint32_t side = 0; side < 2 && !status && !loader->config->without_impostors; side++)
		status = load_impostor(loader, 2 * index + side, keep->views[side], &staging, &out->impostor[side]);
	return status;
}
