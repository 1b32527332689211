#include "tools/read/tag_value.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOOT_M 0.3048
#define INCH_M 0.0254
#define MILE_M 1609.344

int tag_word_find(const struct tag_word *words, const char *value, int missing)
{
	for (; words->word; words++)
		if (!strcmp(words->word, value))
			return words->meaning;
	return missing;
}

static const char *skip_blanks(const char *text)
{
	while (*text == ' ')
		text++;
	return text;
}

/* A decimal number at `*text`, which moves behind it. Not strtod(): that knows locales, hexadecimal, "inf" and "nan".
 */
static enum tag_verdict take_number(const char **text, double *out)
{
	const char *at = skip_blanks(*text);
	enum tag_verdict verdict = TAG_GOOD;
	bool negative = *at == '-';
	double value = 0.0, scale = 1.0;
	int digits = 0;
	if (*at == '+' || *at == '-')
		at++;
	if (*at == '~') {
		at++;
		verdict = TAG_MENDED;
	}
	for (; isdigit((unsigned char)*at) && digits < 15; at++, digits++)
		value = value * 10.0 + (*at - '0');
	bool comma = *at == ',' && isdigit((unsigned char)at[1]);
	if (comma)
		verdict = TAG_MENDED;
	if (*at == '.' || comma)
		for (at++; isdigit((unsigned char)*at); at++, digits++)
			value += (*at - '0') * (scale *= 0.1);
	if (!digits || digits > 30)
		return TAG_BAD;
	*text = at;
	*out = negative ? -value : value;
	return verdict;
}

static bool starts_list(const char *rest)
{
	return *rest == ';' || *rest == '-' || *rest == '/' || *rest == ',' || *rest == '|';
}

enum tag_verdict tag_number(const char *value, double *out)
{
	double number;
	enum tag_verdict verdict = take_number(&value, &number);
	if (verdict == TAG_BAD)
		return TAG_BAD;
	value = skip_blanks(value);
	if (*value)
		verdict = starts_list(value) ? TAG_MENDED : TAG_BAD;
	if (verdict != TAG_BAD)
		*out = number;
	return verdict;
}

/* 12'6" and 12 ft 6 in */
static enum tag_verdict feet_and_inches(const char *rest, double feet, enum tag_verdict verdict, double *out)
{
	double inches = 0.0;
	rest = skip_blanks(rest);
	if (isdigit((unsigned char)*rest)) {
		if (take_number(&rest, &inches) == TAG_BAD)
			return TAG_BAD;
		rest = skip_blanks(rest);
		if (!strncmp(rest, "in", 2) || !strncmp(rest, "''", 2))
			rest += 2;
		else if (*rest == '"')
			rest++;
		else
			verdict = TAG_MENDED;
	}
	if (*skip_blanks(rest))
		verdict = TAG_MENDED;
	*out = feet * FOOT_M + inches * INCH_M;
	return verdict;
}

enum tag_verdict tag_length_m(const char *value, double *out)
{
	static const struct {
		const char *unit;
		double metres;
		bool feet;
	} units[] = {
		{ "metres", 1.0, false },
		{ "meters", 1.0, false },
		{ "meter", 1.0, false },
		{ "metre", 1.0, false },
		{ "mi", MILE_M, false },
		{ "m", 1.0, false },
		{ "M", 1.0, false },
		{ "km", 1000.0, false },
		{ "cm", 0.01, false },
		{ "feet", FOOT_M, true },
		{ "foot", FOOT_M, true },
		{ "ft", FOOT_M, true },
		{ "'", FOOT_M, true },
		{ "\"", INCH_M, false },
		{ "in", INCH_M, false },
	};
	double number;
	enum tag_verdict verdict = take_number(&value, &number);
	if (verdict == TAG_BAD)
		return TAG_BAD;
	value = skip_blanks(value);
	for (size_t i = 0; i < sizeof(units) / sizeof(*units); i++) {
		size_t length = strlen(units[i].unit);
		if (strncmp(value, units[i].unit, length) != 0)
			continue;
		value += length;
		if (units[i].feet)
			return feet_and_inches(value, number, verdict, out);
		*out = number * units[i].metres;
		value = skip_blanks(value);
		return !*value || *value == '.' ? verdict : starts_list(value) ? TAG_MENDED : TAG_BAD;
	}
	if (*value && !starts_list(value))
		return TAG_BAD;
	*out = number;
	return *value ? TAG_MENDED : verdict;
}

