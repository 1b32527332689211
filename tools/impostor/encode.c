/* An impostor's bytes in the package. Blocks that show nothing are all the same, so that they pack to nothing. */
#include <math.h>
#include <string.h>

#include "assets/impostor_fold.h"
#include "tools/impostor/impostor.h"
#include "tools/impostor/page_blocks.h"

#define ROUNDING_RAD 3.6e-5  /* a 32nd of a pixel: half of it either way */
#define VIEW_CELL_MM 70000.0 /* a stretch and its overrun: so much nearer the eye may come than the origin is */

void impostor_mesh_finish(struct impostor_mesh *mesh)
{
	ARRAY_FINISH(&mesh->vertices);
	ARRAY_FINISH(&mesh->indices);
	ARRAY_FINISH(&mesh->patches);
	ARRAY_FINISH(&mesh->texels);
	*mesh = (struct impostor_mesh){ 0 };
}

void impostor_finish(struct impostor *impostor)
{
	ARRAY_FINISH(&impostor->vertices);
	ARRAY_FINISH(&impostor->indices);
	ARRAY_FINISH(&impostor->views);
	array_free(impostor->pages);
	array_free(impostor->truth);
	*impostor = (struct impostor){ 0 };
}

static void put(byte_array *out, const void *bytes, size_t count)
{
	if (!count)
		return;
	ARRAY_RESERVE(out, out->count + count);
	memcpy(out->items + out->count, bytes, count);
	out->count += count;
}

static void encode_page(const uint8_t *page, byte_array *out)
{
	ARRAY_RESERVE(out, out->count + PKG_PAGE_BYTES);
	page_blocks(page, out->items + out->count);
	out->count += PKG_PAGE_BYTES;
}

/* A position may be rounded to so many powers of two mm that it cannot be seen, from anywhere in the view cell. */
static uint16_t position_step(const int32_t at[3])
{
	double distance_mm = sqrt((double)at[0] * at[0] + (double)at[1] * at[1] + (double)at[2] * at[2]);
	double step_mm = (distance_mm - VIEW_CELL_MM) * ROUNDING_RAD;
	return step_mm > 1 ? (uint16_t)fmin(floor(log2(step_mm)), PKG_IMPOSTOR_STEP_MAX) : 0;
}

static uint16_t least_step(const struct impostor *impostor)
{
	uint16_t least = impostor->vertices.count ? PKG_IMPOSTOR_STEP_MAX : 0;
	for (size_t i = 0; i < impostor->vertices.count; i++) {
		uint16_t step = position_step(impostor->vertices.items[i].pos_mm);
		least = step < least ? step : least;
	}
	return least;
}

/* Each by what its own distance allows: low bits that are 0 pack well. */
static void put_vertices(const struct impostor *impostor, byte_array *out)
{
	for (size_t i = 0; i < impostor->vertices.count; i++) {
		struct pkg_impostor_vertex vertex = impostor->vertices.items[i];
		uint16_t step = position_step(vertex.pos_mm);
		int64_t half = (INT64_C(1) << step) / 2;
		for (int k = 0; k < 3; k++)
			vertex.pos_mm[k] = (int32_t)((((int64_t)vertex.pos_mm[k] + half) >> step) * (INT64_C(1) << step));
		put(out, &vertex, sizeof(vertex));
	}
}

void impostor_encode(const struct impostor *impostor, byte_array *out)
{
	static const uint8_t zeros[16];
	size_t start = out->count;
	struct pkg_impostor_head head = { .vertex_count = (uint32_t)impostor->vertices.count,
		.index_count = (uint32_t)impostor->indices.count,
		.page_count = impostor->page_count,
		.view_count = (uint16_t)impostor->views.count,
		.step_log2 = least_step(impostor) };
	put(out, &head, sizeof(head));
	put(out, impostor->views.items, impostor->views.count * sizeof(*impostor->views.items));
	size_t vertices = out->count;
	put_vertices(impostor, out);
	put(out, impostor->indices.items, impostor->indices.count * sizeof(*impostor->indices.items));
	byte_array scratch = { 0 };
	ARRAY_RESERVE(&scratch, impostor_fold_bytes(head.vertex_count, head.index_count) + 1);
	impostor_fold(&head, out->items + vertices, scratch.items);
	ARRAY_FINISH(&scratch);
	put(out, zeros, -(out->count - start) % 16);
	for (uint32_t i = 0; i < impostor->page_count; i++)
		encode_page(impostor->pages + (size_t)i * PKG_PAGE_PX * PKG_PAGE_PX * 4, out);
}

void impostor_encode_truth(const struct impostor *impostor, byte_array *out)
{
	if (impostor->truth)
		put(out, impostor->truth, (size_t)impostor->page_count * PKG_PAGE_PX * PKG_PAGE_PX * sizeof(*impostor->truth));
}
