/* The steps in their order. */
#include <errno.h>

#include "tools/impostor/impostor.h"

/* What each capture has to add, and the triangles that it took without a bound. */
struct demand {
	uint8_t *owner;
	size_t triangles;
};

/* Without a bound. False: there are more triangles than there may be; the mesh is of no use then. */
static bool make_freely(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct demand *demands, struct impostor_mesh *mesh)
{
	struct impostor_options unbound = *options;
	unbound.triangles_max = 0;
	for (size_t i = 0; i < count; i++) {
		size_t before = mesh->indices.count / 3;
		impostor_mesh_add(mesh, cell, &captures[i], demands[i].owner, (uint8_t)i, &unbound);
		demands[i].triangles = mesh->indices.count / 3 - before;
	}
	return !options->triangles_max || mesh->indices.count / 3 <= options->triangles_max;
}

/* The triangles that are left are shared as they were asked for; what a capture does not need the next ones get. */
static void make_within(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, const struct demand *demands, struct impostor_mesh *mesh)
{
	size_t asked = 0;
	for (size_t i = 0; i < count; i++)
		asked += demands[i].triangles;
	for (size_t i = 0; i < count; asked -= demands[i++].triangles) {
		struct impostor_options share = *options;
		size_t used = mesh->indices.count / 3;
		size_t left = options->triangles_max > used ? options->triangles_max - used : 0;
		if (!demands[i].triangles)
			continue;
		share.triangles_max = (uint32_t)(used + left * demands[i].triangles / asked);
		impostor_mesh_add(mesh, cell, &captures[i], demands[i].owner, (uint8_t)i, &share);
	}
}

static void make_mesh(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor_mesh *mesh)
{
	struct pool pool = { 0 };
	struct demand *demands = POOL_ARRAY(&pool, struct demand, count);
	for (size_t i = 0; i < count; i++) {
		const struct capture_view *view = &captures[i].image.view;
		demands[i].owner = POOL_ARRAY(&pool, uint8_t, (size_t)view->width * view->height);
		impostor_fuse(cell, captures, i, options, demands[i].owner);
	}
	if (!make_freely(cell, captures, count, options, demands, mesh)) {
		impostor_mesh_finish(mesh);
		make_within(cell, captures, count, options, demands, mesh);
	}
	pool_finish(&pool);
}

int impostor_build(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out)
{
	if (count > PKG_IMPOSTOR_VIEWS_MAX) {
		*out = (struct impostor){ 0 };
		return -E2BIG;
	}
	struct impostor_mesh mesh = { 0 };
	make_mesh(cell, captures, count, options, &mesh);
	int result = impostor_atlas(&mesh, cell, captures, count, options, out);
	impostor_mesh_finish(&mesh);
	return result;
}
