/*
 * Patches into pieces that fit a page. A patch gets the texels that the nearest eye of the view cell needs and no more
 * than its capture has. What is longer than a page is cut in halves: along a straight line in the capture disparity is
 * linear, so a cut moves nothing.
 */
#include "tools/impostor/atlas_layout.h"
#include "tools/impostor/parallax.h"

#define TEXELS_MAX (PKG_PAGE_PX - 2 * ATLAS_GUTTER - 2) /* of a piece: it starts anywhere in its first pixel */
/* Scales are sixteenths, so that vertices on the mesh's lattice have exact coordinates in the package. */
#define SCALE_STEPS 16
#define SCALE_STEPS_MIN 2

typedef ARRAY(struct mesh_vertex) corner_list;

static double quantized(double scale)
{
	double steps = ceil(scale * SCALE_STEPS - 1e-6);
	return fmin(fmax(steps, SCALE_STEPS_MIN), SCALE_STEPS) / SCALE_STEPS;
}

static void measure(struct atlas_piece *piece, const struct mesh_vertex *corners)
{
	piece->min_x = piece->min_y = INFINITY;
	piece->max_x = piece->max_y = -INFINITY;
	piece->area = 0;
	for (uint32_t i = 0; i < piece->corner_count; i++) {
		piece->min_x = fminf(piece->min_x, corners[i].x);
		piece->min_y = fminf(piece->min_y, corners[i].y);
		piece->max_x = fmaxf(piece->max_x, corners[i].x);
		piece->max_y = fmaxf(piece->max_y, corners[i].y);
	}
	for (uint32_t i = 0; i + 2 < piece->corner_count; i += 3) {
		const struct mesh_vertex *c = corners + i;
		piece->area += 0.5 * fabs((double)(c[1].x - c[0].x) * (double)(c[2].y - c[0].y) -
								  (double)(c[2].x - c[0].x) * (double)(c[1].y - c[0].y));
	}
}

static float along(const struct mesh_vertex *vertex, bool vertical)
{
	return vertical ? vertex->y : vertex->x;
}

/* Where an edge crosses the line; the same for both triangles at the edge. */
static struct mesh_vertex crossing(struct mesh_vertex a, struct mesh_vertex b, bool vertical, float at)
{
	if (along(&a, vertical) > along(&b, vertical)) {
		struct mesh_vertex swapped = a;
		a = b;
		b = swapped;
	}
	float share = (at - along(&a, vertical)) / (along(&b, vertical) - along(&a, vertical));
	struct mesh_vertex cut = { a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
		a.disparity + share * (b.disparity - a.disparity), { 0, 0 } };
	memcpy(cut.normal_oct, share < 0.5f ? a.normal_oct : b.normal_oct, sizeof(cut.normal_oct));
	*(vertical ? &cut.y : &cut.x) = at;
	return cut;
}

/* The part of a triangle on one side of the line, as a fan. */
static void clip(const struct mesh_vertex corners[3], bool vertical, float at, bool above, corner_list *out)
{
	struct mesh_vertex polygon[4];
	int count = 0;
	for (int i = 0; i < 3; i++) {
		const struct mesh_vertex *from = &corners[i], *to = &corners[(i + 1) % 3];
		float a = along(from, vertical), b = along(to, vertical);
		if (above ? a >= at : a <= at)
			polygon[count++] = *from;
		if ((a < at && b > at) || (a > at && b < at))
			polygon[count++] = crossing(*from, *to, vertical, at);
	}
	for (int i = 2; i < count; i++) {
		ARRAY_PUSH(out, polygon[0]);
		ARRAY_PUSH(out, polygon[i - 1]);
		ARRAY_PUSH(out, polygon[i]);
	}
}

static void add_piece(
	struct atlas_layout *layout, const struct atlas_piece *like, const struct mesh_vertex *corners, size_t corner_count)
{
	struct atlas_piece piece = *like;
	piece.first_corner = (uint32_t)layout->corners.count;
	piece.corner_count = (uint32_t)corner_count;
	measure(&piece, corners);
	double width = (piece.max_x - piece.min_x) * piece.scale, height = (piece.max_y - piece.min_y) * piece.scale;
	if (!(piece.area > 0))
		return;
	if (width <= TEXELS_MAX && height <= TEXELS_MAX) {
		for (size_t i = 0; i < corner_count; i++)
			ARRAY_PUSH(&layout->corners, corners[i]);
		ARRAY_PUSH(&layout->pieces, piece);
		return;
	}
	bool vertical = height > width;
	float at = roundf(vertical ? (piece.min_y + piece.max_y) / 2 : (piece.min_x + piece.max_x) / 2);
	for (int side = 0; side < 2; side++) {
		corner_list part = { 0 };
		for (size_t i = 0; i < corner_count; i += 3)
			clip(corners + i, vertical, at, side, &part);
		if (part.count)
			add_piece(layout, like, part.items, part.count);
		ARRAY_FINISH(&part);
	}
}

void atlas_rows(const struct mesh_vertex corners[3], int32_t rows[2])
{
	float low = fminf(corners[0].y, fminf(corners[1].y, corners[2].y));
	float high = fmaxf(corners[0].y, fmaxf(corners[1].y, corners[2].y));
	rows[0] = (int32_t)ceilf(low - 0.5f);
	rows[1] = (int32_t)ceilf(high - 0.5f) - 1;
}

void atlas_columns(const struct mesh_vertex corners[3], int32_t y, int32_t columns[2])
{
	double at = y + 0.5, low = INFINITY, high = -INFINITY;
	for (int i = 0; i < 3; i++) {
		const struct mesh_vertex *a = &corners[i], *b = &corners[(i + 1) % 3];
		if ((a->y <= at) == (b->y <= at))
			continue;
		double x = a->x + (at - a->y) * ((double)b->x - a->x) / ((double)b->y - a->y);
		low = fmin(low, x);
		high = fmax(high, x);
	}
	columns[0] = low <= high ? (int32_t)ceil(low - 0.5) : 0;
	columns[1] = low <= high ? (int32_t)ceil(high - 0.5) - 1 : -1;
}

void atlas_pieces_make(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, const struct impostor_options *options, double factor)
{
	corner_list corners = { 0 };
	for (uint32_t i = 0; i < mesh->patches.count; i++) {
		const struct mesh_patch *patch = &mesh->patches.items[i];
		const struct capture_view *view = &captures[patch->view].image.view;
		struct parallax parallax = parallax_of(cell, view);
		double asked = options->texels_per_px * options->focal_px / view->focal_px *
					   parallax_magnification(&parallax, patch->disparity_max);
		corners.count = 0;
		for (uint32_t k = 0; k < patch->index_count; k++)
			ARRAY_PUSH(
				&corners, mesh->vertices.items[patch->first_vertex + mesh->indices.items[patch->first_index + k]]);
		add_piece(layout, &(struct atlas_piece){ .patch = i, .scale = quantized(asked * factor) }, corners.items,
			corners.count);
	}
	ARRAY_FINISH(&corners);
}
