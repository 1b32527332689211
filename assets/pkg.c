/*
 * Opening a package: the header and table are checked first, then every section's checksum, then pkg_check.c walks the
 * values. GEOM and CELD are left alone until their chunks and blobs are used. Cost: one pass over all but these, about
 * 1 ms a MiB.
 */
#include "assets/pkg.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "assets/height_grid.h"
#include "assets/pkg_check.h"

int pkg_fail(struct pkg_fault *fault, uint64_t offset, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	vsnprintf(fault->text, sizeof(fault->text), format, args);
	va_end(args);
	fault->offset = offset;
	return -EBADMSG;
}

uint32_t pkg_crc32(uint32_t crc, const void *bytes, uint64_t size)
{
	uLong sum = crc;
	const uint8_t *at = bytes;
	while (size > 0) {
		uInt step = size > (1u << 30) ? 1u << 30 : (uInt)size;
		sum = crc32(sum, at, step);
		at += step;
		size -= step;
	}
	return (uint32_t)sum;
}

static int check_header(struct span file, struct pkg_fault *fault)
{
	struct pkg_header header;
	if (file.size < sizeof(header))
		return pkg_fail(fault, file.size, "%zu bytes are too few for a package", file.size);
	memcpy(&header, file.data, sizeof(header));
	if (memcmp(header.magic, PKG_MAGIC, sizeof(header.magic)) != 0)
		return pkg_fail(fault, 0, "not a city package");
	if (header.version_major != PKG_VERSION_MAJOR)
		return pkg_fail(
			fault, 8, "package version %u, this program reads version %u", header.version_major, PKG_VERSION_MAJOR);
	uint32_t stored = header.header_crc32;
	header.header_crc32 = 0;
	if (pkg_crc32(0, &header, sizeof(header)) != stored)
		return pkg_fail(fault, 0, "header checksum is wrong");
	if (header.file_bytes != file.size)
		return pkg_fail(fault, file.size, "file has %zu bytes, its header says %llu", file.size,
			(unsigned long long)header.file_bytes);
	uint64_t table_bytes = (uint64_t)header.section_count * sizeof(struct pkg_section);
	if (header.section_count > 64 || sizeof(header) + table_bytes > file.size)
		return pkg_fail(fault, 12, "%u sections do not fit", header.section_count);
	if (pkg_crc32(0, file.data + sizeof(header), table_bytes) != header.table_crc32)
		return pkg_fail(fault, sizeof(header), "section table checksum is wrong");
	return 0;
}

void pkg_tag_text(uint32_t tag, char out[5])
{
	for (int i = 0; i < 4; i++) {
		char c = (char)(tag >> (8 * i) & 0x7F);
		out[i] = c >= ' ' ? c : '?';
	}
	out[4] = 0;
}

uint32_t pkg_sections(const struct pkg *pkg, const struct pkg_section **sections)
{
	const struct pkg_header *header = (const void *)pkg->map.bytes.data;
	*sections = (const void *)(pkg->map.bytes.data + sizeof(*header));
	return header->section_count;
}

static int check_table(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_section *sections;
	uint32_t count = pkg_sections(pkg, &sections);
	uint64_t end = sizeof(struct pkg_header) + (uint64_t)count * sizeof(*sections);
	for (uint32_t i = 0; i < count; i++) {
		const struct pkg_section *section = &sections[i];
		uint64_t at = sizeof(struct pkg_header) + (uint64_t)i * sizeof(*section);
		char tag[5];
		pkg_tag_text(section->tag, tag);
		if (section->offset % PKG_ALIGN || section->offset < end || section->offset > pkg->map.bytes.size ||
			section->bytes > pkg->map.bytes.size - section->offset)
			return pkg_fail(fault, at, "section %s lies outside the file or overlaps", tag);
		if (!section->element_bytes || section->bytes % section->element_bytes)
			return pkg_fail(fault, at, "section %s is no whole number of elements", tag);
		end = section->offset + section->bytes;
		if (section->tag == PKG_GEOM || section->tag == PKG_CELD)
			continue;
		if (pkg_crc32(0, pkg->map.bytes.data + section->offset, section->bytes) != section->crc32)
			return pkg_fail(fault, section->offset, "section %s: checksum is wrong", tag);
	}
	return 0;
}

/* Finds a section of elements of a known size. An absent one is NULL with count 0. */
static int find_section(const struct pkg *pkg, uint32_t tag, uint32_t element_bytes, const void **at, uint64_t *count,
	struct pkg_fault *fault)
{
	const struct pkg_section *sections;
	uint32_t section_count = pkg_sections(pkg, &sections);
	*at = NULL;
	*count = 0;
	for (uint32_t i = 0; i < section_count; i++) {
		if (sections[i].tag != tag)
			continue;
		char text[5];
		pkg_tag_text(tag, text);
		if (sections[i].element_bytes != element_bytes)
			return pkg_fail(fault, sections[i].offset, "section %s: elements of %u bytes, expected %u", text,
				sections[i].element_bytes, element_bytes);
		*count = sections[i].bytes / element_bytes;
		if (*count > UINT32_MAX - 1 && element_bytes > 1)
			return pkg_fail(fault, sections[i].offset, "section %s: too many elements", text);
		*at = pkg->map.bytes.data + sections[i].offset;
		return 0;
	}
	return 0;
}

/* One array of the package: where its pointer and count go. */
struct wanted_array {
	uint32_t tag;
	uint32_t element_bytes;
	const void **at;
	uint32_t *count;
};

