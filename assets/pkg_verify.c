/* The checks that a reader does not need but a package must pass: for `blvd verify`. Reads every byte of the file. */
#include <errno.h>
#include <string.h>

#include "assets/pkg_check.h"

int pkg_verify_padding(const struct pkg *pkg, uint64_t from, uint64_t to, struct pkg_fault *fault)
{
	for (uint64_t at = from; at < to; at++)
		if (pkg->map.bytes.data[at])
			return pkg_fail(fault, at, "a padding byte is not zero");
	return 0;
}

static int verify_layout(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_section *sections;
	uint32_t count = pkg_sections(pkg, &sections);
	uint64_t end = sizeof(struct pkg_header) + (uint64_t)count * sizeof(*sections);
	for (uint32_t i = 0; i < count; i++) {
		int status = pkg_verify_padding(pkg, end, sections[i].offset, fault);
		if (status < 0)
			return status;
		end = sections[i].offset + sections[i].bytes;
		for (uint32_t k = 0; k < i; k++)
			if (sections[k].tag == sections[i].tag)
				return pkg_fail(fault, sizeof(struct pkg_header) + i * sizeof(*sections), "a section stands twice");
	}
	return pkg_verify_padding(pkg, end, pkg->map.bytes.size, fault);
}

/* GEOM has no checksum of its own: what no chunk covers must be zero. Chunks lie in order. */
static int verify_geometry(const struct pkg *pkg, struct pkg_fault *fault)
{
	uint64_t base = pkg->chunk_count ? pkg_offset_of(pkg, pkg->geometry) : 0, end = 0;
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		const struct pkg_chunk *chunk = &pkg->chunks[i];
		uint64_t indices = (uint64_t)chunk->index_count[0] + chunk->index_count[1];
		uint64_t vertex_end = chunk->vertex_offset + chunk->vertex_count * sizeof(struct pkg_mesh_vertex);
		if (chunk->vertex_offset < end || chunk->index_offset < vertex_end)
			return pkg_fail(fault, pkg_offset_of(pkg, chunk), "section CHNK, element %u: geometry overlaps", i);
		int status;
		if ((status = pkg_verify_padding(pkg, base + end, base + chunk->vertex_offset, fault)) < 0 ||
			(status = pkg_verify_padding(pkg, base + vertex_end, base + chunk->index_offset, fault)) < 0 ||
			(status = pkg_chunk_check(pkg, i, fault)) < 0)
			return status;
		end = chunk->index_offset + indices * sizeof(uint16_t);
	}
	return pkg_verify_padding(pkg, base + end, base + pkg->geometry_bytes, fault);
}

static int verify_faces(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_graph *graph = &pkg->graph;
	for (uint32_t i = 0; i < graph->half_count; i++) {
		const struct pkg_half *half = &graph->halves[i];
		const struct pkg_half *next = &graph->halves[half->next];
		if (next->prev != i || next->face != half->face || next->origin != graph->halves[i ^ 1].origin)
			return pkg_fail(fault, pkg_offset_of(pkg, half), "section HALF, element %u: its face cycle is broken", i);
	}
	uint64_t sum = 0;
	for (uint32_t i = 0; i < graph->face_count; i++) {
		uint32_t start = graph->faces[i].first_half, at = start, length = 0;
		do {
			if (graph->halves[at].face != i || length > graph->half_count)
				return pkg_fail(
					fault, pkg_offset_of(pkg, &graph->faces[i]), "section FACE, element %u: its cycle leaves it", i);
			at = graph->halves[at].next;
			length++;
		} while (at != start);
		if (length != graph->faces[i].half_count)
			return pkg_fail(
				fault, pkg_offset_of(pkg, &graph->faces[i]), "section FACE, element %u: half_count is wrong", i);
		sum += length;
	}
	if (sum != graph->half_count)
		return pkg_fail(
			fault, 0, "section FACE: %llu of %u half-edges lie in a face", (unsigned long long)sum, graph->half_count);
	return 0;
}

static int verify_turns(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_graph *graph = &pkg->graph;
	for (uint32_t i = 0; i < graph->turn_count; i++) {
		const struct pkg_turn *turn = &graph->turns[i];
		bool meet = graph->halves[turn->from_half ^ 1].origin == graph->halves[turn->to_half].origin;
		bool sorted = i == 0 || turn[-1].from_half < turn->from_half ||
					  (turn[-1].from_half == turn->from_half && turn[-1].to_half < turn->to_half);
		if (!meet || !sorted)
			return pkg_fail(fault, pkg_offset_of(pkg, turn), "section TURN, element %u: %s", i,
				meet ? "not sorted" : "edges do not meet");
	}
	return 0;
}

int pkg_verify(const struct pkg *pkg, struct pkg_fault *fault)
{
	int status;
	if ((status = verify_layout(pkg, fault)) < 0 || (status = verify_geometry(pkg, fault)) < 0 ||
		(status = verify_faces(pkg, fault)) < 0 || (status = pkg_verify_far(pkg, fault)) < 0)
		return status;
	return verify_turns(pkg, fault);
}
