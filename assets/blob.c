#include "assets/blob.h"

#include <errno.h>
#include <lzma.h>

#include "assets/pkg_check.h"

struct blob_reader {
	lzma_stream stream;
	lzma_allocator allocator;
	lzma_options_lzma options;
	lzma_filter filters[2];
	struct arena arena; /* what the decoder asks for once, at init */
};

static void *give_memory(void *opaque, size_t items, size_t size)
{
	struct arena *arena = opaque;
	return arena_alloc(arena, items * size, 64);
}

static void keep_memory(void *opaque, void *address)
{
	(void)opaque;
	(void)address;
}

/* A decoder of the same window takes over its predecessor's memory: only the first one asks for any. */
static bool restart(struct blob_reader *reader)
{
	return lzma_raw_decoder(&reader->stream, reader->filters) == LZMA_OK;
}

int blob_reader_init(struct blob_reader **out, struct arena *arena)
{
	struct blob_reader *reader = ARENA_ARRAY(arena, struct blob_reader, 1);
	if (!reader || arena_carve(arena, &reader->arena, "blob reader", BLOB_READER_BYTES - sizeof(*reader) - 256) < 0)
		return -ENOMEM;
	*reader = (struct blob_reader){ .stream = LZMA_STREAM_INIT, .arena = reader->arena };
	reader->allocator = (lzma_allocator){ give_memory, keep_memory, &reader->arena };
	reader->stream.allocator = &reader->allocator;
	reader->options.dict_size = PKG_BLOB_WINDOW;
	reader->filters[0] = (lzma_filter){ LZMA_FILTER_LZMA2, &reader->options };
	reader->filters[1] = (lzma_filter){ LZMA_VLI_UNKNOWN, NULL };
	if (!restart(reader))
		return -ENOMEM;
	*out = reader;
	return 0;
}

int blob_read(struct blob_reader *reader, const struct pkg *pkg, const struct pkg_blob *blob, void *out)
{
	const uint8_t *stored = pkg->blobs + blob->offset;
	if (pkg_crc32(0, stored, blob->stored_bytes) != blob->crc32 || !restart(reader))
		return -EBADMSG;
	lzma_stream *stream = &reader->stream;
	stream->next_in = stored;
	stream->avail_in = blob->stored_bytes;
	stream->next_out = out;
	stream->avail_out = blob->raw_bytes;
	lzma_ret end = lzma_code(stream, LZMA_FINISH);
	file_map_let_go(&pkg->map, stored, blob->stored_bytes); /* or a long drive would hold all that it passed */
	return end == LZMA_STREAM_END && !stream->avail_out && !stream->avail_in ? 0 : -EBADMSG;
}
