/* blvd compare: image measures as JSON. */
#include <argp.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/city/pool.h"
#include "tools/commands.h"
#include "tools/measure/coverage.h"
#include "tools/measure/flip.h"
#include "tools/measure/image.h"
#include "tools/measure/metrics.h"

struct compare_options {
	const char *paths[2];
	int count;
	const char *difference, *heat;
	double ppd;
	uint8_t clear[3];
	bool has_clear;
};

enum { KEY_HEAT = 256, KEY_PPD, KEY_CLEAR };

static void parse_clear(struct compare_options *options, const char *value, struct argp_state *state)
{
	if (strlen(value) != 6 || strspn(value, "0123456789abcdefABCDEF") != 6)
		argp_error(state, "--clear wants six hexadecimal digits, not '%s'", value);
	unsigned long colour = strtoul(value, NULL, 16);
	for (int c = 0; c < 3; c++)
		options->clear[c] = (uint8_t)(colour >> (16 - 8 * c));
	options->has_clear = true;
}

static double parse_ppd(const char *value, struct argp_state *state)
{
	char *end;
	double ppd = strtod(value, &end);
	if (*end || end == value || !(ppd >= FLIP_MIN_PPD && ppd <= FLIP_MAX_PPD))
		argp_error(state, "--ppd wants %g to %g, not '%s'", FLIP_MIN_PPD, FLIP_MAX_PPD, value);
	return ppd;
}

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct compare_options *options = state->input;
	switch (key) {
	case 'd':
		options->difference = value;
		return 0;
	case KEY_HEAT:
		options->heat = value;
		return 0;
	case KEY_PPD:
		options->ppd = parse_ppd(value, state);
		return 0;
	case KEY_CLEAR:
		parse_clear(options, value, state);
		return 0;
	case ARGP_KEY_ARG:
		if (options->count == 2)
			argp_error(state, "two pictures at a time");
		options->paths[options->count++] = value;
		return 0;
	case ARGP_KEY_END:
		if (options->count < 2)
			argp_error(state, "two pictures are wanted");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp_option option_table[] = {
	{ "difference", 'd', "FILE.png", 0, "write the difference, eight times enlarged around grey", 0 },
	{ "heat", KEY_HEAT, "FILE.png", 0, "write the FLIP map: black 0, cream 1", 0 },
	{ "ppd", KEY_PPD, "NUMBER", 0, "pixels a degree of sight for FLIP (67: 4K screen 0.7 m wide, 0.7 m away)", 0 },
	{ "clear", KEY_CLEAR, "RRGGBB", 0, "colour of pixels that nothing was drawn on", 0 },
	{ 0 },
};

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.args_doc = "A.png B.png",
	.doc = "Measures how two pictures of one size differ. A is the reference.",
};

static void print_field(const char *name, double value, int digits)
{
	if (isfinite(value))
		printf(", \"%s\": %.*f", name, digits, value);
	else
		printf(", \"%s\": null", name);
}

static void print_difference(const struct image_difference *d)
{
	printf("\"max\": %d", d->max);
	print_field("mean", d->mean, 6);
	print_field("differing", d->differing, 8);
	print_field("within_2", d->within_2, 8);
	print_field("psnr_db", d->psnr_db, 4);
	print_field("ssim", d->ssim, 6);
}

static void print_coverage(const struct image_coverage *c)
{
	print_field("precision", c->precision, 8);
	print_field("recall", c->recall, 8);
	print_field("precision_within_2", c->precision_within_2, 8);
	print_field("recall_within_2", c->recall_within_2, 8);
	print_field("uncovered", c->uncovered, 8);
}

static void print_flip(const struct flip_summary *f, double ppd)
{
	printf(", \"flip\": {\"ppd\": %.2f", ppd);
	print_field("mean", f->mean, 6);
	print_field("weighted_p25", f->weighted_p25, 6);
	print_field("weighted_p50", f->weighted_p50, 6);
	print_field("weighted_p75", f->weighted_p75, 6);
	print_field("weighted_p95", f->weighted_p95, 6);
	print_field("max", f->max, 6);
	printf("}");
}

static int compare(const struct image *a, const struct image *b, const struct compare_options *options)
{
	struct image_difference difference;
	struct image_coverage coverage;
	struct flip_summary flip;
	float *map = array_grow(NULL, &(size_t){ 0 }, (size_t)a->width * a->height, sizeof(float));
	image_compare(a, b, &difference);
	image_cover(a, b, options->has_clear ? options->clear : NULL, &coverage);
	flip_map(a, b, options->ppd, map);
	flip_summarise(map, a->width, a->height, &flip);
	printf("{");
	print_difference(&difference);
	print_coverage(&coverage);
	print_flip(&flip, options->ppd);
	printf("}\n");
	int status = EXIT_DONE;
	if (options->difference && image_write_difference(a, b, options->difference) < 0)
		status = EXIT_FAILED;
	if (options->heat && flip_write_heat(map, a->width, a->height, options->heat) < 0)
		status = EXIT_FAILED;
	array_free(map);
	return status;
}

int cmd_compare(int argc, char **argv)
{
	struct compare_options options = { .ppd = FLIP_DEFAULT_PPD };
	argp_parse(&parser, argc, argv, 0, NULL, &options);
	struct image a = { 0 }, b = { 0 };
	int status = EXIT_BAD_INPUT;
	if (image_read_png(&a, options.paths[0]) < 0 || image_read_png(&b, options.paths[1]) < 0)
		goto done;
	if (a.width != b.width || a.height != b.height) {
		log_error(
			"%s is %u x %u, %s is %u x %u", options.paths[0], a.width, a.height, options.paths[1], b.width, b.height);
		goto done;
	}
	status = compare(&a, &b, &options);
done:
	image_finish(&a);
	image_finish(&b);
	return status;
}
