/*
 * Solids that hide what is behind them, for the visible sets of the far field (PKG_OCCL). At every few metres of
 * altitude, the footprints of the buildings that are solid from the ground up to there are joined, so that a row of
 * houses hides as one; the joined footprint is shrunk (Wonka, Wimmer, Schmalstieg 2000, section 3) and its contour
 * becomes walls. From the highest level down, buildings only join, so each joined footprint is made of those of the
 * level above. Everything errs towards hiding less. Cost: a few seconds for ten thousand buildings.
 */
#include <geos_c.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bake/bake.h"
#include "tools/bake/solids.h"
#include "tools/read/shape.h"

#define LEVEL_M 2.0     /* of altitude */
#define HIGH_M 24.0     /* above their ground, solids get only every fourth level */
#define LEAST_TOP_M 3.5 /* lower ones hide nothing from a driver */
#define TOUCH_M 0.01    /* to either side: closes what is no gap but rounding */
#define SIMPLIFY_M 0.15 /* of the shrunk contour */
#define SLACK_M 0.05    /* clean outlines, millimetres, GEOS's own simplification */
#define LEAST_AREA_M2 6.0
#define LEVELS_MAX 4096
#define NONE UINT32_MAX

struct pair {
	uint32_t a, b;
};

/* A joined footprint, or one that is about to become part of another. */
struct piece {
	uint32_t root;
	GEOSGeometry *shape; /* owned */
};

struct joining {
	struct pool pool;
	struct report report; /* nobody reads it: what it would count, the generators counted */
	struct shaper shaper;
	GEOSBufferParams *mitre; /* sharp corners: round ones would be cut too little */
	solid_array solids;
	uint32_t *parent;      /* of each solid among those that it is joined with; NONE: not yet there */
	GEOSGeometry **shapes; /* of the roots: the joined footprint, a touch larger; of the others to come, their own */
	double *top_m;         /* of the roots: the lowest of all */
	uint32_t *first_touching;
	ARRAY(struct pair) touching; /* both ways, sorted */
	ARRAY(struct piece) pieces;  /* of the joined footprints that change at this level */
	struct occluders *out;
};

/* Water lies lower than the ground that buildings stand on: under what is built over it one sees through. */
struct water {
	GEOSSTRtree *tree;
	ARRAY(GEOSGeometry *) shapes;
};

static void list_water(struct joining *joining, const struct city *city, struct water *out)
{
	GEOSContextHandle_t geos = joining->shaper.geos;
	out->tree = GEOSSTRtree_create_r(geos, 8);
	for (size_t i = 0; i < city->areas.count; i++) {
		if (city->areas.items[i].kind != AREA_WATER)
			continue;
		GEOSGeometry *shape = shape_to_geos(&joining->shaper, &city->areas.items[i].shape);
		if (!shape)
			continue;
		ARRAY_PUSH(&out->shapes, shape);
		GEOSSTRtree_insert_r(geos, out->tree, shape, shape);
	}
}

static void finish_water(const struct joining *joining, struct water *water)
{
	GEOSSTRtree_destroy_r(joining->shaper.geos, water->tree);
	for (size_t i = 0; i < water->shapes.count; i++)
		GEOSGeom_destroy_r(joining->shaper.geos, water->shapes.items[i]);
	ARRAY_FINISH(&water->shapes);
}

struct drying {
	GEOSContextHandle_t geos;
	GEOSGeometry *shape; /* NULL once GEOS has failed */
};

static void cut_water(void *item, void *context)
{
	struct drying *drying = context;
	if (!drying->shape || GEOSIntersects_r(drying->geos, drying->shape, item) == 0)
		return;
	GEOSGeometry *left = GEOSDifference_r(drying->geos, drying->shape, item);
	GEOSGeom_destroy_r(drying->geos, drying->shape);
	drying->shape = left;
}

/* What of a solid stands on land, a touch larger; NULL: nothing, or nothing sound. */
static GEOSGeometry *shape_of(const struct joining *joining, const struct water *water, const struct solid *solid)
{
	GEOSContextHandle_t geos = joining->shaper.geos;
	GEOSGeometry *shape = shape_to_geos(&joining->shaper, solid->footprint), *out = NULL;
	struct drying drying = { geos, shape && GEOSisValid_r(geos, shape) == 1 ? GEOSGeom_clone_r(geos, shape) : NULL };
	if (drying.shape)
		GEOSSTRtree_query_r(geos, water->tree, shape, cut_water, &drying);
	if (drying.shape && GEOSisEmpty_r(geos, drying.shape) == 0)
		out = GEOSBufferWithParams_r(geos, drying.shape, joining->mitre, TOUCH_M);
	GEOSGeom_destroy_r(geos, drying.shape);
	GEOSGeom_destroy_r(geos, shape);
	return out;
}

