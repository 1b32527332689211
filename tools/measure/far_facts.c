/* What a package holds for the far field, from its sections alone. */
#include <errno.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/measure/tradeoff.h"

static int compare(const void *left, const void *right)
{
	double a = *(const double *)left, b = *(const double *)right;
	return (a > b) - (a < b);
}

static double quantile(const double *sorted, size_t count, double share)
{
	size_t at = (size_t)ceil(share * (double)count);
	return sorted[at ? at - 1 : 0];
}

struct spread spread_of(double *values, size_t count)
{
	struct spread out = { 0 };
	if (!count)
		return out;
	qsort(values, count, sizeof(*values), compare);
	for (size_t i = 0; i < count; i++)
		out.mean += values[i] / (double)count;
	out.median = quantile(values, count, 0.5);
	out.p95 = quantile(values, count, 0.95);
	out.p99 = quantile(values, count, 0.99);
	out.p999 = quantile(values, count, 0.999);
	out.max = values[count - 1];
	return out;
}

/* The visible set counts only where a cell is drawn from it; in other cells it is there for comparison. */
static double half_bytes(const struct pkg *pkg, uint32_t half)
{
	double sum = 0.0;
	for (uint32_t i = pkg->first_stretch[half / 2]; i < pkg->first_stretch[half / 2 + 1]; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		const struct pkg_cell *cells = &pkg->cells[(size_t)2 * i];
		bool needs_set = cells[0].kind == PKG_CELL_GEOMETRY || cells[1].kind == PKG_CELL_GEOMETRY;
		sum += (double)cells[half & 1].impostor.stored_bytes + stretch->local.stored_bytes / 2.0 +
			   (needs_set ? stretch->pvs.stored_bytes / 2.0 : 0.0);
	}
	return sum;
}

static void count_edges(struct far_facts *facts, const struct pkg *pkg)
{
	ARRAY(double) bytes = { 0 };
	for (uint32_t edge = 0; pkg->stretches && edge < pkg->graph.edge_count; edge++) {
		if (pkg->first_stretch[edge] == pkg->first_stretch[edge + 1])
			continue;
		for (uint32_t half = 2 * edge; half <= 2 * edge + 1; half++)
			ARRAY_PUSH(&bytes, half_bytes(pkg, half));
	}
	struct spread spread = spread_of(bytes.items, bytes.count);
	facts->directed_edges = (uint32_t)bytes.count;
	facts->edge_bytes_median = spread.median;
	facts->edge_bytes_mean = spread.mean;
	ARRAY_FINISH(&bytes);
}

static void count_cells(struct far_facts *facts, const struct pkg *pkg)
{
	ARRAY(double) triangles = { 0 };
	facts->cells = pkg->stretches ? 2 * pkg->stretch_count : 0;
	for (uint32_t i = 0; i < facts->cells; i++) {
		const struct pkg_cell *cell = &pkg->cells[i];
		facts->geometry_cells += cell->kind == PKG_CELL_GEOMETRY;
		facts->relaxed_cells += cell->reason == PKG_REASON_TAU_RELAXED;
		if (cell->kind == PKG_CELL_IMPOSTOR)
			ARRAY_PUSH(&triangles, cell->index_count / 3.0);
	}
	facts->impostor_cells = (uint32_t)triangles.count;
	facts->cell_triangles = spread_of(triangles.items, triangles.count);
	ARRAY_FINISH(&triangles);
}

int far_facts_read(struct far_facts *facts, const char *package)
{
	*facts = (struct far_facts){ 0 };
	struct pkg pkg;
	struct pkg_fault fault = { 0 };
	int status = pkg_open(&pkg, package, &fault);
	if (status < 0) {
		log_error("%s: %s", package, status == -EBADMSG ? fault.text : strerror(-status));
		return -EBADMSG;
	}
	facts->package_bytes = pkg.map.bytes.size;
	facts->far_bytes = pkg.blobs_bytes;
	facts->resident_bound_bytes = pkg.meta->resident_bound_bytes;
	for (uint32_t i = 0; i < pkg.chunk_count; i++)
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			facts->triangles += pkg.chunks[i].index_count[pass] / 3;
	for (uint32_t i = 0; i < pkg.graph.edge_count; i++)
		facts->street_km += pkg.graph.edges[i].length_mm * 1e-6;
	count_edges(facts, &pkg);
	count_cells(facts, &pkg);
	pkg_close(&pkg);
	return 0;
}
