#include "tools/city/report.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/city/city.h"

static const char *const fault_names[FAULT_KIND_COUNT] = {
	[FAULT_MISSING_NODE] = "missing_node",
	[FAULT_MISSING_MEMBER] = "missing_member",
	[FAULT_OPEN_RING] = "open_ring",
	[FAULT_SELF_CROSSING] = "self_crossing",
	[FAULT_DUPLICATE_NODE] = "duplicate_node",
	[FAULT_DEGENERATE_RING] = "degenerate_ring",
	[FAULT_DEGENERATE_WAY] = "degenerate_way",
	[FAULT_BAD_NUMBER] = "bad_number",
	[FAULT_BAD_COLOUR] = "bad_colour",
	[FAULT_MISSING_HEIGHT] = "missing_height",
	[FAULT_HEIGHT_ORDER] = "height_order",
	[FAULT_OVERLAPPING_BUILDING] = "overlapping_building",
	[FAULT_PART_WITHOUT_OUTLINE] = "part_without_outline",
	[FAULT_PARTS_INCOMPLETE] = "parts_incomplete",
	[FAULT_STREET_THROUGH_BUILDING] = "street_through_building",
	[FAULT_BUILDING_IN_STREET] = "building_in_street",
	[FAULT_CROSSING_WITHOUT_NODE] = "crossing_without_node",
	[FAULT_NEAR_MISS_NODE] = "near_miss_node",
	[FAULT_DUPLICATE_EDGE] = "duplicate_edge",
	[FAULT_UNCONNECTED_STREET] = "unconnected_street",
	[FAULT_RESTRICTION] = "restriction",
	[FAULT_BRIDGE_PROFILE] = "bridge_profile",
	[FAULT_TERRAIN_VOID] = "terrain_void",
	[FAULT_BAD_GEOMETRY] = "bad_geometry",
	[FAULT_BAD_STRING] = "bad_string",
};

static const char *const element_names[ELEMENT_KIND_COUNT] = { "nodes", "ways", "relations", "features" };
static const char *const height_names[HEIGHT_SOURCE_COUNT] = { "tagged", "levels", "parts", "neighbours", "kind" };
static const char *const count_names[COUNT_KINDS] = { "buildings", "parts", "ways", "drivable_ways", "trees", "areas",
	"nodes", "edges", "faces", "triangles", "chunks", "restrictions" };
static const char *const step_names[STEP_KINDS] = { "read", "heights", "graph", "ground", "buildings", "trees",
	"textures", "light", "occluders", "text", "write" };

void report_fault(struct report *report, enum fault_kind kind, enum fault_outcome outcome, int64_t id)
{
	if (!report->faults[kind][FAULT_MENDED] && !report->faults[kind][FAULT_DROPPED])
		report->first_id[kind] = id;
	report->faults[kind][outcome]++;
}

/* "missing_node" for people. */
static void print_words(FILE *to, const char *name, int width)
{
	int printed = 0;
	for (; name[printed]; printed++)
		fputc(name[printed] == '_' ? ' ' : name[printed], to);
	fprintf(to, "%*s", width > printed ? width - printed : 1, "");
}

static void print_elements(const struct report *report, FILE *to)
{
	fprintf(to, "%-24s %10s %10s %10s %10s\n", "read", "total", "used", "faulty", "ignored");
	for (int kind = 0; kind < ELEMENT_KIND_COUNT; kind++) {
		const uint64_t *fates = report->elements[kind];
		uint64_t total = fates[ELEMENT_USED] + fates[ELEMENT_FAULTY] + fates[ELEMENT_IGNORED];
		if (total)
			fprintf(to, "%-24s %10" PRIu64 " %10" PRIu64 " %10" PRIu64 " %10" PRIu64 "\n", element_names[kind], total,
				fates[ELEMENT_USED], fates[ELEMENT_FAULTY], fates[ELEMENT_IGNORED]);
	}
}

static void print_faults(const struct report *report, FILE *to)
{
	uint64_t sum[2] = { 0, 0 };
	fprintf(to, "\n%-24s %10s %10s %10s  first id\n", "faults", "found", "mended", "dropped");
	for (int kind = 0; kind < FAULT_KIND_COUNT; kind++) {
		uint64_t mended = report->faults[kind][FAULT_MENDED], dropped = report->faults[kind][FAULT_DROPPED];
		if (!mended && !dropped)
			continue;
		print_words(to, fault_names[kind], 25);
		fprintf(to, "%10" PRIu64 " %10" PRIu64 " %10" PRIu64 "  %" PRId64 "\n", (mended + dropped), mended, dropped,
			report->first_id[kind]);
		sum[0] += mended;
		sum[1] += dropped;
	}
	fprintf(to, "%-24s %10" PRIu64 " %10" PRIu64 " %10" PRIu64 "\n", "all", (sum[0] + sum[1]), sum[0], sum[1]);
}