/* The part of "CH:urban" behind the country; the countries' own limits matter little here, so that one table does,
 * with the United Kingdom's and the United States' miles rounded. */
static enum tag_verdict zone_speed_kmh(const char *value, int *out)
{
	static const struct tag_word zones[] = {
		{ "urban", 50 },
		{ "rural", 90 },
		{ "motorway", 120 },
		{ "trunk", 100 },
		{ "living_street", 20 },
		{ "bicycle_road", 30 },
		{ "walk", 7 },
		{ "zone:20", 20 },
		{ "zone20", 20 },
		{ "zone:30", 30 },
		{ "zone30", 30 },
		{ "30", 30 },
		{ "20", 20 },
		{ "nsl_restricted", 48 },
		{ "nsl_single", 97 },
		{ "nsl_dual", 113 },
		{ NULL, 0 },
	};
	const char *colon = strchr(value, ':');
	int speed = colon ? tag_word_find(zones, colon + 1, 0) : 0;
	if (!speed)
		return TAG_BAD;
	if (!strncmp(value, "DE:rural", 8) || !strncmp(value, "AT:rural", 8))
		speed = 100;
	else if (!strncmp(value, "CH:rural", 8) || !strncmp(value, "FR:rural", 8))
		speed = 80;
	else if (!strncmp(value, "FR:motorway", 11) || !strncmp(value, "IT:motorway", 11))
		speed = 130;
	*out = speed;
	return TAG_GOOD;
}

enum tag_verdict tag_speed_kmh(const char *value, int *out)
{
	static const struct tag_word words[] = {
		{ "none", 130 },
		{ "walk", 7 },
		{ "walking", 7 },
		{ "living_street", 20 },
		{ NULL, 0 },
	};
	if (!strcmp(value, "signals") || !strcmp(value, "variable") || !strcmp(value, "implicit"))
		return TAG_GOOD;
	int word = tag_word_find(words, value, 0);
	if (word) {
		*out = word;
		return TAG_GOOD;
	}
	if (isalpha((unsigned char)*value))
		return zone_speed_kmh(value, out);
	double number;
	enum tag_verdict verdict = take_number(&value, &number);
	if (verdict == TAG_BAD)
		return TAG_BAD;
	value = skip_blanks(value);
	if (!strncmp(value, "mph", 3)) {
		number *= MILE_M / 1000.0;
		value += 3;
	} else if (!strncmp(value, "knots", 5)) {
		number *= 1.852;
		value += 5;
	} else if (!strncmp(value, "km/h", 4) || !strncmp(value, "kmh", 3) || !strncmp(value, "kph", 3)) {
		value += value[2] == '/' ? 4 : 3;
	}
	value = skip_blanks(value);
	if (*value && !starts_list(value))
		return TAG_BAD;
	if (number < 1.0 || number > 250.0)
		return TAG_BAD;
	*out = (int)lrint(number);
	return *value ? TAG_MENDED : verdict;
}

static int hex_digit(char c)
{
	return isdigit((unsigned char)c) ? c - '0' : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10 : -1;
}

static enum tag_verdict hex_colour(const char *digits, struct colour *out)
{
	size_t length = strlen(digits);
	if (length != 3 && length != 6 && length != 8)
		return TAG_BAD;
	for (size_t i = 0; i < length; i++)
		if (hex_digit(digits[i]) < 0)
			return TAG_BAD;
	for (size_t i = 0; i < 3; i++)
		out->rgb[i] = (uint8_t)(length == 3 ? hex_digit(digits[i]) * 17
											: hex_digit(digits[2 * i]) * 16 + hex_digit(digits[2 * i + 1]));
	out->given = true;
	return TAG_GOOD;
}

