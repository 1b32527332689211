/*
 * A made-up package with a far field: one straight street along x, cut into edges and stretches; a chunk of objects
 * beside each stretch. Stretch s keeps all of chunk s's triangles, every second one of chunk s + 1's, and sees every
 * third one of chunks s + 2 to s + 4. On the heap; for tests.
 */
#ifndef BLVD_TESTS_ASSETS_FAR_CITY_H
#define BLVD_TESTS_ASSETS_FAR_CITY_H

#include "assets/pkg.h"

#define FAR_CITY_STRETCH_MM 50000

struct far_city_config {
	uint32_t edges, stretches_an_edge;
	uint32_t objects_a_chunk, triangles_an_object; /* opaque; each object has one decal more */
	uint32_t impostor_vertices, impostor_pages;
	uint32_t geometry_every; /* every nth stretch's cells are drawn from its visible set; 0 none */
};

/* A part of the file, for damaging it. */
struct far_city_part {
	size_t offset, size;
};

/* The whole file's bytes; the caller frees them. */
uint8_t *far_city_build(const struct far_city_config *config, size_t *size);
/* Where a section lies. */
struct far_city_part far_city_section(const uint8_t *bytes, uint32_t tag);
/* Makes the checksums of the tables right again after a change, so that only the values are wrong. */
void far_city_sign(uint8_t *bytes);
/* Opens the bytes by way of a file that is gone afterwards. Returns what pkg_open() does. */
int far_city_open(const uint8_t *bytes, size_t size, struct pkg *pkg, struct pkg_fault *fault);

#endif
