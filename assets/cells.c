/*
 * Cells: places to stretches, and what blobs hold to checked views.
 */
#include "assets/cells.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "assets/impostor_fold.h"
#include "assets/pkg_check.h"

uint32_t cells_stretch_at(const struct pkg *pkg, uint32_t edge, int64_t along_mm)
{
	if (!pkg->stretches || edge >= pkg->graph.edge_count)
		return PKG_NONE;
	uint32_t low = pkg->first_stretch[edge], high = pkg->first_stretch[edge + 1];
	if (low == high)
		return PKG_NONE;
	while (high - low > 1) {
		uint32_t middle = low + (high - low) / 2;
		if ((int64_t)pkg->stretches[middle].from_mm <= along_mm)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* How far the eye is outside the view cell's box: along the axis, across it, up. Millimetres, 0 inside. */
static void outside_mm(const struct pkg_stretch *stretch, const int64_t eye_mm[3], double out[3])
{
	double dx = (double)stretch->end_mm[0] - stretch->start_mm[0],
		   dy = (double)stretch->end_mm[1] - stretch->start_mm[1];
	double length = hypot(dx, dy);
	double ux = length > 0.0 ? dx / length : 0.0, uy = length > 0.0 ? dy / length : 1.0;
	double ex = (double)(eye_mm[0] - stretch->start_mm[0]), ey = (double)(eye_mm[1] - stretch->start_mm[1]);
	double along = ex * ux + ey * uy, across = fabs(ex * uy - ey * ux);
	double share = length > 0.0 ? fmin(fmax(along / length, 0.0), 1.0) : 0.0;
	double ground = stretch->start_mm[2] + share * ((double)stretch->end_mm[2] - stretch->start_mm[2]);
	double height = (double)eye_mm[2] - ground;
	out[0] = fmax(fmax(-along, along - length) - stretch->overrun_mm, 0.0);
	out[1] = fmax(across - stretch->half_width_mm, 0.0);
	out[2] = fmax(fmax(stretch->eye_min_mm - height, height - stretch->eye_max_mm), 0.0);
}

bool cells_holds_eye(const struct pkg_stretch *stretch, const int64_t eye_mm[3])
{
	double out[3];
	outside_mm(stretch, eye_mm, out);
	return out[0] <= 0.0 && out[1] <= 0.0 && out[2] <= 0.0;
}

double cells_distance_m(const struct pkg_stretch *stretch, const int64_t eye_mm[3])
{
	double out[3];
	outside_mm(stretch, eye_mm, out);
	return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) / 1000.0;
}

static uint32_t count_bits(const uint8_t *mask, uint32_t bytes)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < bytes; i++)
		sum += (uint32_t)__builtin_popcount(mask[i]);
	return sum;
}

/* The object's triangles, or 0 when its indices are no whole triangles. */
static uint32_t object_triangles(const struct pkg_object *object)
{
	uint32_t sum = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		if (object->index_count[pass] % 3)
			return 0;
		sum += object->index_count[pass] / 3;
	}
	return sum;
}

int set_view_open(struct set_view *set, const struct pkg *pkg, const void *raw, uint32_t raw_bytes)
{
	const struct pkg_set_head *head = raw;
	if (raw_bytes < sizeof(*head) || head->object_count > (raw_bytes - sizeof(*head)) / sizeof(struct pkg_set_object))
		return -EBADMSG;
	*set = (struct set_view){
		.objects = (const void *)(head + 1), .object_count = head->object_count, .triangle_count = head->triangle_count
	};
	set->masks = (const uint8_t *)(set->objects + head->object_count);
	const uint8_t *mask = set->masks;
	uint64_t left = raw_bytes - (uint64_t)(mask - (const uint8_t *)raw), kept = 0;
	for (uint32_t i = 0; i < set->object_count; i++) {
		const struct pkg_set_object *object = &set->objects[i];
		if (object->object >= pkg->object_count || (i && object->object <= object[-1].object))
			return -EBADMSG;
		uint32_t triangles = object_triangles(&pkg->objects[object->object]), bytes = (triangles + 7) / 8;
		kept += object->kept;
		if (!object->kept || object->kept > triangles)
			return -EBADMSG;
		if (object->kept == triangles)
			continue;
		if (bytes > left || count_bits(mask, bytes) != object->kept ||
			(triangles % 8 && mask[bytes - 1] >> (triangles % 8)))
			return -EBADMSG;
		mask += bytes;
		left -= bytes;
	}
	return !left && kept == head->triangle_count ? 0 : -EBADMSG;
}

static int check_vertices(const struct impostor_view *impostor)
{
	for (uint32_t i = 0; i < impostor->head.vertex_count; i++) {
		const struct pkg_impostor_vertex *vertex = &impostor->vertices[i];
		if (vertex->page >= impostor->head.page_count || vertex->view_kind % 32 >= impostor->head.view_count ||
			vertex->uv[0] > PKG_PAGE_PX * 128 || vertex->uv[1] > PKG_PAGE_PX * 128)
			return -EBADMSG;
	}
	for (uint32_t i = 0; i < impostor->head.index_count; i++)
		if (impostor->indices[i] >= impostor->head.vertex_count)
			return -EBADMSG;
	for (uint32_t i = 0; i < impostor->head.view_count; i++)
		for (int k = 0; k < 4; k++)
			if (!isfinite(impostor->views[i].axis[k]))
				return -EBADMSG;
	return 0;
}

