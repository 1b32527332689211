/* blvd bake: map data in, city package out. Runs the steps of bake.h in order, two generators side by side where they
 * are independent. */
#include <argp.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/bake/bake.h"
#include "tools/bake/font_faces.h"
#include "tools/commands.h"
#include "tools/far/far.h"

#define LIST_MAX 64

struct list {
	const char *items[LIST_MAX];
	size_t count;
};

struct bake_options {
	struct list inputs, buildings, terrain, fonts;
	const char *output, *report, *height_field, *name;
	double bounds[4];
	bool bounded;
	enum pkg_texture_format textures;
	struct far_options far;
	bool quiet;
};

enum {
	OPT_REPORT = 256,
	OPT_BUILDINGS,
	OPT_HEIGHT_FIELD,
	OPT_TERRAIN,
	OPT_NAME,
	OPT_FONT,
	OPT_BBOX,
	OPT_TEXTURES,
	OPT_FAR,
	OPT_TAU,
	OPT_NEAR,
	OPT_EYE,
	OPT_CELLS,
	OPT_JOBS,
	OPT_TRUTH,
	OPT_INTERIOR,
	OPT_UNITS,
	OPT_BUDGET,
	OPT_TEXELS,
};

static const struct argp_option option_table[] = {
	{ "output", 'o', "CITY.blvd", 0, "the package to write", 0 },
	{ "buildings", OPT_BUILDINGS, "FILE", 0, "one more set of buildings, in any vector format of GDAL", 0 },
	{ "height-field", OPT_HEIGHT_FIELD, "NAME", 0, "the field of --buildings that holds heights in metres", 0 },
	{ "terrain", OPT_TERRAIN, "FILE", 0, "ground heights: .hgt, GeoTIFF, or any raster of GDAL", 0 },
	{ "bbox", OPT_BBOX, "W,S,E,N", 0, "keep what lies inside these degrees", 0 },
	{ "name", OPT_NAME, "TEXT", 0, "the city's name; default from the first input", 0 },
	{ "font", OPT_FONT, "FILE", 0, "font for names and instruments; repeat for more scripts", 0 },
	{ "textures", OPT_TEXTURES, "etc2|rgba8", 0, "how textures are stored: a quarter of the size (default), or exact",
		0 },
	{ "report", OPT_REPORT, "FILE.json", 0, "write what was read, mended and dropped", 0 },
	{ "quiet", 'q', NULL, 0, "print errors only", 0 },
	{ NULL, 0, NULL, 0, "The far field:", 1 },
	{ "far", OPT_FAR, "none|pvs|impostor|all", 0, "what stands for the distance; default none", 1 },
	{ "tau", OPT_TAU, "PX", 0, "accuracy: the largest displacement, 1/16 to 64; default 1", 1 },
	{ "texels", OPT_TEXELS, "F", 0, "texels of an impostor a pixel of the screen, 0.25 to 2; default 1", 1 },
	{ "near", OPT_NEAR, "M", 0, "what is nearer to the street is drawn as it is; 40 to 2000, default 300", 1 },
	{ "eye", OPT_EYE, "MIN,MAX", 0, "heights of the eye above the street; default 1.2,4", 1 },
	{ "budget", OPT_BUDGET, "MIB", 0, "what may be resident at once; accuracy gives way to it; default no limit", 1 },
	{ "cells", OPT_CELLS, "all|A-B|LOG", 0, "stretches A to B, or those a recorded drive may need; default all", 1 },
	{ "jobs", OPT_JOBS, "N", 0, "workers; default one a core", 1 },
	{ "truth", OPT_TRUTH, NULL, 0, "keep what every texel shows, for measuring", 1 },
	{ "interior", OPT_INTERIOR, "planes|grid", 0, "how surfaces are filled; default planes", 1 },
	{ "units", OPT_UNITS, "DIR", 0, "keep finished units here; default CITY.blvd.cells, which goes at the end", 1 },
	{ 0 },
};

static void list_add(struct list *list, const char *item, struct argp_state *state)
{
	if (list->count == LIST_MAX)
		argp_error(state, "more than %d of one kind of file", LIST_MAX);
	list->items[list->count++] = item;
}

