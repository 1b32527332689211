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

/* "section X, element i: what" for a broken value; returns from the function that it stands in. */
#define PKG_CHECK(condition, element, section, index, what)                                                            \
	do {                                                                                                               \
		if (!(condition))                                                                                              \
			return pkg_fail(                                                                                           \
				fault, pkg_offset_of(pkg, (element)), "section %s, element %u: %s", section, (unsigned)(index), what); \
	} while (0)

static inline bool pkg_run_fits(uint64_t first, uint64_t count, uint64_t limit)
{
	return first <= limit && count <= limit - first;
}

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

/* The far field's sections: all or none, and as many elements as the graph has edges and stretches. */
int pkg_check_far_counts(const struct pkg *pkg, uint64_t index_count, uint64_t cell_count, struct pkg_fault *fault);
/* Every value of its arrays; the blobs are checked one by one when they are used. */
int pkg_check_far(const struct pkg *pkg, struct pkg_fault *fault);
/* Bytes from here to there in the file are zero. */
int pkg_verify_padding(const struct pkg *pkg, uint64_t from, uint64_t to, struct pkg_fault *fault);
/* Blobs in order, nothing but zeros between them, all checksums right. */
int pkg_verify_far(const struct pkg *pkg, struct pkg_fault *fault);

/* Every index, offset, count and string reference of every array. */
int pkg_check_values(const struct pkg *pkg, struct pkg_fault *fault);

#endif
