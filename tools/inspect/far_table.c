#include "tools/inspect/far_table.h"

#include <stdio.h>

#include "tools/city/pool.h"

static const char *const kind_names[] = { "nothing", "geometry", "impostor" };
static const char *const reason_names[] = { "none_in_view", "fewer_triangles", "error_too_large", "impostor_cheaper",
	"tau_relaxed" };
static_assert(sizeof(kind_names) / sizeof(kind_names[0]) == PKG_CELL_KIND_COUNT, "a name each");
static_assert(sizeof(reason_names) / sizeof(reason_names[0]) == PKG_REASON_COUNT, "a name each");

typedef ARRAY(double) values;

static int compare(const void *left, const void *right)
{
	double a = *(const double *)left, b = *(const double *)right;
	return (a > b) - (a < b);
}

static double round_to(double value, double step)
{
	return (double)(int64_t)(value / step + 0.5) * step;
}

/* Median, 99th percentile, largest and mean; frees the values. */
static void add_spread(cJSON *out, const char *name, values *of)
{
	double sum = 0.0;
	ARRAY_SORT(of, compare);
	for (size_t i = 0; i < of->count; i++)
		sum += of->items[i];
	if (of->count) {
		cJSON *row = cJSON_AddObjectToObject(out, name);
		size_t last = of->count - 1;
		cJSON_AddNumberToObject(row, "median", round_to(of->items[last / 2], 1e-4));
		cJSON_AddNumberToObject(row, "p99", round_to(of->items[(size_t)((double)last * 0.99)], 1e-4));
		cJSON_AddNumberToObject(row, "max", round_to(of->items[last], 1e-4));
		cJSON_AddNumberToObject(row, "mean", round_to(sum / (double)of->count, 1e-4));
	}
	ARRAY_FINISH(of);
}

static double cell_kib(const struct pkg_cell *cell)
{
	return cell->impostor.stored_bytes / 1024.0;
}

/* Bytes of a directed edge: its cells, and half of what its stretches share with the other direction. */
static double half_kib(const struct pkg *pkg, uint32_t half)
{
	double sum = 0.0;
	for (uint32_t i = pkg->first_stretch[half / 2]; i < pkg->first_stretch[half / 2 + 1]; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		sum += ((double)stretch->local.stored_bytes + stretch->pvs.stored_bytes) / 2048.0;
		sum += cell_kib(&pkg->cells[far_cell_of(i, half)]);
	}
	return sum;
}

static void describe_kinds(const struct pkg *pkg, cJSON *out)
{
	uint64_t counts[PKG_CELL_KIND_COUNT][PKG_REASON_COUNT] = { 0 };
	for (uint32_t i = 0; i < 2 * pkg->stretch_count; i++)
		counts[pkg->cells[i].kind][pkg->cells[i].reason]++;
	cJSON *kinds = cJSON_AddObjectToObject(out, "cells");
	for (int kind = 0; kind < PKG_CELL_KIND_COUNT; kind++) {
		cJSON *row = cJSON_AddObjectToObject(kinds, kind_names[kind]);
		uint64_t sum = 0;
		for (int reason = 0; reason < PKG_REASON_COUNT; reason++)
			sum += counts[kind][reason];
		cJSON_AddNumberToObject(row, "cells", (double)sum);
		for (int reason = 0; reason < PKG_REASON_COUNT; reason++)
			if (counts[kind][reason])
				cJSON_AddNumberToObject(row, reason_names[reason], (double)counts[kind][reason]);
	}
}

static void describe_cells(const struct pkg *pkg, cJSON *out)
{
	values triangles = { 0 }, kib = { 0 }, pages = { 0 }, error = { 0 }, over = { 0 }, seen = { 0 }, split = { 0 };
	for (uint32_t i = 0; i < 2 * pkg->stretch_count; i++) {
		const struct pkg_cell *cell = &pkg->cells[i];
		if (cell->kind == PKG_CELL_GEOMETRY)
			ARRAY_PUSH(&seen, cell->seen_triangles);
		if (cell->kind != PKG_CELL_IMPOSTOR)
			continue;
		ARRAY_PUSH(&triangles, cell->index_count / 3);
		ARRAY_PUSH(&kib, cell_kib(cell));
		ARRAY_PUSH(&pages, cell->page_count);
		ARRAY_PUSH(&error, cell->error_px);
		ARRAY_PUSH(&over, cell->over_share);
		ARRAY_PUSH(&split, cell->split_mm * 1e-3);
	}
	add_spread(out, "impostor_triangles", &triangles);
	add_spread(out, "impostor_kib", &kib);
	add_spread(out, "impostor_pages", &pages);
	add_spread(out, "error_px", &error);
	add_spread(out, "over_share", &over);
	add_spread(out, "split_m", &split);
	add_spread(out, "geometry_triangles", &seen);
}

