#include "assets/resident.h"

#include <math.h>

#include "assets/cell_cache.h"
#include "assets/pkg_check.h"
#include "assets/residency.h"

#define AHEAD_M 30.0 /* chunks are loaded so much earlier than they are needed */

/* Local triangles are within near_mm of the stretch's axis, and the eye may be at its other end. */
static double find_reach_m(const struct pkg *pkg)
{
	double reach_mm = 0.0;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		double length_mm = hypot((double)stretch->end_mm[0] - stretch->start_mm[0],
							   (double)stretch->end_mm[1] - stretch->start_mm[1]) +
						   2.0 * stretch->overrun_mm + stretch->half_width_mm;
		reach_mm = fmax(reach_mm, stretch->near_mm + length_mm);
	}
	return reach_mm * 1e-3 + AHEAD_M;
}

static uint64_t texture_bytes(const struct pkg *pkg)
{
	const struct pkg_section *sections;
	uint32_t count = pkg->map.bytes.data ? pkg_sections(pkg, &sections) : 0;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < count; i++)
		if (sections[i].tag == PKG_TEXA || sections[i].tag == PKG_LMAP)
			sum += sections[i].bytes;
	return sum;
}

static uint64_t slot_bytes(const struct pkg *pkg)
{
	struct cell_limits limits;
	cell_cache_limits(pkg, &(struct cell_cache_config){ 0 }, &limits);
	return ((uint64_t)limits.local_indices + limits.pvs_indices + limits.impostor_indices) * sizeof(uint16_t) +
		   (uint64_t)limits.pvs_vertices * sizeof(struct pkg_mesh_vertex) +
		   (uint64_t)limits.impostor_vertices * sizeof(struct pkg_impostor_vertex) +
		   (uint64_t)limits.impostor_pages * PKG_PAGE_BYTES +
		   2 * PKG_IMPOSTOR_VIEWS_MAX * sizeof(struct pkg_impostor_view);
}

static void add_up(struct resident_need *need)
{
	need->geometry = need->vertices * sizeof(struct pkg_mesh_vertex) + need->indices * sizeof(uint16_t);
	need->sum = need->textures + need->geometry + RESIDENT_SLOTS * need->slot;
}

void resident_need_whole(const struct pkg *pkg, struct resident_need *out)
{
	*out =
		(struct resident_need){ .textures = texture_bytes(pkg), .slot = slot_bytes(pkg), .reach_m = find_reach_m(pkg) };
	residency_totals(pkg, &out->vertices, &out->indices);
	add_up(out);
}

int resident_need(const struct pkg *pkg, struct arena *scratch, struct resident_need *out)
{
	*out =
		(struct resident_need){ .textures = texture_bytes(pkg), .slot = slot_bytes(pkg), .reach_m = find_reach_m(pkg) };
	int status = residency_pools(pkg, scratch, out->reach_m, &out->vertices, &out->indices);
	if (status == 0)
		add_up(out);
	return status;
}