static void shape_solids(struct joining *joining, const struct city *city)
{
	size_t count = joining->solids.count;
	joining->shapes = POOL_ARRAY(&joining->pool, GEOSGeometry *, count);
	joining->parent = POOL_ARRAY(&joining->pool, uint32_t, count);
	joining->top_m = POOL_ARRAY(&joining->pool, double, count);
	struct water water = { 0 };
	list_water(joining, city, &water);
	for (size_t i = 0; i < count; i++) {
		const struct solid *solid = &joining->solids.items[i];
		joining->parent[i] = NONE;
		joining->top_m[i] = solid->top_m;
		if (solid->top_m >= solid->ground_m + LEAST_TOP_M)
			joining->shapes[i] = shape_of(joining, &water, solid);
	}
	finish_water(joining, &water);
}

struct touch_search {
	struct joining *joining;
	uint32_t self;
};

static void visit_other(void *item, void *context)
{
	const struct touch_search *search = context;
	struct joining *joining = search->joining;
	uint32_t self = search->self, other = (uint32_t)((GEOSGeometry **)item - joining->shapes);
	if (other >= self || GEOSIntersects_r(joining->shaper.geos, joining->shapes[self], joining->shapes[other]) != 1)
		return;
	ARRAY_PUSH(&joining->touching, (struct pair){ self, other });
	ARRAY_PUSH(&joining->touching, (struct pair){ other, self });
}

static int compare_pairs(const void *left, const void *right)
{
	const struct pair *p = left, *q = right;
	if (p->a != q->a)
		return p->a < q->a ? -1 : 1;
	return p->b < q->b ? -1 : p->b > q->b;
}

static void find_touching(struct joining *joining)
{
	GEOSContextHandle_t geos = joining->shaper.geos;
	GEOSSTRtree *tree = GEOSSTRtree_create_r(geos, 8);
	size_t count = joining->solids.count;
	for (size_t i = 0; i < count; i++)
		if (joining->shapes[i])
			GEOSSTRtree_insert_r(geos, tree, joining->shapes[i], &joining->shapes[i]);
	for (uint32_t i = 0; i < count; i++)
		if (joining->shapes[i])
			GEOSSTRtree_query_r(geos, tree, joining->shapes[i], visit_other, &(struct touch_search){ joining, i });
	GEOSSTRtree_destroy_r(geos, tree);
	ARRAY_SORT(&joining->touching, compare_pairs);
	joining->first_touching = POOL_ARRAY(&joining->pool, uint32_t, count + 1);
	for (size_t i = 0; i < joining->touching.count; i++)
		joining->first_touching[joining->touching.items[i].a + 1]++;
	for (size_t i = 0; i < count; i++)
		joining->first_touching[i + 1] += joining->first_touching[i];
}

/* ---- walls ---- */

static void emit_ring(struct joining *joining, const struct ring *ring, int32_t top_mm, uint32_t solid)
{
	int32_t last[2] = { 0, 0 };
	for (size_t i = 0; i <= ring->count; i++) {
		struct dvec2 at = ring->points[i % ring->count];
		int32_t to[2] = { (int32_t)lround(at.x * 1000.0), (int32_t)lround(at.y * 1000.0) };
		if (i && (to[0] != last[0] || to[1] != last[1]))
			ARRAY_PUSH(&joining->out->walls,
				(struct pkg_occluder){
					.from_mm = { last[0], last[1] }, .to_mm = { to[0], to[1] }, .top_mm = top_mm, .solid = solid });
		memcpy(last, to, sizeof(last));
	}
}

static void emit_polygon(struct joining *joining, const struct polygon *polygon, int32_t top_mm)
{
	emit_ring(joining, &polygon->outer, top_mm, joining->out->solid_count);
	for (size_t i = 0; i < polygon->hole_count; i++)
		emit_ring(joining, &polygon->holes[i], top_mm, joining->out->solid_count);
	joining->out->solid_count++;
}

/* The simplified contour leaves the shrunk footprint by SIMPLIFY_M at most, which the shrinking allows for. */
static void shrink(struct joining *joining, const GEOSGeometry *polygon, double top_m)
{
	GEOSContextHandle_t geos = joining->shaper.geos;
	double by = PKG_OCCLUDER_SHRINK_MM * 1e-3 + TOUCH_M + SIMPLIFY_M + SLACK_M;
	GEOSGeometry *inner = GEOSBufferWithParams_r(geos, polygon, joining->mitre, -by);
	GEOSGeometry *simple = inner ? GEOSTopologyPreserveSimplify_r(geos, inner, SIMPLIFY_M) : NULL;
	polygon_array pieces = { 0 };
	if (simple)
		shape_from_geos(&joining->shaper, simple, LEAST_AREA_M2, &pieces);
	for (size_t i = 0; i < pieces.count; i++)
		emit_polygon(joining, &pieces.items[i], (int32_t)floor(top_m * 1000.0));
	ARRAY_FINISH(&pieces);
	GEOSGeom_destroy_r(geos, simple);
	GEOSGeom_destroy_r(geos, inner);
}

/* ---- a level of altitude ---- */

static bool reaches(const struct solid *solid, long level)
{
	double altitude = (double)level * LEVEL_M, above = altitude - solid->ground_m;
	return altitude <= solid->top_m && (above <= HIGH_M || level % 4 == 0);
}

