/*
 * blvd synth: a made-up city as OSM, the same bytes for the same options.
 *
 * How size follows from the options (seed 7, density 1, triangles of blvd bake): 0.5x0.5 km 0.09 million, 1x1 0.31,
 * 1.6x1.6 0.67, 3x3 2.2; from there about 0.25 million a square kilometre, so 6.4x6.4 makes about 10 million. Trees are
 * half of them. --density 2 adds a quarter: narrower lots, more trees.
 */
#include <argp.h>
#include <stdlib.h>

#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/synth/synth.h"

#define LEAST_KM 0.3
#define MOST_KM 25.0

struct synth_arguments {
	struct synth_options options;
	const char *output, *terrain;
};

enum { OPT_SEED = 256, OPT_SIZE, OPT_DENSITY, OPT_TERRAIN_OUT };

static const struct argp_option option_table[] = {
	{ "output", 'o', "CITY.osm", 0, "the OSM file to write", 0 },
	{ "seed", OPT_SEED, "N", 0, "which city; default 1", 0 },
	{ "size", OPT_SIZE, "KMxKM", 0, "west to east by south to north, 0.3 to 25 km; default 2x2", 0 },
	{ "density", OPT_DENSITY, "F", 0, "0.25 to 4: narrower lots, more trees; default 1", 0 },
	{ "terrain-out", OPT_TERRAIN_OUT, "FILE.tif", 0, "write a hill as a GeoTIFF, for blvd bake --terrain", 0 },
	{ 0 },
};

static void parse_size(struct synth_options *options, const char *text, struct argp_state *state)
{
	double width, height;
	char extra;
	if (sscanf(text, "%lfx%lf%c", &width, &height, &extra) != 2 || !(width >= LEAST_KM && width <= MOST_KM) ||
		!(height >= LEAST_KM && height <= MOST_KM))
		argp_error(state, "--size wants KMxKM, each from %.1f to %.0f, not '%s'", LEAST_KM, MOST_KM, text);
	options->width_m = width * 1000.0;
	options->height_m = height * 1000.0;
}

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct synth_arguments *arguments = state->input;
	char *end;
	switch (key) {
	case 'o':
		arguments->output = value;
		return 0;
	case OPT_TERRAIN_OUT:
		arguments->terrain = value;
		return 0;
	case OPT_SEED:
		arguments->options.seed = strtoull(value, &end, 10);
		if (!*value || *end || *value == '-')
			argp_error(state, "--seed wants a whole number, not '%s'", value);
		return 0;
	case OPT_DENSITY:
		arguments->options.density = strtod(value, &end);
		if (!*value || *end || !(arguments->options.density >= 0.25 && arguments->options.density <= 4.0))
			argp_error(state, "--density wants a number from 0.25 to 4, not '%s'", value);
		return 0;
	case OPT_SIZE:
		parse_size(&arguments->options, value, state);
		return 0;
	case ARGP_KEY_ARG:
		argp_error(state, "what is '%s'?", value);
		return 0;
	case ARGP_KEY_END:
		if (!arguments->output)
			argp_error(state, "no output: -o CITY.osm");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.doc =
		"Makes up a city with streets, blocks, courtyards, landmarks and a river, and writes it as OSM XML. The same "
		"options give the same bytes.",
};

int cmd_synth(int argc, char **argv)
{
	struct synth_arguments arguments = { .options = {
											 .seed = 1, .width_m = 2000.0, .height_m = 2000.0, .density = 1.0 } };
	struct synth synth;
	argp_parse(&parser, argc, argv, 0, NULL, &arguments);
	synth_make(&synth, &arguments.options);
	int status = osm_doc_write(synth.doc, arguments.output);
	if (!status && arguments.terrain)
		status = terrain_write(&synth, arguments.terrain);
	if (!status)
		log_info("%s: %zu street edges, %zu ways, %zu nodes", arguments.output, synth.graph.edges.count,
			osm_doc_way_count(synth.doc), osm_doc_node_count(synth.doc));
	synth_finish(&synth);
	return status ? EXIT_FAILED : EXIT_DONE;
}
