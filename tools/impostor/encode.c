/* An impostor's bytes in the package. Blocks that show nothing are all the same, so that they pack to nothing. */
#include <string.h>

#include "tools/impostor/impostor.h"
#include "tools/impostor/page_blocks.h"

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

void impostor_encode(const struct impostor *impostor, byte_array *out)
{
	static const uint8_t zeros[16];
	size_t start = out->count;
	struct pkg_impostor_head head = { .vertex_count = (uint32_t)impostor->vertices.count,
		.index_count = (uint32_t)impostor->indices.count,
		.page_count = impostor->page_count,
		.view_count = (uint32_t)impostor->views.count };
	put(out, &head, sizeof(head));
	put(out, impostor->views.items, impostor->views.count * sizeof(*impostor->views.items));
	put(out, impostor->vertices.items, impostor->vertices.count * sizeof(*impostor->vertices.items));
	put(out, impostor->indices.items, impostor->indices.count * sizeof(*impostor->indices.items));
	put(out, zeros, -(out->count - start) % 16);
	for (uint32_t i = 0; i < impostor->page_count; i++)
		encode_page(impostor->pages + (size_t)i * PKG_PAGE_PX * PKG_PAGE_PX * 4, out);
}

void impostor_encode_truth(const struct impostor *impostor, byte_array *out)
{
	if (impostor->truth)
		put(out, impostor->truth, (size_t)impostor->page_count * PKG_PAGE_PX * PKG_PAGE_PX * sizeof(*impostor->truth));
}
