/*
 * A set of the package's triangles, by object: which of each object's triangles are in it. Bits are in the order of
 * PKG_STRC's sets: an object's opaque triangles first, then its decals. Also the on-disk form.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_TRIANGLE_SET_H
#define BLVD_TOOLS_IMPOSTOR_TRIANGLE_SET_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "tools/city/pool.h"

struct triangle_set_item {
	uint32_t object;     /* into OBJS */
	uint32_t first_word; /* of its bits, in `words` */
	uint32_t kept;       /* bits set; never 0 after triangle_set_tidy() */
};
struct triangle_set {
	ARRAY(struct triangle_set_item) items; /* sorted by object */
	ARRAY(uint64_t) words;
	uint32_t triangles; /* kept, of all objects */
};

/* Triangles of an object, all passes. */
static inline uint32_t triangle_set_object_size(const struct pkg_object *object)
{
	uint32_t sum = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		sum += object->index_count[pass] / 3;
	return sum;
}

void triangle_set_finish(struct triangle_set *set);
void triangle_set_clear(struct triangle_set *set);

/* Adds an object with no triangle kept and returns its words, to be filled in before the next call. Objects come in
 * ascending order. */
uint64_t *triangle_set_add(struct triangle_set *set, const struct pkg *pkg, uint32_t object);
/* Counts; drops objects of which nothing is kept. */
void triangle_set_tidy(struct triangle_set *set, const struct pkg *pkg);

/* out = a and b, a or b, a without b. `out` is neither. */
enum triangle_set_operation { TRIANGLE_SET_AND, TRIANGLE_SET_OR, TRIANGLE_SET_WITHOUT };
void triangle_set_combine(const struct triangle_set *a, const struct triangle_set *b, enum triangle_set_operation how,
	const struct pkg *pkg, struct triangle_set *out);

/* The three corners of an object's triangle (a bit's index) in the city frame, mm. */
void triangle_set_corners(const struct pkg *pkg, uint32_t object, uint32_t triangle, int64_t out[3][3]);

/* The raw bytes of a set's blob (struct pkg_set_head ...), appended to `out`; and back. Returns 0 or -EBADMSG. */
typedef ARRAY(uint8_t) byte_array;
void triangle_set_encode(const struct triangle_set *set, const struct pkg *pkg, byte_array *out);
int triangle_set_decode(const struct pkg *pkg, const uint8_t *bytes, size_t size, struct triangle_set *out);

#endif
