/* Normals as the package has them: the octahedral map (Meyer et al. 2010, "On Floating-Point Normal Vectors"), 127 = 1.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_OCT_NORMAL_H
#define BLVD_TOOLS_IMPOSTOR_OCT_NORMAL_H

#include <math.h>
#include <stdint.h>

#include "platform/base/vec.h"

/* Not scaled to unit length. */
static inline struct dvec3 oct_normal(const int8_t oct[2])
{
	double x = oct[0] / 127.0, y = oct[1] / 127.0, z = 1 - fabs(x) - fabs(y);
	if (z < 0) {
		double folded = copysign(1 - fabs(y), x);
		y = copysign(1 - fabs(x), y);
		x = folded;
	}
	return (struct dvec3){ x, y, z };
}

static inline struct dvec3 oct_unit_normal(const int8_t oct[2])
{
	struct dvec3 n = oct_normal(oct);
	double scale = 1 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
	return (struct dvec3){ n.x * scale, n.y * scale, n.z * scale };
}

/* Of any length but 0. */
static inline void oct_encode(struct dvec3 normal, int8_t oct[2])
{
	double sum = fabs(normal.x) + fabs(normal.y) + fabs(normal.z);
	double x = normal.x / sum, y = normal.y / sum;
	if (normal.z < 0) {
		double folded = copysign(1 - fabs(y), x);
		y = copysign(1 - fabs(x), y);
		x = folded;
	}
	oct[0] = (int8_t)lround(127 * x);
	oct[1] = (int8_t)lround(127 * y);
}

#endif