/* CSS Color Module Level 4, named colours. */
static const struct tag_word colour_names[] = {
	{ "aliceblue", 0xf0f8ff },
	{ "antiquewhite", 0xfaebd7 },
	{ "aqua", 0x00ffff },
	{ "aquamarine", 0x7fffd4 },
	{ "azure", 0xf0ffff },
	{ "beige", 0xf5f5dc },
	{ "bisque", 0xffe4c4 },
	{ "black", 0x000000 },
	{ "blanchedalmond", 0xffebcd },
	{ "blue", 0x0000ff },
	{ "blueviolet", 0x8a2be2 },
	{ "brown", 0xa52a2a },
	{ "burlywood", 0xdeb887 },
	{ "cadetblue", 0x5f9ea0 },
	{ "chartreuse", 0x7fff00 },
	{ "chocolate", 0xd2691e },
	{ "coral", 0xff7f50 },
	{ "cornflowerblue", 0x6495ed },
	{ "cornsilk", 0xfff8dc },
	{ "cream", 0xfffdd0 }, /* not CSS, but common on buildings */
	{ "crimson", 0xdc143c },
	{ "cyan", 0x00ffff },
	{ "darkblue", 0x00008b },
	{ "darkbrown", 0x5c4033 },
	{ "darkcyan", 0x008b8b },
	{ "darkgoldenrod", 0xb8860b },
	{ "darkgray", 0xa9a9a9 },
	{ "darkgreen", 0x006400 },
	{ "darkkhaki", 0xbdb76b },
	{ "darkmagenta", 0x8b008b },
	{ "darkolivegreen", 0x556b2f },
	{ "darkorange", 0xff8c00 },
	{ "darkorchid", 0x9932cc },
	{ "darkred", 0x8b0000 },
	{ "darksalmon", 0xe9967a },
	{ "darkseagreen", 0x8fbc8f },
	{ "darkslateblue", 0x483d8b },
	{ "darkslategray", 0x2f4f4f },
	{ "darkturquoise", 0x00ced1 },
	{ "darkviolet", 0x9400d3 },
	{ "deeppink", 0xff1493 },
	{ "deepskyblue", 0x00bfff },
	{ "dimgray", 0x696969 },
	{ "dodgerblue", 0x1e90ff },
	{ "firebrick", 0xb22222 },
	{ "floralwhite", 0xfffaf0 },
	{ "forestgreen", 0x228b22 },
	{ "fuchsia", 0xff00ff },
	{ "gainsboro", 0xdcdcdc },
	{ "ghostwhite", 0xf8f8ff },
	{ "gold", 0xffd700 },
	{ "goldenrod", 0xdaa520 },
	{ "gray", 0x808080 },
	{ "green", 0x008000 },
	{ "greenyellow", 0xadff2f },
	{ "honeydew", 0xf0fff0 },
	{ "hotpink", 0xff69b4 },
	{ "indianred", 0xcd5c5c },
	{ "indigo", 0x4b0082 },
	{ "ivory", 0xfffff0 },
	{ "khaki", 0xf0e68c },
	{ "lavender", 0xe6e6fa },
	{ "lavenderblush", 0xfff0f5 },
	{ "lawngreen", 0x7cfc00 },
	{ "lemonchiffon", 0xfffacd },
	{ "lightblue", 0xadd8e6 },
	{ "lightbrown", 0xb5651d },
	{ "lightcoral", 0xf08080 },
	{ "lightcyan", 0xe0ffff },
	{ "lightgoldenrodyellow", 0xfafad2 },
	{ "lightgray", 0xd3d3d3 },
	{ "lightgreen", 0x90ee90 },
	{ "lightpink", 0xffb6c1 },
	{ "lightsalmon", 0xffa07a },
	{ "lightseagreen", 0x20b2aa },
	{ "lightskyblue", 0x87cefa },
	{ "lightslategray", 0x778899 },
	{ "lightsteelblue", 0xb0c4de },
	{ "lightyellow", 0xffffe0 },
	{ "lime", 0x00ff00 },
	{ "limegreen", 0x32cd32 },
	{ "linen", 0xfaf0e6 },
	{ "magenta", 0xff00ff },
	{ "maroon", 0x800000 },
	{ "mediumaquamarine", 0x66cdaa },
	{ "mediumblue", 0x0000cd },
	{ "mediumorchid", 0xba55d3 },
	{ "mediumpurple", 0x9370db },
	{ "mediumseagreen", 0x3cb371 },
	{ "mediumslateblue", 0x7b68ee },
	{ "mediumspringgreen", 0x00fa9a },
	{ "mediumturquoise", 0x48d1cc },
	{ "mediumvioletred", 0xc71585 },
	{ "midnightblue", 0x191970 },
	{ "mintcream", 0xf5fffa },
	{ "mistyrose", 0xffe4e1 },
	{ "moccasin", 0xffe4b5 },
	{ "navajowhite", 0xffdead },
	{ "navy", 0x000080 },
	{ "oldlace", 0xfdf5e6 },
	{ "olive", 0x808000 },
	{ "olivedrab", 0x6b8e23 },
	{ "orange", 0xffa500 },
	{ "orangered", 0xff4500 },
	{ "orchid", 0xda70d6 },
	{ "palegoldenrod", 0xeee8aa },
	{ "palegreen", 0x98fb98 },
	{ "paleturquoise", 0xafeeee },
	{ "palevioletred", 0xdb7093 },
	{ "papayawhip", 0xffefd5 },
	{ "peachpuff", 0xffdab9 },
	{ "peru", 0xcd853f },
	{ "pink", 0xffc0cb },
	{ "plum", 0xdda0dd },
	{ "powderblue", 0xb0e0e6 },
	{ "purple", 0x800080 },
	{ "rebeccapurple", 0x663399 },
	{ "red", 0xff0000 },
	{ "rosybrown", 0xbc8f8f },
	{ "royalblue", 0x4169e1 },
	{ "saddlebrown", 0x8b4513 },
	{ "salmon", 0xfa8072 },
	{ "sandybrown", 0xf4a460 },
	{ "seagreen", 0x2e8b57 },
	{ "seashell", 0xfff5ee },
	{ "sienna", 0xa0522d },
	{ "silver", 0xc0c0c0 },
	{ "skyblue", 0x87ceeb },
	{ "slateblue", 0x6a5acd },
	{ "slategray", 0x708090 },
	{ "snow", 0xfffafa },
	{ "springgreen", 0x00ff7f },
	{ "steelblue", 0x4682b4 },
	{ "tan", 0xd2b48c },
	{ "teal", 0x008080 },
	{ "thistle", 0xd8bfd8 },
	{ "tomato", 0xff6347 },
	{ "turquoise", 0x40e0d0 },
	{ "violet", 0xee82ee },
	{ "wheat", 0xf5deb3 },
	{ "white", 0xffffff },
	{ "whitesmoke", 0xf5f5f5 },
	{ "yellow", 0xffff00 },
	{ "yellowgreen", 0x9acd32 },
	{ NULL, 0 },
};

