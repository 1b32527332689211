/* From labelled triangles to patches: their order, the points' disparities, vertices, texels. */
#include <math.h>
#include <string.h>

#include "tools/impostor/sheet_mesh.h"

#define NEAREST_PX 4
#define AGREE_SHARE 0.4 /* of the tolerance: planes nearer to each other than this share a vertex */

/* Kept triangles in the order of patches: by surface, then by cell of large ones, then as they are. */
static void order_triangles(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	mesher->order.count = 0;
	for (uint32_t i = 0; i < mesher->cdt.triangles.count; i++) {
		uint32_t label = mesher->face.items[i];
		if (!label)
			continue;
		uint64_t cell = 0;
		if (sheet_is_large(source, sheet_surface(source, label))) {
			struct triangle_corners corners = sheet_corners(&mesher->cdt, i);
			uint64_t column = (uint64_t)((corners.x[0] + corners.x[1] + corners.x[2]) / (3 * MESH_CELL_PX));
			uint64_t row = (uint64_t)((corners.y[0] + corners.y[1] + corners.y[2]) / (3 * MESH_CELL_PX));
			cell = row << 5 | column;
		}
		ARRAY_PUSH(&mesher->order, (uint64_t)label << 38 | cell << 28 | i);
	}
}

static int by_value(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
	return (a > b) - (a < b);
}

/* Disparity of the surface's pixel that is nearest to a point, of those within NEAREST_PX. */
static double captured_at(const struct sheet_source *source, uint32_t label, double x, double y)
{
	const struct surfaces *surfaces = source->surfaces;
	double best = INFINITY, disparity = sheet_surface(source, label)->least_disparity;
	for (int64_t row = (int64_t)y - NEAREST_PX; row <= (int64_t)y + NEAREST_PX; row++) {
		for (int64_t column = (int64_t)x - NEAREST_PX; column <= (int64_t)x + NEAREST_PX; column++) {
			if (row < 0 || column < 0 || row >= surfaces->height || column >= surfaces->width)
				continue;
			size_t pixel = (size_t)row * surfaces->width + (size_t)column;
			double dx = (double)column + 0.5 - x, dy = (double)row + 0.5 - y;
			if (surfaces->label[pixel] == label && dx * dx + dy * dy < best) {
				best = dx * dx + dy * dy;
				disparity = source->image->pixels[pixel].disparity;
			}
		}
	}
	return disparity;
}

static double disparity_at(const struct sheet_source *source, uint32_t label, struct cdt_point point)
{
	double x = (double)point.x / MESH_LATTICE, y = (double)point.y / MESH_LATTICE;
	if (source->options.grid_px)
		return captured_at(source, label, x, y);
	const struct surface *surface = sheet_surface(source, label);
	return fmax(plane_at(&surface->plane, x, y), MESH_LEAST_SHARE * (double)surface->least_disparity);
}

/* Asks the surfaces that meet at each point for its disparity. */
static void ask_surfaces(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	size_t count = mesher->cdt.points.count;
	ARRAY_RESERVE(&mesher->stamp, count);
	ARRAY_RESERVE(&mesher->meetings, count);
	memset(mesher->stamp.items, 0, count * sizeof(uint32_t));
	memset(mesher->meetings.items, 0, count * sizeof(*mesher->meetings.items));
	for (size_t i = 0; i < mesher->order.count; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->order.items[i] & 0xfffffff];
		uint32_t label = (uint32_t)(mesher->order.items[i] >> 38);
		for (int k = 0; k < 3; k++) {
			uint32_t point = triangle->corner[k];
			struct meeting_point *meeting = &mesher->meetings.items[point];
			if (mesher->stamp.items[point] == label)
				continue;
			mesher->stamp.items[point] = label;
			double disparity = disparity_at(source, label, mesher->cdt.points.items[point]);
			meeting->sum += disparity;
			meeting->low = meeting->surfaces ? fmin(meeting->low, disparity) : disparity;
			meeting->high = meeting->surfaces ? fmax(meeting->high, disparity) : disparity;
			meeting->surfaces++;
		}
	}
	memset(mesher->stamp.items, 0xff, count * sizeof(uint32_t));
}

/* The mean of the surfaces that meet at a point. Where they do not agree, as where their outlines were grown beyond
 * what joins them, each keeps to its own plane: a mean would pull the whole triangle off it. */
static double agreed_at(
	const struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t label, uint32_t point)
{
	const struct meeting_point *meeting = &mesher->meetings.items[point];
	double mean = meeting->sum / meeting->surfaces, spread = meeting->high - meeting->low;
	struct cdt_point at = mesher->cdt.points.items[point];
	if (!(spread > 0) ||
		spread <= AGREE_SHARE * displacement_tolerance(source->displacement, (double)at.x / MESH_LATTICE,
									(double)at.y / MESH_LATTICE, mean, source->tau_px))
		return mean;
	return disparity_at(source, label, at);
}

