/*
 * A package file from its sections: lays them out, checksums them and writes them to PATH.part, which is synced and
 * renamed, so that the final name never holds half a file and a full disk leaves what was there. Same sections, same
 * bytes.
 */
#ifndef BLVD_TOOLS_BAKE_PKG_FILE_H
#define BLVD_TOOLS_BAKE_PKG_FILE_H

#include <stdint.h>
#include <stdio.h>

#include "assets/pkg_format.h"

#define PKG_FILE_SECTIONS_MAX 48

struct pkg_file_section {
	uint32_t tag, element_bytes;
	const void *head; /* written before `bytes`; may be NULL with head_bytes 0 */
	size_t head_bytes;
	const void *bytes;
	uint64_t size;
	/* For what is too large to hold: writes exactly `size` bytes instead of `bytes` being written. The section has no
	 * checksum of its own then. Returns 0 or -errno. */
	int (*emit)(void *context, FILE *file);
	void *context;
};

/* Returns 0 or -errno, with PATH as it was. Logs nothing. */
int pkg_file_write(const char *path, const struct pkg_file_section *sections, uint32_t count);

#endif
