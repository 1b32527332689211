/* blvd inspect: what is in a package, as a table, as JSON, or as pictures. */
#include <argp.h>
#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "assets/pkg.h"
#include "assets/pkg_check.h"
#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/inspect/far_pictures.h"
#include "tools/inspect/far_table.h"
#include "tools/inspect/pictures.h"

struct inspect_options {
	const char *path, *pictures;
	bool json;
	long cell; /* -1: the whole package */
};

enum { OPT_JSON = 256, OPT_PNG, OPT_CELL };

static const struct argp_option option_table[] = {
	{ "cell", OPT_CELL, "N", 0, "one directed edge (half-edge N), with its cells", 0 },
	{ "json", OPT_JSON, NULL, 0, "print JSON", 0 },
	{ "png", OPT_PNG, "DIR", 0, "write pictures: street graph, light map, textures, glyphs; with --cell its impostors",
		0 },
	{ 0 },
};

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct inspect_options *options = state->input;
	char *end;
	switch (key) {
	case OPT_JSON:
		options->json = true;
		return 0;
	case OPT_PNG:
		options->pictures = value;
		return 0;
	case OPT_CELL:
		options->cell = strtol(value, &end, 10);
		if (*end || end == value || options->cell < 0)
			argp_error(state, "--cell wants a number from 0, not '%s'", value);
		return 0;
	case ARGP_KEY_ARG:
		if (options->path)
			argp_error(state, "one package at a time");
		options->path = value;
		return 0;
	case ARGP_KEY_END:
		if (!options->path)
			argp_error(state, "no package");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.args_doc = "CITY.blvd",
	.doc = "Tells what is in a package.",
};

static cJSON *describe_sections(const struct pkg *pkg)
{
	cJSON *out = cJSON_CreateArray();
	const struct pkg_section *sections;
	uint32_t count = pkg_sections(pkg, &sections);
	for (uint32_t i = 0; i < count; i++) {
		char tag[5];
		pkg_tag_text(sections[i].tag, tag);
		cJSON *section = cJSON_CreateObject();
		cJSON_AddStringToObject(section, "tag", tag);
		cJSON_AddNumberToObject(section, "elements", (double)(sections[i].bytes / sections[i].element_bytes));
		cJSON_AddNumberToObject(section, "bytes", (double)sections[i].bytes);
		cJSON_AddItemToArray(out, section);
	}
	return out;
}

static double street_km(const struct pkg *pkg)
{
	double sum = 0.0;
	for (uint32_t i = 0; i < pkg->graph.edge_count; i++)
		sum += pkg->graph.edges[i].length_mm / 1e6;
	return sum;
}

static void count_objects(const struct pkg *pkg, cJSON *out)
{
	static const char *const names[] = { "buildings", "trees", "ground", "water", "bridges", "tunnels", "furniture" };
	uint64_t objects[7] = { 0 }, triangles[7] = { 0 };
	for (uint32_t i = 0; i < pkg->object_count; i++) {
		const struct pkg_object *object = &pkg->objects[i];
		unsigned kind = object->kind < 7 ? object->kind : 6;
		objects[kind]++;
		triangles[kind] += (object->index_count[PKG_PASS_OPAQUE] + object->index_count[PKG_PASS_DECAL]) / 3;
	}
	for (int kind = 0; kind < 7; kind++) {
		cJSON *row = cJSON_AddObjectToObject(out, names[kind]);
		cJSON_AddNumberToObject(row, "objects", (double)objects[kind]);
		cJSON_AddNumberToObject(row, "triangles", (double)triangles[kind]);
	}
}

static cJSON *describe_package(const struct pkg *pkg)
{
	cJSON *out = cJSON_CreateObject();
	const struct pkg_meta *meta = pkg->meta;
	cJSON_AddStringToObject(out, "city", pkg_string(pkg, meta->city_name));
	cJSON_AddStringToObject(out, "attribution", pkg_string(pkg, meta->attribution));
	cJSON_AddNumberToObject(out, "latitude", meta->origin_lat_deg);
	cJSON_AddNumberToObject(out, "longitude", meta->origin_lon_deg);
	cJSON_AddNumberToObject(out, "width_m", (meta->max_mm[0] - (double)meta->min_mm[0]) / 1000.0);
	cJSON_AddNumberToObject(out, "height_m", (meta->max_mm[1] - (double)meta->min_mm[1]) / 1000.0);
	cJSON_AddNumberToObject(out, "file_bytes", (double)pkg->map.bytes.size);
	cJSON_AddNumberToObject(out, "resident_bound_bytes", (double)meta->resident_bound_bytes);
	cJSON_AddNumberToObject(out, "triangles", (double)meta->triangle_count);
	cJSON_AddNumberToObject(out, "chunks", pkg->chunk_count);
	cJSON_AddNumberToObject(out, "nodes", pkg->graph.node_count);
	cJSON_AddNumberToObject(out, "edges", pkg->graph.edge_count);
	cJSON_AddNumberToObject(out, "faces", pkg->graph.face_count);
	cJSON_AddNumberToObject(out, "forbidden_turns", pkg->graph.turn_count);
	cJSON_AddNumberToObject(out, "street_km", street_km(pkg));
	count_objects(pkg, cJSON_AddObjectToObject(out, "objects"));
	far_describe(pkg, out);
	cJSON_AddItemToObject(out, "sections", describe_sections(pkg));
	return out;
}

