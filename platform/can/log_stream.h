/* The bytes of a plain or gzip file in order, through buffers from an arena: no allocation after opening, none by zlib
 * either. Internal to platform/can. */
#ifndef BLVD_PLATFORM_CAN_LOG_STREAM_H
#define BLVD_PLATFORM_CAN_LOG_STREAM_H

#include <stdbool.h>
#include <zlib.h>

#include "platform/base/arena.h"

#define LOG_STREAM_INPUT (1 << 16)

struct log_stream {
	int fd;
	bool compressed;
	bool file_ended;
	bool cut;            /* the file ended inside a gzip member, or zlib refused it */
	int error;           /* -errno of a read; the stream then ends */
	struct arena memory; /* zlib's */
	z_stream zlib;
	uint8_t *input;
	size_t input_at, input_end; /* not consumed yet */
};

/* Returns 0 or -errno (-EISDIR for a directory). */
int log_stream_open(struct log_stream *stream, const char *path, struct arena *arena);

/* Up to `size` bytes; 0 only at the end. */
size_t log_stream_read(struct log_stream *stream, uint8_t *to, size_t size);

void log_stream_close(struct log_stream *stream);

#endif
