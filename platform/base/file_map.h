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

/* These bytes have been read and will not be for a while: their pages no longer count as the process's own. They stay
 * valid, the next look only takes longer. Bytes outside the map are left alone. Any thread. */
void file_map_let_go(const struct file_map *map, const void *at, size_t bytes);

#endif