static void describe_stretches(const struct pkg *pkg, cJSON *out)
{
	values length = { 0 }, local = { 0 }, kept = { 0 }, pvs = { 0 }, halves = { 0 };
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		ARRAY_PUSH(&length, (stretch->to_mm - stretch->from_mm) * 1e-3);
		ARRAY_PUSH(&local, stretch->local_triangles);
		ARRAY_PUSH(&pvs, stretch->pvs_triangles);
		if (stretch->near_triangles)
			ARRAY_PUSH(&kept, stretch->local_triangles / (double)stretch->near_triangles);
	}
	for (uint32_t half = 0; half < pkg->graph.half_count; half++)
		if (pkg->first_stretch[half / 2] < pkg->first_stretch[half / 2 + 1])
			ARRAY_PUSH(&halves, half_kib(pkg, half));
	add_spread(out, "stretch_m", &length);
	add_spread(out, "local_triangles", &local);
	add_spread(out, "local_share_kept", &kept);
	add_spread(out, "pvs_triangles", &pvs);
	add_spread(out, "directed_edge_kib", &halves);
}

void far_describe(const struct pkg *pkg, cJSON *out)
{
	if (!pkg->stretches)
		return;
	cJSON *table = cJSON_AddObjectToObject(out, "far_field");
	cJSON_AddNumberToObject(table, "stretches", pkg->stretch_count);
	cJSON_AddNumberToObject(table, "bytes", (double)pkg->blobs_bytes);
	describe_stretches(pkg, table);
	describe_kinds(pkg, table);
	describe_cells(pkg, table);
}

static void describe_one(const struct pkg *pkg, uint32_t index, uint32_t half, cJSON *rows)
{
	const struct pkg_stretch *stretch = &pkg->stretches[index];
	const struct pkg_cell *cell = &pkg->cells[far_cell_of(index, half)];
	cJSON *row = cJSON_CreateObject();
	cJSON_AddItemToArray(rows, row);
	cJSON_AddNumberToObject(row, "stretch", index);
	cJSON_AddNumberToObject(row, "from_m", stretch->from_mm * 1e-3);
	cJSON_AddNumberToObject(row, "to_m", stretch->to_mm * 1e-3);
	cJSON_AddStringToObject(row, "kind", kind_names[cell->kind]);
	cJSON_AddStringToObject(row, "reason", reason_names[cell->reason]);
	cJSON_AddNumberToObject(row, "local_triangles", stretch->local_triangles);
	cJSON_AddNumberToObject(row, "near_triangles", stretch->near_triangles);
	cJSON_AddNumberToObject(row, "seen_triangles", cell->seen_triangles);
	if (cell->kind != PKG_CELL_IMPOSTOR)
		return;
	cJSON_AddNumberToObject(row, "triangles", cell->index_count / 3);
	cJSON_AddNumberToObject(row, "pages", cell->page_count);
	cJSON_AddNumberToObject(row, "kib", round_to(cell_kib(cell), 0.1));
	cJSON_AddNumberToObject(row, "error_px", round_to(cell->error_px, 1e-3));
	cJSON_AddNumberToObject(row, "over_share", round_to(cell->over_share, 1e-5));
	cJSON_AddNumberToObject(row, "split_m", round_to(cell->split_mm * 1e-3, 0.1));
}

void far_describe_half(const struct pkg *pkg, uint32_t half, cJSON *out)
{
	if (!pkg->stretches)
		return;
	uint32_t from = pkg->first_stretch[half / 2], to = pkg->first_stretch[half / 2 + 1];
	cJSON *rows = cJSON_AddArrayToObject(out, "cells");
	for (uint32_t i = from; i < to; i++)
		describe_one(pkg, half & 1 ? to - 1 - (i - from) : i, half, rows);
}