static void add_texels(const struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t label,
	uint32_t sheet, struct impostor_mesh *mesh, struct mesh_patch *patch)
{
	patch->first_texel = (uint32_t)mesh->texels.count;
	const struct surfaces *surfaces = source->surfaces;
	const struct surface *surface = sheet_surface(source, label);
	for (uint32_t y = patch->min_y; y <= patch->max_y; y++) {
		for (uint32_t x = patch->min_x; x <= patch->max_x; x++) {
			uint32_t pixel = y * surfaces->width + x, own = surfaces->label[pixel];
			size_t at = (size_t)((int32_t)y - mesher->window.y) * mesher->window.width +
						(size_t)((int32_t)x - mesher->window.x);
			bool shown = mesher->window.seam.items[at] || (own && source->sheets->sheet_of.items[own - 1] == sheet);
			enum mesh_texel texel = MESH_SHOW;
			if (!shown)
				texel = source->open_below[pixel] ? MESH_FILL : sheet_texel(source, surface, x, y);
			/* What agrees, but is not the sheet's, is shown by others; a grid has no plane to go by. */
			if (!shown && (texel == MESH_SHOW || source->options.grid_px))
				texel = MESH_CUT;
			ARRAY_PUSH(&mesh->texels, (uint8_t)texel);
		}
	}
}

static struct mesh_vertex vertex_at(
	const struct sheet_source *source, const struct surface *surface, struct cdt_point at, float disparity)
{
	struct mesh_vertex vertex = { (float)at.x / MESH_LATTICE, (float)at.y / MESH_LATTICE, disparity,
		{ surface->normal_oct[0], surface->normal_oct[1] } };
	if (surface->kind == PKG_MATERIAL_FOLIAGE)
		foliage_light_at(source->foliage, surface->object, (double)vertex.x, (double)vertex.y, vertex.normal_oct);
	return vertex;
}

/* One patch from the ordered triangles [from, to). */
static void add_patch(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet,
	struct impostor_mesh *mesh, size_t from, size_t to)
{
	uint32_t label = (uint32_t)(mesher->order.items[from] >> 38);
	const struct surface *surface = sheet_surface(source, label);
	struct mesh_patch patch = {
		.first_vertex = (uint32_t)mesh->vertices.count,
		.first_index = (uint32_t)mesh->indices.count,
		.index_count = (uint32_t)(to - from) * 3,
		.normal_oct = { surface->normal_oct[0], surface->normal_oct[1] },
		.smooth = surface->kind == PKG_MATERIAL_FOLIAGE,
		.kind = surface->kind,
		.view = source->options.view,
	};
	struct cdt_point min = { INT32_MAX, INT32_MAX }, max = { 0, 0 };
	for (size_t i = from; i < to; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->order.items[i] & 0xfffffff];
		for (int k = 0; k < 3; k++) {
			uint32_t point = triangle->corner[k], *stamp = &mesher->stamp.items[point];
			struct cdt_point at = mesher->cdt.points.items[point];
			if (*stamp == UINT32_MAX || *stamp < patch.first_vertex) {
				*stamp = (uint32_t)mesh->vertices.count;
				float disparity = (float)agreed_at(mesher, source, label, point);
				ARRAY_PUSH(&mesh->vertices, vertex_at(source, surface, at, disparity));
				patch.disparity_max = fmaxf(patch.disparity_max, disparity);
				min = (struct cdt_point){ at.x < min.x ? at.x : min.x, at.y < min.y ? at.y : min.y };
				max = (struct cdt_point){ at.x > max.x ? at.x : max.x, at.y > max.y ? at.y : max.y };
			}
			ARRAY_PUSH(&mesh->indices, *stamp - patch.first_vertex);
		}
	}
	patch.vertex_count = (uint32_t)mesh->vertices.count - patch.first_vertex;
	patch.min_x = (uint16_t)(min.x / MESH_LATTICE);
	patch.min_y = (uint16_t)(min.y / MESH_LATTICE);
	patch.max_x = (uint16_t)((max.x - 1) / MESH_LATTICE);
	patch.max_y = (uint16_t)((max.y - 1) / MESH_LATTICE);
	add_texels(mesher, source, label, sheet, mesh, &patch);
	ARRAY_PUSH(&mesh->patches, patch);
}

void sheet_add_patches(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh)
{
	order_triangles(mesher, source);
	ARRAY_SORT(&mesher->order, by_value);
	ask_surfaces(mesher, source);
	for (size_t from = 0, to; from < mesher->order.count; from = to) {
		for (to = from; to < mesher->order.count; to++)
			if (mesher->order.items[to] >> 28 != mesher->order.items[from] >> 28)
				break;
		add_patch(mesher, source, sheet, mesh, from, to);
	}
}
