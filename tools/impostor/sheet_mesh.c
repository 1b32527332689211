/* One sheet from its window to patches; cost follows the sheet's bounding box. */
#include "tools/impostor/sheet_mesh.h"

#include <math.h>
#include <string.h>

#include "tools/impostor/triangle_rows.h"

static void start_triangulation(struct sheet_mesher *mesher)
{
	struct cdt_point min = { (mesher->window.x - 1) * MESH_LATTICE, (mesher->window.y - 1) * MESH_LATTICE };
	struct cdt_point max = { (mesher->window.x + (int32_t)mesher->window.width + 1) * MESH_LATTICE,
		(mesher->window.y + (int32_t)mesher->window.height + 1) * MESH_LATTICE };
	cdt_finish(&mesher->cdt);
	cdt_init(&mesher->cdt, min, max);
}

struct triangle_corners sheet_corners(const struct cdt *cdt, uint32_t triangle)
{
	struct triangle_corners corners;
	for (int i = 0; i < 3; i++) {
		struct cdt_point point = cdt->points.items[cdt->triangles.items[triangle].corner[i]];
		corners.x[i] = (double)point.x / MESH_LATTICE;
		corners.y[i] = (double)point.y / MESH_LATTICE;
	}
	return corners;
}

/* Triangles on the same side of all segments, from one of them. Returns whether they reach the rectangle's corners:
 * then they are outside. */
static bool gather_face(struct sheet_mesher *mesher, uint32_t start, uint32_t face)
{
	bool outside = false;
	mesher->members.count = 0;
	mesher->face.items[start] = face;
	ARRAY_PUSH(&mesher->members, start);
	for (size_t i = 0; i < mesher->members.count; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->members.items[i]];
		for (int side = 0; side < 3; side++) {
			outside |= triangle->corner[side] < 4;
			uint32_t neighbour = triangle->neighbour[side];
			if (triangle->fixed[side] || neighbour == CDT_NONE || mesher->face.items[neighbour] != UINT32_MAX)
				continue;
			mesher->face.items[neighbour] = face;
			ARRAY_PUSH(&mesher->members, neighbour);
		}
	}
	return outside;
}

/* The label of most pixel centres of the gathered face, if any has one: outlines only grow, so a face with a labelled
 * pixel is inside. Of its first triangle's middle if there are no pixel centres at all. */
static uint32_t vote(struct sheet_mesher *mesher)
{
	uint32_t best = 0, best_votes = 0, pixels = 0;
	int32_t right = mesher->window.x + (int32_t)mesher->window.width,
			bottom = mesher->window.y + (int32_t)mesher->window.height;
	for (int pass = 0; pass < 2; pass++) { /* the second takes the votes back */
		for (size_t i = 0; i < mesher->members.count; i++) {
			struct triangle_corners corners = sheet_corners(&mesher->cdt, mesher->members.items[i]);
			struct pixel_run rows = triangle_rows(corners.y, bottom);
			for (int32_t y = rows.from; y < rows.to; y++) {
				struct pixel_run run = triangle_run(corners.x, corners.y, y, right);
				for (int32_t x = run.from; x < run.to; x++) {
					uint32_t label = sheet_window_label(&mesher->window, x, y);
					uint32_t *votes = &mesher->votes.items[label];
					*votes = pass || !label ? 0 : *votes + 1;
					pixels++;
					if (*votes > best_votes) {
						best = label;
						best_votes = *votes;
					}
				}
			}
		}
	}
	if (pixels)
		return best;
	struct triangle_corners corners = sheet_corners(&mesher->cdt, mesher->members.items[0]);
	return sheet_window_label(&mesher->window, (int64_t)floor((corners.x[0] + corners.x[1] + corners.x[2]) / 3),
		(int64_t)floor((corners.y[0] + corners.y[1] + corners.y[2]) / 3));
}

static void label_faces(struct sheet_mesher *mesher, size_t surfaces)
{
	size_t count = mesher->cdt.triangles.count;
	ARRAY_RESERVE(&mesher->face, count);
	if (mesher->votes.capacity < surfaces + 1) {
		ARRAY_RESERVE(&mesher->votes, surfaces + 1);
		memset(mesher->votes.items, 0, mesher->votes.capacity * sizeof(uint32_t));
	}
	memset(mesher->face.items, 0xff, count * sizeof(uint32_t));
	for (uint32_t i = 0; i < count; i++) {
		if (mesher->face.items[i] != UINT32_MAX)
			continue;
		uint32_t label = gather_face(mesher, i, 0) ? 0 : vote(mesher);
		for (size_t k = 0; k < mesher->members.count; k++)
			mesher->face.items[mesher->members.items[k]] = label;
	}
}

void sheet_mesh(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh)
{
	sheet_window_open(&mesher->window, source, sheet);
	start_triangulation(mesher);
	sheet_add_segments(mesher, source, sheet);
	mesher->cuts += mesher->cdt.cuts;
	label_faces(mesher, source->surfaces->items.count);
	sheet_add_patches(mesher, source, sheet, mesh);
}

void sheet_mesher_finish(struct sheet_mesher *mesher)
{
	sheet_window_finish(&mesher->window);
	contours_finish(&mesher->contours);
	simplifier_finish(&mesher->simplifier);
	ARRAY_FINISH(&mesher->inner);
	hull_finish(&mesher->hull);
	cdt_finish(&mesher->cdt);
	ARRAY_FINISH(&mesher->face);
	ARRAY_FINISH(&mesher->members);
	ARRAY_FINISH(&mesher->votes);
	ARRAY_FINISH(&mesher->stamp);
	ARRAY_FINISH(&mesher->meetings);
	ARRAY_FINISH(&mesher->order);
}