static cJSON *describe_cell(const struct pkg *pkg, uint32_t half)
{
	const struct pkg_edge *edge = &pkg->graph.edges[half / 2];
	const struct pkg_half *at = &pkg->graph.halves[half];
	cJSON *out = cJSON_CreateObject();
	cJSON_AddNumberToObject(out, "cell", half);
	cJSON_AddStringToObject(out, "street", pkg_string(pkg, edge->name));
	cJSON_AddNumberToObject(out, "way", (double)edge->source_id);
	cJSON_AddNumberToObject(out, "class", edge->street_class);
	cJSON_AddNumberToObject(out, "length_m", edge->length_mm / 1000.0);
	cJSON_AddNumberToObject(out, "width_m", edge->width_mm / 1000.0);
	cJSON_AddNumberToObject(out, "lanes", half % 2 ? edge->lanes_backward : edge->lanes_forward);
	cJSON_AddNumberToObject(out, "speed_kmh", edge->speed_kmh);
	cJSON_AddBoolToObject(out, "driven", edge->flags & (half % 2 ? PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD));
	cJSON_AddBoolToObject(out, "bridge", edge->flags & PKG_EDGE_BRIDGE);
	cJSON_AddBoolToObject(out, "tunnel", edge->flags & PKG_EDGE_TUNNEL);
	cJSON_AddNumberToObject(out, "from_node", at->origin);
	cJSON_AddNumberToObject(out, "to_node", pkg->graph.halves[half ^ 1].origin);
	cJSON_AddNumberToObject(out, "next", at->next);
	cJSON_AddNumberToObject(out, "face", at->face);
	cJSON_AddNumberToObject(out, "face_area_m2", pkg->graph.faces[at->face].area_m2);
	far_describe_half(pkg, half, out);
	return out;
}

/* An object of nothing but plain values: one line. */
static bool is_row(const cJSON *item)
{
	if (!cJSON_IsObject(item) || !item->child)
		return false;
	for (const cJSON *field = item->child; field; field = field->next)
		if (cJSON_IsObject(field) || cJSON_IsArray(field))
			return false;
	return true;
}

/* "key: value" lines, objects indented, arrays of objects one line each. */
static void print_table(const cJSON *object, int indent)
{
	for (const cJSON *item = object->child; item; item = item->next) {
		const char *key = item->string ? item->string : "";
		if (is_row(item)) {
			printf("%*s%-22s", indent, "", key);
			for (const cJSON *field = item->child; field; field = field->next) {
				if (cJSON_IsString(field))
					printf(" %-8s", field->valuestring);
				else
					printf(" %s %.15g", field->string, field->valuedouble);
			}
			putchar('\n');
		} else if (cJSON_IsObject(item) || cJSON_IsArray(item)) {
			printf("%*s%s\n", indent, "", key);
			print_table(item, indent + 2);
		} else if (cJSON_IsString(item)) {
			printf("%*s%-22s %s\n", indent, "", key, item->valuestring);
		} else if (cJSON_IsBool(item)) {
			printf("%*s%-22s %s\n", indent, "", key, cJSON_IsTrue(item) ? "yes" : "no");
		} else {
			printf("%*s%-22s %.15g\n", indent, "", key, item->valuedouble);
		}
	}
}

static int print(cJSON *about, bool json)
{
	if (json) {
		char *text = cJSON_Print(about);
		puts(text ? text : "{}");
		cJSON_free(text);
	} else {
		print_table(about, 0);
	}
	cJSON_Delete(about);
	return EXIT_DONE;
}

static int draw(const struct pkg *pkg, const struct inspect_options *options)
{
	if (mkdir(options->pictures, 0777) < 0 && errno != EEXIST) {
		log_error("%s: %s", options->pictures, strerror(errno));
		return EXIT_FAILED;
	}
	int err = options->cell < 0 ? inspect_pictures(pkg, options->pictures)
								: far_pictures(pkg, (uint32_t)options->cell, options->pictures);
	return err < 0 ? EXIT_FAILED : EXIT_DONE;
}

static int inspect(const struct pkg *pkg, const struct inspect_options *options)
{
	if (options->cell >= 0 && (uint64_t)options->cell >= pkg->graph.half_count) {
		log_error("%s has the cells 0 to %u, not %ld", options->path, pkg->graph.half_count - 1, options->cell);
		return EXIT_USAGE;
	}
	if (options->pictures)
		return draw(pkg, options);
	if (options->cell < 0)
		return print(describe_package(pkg), options->json);
	return print(describe_cell(pkg, (uint32_t)options->cell), options->json);
}

int cmd_inspect(int argc, char **argv)
{
	struct inspect_options options = { .cell = -1 };
	argp_parse(&parser, argc, argv, 0, NULL, &options);
	struct pkg pkg;
	struct pkg_fault fault;
	if (pkg_open(&pkg, options.path, &fault) < 0) {
		log_error("%s: byte %llu: %s", options.path, (unsigned long long)fault.offset, fault.text);
		return EXIT_BAD_INPUT;
	}
	int status = inspect(&pkg, &options);
	pkg_close(&pkg);
	return status;
}
