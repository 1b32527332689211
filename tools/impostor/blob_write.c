#include "tools/impostor/blob_write.h"

#include <errno.h>
#include <lzma.h>
#include <string.h>

#include "assets/pkg_check.h"

/* 9 takes twice the time of 6 for less than 1 %. */
static const uint32_t presets[] = { [BLOB_SMALL] = 6, [BLOB_QUICK] = 0 };

/* Blocks of 16 bytes and vertices of 20: what a byte is depends on its place among 16 more than on its neighbours. */
static const uint32_t place_bits = 4;

int blob_append(byte_array *out, const byte_array *raw, enum blob_effort effort, struct pkg_blob *blob)
{
	lzma_options_lzma options;
	lzma_filter filters[] = { { LZMA_FILTER_LZMA2, &options }, { LZMA_VLI_UNKNOWN, NULL } };
	if (lzma_lzma_preset(&options, presets[effort]))
		return -ENOMEM;
	options.dict_size = PKG_BLOB_WINDOW;
	options.lc = 0;
	options.lp = options.pb = place_bits;
	size_t at = (out->count + PKG_BLOB_ALIGN - 1) / PKG_BLOB_ALIGN * PKG_BLOB_ALIGN, end = at;
	size_t room = at + raw->count + raw->count / 8 + 64; /* what cannot be packed is stored, in chunks */
	ARRAY_RESERVE(out, room);
	memset(out->items + out->count, 0, at - out->count);
	if (lzma_raw_buffer_encode(filters, NULL, raw->items, raw->count, out->items, &end, room) != LZMA_OK)
		return -ENOMEM;
	*blob = (struct pkg_blob){ .offset = at,
		.stored_bytes = (uint32_t)(end - at),
		.raw_bytes = (uint32_t)raw->count,
		.crc32 = pkg_crc32(0, out->items + at, end - at) };
	out->count = end;
	return 0;
}
