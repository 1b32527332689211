#include "platform/can/log_stream.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ZLIB_MEMORY (64 * 1024) /* state and a 32 KiB window; zlib 1.2.13 takes 40 KiB */

static voidpf take_memory(voidpf arena, uInt count, uInt size)
{
	return arena_alloc(arena, (size_t)count * size, _Alignof(max_align_t));
}

/* zlib frees at the end only; the arena goes with the stream. */
static void give_memory(voidpf arena, voidpf at)
{
	(void)arena;
	(void)at;
}

static void fill(struct log_stream *stream)
{
	if (stream->input_at < stream->input_end || stream->file_ended)
		return;
	ssize_t n;
	do
		n = read(stream->fd, stream->input, LOG_STREAM_INPUT);
	while (n < 0 && errno == EINTR);
	if (n < 0)
		stream->error = -errno;
	stream->file_ended = n <= 0;
	stream->input_at = 0;
	stream->input_end = n > 0 ? (size_t)n : 0;
}

static int start(struct log_stream *stream, struct arena *arena)
{
	struct stat info;
	if (fstat(stream->fd, &info) < 0)
		return -errno;
	if (S_ISDIR(info.st_mode))
		return -EISDIR;
	stream->input = arena_alloc(arena, LOG_STREAM_INPUT, 64);
	if (!stream->input)
		return -ENOMEM;
	fill(stream);
	if (stream->error)
		return stream->error;
	stream->compressed = stream->input_end >= 2 && stream->input[0] == 0x1F && stream->input[1] == 0x8B;
	if (!stream->compressed)
		return 0;
	if (arena_carve(arena, &stream->memory, "inflate", ZLIB_MEMORY))
		return -ENOMEM;
	stream->zlib.zalloc = take_memory;
	stream->zlib.zfree = give_memory;
	stream->zlib.opaque = &stream->memory;
	return inflateInit2(&stream->zlib, 15 + 16) == Z_OK ? 0 : -ENOMEM;
}

int log_stream_open(struct log_stream *stream, const char *path, struct arena *arena)
{
	*stream = (struct log_stream){ .fd = open(path, O_RDONLY | O_CLOEXEC) };
	if (stream->fd < 0)
		return -errno;
	int status = start(stream, arena);
	if (status)
		log_stream_close(stream);
	return status;
}

static size_t read_plain(struct log_stream *stream, uint8_t *to, size_t size)
{
	size_t n = stream->input_end - stream->input_at;
	if (n > size)
		n = size;
	memcpy(to, stream->input + stream->input_at, n);
	stream->input_at += n;
	return n;
}

/* One step of inflate over what is buffered. Returns false when nothing more can come. */
static bool inflate_step(struct log_stream *stream)
{
	z_stream *zlib = &stream->zlib;
	zlib->next_in = stream->input + stream->input_at;
	zlib->avail_in = (uInt)(stream->input_end - stream->input_at);
	int status = inflate(zlib, Z_NO_FLUSH);
	stream->input_at = stream->input_end - zlib->avail_in;
	if (status == Z_STREAM_END) {
		fill(stream); /* logs are joined by `cat a.gz b.gz` */
		if (stream->input_at == stream->input_end)
			return false;
		return inflateReset(zlib) == Z_OK;
	}
	if (status == Z_OK || (status == Z_BUF_ERROR && !stream->file_ended))
		return true;
	stream->cut = true;
	return false;
}

static size_t read_compressed(struct log_stream *stream, uint8_t *to, size_t size)
{
	stream->zlib.next_out = to;
	stream->zlib.avail_out = (uInt)size;
	do {
		fill(stream);
		if (inflate_step(stream))
			continue;
		stream->compressed = false; /* what is left of the file is not read */
		stream->file_ended = true;
		stream->input_at = stream->input_end;
		break;
	} while (stream->zlib.avail_out == size);
	return size - stream->zlib.avail_out;
}

size_t log_stream_read(struct log_stream *stream, uint8_t *to, size_t size)
{
	if (stream->compressed)
		return read_compressed(stream, to, size);
	fill(stream);
	return read_plain(stream, to, size);
}

void log_stream_close(struct log_stream *stream)
{
	if (stream->memory.base)
		inflateEnd(&stream->zlib);
	if (stream->fd >= 0)
		close(stream->fd);
	stream->fd = -1;
	stream->memory = (struct arena){ 0 };
}
