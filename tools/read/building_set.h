/*
 * More buildings: polygons with heights from anything GDAL opens (shapefile, GeoJSON, GeoPackage, vector tiles). Read
 * in two steps, because the city's frame depends on what all inputs cover.
 *
 * Heights, in this order: the field asked for; a field with a usual name; the polygons' own z, which is the eaves'
 * altitude, less the ground's. The ground's altitude is a field with a usual name or, without one, 3.5 m below the
 * lowest tenth of the eaves within 150 m.
 */
#ifndef BLVD_TOOLS_READ_BUILDING_SET_H
#define BLVD_TOOLS_READ_BUILDING_SET_H

#include "tools/read/shape.h"

struct set_building {
	int64_t id;
	struct polygon degrees;                /* x longitude, y latitude, WGS84 */
	double height_m, min_height_m, levels; /* 0: not known */
	double eaves_z_m, ground_z_m;          /* altitudes; NAN: not known */
	bool eaves;                            /* height_m is up to the eaves */
	const char *name;                      /* or NULL */
	const char *kind;                      /* as OSM's building=*, or NULL */
	struct dvec3 *walls;                   /* triangles: longitude, latitude, m above the building's foot; or NULL */
	size_t wall_count;                     /* points */
};

struct set_area {
	int64_t id;
	enum area_kind kind;
	struct polygon degrees;
};

struct building_set {
	struct pool pool;
	ARRAY(struct set_building) buildings;
	ARRAY(struct set_area) areas;       /* CityJSON has some */
	uint64_t fates[ELEMENT_FATE_COUNT]; /* of the file's features */
};

/* Adds what `path` holds. `height_field` may be NULL. Returns 0, -errno or -EBADMSG after logging one line. */
int building_set_read(struct building_set *set, const char *path, const char *height_field, struct report *report);

/* Pushes them all, projected to the city's frame. Walls are left standing on height 0 until building_set_lift(). */
void building_set_make(const struct building_set *set, struct city *city, struct shaper *shaper);

/* Puts walls_3d on the terrain, once there is one. */
void building_set_lift(struct city *city);

void building_set_finish(struct building_set *set);

#endif