static void parse_bounds(struct bake_options *options, const char *text, struct argp_state *state)
{
	double *b = options->bounds;
	char extra;
	if (sscanf(text, "%lf,%lf,%lf,%lf%c", &b[0], &b[1], &b[2], &b[3], &extra) != 4 || !(b[1] < b[3]) || !(b[0] != b[2]))
		argp_error(state, "--bbox wants west,south,east,north in degrees, not '%s'", text);
	options->bounded = true;
}

static enum pkg_texture_format parse_textures(const char *text, struct argp_state *state)
{
	if (strcmp(text, "etc2") != 0 && strcmp(text, "rgba8") != 0)
		argp_error(state, "--textures wants etc2 or rgba8, not '%s'", text);
	return text[0] == 'e' ? PKG_TEXTURE_ETC2_RGBA : PKG_TEXTURE_RGBA8;
}

static double parse_number(const char *text, double min, double max, const char *what, struct argp_state *state)
{
	char *end;
	double value = strtod(text, &end);
	if (end == text || *end || !(value >= min && value <= max))
		argp_error(state, "%s wants a number from %g to %g, not '%s'", what, min, max, text);
	return value;
}

static void parse_far(struct cell_options *cells, const char *text, struct argp_state *state)
{
	bool all = !strcmp(text, "all"), none = !strcmp(text, "none");
	cells->pvs = all || !strcmp(text, "pvs");
	cells->impostor = all || !strcmp(text, "impostor");
	if (!none && !cells->pvs && !cells->impostor)
		argp_error(state, "--far wants none, pvs, impostor or all, not '%s'", text);
}

static void parse_eye(struct stretch_options *stretches, const char *text, struct argp_state *state)
{
	char extra;
	if (sscanf(text, "%lf,%lf%c", &stretches->eye_min_m, &stretches->eye_max_m, &extra) != 2 ||
		!(stretches->eye_min_m >= 0.2) || !(stretches->eye_max_m > stretches->eye_min_m) ||
		!(stretches->eye_max_m <= 50.0))
		argp_error(state, "--eye wants two heights in metres, 0.2 to 50, the lower one first, not '%s'", text);
}

static error_t parse_far_option(int key, char *value, struct argp_state *state)
{
	struct far_options *far = &((struct bake_options *)state->input)->far;
	switch (key) {
	case OPT_FAR:
		parse_far(&far->cells, value, state);
		return 0;
	case OPT_TAU:
		far->cells.tau_px = parse_number(value, 0.0625, 64.0, "--tau", state);
		return 0;
	case OPT_TEXELS:
		far->cells.texels_per_px = parse_number(value, 0.25, 2.0, "--texels", state);
		return 0;
	case OPT_NEAR:
		far->stretches.near_m = parse_number(value, 40.0, 2000.0, "--near", state);
		return 0;
	case OPT_EYE:
		parse_eye(&far->stretches, value, state);
		return 0;
	case OPT_BUDGET:
		far->budget_bytes = (uint64_t)(parse_number(value, 1.0, 65536.0, "--budget", state) * 1048576.0);
		return 0;
	case OPT_CELLS:
		far->selection = value;
		return 0;
	case OPT_JOBS:
		far->jobs = (unsigned)parse_number(value, 1.0, 256.0, "--jobs", state);
		return 0;
	case OPT_TRUTH:
		far->cells.truth = true;
		return 0;
	case OPT_INTERIOR:
		if (strcmp(value, "planes") != 0 && strcmp(value, "grid") != 0)
			argp_error(state, "--interior wants planes or grid, not '%s'", value);
		far->cells.grid = value[0] == 'g';
		return 0;
	case OPT_UNITS:
		far->units = value;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct bake_options *options = state->input;
	switch (key) {
	case 'o':
		options->output = value;
		return 0;
	case 'q':
		options->quiet = true;
		return 0;
	case OPT_REPORT:
		options->report = value;
		return 0;
	case OPT_HEIGHT_FIELD:
		options->height_field = value;
		return 0;
	case OPT_TEXTURES:
		options->textures = parse_textures(value, state);
		return 0;
	case OPT_NAME:
		options->name = value;
		return 0;
	case OPT_BUILDINGS:
		list_add(&options->buildings, value, state);
		return 0;
	case OPT_TERRAIN:
		list_add(&options->terrain, value, state);
		return 0;
	case OPT_FONT:
		list_add(&options->fonts, value, state);
		return 0;
	case OPT_BBOX:
		parse_bounds(options, value, state);
		return 0;
	case ARGP_KEY_ARG:
		list_add(&options->inputs, value, state);
		return 0;
	case ARGP_KEY_END:
		if (!options->inputs.count)
			argp_error(state, "no input");
		if (!options->output)
			argp_error(state, "no output: give -o CITY.blvd");
		return 0;
	default:
		return parse_far_option(key, value, state);
	}
}

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.args_doc = "INPUT...",
	.doc = "Bakes map data into a city package.\vINPUT is .osm, .osm.pbf, .osm.gz, .osm.bz2 or CityJSON, or one "
		   "package, of which only the far field is made anew. "
		   "Exit status: 0 done, 1 failed, 2 wrong usage, 3 bad input.",
};