enum tag_verdict tag_colour(const char *value, struct colour *out)
{
	if (*value == '#')
		return hex_colour(value + 1, out);
	char name[32];
	size_t length = 0;
	bool listed = false;
	for (; *value && length + 1 < sizeof(name); value++) {
		if (*value == ';' || *value == '/') {
			listed = true;
			break;
		}
		if (isalpha((unsigned char)*value))
			name[length++] = (char)tolower((unsigned char)*value);
		else if (!strchr(" _-", *value))
			return TAG_BAD;
	}
	name[length] = 0;
	char *grey = strstr(name, "grey");
	if (grey)
		grey[2] = 'a';
	int rgb = tag_word_find(colour_names, name, -1);
	if (rgb < 0)
		return TAG_BAD;
	*out = (struct colour){ { (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8 & 0xFF), (uint8_t)(rgb & 0xFF) }, true };
	return listed ? TAG_MENDED : TAG_GOOD;
}

enum tag_verdict tag_direction_deg(const char *value, double *out)
{
	static const char *const points[] = { "N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW",
		"W", "WNW", "NW", "NNW" };
	for (int i = 0; i < 16; i++) {
		if (!strcasecmp(value, points[i])) {
			*out = 22.5 * i;
			return TAG_GOOD;
		}
	}
	double number;
	enum tag_verdict verdict = tag_number(value, &number);
	if (verdict == TAG_BAD || fabs(number) > 720.0)
		return TAG_BAD;
	number = fmod(number, 360.0);
	*out = number < 0.0 ? number + 360.0 : number;
	return verdict;
}

