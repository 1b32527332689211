/* Buildings that come as surfaces (CityJSON LoD2): what looks up is roof, what stands is wall, what looks down stays.
 */
#include "tools/bake/buildings.h"

#include <math.h>

struct tilt {
	struct dvec3 normal;
	struct dvec2 along; /* horizontal, along the surface */
};

static bool tilt_of(const struct dvec3 *p, struct tilt *out)
{
	struct dvec3 a = { p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z };
	struct dvec3 b = { p[2].x - p[0].x, p[2].y - p[0].y, p[2].z - p[0].z };
	struct dvec3 n = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
	double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
	if (!(length > 1e-6))
		return false;
	out->normal = (struct dvec3){ n.x / length, n.y / length, n.z / length };
	double flat = hypot(n.x, n.y);
	out->along = flat > 1e-3 * length ? (struct dvec2){ -n.y / flat, n.x / flat } : (struct dvec2){ 1.0, 0.0 };
	return true;
}

/* Bays and storeys are counted from the building's own corner and ground, so that neighbouring triangles agree. */
static void draw_surface(const struct dvec3 *p, const struct tilt *tilt, const struct dvec3 *origin,
	const struct facade *f, struct shell *shell)
{
	bool wall = fabs(tilt->normal.z) < 0.35, down = tilt->normal.z <= -0.35;
	shell_brush(shell, wall ? f->upper : down ? f->blank : f->roofing, wall || down ? f->wall_rgb : f->roof_rgb);
	struct shell_point points[3];
	for (int i = 0; i < 3; i++) {
		double x = p[i].x - origin->x, y = p[i].y - origin->y, z = p[i].z - origin->z;
		double s = x * tilt->along.x + y * tilt->along.y, up = wall ? z : x * -tilt->along.y + y * tilt->along.x;
		double across = wall ? f->bay_m : ROOF_TILE_M, high = wall ? f->storey_m : ROOF_TILE_M;
		points[i] = (struct shell_point){ p[i], (float)(s / across), (float)(up / high),
			(float)(0.7 + 0.3 * fmin(z / 4.0, 1.0)) };
	}
	float u = fminf(points[0].u, fminf(points[1].u, points[2].u)),
		  v = fminf(points[0].v, fminf(points[1].v, points[2].v));
	for (int i = 0; i < 3; i++) {
		points[i].u -= floorf(u);
		points[i].v -= floorf(v);
	}
	shell_face(shell, points, 3);
}

void building_surfaces(const struct building *building, const struct facade *facade, struct shell *shell)
{
	struct dvec3 origin = { INFINITY, INFINITY, INFINITY };
	for (size_t i = 0; i < building->wall_3d_count; i++) {
		origin.x = fmin(origin.x, building->walls_3d[i].x);
		origin.y = fmin(origin.y, building->walls_3d[i].y);
		origin.z = fmin(origin.z, building->walls_3d[i].z);
	}
	for (size_t i = 0; i + 2 < building->wall_3d_count; i += 3) {
		struct tilt tilt;
		const struct dvec3 *p = &building->walls_3d[i];
		if (isfinite(p[0].x + p[0].y + p[0].z + p[1].x + p[1].y + p[1].z + p[2].x + p[2].y + p[2].z) &&
			tilt_of(p, &tilt))
			draw_surface(p, &tilt, &origin, facade, shell);
	}
}
