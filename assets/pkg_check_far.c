/*
 * Range checks of the far field's tables: where each stretch lies on its edge, which bytes its blobs have, how large
 * they may become. What is inside a blob is checked when it is read (cells.h). Linear in the number of stretches.
 */
#include <errno.h>
#include <math.h>

#include "assets/pkg_check.h"

#define UNPACK_RATIO_MAX 8192u /* LZMA's longest match is 273 bytes and never takes less than a quarter of a bit */
#define EDGE_SLACK_MM 1000u

int pkg_check_far_counts(const struct pkg *pkg, uint64_t index_count, uint64_t cell_count, struct pkg_fault *fault)
{
	if (!pkg->stretches != !pkg->first_stretch || !pkg->stretches != !pkg->cells)
		return pkg_fail(fault, 0, "of the sections STRC, CIDX, CELL and CELD only some are there");
	if (!pkg->stretches)
		return 0;
	if (index_count != (uint64_t)pkg->graph.edge_count + 1)
		return pkg_fail(fault, pkg_offset_of(pkg, pkg->first_stretch), "section CIDX: %llu elements for %u edges",
			(unsigned long long)index_count, pkg->graph.edge_count);
	if (cell_count != 2 * (uint64_t)pkg->stretch_count || pkg->stretch_count > PKG_NONE / 2)
		return pkg_fail(fault, pkg_offset_of(pkg, pkg->cells), "section CELL: %llu elements for %u stretches",
			(unsigned long long)cell_count, pkg->stretch_count);
	return 0;
}

/* Stored bytes inside CELD, and a size after inflating that they can have and that what they hold can need. */
static bool blob_fits(const struct pkg *pkg, const struct pkg_blob *blob, uint64_t raw_min, uint64_t raw_max)
{
	if (!blob->stored_bytes)
		return !blob->raw_bytes;
	return blob->offset % PKG_BLOB_ALIGN == 0 && pkg_run_fits(blob->offset, blob->stored_bytes, pkg->blobs_bytes) &&
		   blob->raw_bytes >= raw_min && blob->raw_bytes <= raw_max &&
		   blob->raw_bytes <= (uint64_t)blob->stored_bytes * UNPACK_RATIO_MAX;
}

/* A set of these triangles at most: every object may be in it with a mask of whole bytes. */
static bool set_fits(const struct pkg *pkg, const struct pkg_blob *blob, uint64_t triangles)
{
	uint64_t objects = pkg->object_count < triangles ? pkg->object_count : triangles;
	uint64_t raw_max =
		sizeof(struct pkg_set_head) + objects * (sizeof(struct pkg_set_object) + 1) + pkg->meta->triangle_count / 8;
	return blob_fits(pkg, blob, sizeof(struct pkg_set_head), raw_max);
}

static int check_stretch(const struct pkg *pkg, uint32_t index, struct pkg_fault *fault)
{
	const struct pkg_stretch *stretch = &pkg->stretches[index];
	const uint64_t triangles = pkg->meta->triangle_count;
	PKG_CHECK(stretch->from_mm <= stretch->to_mm, stretch, "STRC", index, "ends before it begins");
	PKG_CHECK(stretch->eye_min_mm <= stretch->eye_max_mm, stretch, "STRC", index, "eye heights are inside out");
	PKG_CHECK(stretch->local_triangles <= stretch->near_triangles && stretch->near_triangles <= triangles &&
				  stretch->pvs_triangles <= triangles,
		stretch, "STRC", index, "more triangles than there are");
	PKG_CHECK(
		set_fits(pkg, &stretch->local, stretch->local_triangles), stretch, "STRC", index, "local set out of range");
	PKG_CHECK(set_fits(pkg, &stretch->pvs, stretch->pvs_triangles), stretch, "STRC", index, "visible set out of range");
	return 0;
}

static int check_index(const struct pkg *pkg, struct pkg_fault *fault)
{
	const uint32_t *first = pkg->first_stretch;
	PKG_CHECK(first[0] == 0 && first[pkg->graph.edge_count] == pkg->stretch_count, first, "CIDX", 0,
		"does not cover the stretches");
	for (uint32_t e = 0; e < pkg->graph.edge_count; e++) {
		PKG_CHECK(first[e] <= first[e + 1] && first[e + 1] <= pkg->stretch_count, &first[e], "CIDX", e, "not sorted");
		for (uint32_t i = first[e]; i < first[e + 1]; i++) {
			const struct pkg_stretch *stretch = &pkg->stretches[i];
			PKG_CHECK(stretch->edge == e, stretch, "STRC", i, "belongs to another edge");
			PKG_CHECK(stretch->from_mm == (i == first[e] ? 0 : stretch[-1].to_mm), stretch, "STRC", i,
				"leaves a gap on its edge");
		}
	}
	return 0;
}

static bool good_number(float value)
{
	return isfinite(value) && value >= 0.0f;
}

