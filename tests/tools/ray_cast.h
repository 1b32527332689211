/* What a ray meets first among all triangles of a package: slow, simple and exact, the truth that visible sets and
 * pictures are tested against. */
#ifndef BLVD_TESTS_TOOLS_RAY_CAST_H
#define BLVD_TESTS_TOOLS_RAY_CAST_H

#include "assets/pkg.h"
#include "platform/base/vec.h"
#include "tools/impostor/triangle_set.h"

struct ray_caster;
struct ray_hit {
	uint32_t object, triangle;
	double t; /* along the direction */
	bool front;
};

struct ray_caster *ray_caster_new(const struct pkg *pkg);
void ray_caster_free(struct ray_caster *caster);

/* Metres of the city frame; the direction need not be unit. `backs`: back faces stop the ray, too. */
bool ray_cast(const struct ray_caster *caster, struct dvec3 from, struct dvec3 direction, double t_max, bool backs,
	struct ray_hit *hit);

#endif