/* Everything a bake makes, so that one function frees it. */
struct bake {
	const struct bake_options *options;
	const char *output; /* without far field */
	struct report report;
	struct city city;
	struct graph_data graph;
	struct mesh_sink *ground, *buildings;
	lamp_array lamps;
	struct light_map light_map;
	struct materials materials;
	struct mesh_chunks mesh;
	struct text_data text;
	struct occluders occluders;
	bool show_progress;
};

/* Names the step on a terminal; returns its start. */
static int64_t step_begin(const struct bake *bake, const char *what)
{
	if (bake->show_progress)
		fprintf(stderr, "\r\033[K%s...", what);
	return clock_now_ns();
}

static void step_end(struct bake *bake, enum report_step step, int64_t started)
{
	bake->report.seconds[step] += (double)(clock_now_ns() - started) / 1e9;
	if (bake->show_progress)
		fprintf(stderr, "\r\033[K");
}

/* Buildings and textures need nothing of the ground: they run beside it. Their order in the package is fixed all the
 * same. */
static void *bake_buildings(void *context)
{
	struct bake *bake = context;
	struct pkg_graph graph = graph_view(&bake->graph);
	int64_t started = clock_now_ns();
	buildings_build(&bake->city, &graph, bake->buildings);
	bake->report.seconds[STEP_BUILDINGS] = (double)(clock_now_ns() - started) / 1e9;
	started = clock_now_ns();
	materials_paint(&bake->materials, bake->options->textures);
	bake->report.seconds[STEP_TEXTURES] = (double)(clock_now_ns() - started) / 1e9;
	return NULL;
}

static void bake_geometry(struct bake *bake)
{
	int64_t started = step_begin(bake, "streets, ground, buildings");
	struct pkg_graph graph = graph_view(&bake->graph);
	bake->ground = mesh_sink_new();
	bake->buildings = mesh_sink_new();
	pthread_t worker;
	bool threaded = pthread_create(&worker, NULL, bake_buildings, bake) == 0;
	ground_build(&bake->city, &graph, bake->ground, &bake->lamps);
	bake->report.seconds[STEP_GROUND] = (double)(clock_now_ns() - started) / 1e9;
	if (threaded)
		pthread_join(worker, NULL);
	else
		bake_buildings(bake);
	int64_t trees_started = step_begin(bake, "trees");
	trees_build(&bake->city, &graph, bake->buildings);
	step_end(bake, STEP_TREES, trees_started);
	mesh_append(bake->ground, bake->buildings);
	mesh_finish_chunks(bake->ground, &bake->mesh);
}

