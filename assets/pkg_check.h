/*
 * The checks behind pkg_open(), pkg_chunk_check() and pkg_verify(): package bytes are hostile until these have passed.
 * Inside assets only. Each returns 0, or -EBADMSG with `fault` filled in.
 */
#ifndef BLVD_ASSETS_PKG_CHECK_H
#define BLVD_ASSETS_PKG_CHECK_H

#include "assets/pkg.h"

int pkg_fail(struct pkg_fault *fault, uint64_t offset, const char *format, ...) __attribute__((format(printf, 3, 4)));
uint32_t pkg_crc32(uint32_t crc, const void *bytes, uint64_t size);
void pkg_tag_text(uint32_t tag, char out[5]);
uint32_t pkg_sections(const struct pkg *pkg, const struct pkg_section **sections);

/* Byte in the file of something inside the mapping. */
static inline uint64_t pkg_offset_of(const struct pkg *pkg, const void *at)
{
	return (uint64_t)((const uint8_t *)at - pkg->map.bytes.data);
}

/* Blobs with a header of their own: check the sizes, then set the package's pointers. `at` may be NULL: absent. */
int pkg_check_heights(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault);
int pkg_check_textures(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault);
int pkg_check_light_map(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault);
int pkg_check_font(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault);

/* Every index, offset, count and string reference of every array. */
int pkg_check_values(const struct pkg *pkg, struct pkg_fault *fault);

#endif
