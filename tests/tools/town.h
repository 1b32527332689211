/*
 * Small towns written by a test as OpenStreetMap files, in metres east and north of any place on earth, and baked the
 * way a user bakes them. Header only.
 */
#ifndef BLVD_TESTS_TOOLS_TOWN_H
#define BLVD_TESTS_TOOLS_TOWN_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/geo.h"
#include "tools/commands.h"

#define TOWN_ARGS_MAX 24

struct town {
	FILE *file;
	struct geo_point origin;
	double lat_m, lon_m; /* of a degree */
	long long nodes, ways;
};

static inline void town_open(struct town *town, const char *path, struct geo_point origin)
{
	double s = sin(origin.lat_deg * (BLVD_PI / 180.0)), c = cos(origin.lat_deg * (BLVD_PI / 180.0));
	double n = GEO_WGS84_A / sqrt(1.0 - GEO_WGS84_E2 * s * s);
	double m = n * (1.0 - GEO_WGS84_E2) / (1.0 - GEO_WGS84_E2 * s * s);
	*town = (struct town){
		.file = fopen(path, "w"), .origin = origin, .lat_m = m * BLVD_PI / 180.0, .lon_m = n * c * BLVD_PI / 180.0
	};
	if (!town->file)
		abort();
	fputs("<?xml version=\"1.0\"?>\n<osm version=\"0.6\">\n", town->file);
}

static inline void town_close(struct town *town)
{
	fputs("</osm>\n", town->file);
	if (fclose(town->file))
		abort();
}

/* Places are whole steps of 1e-7 degrees from the origin, as OpenStreetMap has them: elsewhere they are the same steps.
 */
static inline long long town_node(struct town *town, double x, double y)
{
	double lon = remainder(town->origin.lon_deg + round(x / town->lon_m * 1e7) * 1e-7, 360.0);
	double lat = town->origin.lat_deg + round(y / town->lat_m * 1e7) * 1e-7;
	fprintf(town->file, "<node id=\"%lld\" lat=\"%.7f\" lon=\"%.7f\"/>\n", ++town->nodes, lat, lon);
	return town->nodes;
}

/* `tags`: "key=value" one after another, NULL at the end. */
static inline void town_way(struct town *town, const long long *nodes, int count, const char *const *tags)
{
	fprintf(town->file, "<way id=\"%lld\">", ++town->ways);
	for (int i = 0; i < count; i++)
		fprintf(town->file, "<nd ref=\"%lld\"/>", nodes[i]);
	for (; *tags; tags++) {
		const char *value = strchr(*tags, '=');
		fprintf(town->file, "<tag k=\"%.*s\" v=\"%s\"/>", (int)(value - *tags), *tags, value + 1);
	}
	fputs("</way>\n", town->file);
}

static inline void town_street(struct town *town, const long long *nodes, int count, const char *name)
{
	char tag[64];
	snprintf(tag, sizeof(tag), "name=%s", name);
	town_way(town, nodes, count,
		(const char *const[]){ "highway=residential", "lanes=2", "maxspeed=50", "sidewalk=both", tag, NULL });
}

/* An area with the corners (x0, y0) and (x1, y1). */
static inline void town_area(struct town *town, double x0, double y0, double x1, double y1, const char *const *tags)
{
	long long nodes[5] = { town_node(town, x0, y0), town_node(town, x1, y0), town_node(town, x1, y1),
		town_node(town, x0, y1) };
	nodes[4] = nodes[0];
	town_way(town, nodes, 5, tags);
}

static inline void town_house(struct town *town, double x, double y, double width, double depth, double height)
{
	char tag[64];
	snprintf(tag, sizeof(tag), "height=%.1f", height);
	town_area(
		town, x, y, x + width, y + depth, (const char *const[]){ "building=apartments", "roof:shape=flat", tag, NULL });
}

/* A row of houses that touch, along x or along y, of changing heights. */
static inline void town_row(struct town *town, double x, double y, int count, double width, double depth, bool along_x)
{
	for (int i = 0; i < count; i++) {
		double height = 9.0 + 3.0 * (i * 7 % 4);
		if (along_x)
			town_house(town, x + i * width, y, width, depth, height);
		else
			town_house(town, x, y + i * width, depth, width, height);
	}
}

/* Runs `blvd bake MAP -o PACKAGE` with what more there is, NULL at the end. Returns its exit status. Workers are
 * forked: no GL context may be open. Textures are not compressed, which takes longest. */
static inline int town_bake(const char *map, const char *package, const char *const *more)
{
	char *args[TOWN_ARGS_MAX] = { "bake", "-q", "--textures", "rgba8", (char *)map, "-o", (char *)package };
	int count = 7;
	while (*more && count + 1 < TOWN_ARGS_MAX)
		args[count++] = (char *)*more++;
	return cmd_bake(count, args);
}

#endif
