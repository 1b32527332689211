/*
 * What is asked of a file system to keep something through a power cut, behind a table of functions, so that a test can
 * stand in for a disk that fills up, tears writes or loses what was not synced. Paths are whole. Everything returns
 * -errno on failure. None of it belongs into the frame loop: each call may wait for the medium.
 */
#ifndef BLVD_PLATFORM_BASE_FILE_OPS_H
#define BLVD_PLATFORM_BASE_FILE_OPS_H

#include <stddef.h>
#include <stdint.h>

/* All mandatory. `context` is the table's owner's. */
struct file_ops {
	/* A file of the name, empty, to write to; one that is there is cut to nothing. Returns a descriptor. */
	int (*create)(void *context, const char *path);
	/* May write less than asked. Returns how much. */
	int64_t (*write)(void *context, int fd, const void *bytes, size_t size);
	int (*sync)(void *context, int fd); /* content and length are on the medium */
	int (*close)(void *context, int fd);
	int (*rename)(void *context, const char *from, const char *to); /* replaces what is there, in one step */
	int (*remove)(void *context, const char *path);
	int (*sync_folder)(void *context, const char *path); /* names are on the medium */
	/* Up to `size` bytes from the start. Returns how many. */
	int64_t (*read)(void *context, const char *path, void *bytes, size_t size);
};

extern const struct file_ops file_ops_system; /* context NULL */

#endif