static uint32_t root_of(struct joining *joining, uint32_t solid)
{
	while (joining->parent[solid] != solid) {
		joining->parent[solid] = joining->parent[joining->parent[solid]];
		solid = joining->parent[solid];
	}
	return solid;
}

/* What a root has so far goes to the pieces: it is about to change. */
static void release(struct joining *joining, uint32_t root)
{
	if (!joining->shapes[root])
		return;
	ARRAY_PUSH(&joining->pieces, (struct piece){ root, joining->shapes[root] });
	joining->shapes[root] = NULL;
}

static void admit(struct joining *joining, uint32_t solid)
{
	joining->parent[solid] = solid;
	release(joining, solid);
	for (uint32_t i = joining->first_touching[solid]; i < joining->first_touching[solid + 1]; i++) {
		uint32_t other = joining->touching.items[i].b;
		if (joining->parent[other] == NONE)
			continue;
		uint32_t a = root_of(joining, solid), b = root_of(joining, other);
		release(joining, b);
		uint32_t root = a < b ? a : b, child = a < b ? b : a;
		joining->parent[child] = root;
		joining->top_m[root] = fmin(joining->top_m[root], joining->top_m[child]);
	}
}

static int compare_pieces(const void *left, const void *right)
{
	const struct piece *p = left, *q = right;
	return p->root < q->root ? -1 : p->root > q->root;
}

static GEOSGeometry *join(const struct joining *joining, const struct piece *pieces, size_t count)
{
	GEOSContextHandle_t geos = joining->shaper.geos;
	if (count == 1)
		return pieces[0].shape;
	ARRAY(GEOSGeometry *) parts = { 0 };
	for (size_t i = 0; i < count; i++)
		ARRAY_PUSH(&parts, pieces[i].shape);
	GEOSGeometry *all = GEOSGeom_createCollection_r(geos, GEOS_GEOMETRYCOLLECTION, parts.items, (unsigned)parts.count);
	GEOSGeometry *joined = all ? GEOSUnaryUnion_r(geos, all) : NULL;
	GEOSGeom_destroy_r(geos, all);
	ARRAY_FINISH(&parts);
	return joined;
}

static void join_level(struct joining *joining, long level)
{
	joining->pieces.count = 0;
	for (uint32_t i = 0; i < joining->solids.count; i++)
		if (joining->parent[i] == NONE && joining->shapes[i] && reaches(&joining->solids.items[i], level))
			admit(joining, i);
	for (size_t i = 0; i < joining->pieces.count; i++)
		joining->pieces.items[i].root = root_of(joining, joining->pieces.items[i].root);
	ARRAY_SORT(&joining->pieces, compare_pieces);
	for (size_t i = 0, end; i < joining->pieces.count; i = end) {
		uint32_t root = joining->pieces.items[i].root;
		for (end = i; end < joining->pieces.count && joining->pieces.items[end].root == root; end++)
			;
		joining->shapes[root] = join(joining, &joining->pieces.items[i], end - i);
		if (joining->shapes[root])
			shrink(joining, joining->shapes[root], joining->top_m[root]);
	}
}

static void join_all(struct joining *joining)
{
	double low = INFINITY, high = -INFINITY;
	for (size_t i = 0; i < joining->solids.count; i++) {
		low = fmin(low, joining->solids.items[i].ground_m + LEAST_TOP_M);
		high = fmax(high, joining->solids.items[i].top_m);
	}
	if (!joining->solids.count)
		return;
	long last = (long)floor(low / LEVEL_M), first = (long)floor(fmin(high, low + LEVELS_MAX * LEVEL_M) / LEVEL_M);
	for (long level = first; level >= last; level--)
		join_level(joining, level);
}

void occluders_build(const struct city *city, struct occluders *out)
{
	*out = (struct occluders){ 0 };
	struct joining joining = { .out = out };
	shaper_init(&joining.shaper, &joining.pool, &joining.report);
	GEOSContextHandle_t geos = joining.shaper.geos;
	joining.mitre = GEOSBufferParams_create_r(geos);
	GEOSBufferParams_setJoinStyle_r(geos, joining.mitre, GEOSBUF_JOIN_MITRE);
	GEOSBufferParams_setMitreLimit_r(geos, joining.mitre, 3.0);
	solids_list(city, &joining.solids);
	shape_solids(&joining, city);
	find_touching(&joining);
	join_all(&joining);
	for (size_t i = 0; i < joining.solids.count; i++)
		GEOSGeom_destroy_r(geos, joining.shapes[i]);
	GEOSBufferParams_destroy_r(geos, joining.mitre);
	ARRAY_FINISH(&joining.solids);
	ARRAY_FINISH(&joining.touching);
	ARRAY_FINISH(&joining.pieces);
	shaper_finish(&joining.shaper);
	pool_finish(&joining.pool);
}

void occluders_finish(struct occluders *occluders)
{
	ARRAY_FINISH(&occluders->walls);
}