static void print_list(FILE *to, const char *title, const char *const *names, const uint64_t *values, int count)
{
	fprintf(to, "\n%s\n", title);
	for (int i = 0; i < count; i++) {
		if (!values[i])
			continue;
		print_words(to, names[i], 25);
		fprintf(to, "%10" PRIu64 "\n", values[i]);
	}
}

void report_print(const struct report *report, FILE *to)
{
	print_elements(report, to);
	print_faults(report, to);
	print_list(to, "heights from", height_names, report->heights, HEIGHT_SOURCE_COUNT);
	print_list(to, "made", count_names, report->counts, COUNT_KINDS);
	fprintf(to, "\nseconds\n");
	for (int i = 0; i < STEP_KINDS; i++)
		if (report->seconds[i] > 0.0)
			fprintf(to, "%-24s %10.2f\n", step_names[i], report->seconds[i]);
}

static void add_elements(cJSON *root, const struct report *report)
{
	cJSON *elements = cJSON_AddObjectToObject(root, "elements");
	for (int kind = 0; kind < ELEMENT_KIND_COUNT; kind++) {
		const uint64_t *fates = report->elements[kind];
		cJSON *element = cJSON_AddObjectToObject(elements, element_names[kind]);
		cJSON_AddNumberToObject(
			element, "read", (double)(fates[ELEMENT_USED] + fates[ELEMENT_FAULTY] + fates[ELEMENT_IGNORED]));
		cJSON_AddNumberToObject(element, "used", (double)fates[ELEMENT_USED]);
		cJSON_AddNumberToObject(element, "dropped", (double)fates[ELEMENT_FAULTY]);
		cJSON_AddNumberToObject(element, "ignored", (double)fates[ELEMENT_IGNORED]);
	}
}

static void add_faults(cJSON *root, const struct report *report)
{
	cJSON *faults = cJSON_AddObjectToObject(root, "faults");
	for (int kind = 0; kind < FAULT_KIND_COUNT; kind++) {
		uint64_t mended = report->faults[kind][FAULT_MENDED], dropped = report->faults[kind][FAULT_DROPPED];
		cJSON *fault = cJSON_AddObjectToObject(faults, fault_names[kind]);
		cJSON_AddNumberToObject(fault, "found", (double)(mended + dropped));
		cJSON_AddNumberToObject(fault, "mended", (double)mended);
		cJSON_AddNumberToObject(fault, "dropped", (double)dropped);
		if (mended || dropped) { /* ids reach beyond what a double holds */
			char id[24];
			snprintf(id, sizeof(id), "%" PRId64, report->first_id[kind]);
			cJSON_AddRawToObject(fault, "first_id", id);
		}
	}
}

static char *to_json(const struct report *report)
{
	cJSON *root = cJSON_CreateObject();
	add_elements(root, report);
	add_faults(root, report);
	cJSON *heights = cJSON_AddObjectToObject(root, "heights");
	for (int i = 0; i < HEIGHT_SOURCE_COUNT; i++)
		cJSON_AddNumberToObject(heights, height_names[i], (double)report->heights[i]);
	cJSON *counts = cJSON_AddObjectToObject(root, "counts");
	for (int i = 0; i < COUNT_KINDS; i++)
		cJSON_AddNumberToObject(counts, count_names[i], (double)report->counts[i]);
	cJSON *seconds = cJSON_AddObjectToObject(root, "seconds");
	for (int i = 0; i < STEP_KINDS; i++)
		cJSON_AddNumberToObject(seconds, step_names[i], report->seconds[i]);
	char *text = cJSON_Print(root);
	cJSON_Delete(root);
	return text;
}

static int write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "we");
	if (!file)
		return -errno;
	int status = fputs(text, file) < 0 || fputc('\n', file) == EOF || fflush(file) ? -errno : 0;
	if (!status && fsync(fileno(file)) < 0 && errno != EINVAL) /* EINVAL: a pipe or the like */
		status = -errno;
	if (fclose(file) && !status)
		status = -errno;
	return status;
}

int report_write_json(const struct report *report, const char *path)
{
	char *text = to_json(report);
	size_t length = strlen(path);
	char *part = malloc(length + 6);
	if (!text || !part) {
		cJSON_free(text);
		free(part);
		return -ENOMEM;
	}
	memcpy(part, path, length);
	memcpy(part + length, ".part", 6);
	int status = write_file(part, text);
	if (!status && rename(part, path) < 0)
		status = -errno;
	if (status)
		unlink(part);
	cJSON_free(text);
	free(part);
	return status;
}
