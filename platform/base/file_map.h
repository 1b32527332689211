/* A whole file, read only, in the address space. */
#ifndef BLVD_PLATFORM_BASE_FILE_MAP_H
#define BLVD_PLATFORM_BASE_FILE_MAP_H

#include "platform/base/span.h"

struct file_map {
	struct span bytes; /* valid until file_map_close; empty for an empty file */
};

/* Returns 0 or -errno (-EISDIR for a directory). Logs nothing: the caller knows what the file was for. */
int file_map_open(struct file_map *map, const char *path);
void file_map_close(struct file_map *map);

#endif