static int compare_strings(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Every string that may be drawn: street names and numbers, landmarks, the city, the credit. Sorted, each once. */
static int bake_text(struct bake *bake)
{
	ARRAY(const char *) strings = { 0 };
	for (size_t i = 0; i < bake->graph.names.count; i++)
		ARRAY_PUSH(&strings, bake->graph.names.items[i]);
	for (size_t i = 0; i < bake->city.buildings.count; i++)
		if (bake->city.buildings.items[i].landmark && bake->city.buildings.items[i].name)
			ARRAY_PUSH(&strings, bake->city.buildings.items[i].name);
	if (bake->city.name)
		ARRAY_PUSH(&strings, bake->city.name);
	if (bake->city.attribution)
		ARRAY_PUSH(&strings, bake->city.attribution);
	if (strings.count)
		qsort(strings.items, strings.count, sizeof(*strings.items), compare_strings);
	size_t kept = 0;
	for (size_t i = 0; i < strings.count; i++)
		if (strings.items[i][0] && (!kept || strcmp(strings.items[kept - 1], strings.items[i]) != 0))
			strings.items[kept++] = strings.items[i];
	struct list fonts = bake->options->fonts;
	if (!fonts.count)
		fonts.count = text_default_fonts(fonts.items, LIST_MAX);
	int status = text_bake(fonts.items, fonts.count, strings.items, kept, &bake->text);
	ARRAY_FINISH(&strings);
	return status;
}

static uint64_t hash_options(const struct bake_options *options)
{
	uint64_t hash = hash_u64(options->inputs.count + options->buildings.count * 16 + options->terrain.count * 256 +
							 ((uint64_t)options->textures << 32));
	for (int i = 0; i < 4; i++) {
		uint64_t bits;
		memcpy(&bits, &options->bounds[i], sizeof(bits));
		hash = hash_u64(hash ^ bits);
	}
	return hash;
}

static void count_results(struct bake *bake)
{
	uint64_t *counts = bake->report.counts;
	memset(counts, 0, sizeof(bake->report.counts));
	for (size_t i = 0; i < bake->city.buildings.count; i++)
		counts[bake->city.buildings.items[i].is_part ? COUNT_PARTS : COUNT_BUILDINGS]++;
	for (size_t i = 0; i < bake->city.ways.count; i++)
		counts[COUNT_DRIVABLE_WAYS] += bake->city.ways.items[i].drivable;
	counts[COUNT_WAYS] = bake->city.ways.count;
	counts[COUNT_TREES] = bake->city.trees.count;
	counts[COUNT_AREAS] = bake->city.areas.count;
	counts[COUNT_NODES] = bake->graph.nodes.count;
	counts[COUNT_EDGES] = bake->graph.edges.count;
	counts[COUNT_FACES] = bake->graph.faces.count;
	counts[COUNT_TRIANGLES] = bake->mesh.triangles;
	counts[COUNT_CHUNKS] = bake->mesh.chunks.count;
	counts[COUNT_RESTRICTIONS] = bake->graph.turns.count;
}

static int write_package(struct bake *bake)
{
	int64_t started = step_begin(bake, "writing");
	struct pkg_content content = {
		.city = &bake->city,
		.graph = &bake->graph,
		.mesh = &bake->mesh,
		.materials = &bake->materials,
		.light_map = &bake->light_map,
		.text = &bake->text,
		.occluders = &bake->occluders,
		.source_hash = hash_options(bake->options),
	};
	int status = pkg_write(bake->output, &content);
	step_end(bake, STEP_WRITE, started);
	return status;
}

static int run_steps(struct bake *bake)
{
	const struct bake_options *options = bake->options;
	struct read_options read = {
		.inputs = options->inputs.items,
		.input_count = options->inputs.count,
		.building_files = options->buildings.items,
		.building_file_count = options->buildings.count,
		.height_field = options->height_field,
		.terrain_files = options->terrain.items,
		.terrain_file_count = options->terrain.count,
		.bounds = options->bounded ? options->bounds : NULL,
		.name = options->name,
	};
	int64_t started = step_begin(bake, "reading");
	if (read_city(&bake->city, &read) < 0)
		return EXIT_BAD_INPUT;
	step_end(bake, STEP_READ, started);
	started = step_begin(bake, "heights");
	heights_infer(&bake->city);
	step_end(bake, STEP_HEIGHTS, started);
	started = step_begin(bake, "street graph");
	graph_build(&bake->city, &bake->graph);
	struct pkg_graph graph = graph_view(&bake->graph);
	blocks_assign(&bake->city, &graph);
	step_end(bake, STEP_GRAPH, started);
	bake_geometry(bake);
	started = step_begin(bake, "light");
	light_map_bake(&bake->city, &bake->lamps, &bake->light_map);
	if (options->textures == PKG_TEXTURE_ETC2_RGBA)
		light_map_pack(&bake->light_map);
	step_end(bake, STEP_LIGHT, started);
	started = step_begin(bake, "occluders");
	occluders_build(&bake->city, &bake->occluders);
	step_end(bake, STEP_OCCLUDERS, started);
	started = step_begin(bake, "text");
	if (bake_text(bake) < 0)
		return EXIT_BAD_INPUT;
	step_end(bake, STEP_TEXT, started);
	if (write_package(bake) < 0)
		return EXIT_FAILED;
	count_results(bake);
	if (options->report && report_write_json(&bake->report, options->report) < 0) {
		log_error("%s: cannot write the report", options->report);
		return EXIT_FAILED;
	}
	return EXIT_DONE;
}

static void finish(struct bake *bake)
{
	mesh_sink_free(bake->ground);
	mesh_sink_free(bake->buildings);
	ARRAY_FINISH(&bake->lamps);
	mesh_chunks_finish(&bake->mesh);
	light_map_finish(&bake->light_map);
	materials_finish(&bake->materials);
	text_data_finish(&bake->text);
	occluders_finish(&bake->occluders);
	graph_data_finish(&bake->graph);
	city_finish(&bake->city);
}

/* Everything but the far field, into `output`. */
static int bake_base(const struct bake_options *options, const char *output)
{
	static struct bake bake; /* large, and used once */
	bake = (struct bake){
		.options = options, .output = output, .show_progress = !options->quiet && isatty(STDERR_FILENO)
	};
	bake.city.report = &bake.report;
	int status = run_steps(&bake);
	if (status == EXIT_DONE && !options->quiet)
		report_print(&bake.report, stdout);
	finish(&bake);
	return status;
}

/* The far field from a package on disk, which may be the output itself. */
static int bake_far(const struct bake_options *options, const char *base)
{
	struct pkg pkg;
	struct pkg_fault fault;
	if (pkg_open(&pkg, base, &fault) < 0) {
		log_error("%s: byte %llu: %s", base, (unsigned long long)fault.offset, fault.text);
		return EXIT_BAD_INPUT;
	}
	bool wanted = options->far.cells.pvs || options->far.cells.impostor;
	int status = wanted ? far_bake(&pkg, options->output, &options->far) : far_strip(&pkg, options->output);
	pkg_close(&pkg);
	return status;
}

/* From map data: the package without far field waits beside the units, so that the output is replaced only once. */
static int bake_both(const struct bake_options *options)
{
	char folder[PATH_MAX], base[PATH_MAX];
	if (far_units_folder(&options->far, options->output, folder))
		return EXIT_FAILED;
	if (snprintf(base, sizeof(base), "%s/base.blvd", folder) >= (int)sizeof(base)) {
		log_error("%s: the name is too long", folder);
		return EXIT_FAILED;
	}
	int status = bake_base(options, base);
	if (status == EXIT_DONE)
		status = bake_far(options, base);
	unlink(base);
	if (!options->far.units)
		rmdir(folder); /* stays while it holds units of a bake that did not end */
	return status;
}

static bool is_package(const char *path)
{
	char magic[sizeof(PKG_MAGIC) - 1];
	FILE *file = fopen(path, "rb");
	bool is = file && fread(magic, 1, sizeof(magic), file) == sizeof(magic) && !memcmp(magic, PKG_MAGIC, sizeof(magic));
	if (file)
		fclose(file);
	return is;
}

int cmd_bake(int argc, char **argv)
{
	struct bake_options options = { .textures = PKG_TEXTURE_ETC2_RGBA };
	argp_parse(&parser, argc, argv, 0, NULL, &options);
	if (options.quiet)
		log_init("blvd", LOG_ERROR);
	options.far.quiet = options.quiet;
	if (options.inputs.count == 1 && is_package(options.inputs.items[0]))
		return bake_far(&options, options.inputs.items[0]);
	if (options.far.cells.pvs || options.far.cells.impostor)
		return bake_both(&options);
	return bake_base(&options, options.output);
}
