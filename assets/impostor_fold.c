/* Rows of 16 bytes, as wide as the blocks of the pages that follow: the packer looks at places modulo 16. */
#include "assets/impostor_fold.h"

#include <stddef.h>
#include <string.h>

#define UV_STEP 8 /* a sixteenth of a texel */
#define TAIL 4    /* bytes of a vertex behind its row */

struct fold_row {
	uint32_t pos[3];
	uint16_t uv[2];
};
static_assert(sizeof(struct fold_row) == 16 && sizeof(struct fold_row) + TAIL == sizeof(struct pkg_impostor_vertex),
	"rows and tails are as long as the vertices");

/* Small differences of either sign to small numbers: 0, -1, 1, -2 ... to 0, 1, 2, 3 ... */
static uint32_t zigzag(uint32_t difference)
{
	return difference << 1 ^ (difference >> 31 ? UINT32_MAX : 0);
}

static uint32_t unzigzag(uint32_t folded)
{
	return folded >> 1 ^ (folded & 1 ? UINT32_MAX : 0);
}

static uint16_t zigzag_16(uint16_t difference)
{
	return (uint16_t)(difference << 1 ^ (difference >> 15 ? UINT16_MAX : 0));
}

static uint16_t unzigzag_16(uint16_t folded)
{
	return (uint16_t)(folded >> 1 ^ (folded & 1 ? UINT16_MAX : 0));
}

static void fold_vertices(uint32_t count, unsigned step_log2, uint8_t *bytes, uint8_t *tails)
{
	struct fold_row last = { 0 };
	for (uint32_t i = 0; i < count; i++) {
		struct pkg_impostor_vertex vertex;
		struct fold_row now, row;
		memcpy(&vertex, bytes + i * sizeof(vertex), sizeof(vertex));
		for (int k = 0; k < 3; k++) {
			int64_t half = (INT64_C(1) << step_log2) / 2;
			now.pos[k] = (uint32_t)(((int64_t)vertex.pos_mm[k] + half) >> step_log2);
			row.pos[k] = zigzag(now.pos[k] - last.pos[k]);
		}
		for (int k = 0; k < 2; k++) {
			now.uv[k] = (uint16_t)((vertex.uv[k] + UV_STEP / 2) / UV_STEP);
			row.uv[k] = zigzag_16((uint16_t)(now.uv[k] - last.uv[k]));
		}
		for (size_t k = 0; k < TAIL; k++)
			tails[k * count + i] = bytes[i * sizeof(vertex) + sizeof(row) + k];
		memcpy(bytes + i * sizeof(row), &row, sizeof(row));
		last = now;
	}
	memcpy(bytes + count * sizeof(struct fold_row), tails, (size_t)count * TAIL);
}

/* Sums first; then each row moves to its vertex's place, the last one first. */
static void unfold_vertices(uint32_t count, unsigned step_log2, uint8_t *bytes, uint8_t *tails)
{
	struct fold_row sum = { 0 };
	memcpy(tails, bytes + count * sizeof(struct fold_row), (size_t)count * TAIL);
	for (uint32_t i = 0; i < count; i++) {
		struct fold_row row;
		memcpy(&row, bytes + i * sizeof(row), sizeof(row));
		for (int k = 0; k < 3; k++)
			sum.pos[k] += unzigzag(row.pos[k]);
		for (int k = 0; k < 2; k++)
			sum.uv[k] = (uint16_t)(sum.uv[k] + unzigzag_16(row.uv[k]));
		memcpy(bytes + i * sizeof(row), &sum, sizeof(sum));
	}
	for (uint32_t i = count; i-- > 0;) {
		struct fold_row row;
		memcpy(&row, bytes + i * sizeof(row), sizeof(row));
		struct pkg_impostor_vertex vertex = { 0 };
		for (int k = 0; k < 3; k++)
			vertex.pos_mm[k] = (int32_t)(row.pos[k] << step_log2);
		for (int k = 0; k < 2; k++)
			vertex.uv[k] = (uint16_t)(row.uv[k] * UV_STEP);
		memcpy(bytes + i * sizeof(vertex), &vertex, sizeof(row));
		for (size_t k = 0; k < TAIL; k++)
			bytes[i * sizeof(vertex) + sizeof(row) + k] = tails[k * count + i];
	}
}

/* An index is mostly the first that no triangle had before, or one of the last ones. */
static void fold_indices(uint32_t count, uint8_t *bytes, uint8_t *columns)
{
	uint16_t next = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint16_t index;
		memcpy(&index, bytes + i * sizeof(index), sizeof(index));
		uint16_t back = zigzag_16((uint16_t)(next - index));
		columns[i] = (uint8_t)back;
		columns[count + i] = (uint8_t)(back >> 8);
		next = index >= next ? (uint16_t)(index + 1) : next;
	}
	memcpy(bytes, columns, (size_t)count * sizeof(uint16_t));
}

static void unfold_indices(uint32_t count, uint8_t *bytes, uint8_t *columns)
{
	uint16_t next = 0;
	memcpy(columns, bytes, (size_t)count * sizeof(uint16_t));
	for (uint32_t i = 0; i < count; i++) {
		uint16_t index = (uint16_t)(next - unzigzag_16((uint16_t)(columns[i] | columns[count + i] << 8)));
		memcpy(bytes + i * sizeof(index), &index, sizeof(index));
		next = index >= next ? (uint16_t)(index + 1) : next;
	}
}

void impostor_fold(const struct pkg_impostor_head *head, void *vertices, void *scratch)
{
	uint8_t *bytes = vertices;
	fold_vertices(head->vertex_count, head->step_log2, bytes, scratch);
	fold_indices(head->index_count, bytes + (size_t)head->vertex_count * sizeof(struct pkg_impostor_vertex), scratch);
}

void impostor_unfold(const struct pkg_impostor_head *head, void *vertices, void *scratch)
{
	uint8_t *bytes = vertices;
	unfold_vertices(head->vertex_count, head->step_log2, bytes, scratch);
	unfold_indices(head->index_count, bytes + (size_t)head->vertex_count * sizeof(struct pkg_impostor_vertex), scratch);
}