int impostor_view_open(
	struct impostor_view *impostor, const struct pkg_cell *cell, void *raw, uint32_t raw_bytes, void *scratch)
{
	struct impostor_view view = { 0 };
	if (raw_bytes < sizeof(view.head))
		return -EBADMSG;
	memcpy(&view.head, raw, sizeof(view.head));
	if (view.head.vertex_count != cell->vertex_count || view.head.index_count != cell->index_count ||
		view.head.page_count != cell->page_count || view.head.view_count > PKG_IMPOSTOR_VIEWS_MAX ||
		view.head.step_log2 > PKG_IMPOSTOR_STEP_MAX)
		return -EBADMSG;
	uint8_t *bytes = raw;
	uint64_t at = sizeof(view.head);
	view.views = (const void *)(bytes + at);
	at += view.head.view_count * sizeof(*view.views);
	uint64_t vertices_at = at;
	at += view.head.vertex_count * sizeof(*view.vertices);
	uint64_t indices_at = at;
	at += view.head.index_count * sizeof(*view.indices);
	at = (at + 15) / 16 * 16;
	if (at + view.head.page_count * (uint64_t)PKG_PAGE_BYTES != raw_bytes)
		return -EBADMSG;
	impostor_unfold(&view.head, bytes + vertices_at, scratch);
	view.vertices = (const void *)(bytes + vertices_at);
	view.indices = (const void *)(bytes + indices_at);
	view.pages = bytes + at;
	int status = check_vertices(&view);
	if (!status)
		*impostor = view;
	return status;
}

static int verify_set(
	const struct pkg *pkg, struct blob_reader *reader, const struct pkg_blob *blob, void *buffer, uint32_t triangles)
{
	struct set_view set = { 0 };
	if (!blob->stored_bytes)
		return 0;
	int status = blob_read(reader, pkg, blob, buffer);
	if (!status)
		status = set_view_open(&set, pkg, buffer, blob->raw_bytes);
	return !status && set.triangle_count != triangles ? -EBADMSG : status;
}

static int verify_impostor(
	const struct pkg *pkg, struct blob_reader *reader, const struct pkg_cell *cell, void *buffer, void *scratch)
{
	struct impostor_view impostor;
	if (!cell->impostor.stored_bytes)
		return 0;
	int status = blob_read(reader, pkg, &cell->impostor, buffer);
	return status ? status : impostor_view_open(&impostor, cell, buffer, cell->impostor.raw_bytes, scratch);
}

static uint32_t largest_raw(const struct pkg *pkg)
{
	uint32_t most = 0;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const uint32_t raw[] = { pkg->stretches[i].local.raw_bytes, pkg->stretches[i].pvs.raw_bytes,
			pkg->cells[2 * i].impostor.raw_bytes, pkg->cells[2 * i + 1].impostor.raw_bytes };
		for (int k = 0; k < 4; k++)
			most = raw[k] > most ? raw[k] : most;
	}
	return most;
}

static uint64_t largest_fold(const struct pkg *pkg)
{
	uint64_t most = 0;
	for (uint32_t i = 0; i < 2 * pkg->stretch_count; i++) {
		uint64_t bytes = impostor_fold_bytes(pkg->cells[i].vertex_count, pkg->cells[i].index_count);
		most = bytes > most ? bytes : most;
	}
	return most;
}

uint64_t cells_verify_bytes(const struct pkg *pkg)
{
	return BLOB_READER_BYTES + largest_raw(pkg) + largest_fold(pkg) + 256;
}

int cells_verify(const struct pkg *pkg, struct arena *arena, struct pkg_fault *fault)
{
	struct blob_reader *reader;
	void *buffer = arena_alloc(arena, largest_raw(pkg) + 1, 16);
	void *scratch = arena_alloc(arena, largest_fold(pkg) + 1, 16);
	if (!buffer || !scratch || blob_reader_init(&reader, arena) < 0)
		return -ENOMEM;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		if (verify_set(pkg, reader, &stretch->local, buffer, stretch->local_triangles) < 0)
			return pkg_fail(
				fault, pkg_offset_of(pkg, stretch), "section STRC, element %u: its local set is damaged", i);
		if (verify_set(pkg, reader, &stretch->pvs, buffer, stretch->pvs_triangles) < 0)
			return pkg_fail(
				fault, pkg_offset_of(pkg, stretch), "section STRC, element %u: its visible set is damaged", i);
		for (uint32_t cell = 2 * i; cell < 2 * i + 2; cell++)
			if (verify_impostor(pkg, reader, &pkg->cells[cell], buffer, scratch) < 0)
				return pkg_fail(fault, pkg_offset_of(pkg, &pkg->cells[cell]),
					"section CELL, element %u: its impostor is damaged", cell);
	}
	return 0;
}
