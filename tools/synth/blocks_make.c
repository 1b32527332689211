/* The blocks: each face of the street graph less its carriageways and sidewalks, and what it is used for. */
#include <math.h>
#include <stdlib.h>

#include "tools/synth/synth.h"

static double sidewalk(const struct pkg_edge *edge)
{
	switch (edge->street_class) {
	case PKG_STREET_LIVING:
		return 0.8;
	case PKG_STREET_PRIMARY:
	case PKG_STREET_SECONDARY:
		return 4.2;
	case PKG_STREET_TERTIARY:
		return 3.2;
	default:
		return 2.6;
	}
}

static GEOSGeometry *edge_band(const struct synth *synth, uint32_t half)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	const struct pkg_edge *edge = &synth->view.edges[half / 2];
	GEOSCoordSequence *points = GEOSCoordSeq_create_r(geos, edge->point_count, 2);
	for (uint32_t i = 0; i < edge->point_count; i++) {
		struct dvec2 p = street_point(synth, half, i);
		GEOSCoordSeq_setXY_r(geos, points, i, p.x, p.y);
	}
	GEOSGeometry *line = GEOSGeom_createLineString_r(geos, points);
	double width = edge->width_mm / 2000.0 + sidewalk(edge);
	GEOSGeometry *band =
		line ? GEOSBufferWithStyle_r(geos, line, width, 3, GEOSBUF_CAP_SQUARE, GEOSBUF_JOIN_MITRE, 2.5) : NULL;
	GEOSGeom_destroy_r(geos, line);
	return band;
}

/* The face's outline as a polygon; dead ends into it are folded away by MakeValid. */
static GEOSGeometry *face_shape(const struct synth *synth, const struct pkg_face *face)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	ARRAY(struct dvec2) points = { 0 };
	uint32_t half = face->first_half;
	do {
		for (uint32_t i = 0; i + 1 < synth->view.edges[half / 2].point_count; i++)
			ARRAY_PUSH(&points, street_point(synth, half, i));
		half = synth->view.halves[half].next;
	} while (half != face->first_half);
	GEOSGeometry *raw = shape_to_geos(&synth->shaper, &(struct polygon){ .outer = { points.items, points.count } });
	GEOSGeometry *valid = raw ? GEOSMakeValid_r(geos, raw) : NULL;
	GEOSGeom_destroy_r(geos, raw);
	ARRAY_FINISH(&points);
	return valid;
}

static GEOSGeometry *all_bands(const struct synth *synth, const struct pkg_face *face)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	ARRAY(GEOSGeometry *) bands = { 0 };
	uint32_t half = face->first_half;
	do {
		GEOSGeometry *band = edge_band(synth, half);
		if (band)
			ARRAY_PUSH(&bands, band);
		half = synth->view.halves[half].next;
	} while (half != face->first_half);
	GEOSGeometry *all = GEOSGeom_createCollection_r(geos, GEOS_GEOMETRYCOLLECTION, bands.items, (unsigned)bands.count);
	GEOSGeometry *joined = all ? GEOSUnaryUnion_r(geos, all) : NULL;
	GEOSGeom_destroy_r(geos, all);
	ARRAY_FINISH(&bands);
	return joined;
}

/* Without the notches that widths of streets leave at corners. Stays within a metre of what it was. */
static bool tidy(struct synth *synth, struct polygon *land)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	polygon_array out = { 0 };
	GEOSGeometry *from = shape_to_geos(&synth->shaper, land);
	GEOSGeometry *less =
		from ? GEOSBufferWithStyle_r(geos, from, -2.5, 2, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 3.0) : NULL;
	GEOSGeometry *back =
		less ? GEOSBufferWithStyle_r(geos, less, 2.0, 2, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 3.0) : NULL;
	GEOSGeometry *plain = back ? GEOSTopologyPreserveSimplify_r(geos, back, 0.5) : NULL;
	if (plain)
		shape_from_geos(&synth->shaper, plain, 60.0, &out);
	GEOSGeom_destroy_r(geos, plain);
	GEOSGeom_destroy_r(geos, back);
	GEOSGeom_destroy_r(geos, less);
	GEOSGeom_destroy_r(geos, from);
	size_t best = 0;
	for (size_t i = 1; i < out.count; i++)
		best = polygon_area(&out.items[i]) > polygon_area(&out.items[best]) ? i : best;
	bool any = out.count > 0;
	if (any)
		*land = out.items[best];
	ARRAY_FINISH(&out);
	return any;
}