static int find_arrays(struct pkg *pkg, struct pkg_fault *fault)
{
	struct pkg_graph *graph = &pkg->graph;
	uint32_t meta_count = 0, index_count = 0, cell_count = 0;
#define WANTED(tag, pointer, counter)                                                                                  \
	{                                                                                                                  \
		tag, sizeof(*(pointer)), (const void **)&(pointer), &(counter)                                                 \
	}
	const struct wanted_array wanted[] = {
		WANTED(PKG_META, pkg->meta, meta_count),
		WANTED(PKG_STRS, pkg->strings, pkg->strings_bytes),
		WANTED(PKG_NODE, graph->nodes, graph->node_count),
		WANTED(PKG_OUTS, graph->outs, graph->out_count),
		WANTED(PKG_HALF, graph->halves, graph->half_count),
		WANTED(PKG_EDGE, graph->edges, graph->edge_count),
		WANTED(PKG_POLY, graph->points, graph->point_count),
		WANTED(PKG_FACE, graph->faces, graph->face_count),
		WANTED(PKG_TURN, graph->turns, graph->turn_count),
		WANTED(PKG_MATL, pkg->materials, pkg->material_count),
		WANTED(PKG_CHNK, pkg->chunks, pkg->chunk_count),
		WANTED(PKG_OBJS, pkg->objects, pkg->object_count),
		WANTED(PKG_TEXT, pkg->texts, pkg->text_count),
		WANTED(PKG_GRUN, pkg->glyph_runs, pkg->glyph_run_count),
		WANTED(PKG_STRC, pkg->stretches, pkg->stretch_count),
		WANTED(PKG_CIDX, pkg->first_stretch, index_count),
		WANTED(PKG_CELL, pkg->cells, cell_count),
		WANTED(PKG_OCCL, pkg->occluders, pkg->occluder_count),
	};
#undef WANTED
	for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++) {
		uint64_t count;
		int status = find_section(pkg, wanted[i].tag, wanted[i].element_bytes, wanted[i].at, &count, fault);
		if (status < 0)
			return status;
		if (count >= UINT32_MAX)
			return pkg_fail(fault, 0, "a section has more than 2^32 elements");
		*wanted[i].count = (uint32_t)count;
	}
	if (meta_count != 1)
		return pkg_fail(fault, 0, "section META is missing or has %u elements", meta_count);
	return pkg_check_far_counts(pkg, index_count, cell_count, fault);
}

static int find_blobs(struct pkg *pkg, struct pkg_fault *fault)
{
	const void *at;
	uint64_t bytes;
	int status = find_section(pkg, PKG_GEOM, 1, (const void **)&pkg->geometry, &pkg->geometry_bytes, fault);
	if (status < 0)
		return status;
	if ((status = find_section(pkg, PKG_HGRD, 1, &at, &bytes, fault)) < 0 ||
		(status = pkg_check_heights(pkg, at, bytes, fault)) < 0)
		return status;
	if ((status = find_section(pkg, PKG_TEXA, 1, &at, &bytes, fault)) < 0 ||
		(status = pkg_check_textures(pkg, at, bytes, fault)) < 0)
		return status;
	if ((status = find_section(pkg, PKG_LMAP, 1, &at, &bytes, fault)) < 0 ||
		(status = pkg_check_light_map(pkg, at, bytes, fault)) < 0)
		return status;
	if ((status = find_section(pkg, PKG_CELD, 1, (const void **)&pkg->blobs, &pkg->blobs_bytes, fault)) < 0)
		return status;
	if (!pkg->blobs != !pkg->stretches)
		return pkg_fail(fault, 0, "of the sections STRC, CIDX, CELL and CELD only some are there");
	if ((status = find_section(pkg, PKG_FONT, 1, &at, &bytes, fault)) < 0)
		return status;
	return pkg_check_font(pkg, at, bytes, fault);
}

static int open_mapped(struct pkg *pkg, struct pkg_fault *fault)
{
	int status;
	if ((status = check_header(pkg->map.bytes, fault)) < 0 || (status = check_table(pkg, fault)) < 0 ||
		(status = find_arrays(pkg, fault)) < 0 || (status = find_blobs(pkg, fault)) < 0)
		return status;
	if ((status = pkg_check_values(pkg, fault)) < 0)
		return status;
	pkg->frame = geo_frame_at((struct geo_point){ pkg->meta->origin_lat_deg, pkg->meta->origin_lon_deg });
	return 0;
}

int pkg_open(struct pkg *pkg, const char *path, struct pkg_fault *fault)
{
	*pkg = (struct pkg){ 0 };
	*fault = (struct pkg_fault){ 0 };
	int status = file_map_open(&pkg->map, path);
	if (status < 0) {
		snprintf(fault->text, sizeof(fault->text), "%s", strerror(-status));
		return status;
	}
	status = open_mapped(pkg, fault);
	if (status < 0)
		pkg_close(pkg);
	return status;
}

void pkg_close(struct pkg *pkg)
{
	file_map_close(&pkg->map);
	*pkg = (struct pkg){ 0 };
}

int32_t pkg_ground_mm(const struct pkg *pkg, int64_t east_mm, int64_t north_mm)
{
	if (!pkg->heights)
		return 0;
	return (int32_t)lrint(height_grid_at(pkg->heights, pkg->height_mm, (double)east_mm, (double)north_mm));
}

const struct pkg_text *pkg_text_find(const struct pkg *pkg, uint32_t string)
{
	uint32_t low = 0, high = pkg->text_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (pkg->texts[middle].string < string)
			low = middle + 1;
		else
			high = middle;
	}
	return low < pkg->text_count && pkg->texts[low].string == string ? &pkg->texts[low] : NULL;
}