static int check_cell(const struct pkg *pkg, uint32_t index, struct pkg_fault *fault)
{
	const struct pkg_cell *cell = &pkg->cells[index];
	PKG_CHECK(cell->kind < PKG_CELL_KIND_COUNT && cell->reason < PKG_REASON_COUNT, cell, "CELL", index,
		"unknown kind or reason");
	PKG_CHECK(good_number(cell->tau_px) && good_number(cell->error_px) && good_number(cell->over_share), cell, "CELL",
		index, "accuracy is no number");
	bool drawn = cell->kind == PKG_CELL_IMPOSTOR;
	PKG_CHECK(drawn == (cell->impostor.stored_bytes != 0), cell, "CELL", index, "kind and impostor do not match");
	PKG_CHECK(cell->vertex_count <= 65535 && cell->index_count % 3 == 0 && cell->page_count <= 256, cell, "CELL", index,
		"too much in it");
	uint64_t least = sizeof(struct pkg_impostor_head) +
					 (uint64_t)cell->vertex_count * sizeof(struct pkg_impostor_vertex) +
					 (uint64_t)cell->index_count * sizeof(uint16_t) + (uint64_t)cell->page_count * PKG_PAGE_BYTES;
	uint64_t most = least + PKG_IMPOSTOR_VIEWS_MAX * sizeof(struct pkg_impostor_view) + 15;
	PKG_CHECK(blob_fits(pkg, &cell->impostor, least, most), cell, "CELL", index, "impostor out of range");
	uint64_t truth = (uint64_t)cell->page_count * PKG_PAGE_PX * PKG_PAGE_PX * sizeof(struct pkg_truth_texel);
	PKG_CHECK(blob_fits(pkg, &cell->truth, truth, truth), cell, "CELL", index, "truth out of range");
	return 0;
}

int pkg_check_far(const struct pkg *pkg, struct pkg_fault *fault)
{
	if (!pkg->stretches)
		return 0;
	int status = check_index(pkg, fault);
	for (uint32_t i = 0; i < pkg->stretch_count && !status; i++)
		status = check_stretch(pkg, i, fault);
	for (uint32_t i = 0; i < 2 * pkg->stretch_count && !status; i++)
		status = check_cell(pkg, i, fault);
	return status;
}

/* `end`: of the blobs before it, in CELD. */
static int verify_blob(const struct pkg *pkg, const struct pkg_blob *blob, uint64_t *end, struct pkg_fault *fault)
{
	if (!blob->stored_bytes)
		return 0;
	uint64_t base = pkg_offset_of(pkg, pkg->blobs);
	if (blob->offset < *end || blob->offset - *end >= PKG_BLOB_ALIGN)
		return pkg_fail(fault, pkg_offset_of(pkg, blob), "section CELD: a blob at %llu after an end at %llu",
			(unsigned long long)blob->offset, (unsigned long long)*end);
	int status = pkg_verify_padding(pkg, base + *end, base + blob->offset, fault);
	if (status < 0)
		return status;
	if (pkg_crc32(0, pkg->blobs + blob->offset, blob->stored_bytes) != blob->crc32)
		return pkg_fail(fault, base + blob->offset, "section CELD: a blob's checksum is wrong");
	*end = blob->offset + blob->stored_bytes;
	return 0;
}

static int verify_stretch(const struct pkg *pkg, uint32_t index, uint64_t *end, struct pkg_fault *fault)
{
	const struct pkg_stretch *stretch = &pkg->stretches[index];
	const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)index];
	const struct pkg_blob *const blobs[] = { &stretch->local, &stretch->pvs, &cells[0].impostor, &cells[0].truth,
		&cells[1].impostor, &cells[1].truth };
	int status = 0;
	for (size_t i = 0; i < sizeof(blobs) / sizeof(blobs[0]) && !status; i++)
		status = verify_blob(pkg, blobs[i], end, fault);
	if (status < 0)
		return status;
	bool geometry = cells[0].kind == PKG_CELL_GEOMETRY || cells[1].kind == PKG_CELL_GEOMETRY;
	PKG_CHECK(!geometry || stretch->pvs.stored_bytes, stretch, "STRC", index,
		"a cell is drawn from a set that is not stored");
	PKG_CHECK(!stretch->local_triangles || stretch->local.stored_bytes, stretch, "STRC", index, "has no local set");
	bool last = index + 1 == pkg->first_stretch[stretch->edge + 1];
	PKG_CHECK(!last || stretch->to_mm + EDGE_SLACK_MM >= pkg->graph.edges[stretch->edge].length_mm, stretch, "STRC",
		index, "ends before its edge");
	return 0;
}

int pkg_verify_far(const struct pkg *pkg, struct pkg_fault *fault)
{
	if (!pkg->stretches)
		return 0;
	uint64_t end = 0;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		int status = verify_stretch(pkg, i, &end, fault);
		if (status < 0)
			return status;
	}
	uint64_t base = pkg_offset_of(pkg, pkg->blobs);
	return pkg_verify_padding(pkg, base + end, base + pkg->blobs_bytes, fault);
}