static void lay_out(struct synth *synth, struct block *block)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	const struct pkg_face *face = &synth->view.faces[block->face];
	polygon_array pieces = { 0 };
	GEOSGeometry *shape = face_shape(synth, face), *bands = all_bands(synth, face);
	GEOSGeometry *land = shape && bands ? GEOSDifference_r(geos, shape, bands) : NULL;
	if (land)
		shape_from_geos(&synth->shaper, land, 60.0, &pieces);
	for (size_t i = 0; i < pieces.count; i++) {
		if (!tidy(synth, &pieces.items[i]))
			continue;
		double area = polygon_area(&pieces.items[i]);
		if (area > block->area_m2) {
			block->area_m2 = area;
			block->land = pieces.items[i];
		}
	}
	GEOSGeom_destroy_r(geos, shape);
	GEOSGeom_destroy_r(geos, bands);
	GEOSGeom_destroy_r(geos, land);
	ARRAY_FINISH(&pieces);
}

static void find_middle(struct synth *synth, struct block *block)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	GEOSGeometry *land = shape_to_geos(&synth->shaper, &block->land);
	GEOSGeometry *radius = land ? GEOSMaximumInscribedCircle_r(geos, land, 0.5) : NULL;
	if (radius) {
		const GEOSCoordSequence *ends = GEOSGeom_getCoordSeq_r(geos, radius);
		GEOSCoordSeq_getXY_r(geos, ends, 0, &block->middle.x, &block->middle.y);
		GEOSLength_r(geos, radius, &block->room_m);
	}
	GEOSGeom_destroy_r(geos, radius);
	GEOSGeom_destroy_r(geos, land);
}

static bool is_river(const struct plan *plan, struct dvec2 at)
{
	return plan->river && fabs(plan_unplace(plan, at).y) < plan->river_half_m;
}

static bool is_park(const struct plan *plan, struct dvec2 at)
{
	struct dvec2 p = plan_unplace(plan, at);
	return plan->park && p.x > plan->s.items[plan->park_s0].at && p.x < plan->s.items[plan->park_s1].at &&
		   p.y > plan->t.items[plan->park_t0].at && p.y < plan->t.items[plan->park_t1].at;
}

static bool is_railway(const struct plan *plan, struct dvec2 at)
{
	double s = plan_unplace(plan, at).x;
	return plan->railway && s > plan->s.items[plan->rail_column].at && s < plan->s.items[plan->rail_column + 1].at;
}

static enum block_use use_of(const struct synth *synth, const struct block *block, struct rng *rng)
{
	const struct plan *plan = &synth->plan;
	struct dvec2 p = plan_unplace(plan, block->middle);
	double dice = rng_unit(rng), centre = block->centrality;
	if (is_river(plan, block->middle))
		return BLOCK_NONE;
	if (is_railway(plan, block->middle))
		return BLOCK_INDUSTRY;
	if (is_park(plan, block->middle))
		return BLOCK_PARK;
	if (plan_old_town(plan, p.x, p.y) < 0.0)
		return block->room_m < 7.0 ? BLOCK_SQUARE : BLOCK_OLD;
	if (block->room_m < 9.0)
		return BLOCK_SQUARE;
	if (dvec2_length(dvec2_sub(block->middle, plan->downtown)) < plan->downtown_radius_m)
		return dice < 0.06 ? BLOCK_SQUARE : BLOCK_DOWNTOWN;
	if (centre > 0.30)
		return dice < 0.05 && block->area_m2 > 2500.0 ? BLOCK_PARK
			   : dice < 0.13 && centre < 0.7          ? BLOCK_SLABS
													  : BLOCK_PERIMETER;
	if (centre > 0.18)
		return dice < 0.5 ? BLOCK_SLABS : dice < 0.85 ? BLOCK_PERIMETER : BLOCK_VILLAS;
	return dice < 0.07 && centre < 0.12 ? BLOCK_WOOD : dice < 0.18 ? BLOCK_PARK : BLOCK_VILLAS;
}

void blocks_make(struct synth *synth)
{
	for (uint32_t f = 0; f < synth->view.face_count; f++) {
		struct block block = { .face = f };
		if (!synth->view.faces[f].flags && synth->view.faces[f].area_m2 > 100.0)
			lay_out(synth, &block);
		if (block.land.outer.count >= 3) {
			struct rng rng = synth_rng(synth, 30, f);
			find_middle(synth, &block);
			block.centrality = plan_centrality(synth, block.middle);
			block.use = use_of(synth, &block, &rng);
		}
		ARRAY_PUSH(&synth->blocks, block);
	}
}

void blocks_finish(struct synth *synth)
{
	ARRAY_FINISH(&synth->blocks);
}
