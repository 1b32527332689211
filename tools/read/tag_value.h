/*
 * What the values of tags mean. Nothing here fails: a value is good, was understood in spite of its form (mended), or
 * says nothing (bad); the caller counts. Rules: https://wiki.openstreetmap.org/wiki/Map_features/Units, Key:maxspeed,
 * Key:colour, Key:roof:shape, Key:roof:direction.
 */
#ifndef BLVD_TOOLS_READ_TAG_VALUE_H
#define BLVD_TOOLS_READ_TAG_VALUE_H

#include <stdbool.h>

#include "tools/city/city.h"

enum tag_verdict { TAG_GOOD, TAG_MENDED, TAG_BAD };

/* "12", "12.5 m", "12,5m" (mended), "40 ft", "12'6\"", "0.01 mi"; lists and ranges give their first number (mended). */
enum tag_verdict tag_length_m(const char *value, double *out);

/* A number without unit, as above. */
enum tag_verdict tag_number(const char *value, double *out);

/* "50", "30 mph", "5 knots", "walk", "none", "CH:urban", "DE:zone30"; "signals" and "variable" leave `out` and are
 * good. */
enum tag_verdict tag_speed_kmh(const char *value, int *out);

/* "#a1b2c3", "#abc", CSS names with or without spaces or underscores. */
enum tag_verdict tag_colour(const char *value, struct colour *out);

/* "135", "NW", "nnw". Degrees clockwise from north, 0 to 360. */
enum tag_verdict tag_direction_deg(const char *value, double *out);

enum roof_shape tag_roof_shape(const char *value);       /* ROOF_UNKNOWN for what cannot be drawn */
enum wall_material tag_wall_material(const char *value); /* WALL_UNKNOWN for others */
enum roof_material tag_roof_material(const char *value); /* ROOFING_UNKNOWN for others */

/* Looks a word up in a table that ends with a NULL word; `missing` when it is not there. */
struct tag_word {
	const char *word;
	int meaning;
};
int tag_word_find(const struct tag_word *words, const char *value, int missing);

#endif