enum roof_shape tag_roof_shape(const char *value)
{
	static const struct tag_word words[] = {
		{ "flat", ROOF_FLAT },
		{ "terrace", ROOF_FLAT },
		{ "gabled", ROOF_GABLED },
		{ "pitched", ROOF_GABLED },
		{ "saltbox", ROOF_GABLED },
		{ "gabled_height_moved", ROOF_GABLED },
		{ "double_saltbox", ROOF_GABLED },
		{ "cross_gabled", ROOF_GABLED },
		{ "crosspitched", ROOF_GABLED },
		{ "hipped", ROOF_HIPPED },
		{ "hipped-and-gabled", ROOF_HALF_HIPPED },
		{ "side_hipped", ROOF_HIPPED },
		{ "half-hipped", ROOF_HALF_HIPPED },
		{ "half_hipped", ROOF_HALF_HIPPED },
		{ "side_half-hipped", ROOF_HALF_HIPPED },
		{ "pyramidal", ROOF_PYRAMIDAL },
		{ "pyramid", ROOF_PYRAMIDAL },
		{ "spire", ROOF_PYRAMIDAL },
		{ "skillion", ROOF_SKILLION },
		{ "lean_to", ROOF_SKILLION },
		{ "shed", ROOF_SKILLION },
		{ "dome", ROOF_DOME },
		{ "onion", ROOF_ONION },
		{ "mansard", ROOF_MANSARD },
		{ "gambrel", ROOF_GAMBREL },
		{ "round", ROOF_ROUND },
		{ "barrel", ROOF_ROUND },
		{ "circular", ROOF_ROUND },
		{ "cone", ROOF_CONE },
		{ "conical", ROOF_CONE },
		{ "round_gabled", ROOF_ROUND },
		{ NULL, 0 },
	};
	return (enum roof_shape)tag_word_find(words, value, ROOF_UNKNOWN);
}

enum wall_material tag_wall_material(const char *value)
{
	static const struct tag_word words[] = {
		{ "plaster", WALL_PLASTER },
		{ "stucco", WALL_PLASTER },
		{ "brick", WALL_BRICK },
		{ "bricks", WALL_BRICK },
		{ "stone", WALL_STONE },
		{ "sandstone", WALL_STONE },
		{ "limestone", WALL_STONE },
		{ "granite", WALL_STONE },
		{ "marble", WALL_STONE },
		{ "masonry", WALL_STONE },
		{ "concrete", WALL_CONCRETE },
		{ "reinforced_concrete", WALL_CONCRETE },
		{ "cement_block", WALL_CONCRETE },
		{ "glass", WALL_GLASS },
		{ "mirror", WALL_GLASS },
		{ "metal", WALL_METAL },
		{ "steel", WALL_METAL },
		{ "aluminium", WALL_METAL },
		{ "metal_plates", WALL_METAL },
		{ "copper", WALL_METAL },
		{ "wood", WALL_WOOD },
		{ "timber_framing", WALL_WOOD },
		{ NULL, 0 },
	};
	return (enum wall_material)tag_word_find(words, value, WALL_UNKNOWN);
}

enum roof_material tag_roof_material(const char *value)
{
	static const struct tag_word words[] = {
		{ "roof_tiles", ROOFING_TILES },
		{ "tile", ROOFING_TILES },
		{ "tiles", ROOFING_TILES },
		{ "slate", ROOFING_SLATE },
		{ "stone", ROOFING_SLATE },
		{ "metal", ROOFING_METAL },
		{ "metal_sheet", ROOFING_METAL },
		{ "zinc", ROOFING_METAL },
		{ "tin", ROOFING_METAL },
		{ "steel", ROOFING_METAL },
		{ "aluminium", ROOFING_METAL },
		{ "lead", ROOFING_METAL },
		{ "copper", ROOFING_COPPER },
		{ "gravel", ROOFING_GRAVEL },
		{ "tar_paper", ROOFING_GRAVEL },
		{ "asphalt", ROOFING_GRAVEL },
		{ "bitumen", ROOFING_GRAVEL },
		{ "concrete", ROOFING_CONCRETE },
		{ "eternit", ROOFING_CONCRETE },
		{ "glass", ROOFING_GLASS },
		{ "acrylic_glass", ROOFING_GLASS },
		{ "solar_panels", ROOFING_GLASS },
		{ "grass", ROOFING_GRASS },
		{ "thatch", ROOFING_GRASS },
		{ "plants", ROOFING_GRASS },
		{ NULL, 0 },
	};
	return (enum roof_material)tag_word_find(words, value, ROOFING_UNKNOWN);
}
