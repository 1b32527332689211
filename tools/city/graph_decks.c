/*
 * The base heights: the ground; on bridges and in tunnels the taut line between their ends instead. Where structures
 * branch, the taut line is the harmonic function of the network (weights 1 / length), by conjugate gradients.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/city/graph_heights.h"

#define TO_GROUND 1e-9 /* holds structures that touch the ground nowhere */
#define RESIDUAL 1e-9

static void *zeros(size_t count, size_t bytes)
{
	size_t capacity = 0;
	void *out = array_grow(NULL, &capacity, count + 1, bytes);
	memset(out, 0, (count + 1) * bytes);
	return out;
}

bool heights_is_structure(const struct heights *heights, uint32_t segment)
{
	const struct way *way = &heights->net->city->ways.items[heights->net->segments.items[segment].way];
	return way->bridge || way->tunnel;
}

/* Three or more streets, none of them a bridge, a tunnel or a mere driveway. */
static bool is_junction(const struct heights *heights, uint32_t vertex)
{
	uint32_t streets = 0;
	for (uint32_t i = heights->stars.first[vertex]; i < heights->stars.first[vertex + 1]; i++) {
		uint32_t segment = heights->stars.segments[i];
		if (heights_is_structure(heights, segment))
			return false;
		streets +=
			heights->net->city->ways.items[heights->net->segments.items[segment].way].street_class < PKG_STREET_SERVICE;
	}
	return streets > 2;
}

void heights_init(struct heights *heights, struct net *net, unsigned kind)
{
	size_t count = net->vertices.count;
	*heights = (struct heights){ .net = net, .kind = kind };
	net_stars_init(&heights->stars, net, kind);
	heights->ground = zeros(count, sizeof(double));
	heights->base = zeros(count, sizeof(double));
	heights->up = zeros(count, sizeof(double));
	heights->down = zeros(count, sizeof(double));
	heights->portal = zeros(count, sizeof(double));
	heights->pinned = zeros(count, sizeof(bool));
	heights->junction = zeros(count, sizeof(bool));
	heights->on_ramp = zeros(net->segments.count, sizeof(bool));
	heights->search = ramp_search_new(count);
	for (size_t v = 0; v < count; v++) {
		const struct net_vertex *at = &net->vertices.items[v];
		heights->ground[v] = city_ground(net->city, (struct dvec2){ at->x / 1000.0, at->y / 1000.0 });
		heights->base[v] = heights->ground[v];
		heights->junction[v] = is_junction(heights, (uint32_t)v);
	}
}

void heights_finish(struct heights *heights)
{
	net_stars_finish(&heights->stars);
	array_free(heights->ground);
	array_free(heights->base);
	array_free(heights->up);
	array_free(heights->down);
	array_free(heights->portal);
	array_free(heights->pinned);
	array_free(heights->junction);
	array_free(heights->on_ramp);
	ramp_search_free(heights->search);
	*heights = (struct heights){ 0 };
}

/* All ways here are bridges or tunnels, so nothing holds the height. */
static bool is_free(const struct heights *heights, uint32_t vertex)
{
	if (heights->pinned[vertex] || heights->stars.first[vertex] == heights->stars.first[vertex + 1])
		return false;
	for (uint32_t i = heights->stars.first[vertex]; i < heights->stars.first[vertex + 1]; i++)
		if (!heights_is_structure(heights, heights->stars.segments[i]))
			return false;
	return true;
}

struct taut {
	const struct heights *heights;
	index_array vertices;  /* free ones */
	uint32_t *unknown_of;  /* by vertex, PKG_NONE for held ones */
	double *x, *r, *p, *q; /* by unknown */
};

static double weight(const struct heights *heights, uint32_t segment)
{
	return 1.0 / fmax(net_length(heights->net, &heights->net->segments.items[segment]), 0.01);
}

/* out = A in; the held neighbours' heights go to `held` when it is given. */
static void apply(const struct taut *taut, const double *in, double *out, double *held)
{
	const struct heights *heights = taut->heights;
	for (size_t i = 0; i < taut->vertices.count; i++) {
		uint32_t vertex = taut->vertices.items[i];
		double sum = TO_GROUND * in[i];
		if (held)
			held[i] = TO_GROUND * heights->ground[vertex];
		for (uint32_t k = heights->stars.first[vertex]; k < heights->stars.first[vertex + 1]; k++) {
			uint32_t segment = heights->stars.segments[k];
			const struct net_segment *s = &heights->net->segments.items[segment];
			uint32_t other = s->a == vertex ? s->b : s->a;
			double w = weight(heights, segment);
			if (taut->unknown_of[other] == PKG_NONE) {
				sum += w * in[i];
				if (held)
					held[i] += w * heights->base[other];
			} else {
				sum += w * (in[i] - in[taut->unknown_of[other]]);
			}
		}
		out[i] = sum;
	}
}

static double dot(const double *a, const double *b, size_t count)
{
	double sum = 0.0;
	for (size_t i = 0; i < count; i++)
		sum += a[i] * b[i];
	return sum;
}

static void conjugate_gradients(struct taut *taut)
{
	size_t n = taut->vertices.count;
	apply(taut, taut->x, taut->q, taut->r); /* r holds the right-hand side */
	for (size_t i = 0; i < n; i++)
		taut->p[i] = taut->r[i] -= taut->q[i];
	double rr = dot(taut->r, taut->r, n);
	for (size_t step = 0; step < 2 * n + 100 && rr > RESIDUAL * RESIDUAL * (double)n; step++) {
		apply(taut, taut->p, taut->q, NULL);
		double alpha = rr / dot(taut->p, taut->q, n);
		for (size_t i = 0; i < n; i++) {
			taut->x[i] += alpha * taut->p[i];
			taut->r[i] -= alpha * taut->q[i];
		}
		double next = dot(taut->r, taut->r, n);
		for (size_t i = 0; i < n; i++)
			taut->p[i] = taut->r[i] + next / rr * taut->p[i];
		rr = next;
	}
}

void decks_lay(struct heights *heights)
{
	size_t count = heights->net->vertices.count;
	struct taut taut = { .heights = heights, .unknown_of = zeros(count, sizeof(uint32_t)) };
	for (uint32_t v = 0; v < count; v++) {
		bool unknown = is_free(heights, v);
		taut.unknown_of[v] = unknown ? (uint32_t)taut.vertices.count : PKG_NONE;
		heights->portal[v] = unknown ? HUGE_VAL : 0.0;
		if (unknown)
			ARRAY_PUSH(&taut.vertices, v);
	}
	size_t n = taut.vertices.count;
	taut.x = zeros(n, sizeof(double));
	taut.r = zeros(n, sizeof(double));
	taut.p = zeros(n, sizeof(double));
	taut.q = zeros(n, sizeof(double));
	for (size_t i = 0; i < n; i++)
		taut.x[i] = heights->ground[taut.vertices.items[i]];
	conjugate_gradients(&taut);
	for (size_t i = 0; i < n; i++)
		heights->base[taut.vertices.items[i]] = taut.x[i];
	ramp_spread(heights->search, heights, heights->portal);
	ARRAY_FINISH(&taut.vertices);
	array_free(taut.unknown_of);
	array_free(taut.x);
	array_free(taut.r);
	array_free(taut.p);
	array_free(taut.q);
}
