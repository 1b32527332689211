/* Small regions become guests of a neighbour, the smallest first; those that do not fit as long as the allowance lasts.
 */
#include <math.h>

#include "tools/impostor/surface_merger.h"

#define HOST_SHARE 0.5 /* of a guest's disparity: the least that its host's plane may have there */

struct small_region {
	uint32_t pixels, region;
};

/* Neighbours of regions: those of region r are beside[first[r]] to beside[first[r + 1] - 1]. */
struct neighbours {
	uint32_t *first, *beside;
};

static struct neighbours list_neighbours(struct pool *pool, const struct merger *merger)
{
	size_t regions = merger->parent.count, count = merger->borders.items.count;
	struct neighbours list = { POOL_ARRAY(pool, uint32_t, regions + 1), POOL_ARRAY(pool, uint32_t, 2 * count + 1) };
	const struct border *borders = merger->borders.items.items;
	for (size_t i = 0; i < count; i++) {
		list.first[borders[i].a - 1]++;
		list.first[borders[i].b - 1]++;
	}
	for (size_t i = 1; i <= regions; i++)
		list.first[i] += list.first[i - 1];
	for (size_t i = count; i-- > 0;) {
		list.beside[--list.first[borders[i].a - 1]] = borders[i].b - 1;
		list.beside[--list.first[borders[i].b - 1]] = borders[i].a - 1;
	}
	return list;
}

/* Is the plane well on this side of its horizon at a region's pixels? A guest beyond it would bend the whole host,
 * whose vertices have to have a depth. */
static bool is_ahead(const struct plane_fit *fit, const struct plane *plane)
{
	for (int i = 0; i < PLANE_FIT_SAMPLES; i++)
		if (plane_at(plane, fit->samples[i].x, fit->samples[i].y) < HOST_SHARE * (double)fit->samples[i].w)
			return false;
	return true;
}

/* The neighbour whose plane fits a region's pixels best. */
struct host {
	uint32_t region; /* UINT32_MAX: none */
	double error;
};

static struct host find_host(struct merger *merger, const struct neighbours *list, uint32_t region)
{
	const struct plane_fit *fit = &merger->seeds.fits.items[region];
	struct host host = { UINT32_MAX, INFINITY };
	for (uint32_t i = list->first[region]; i < list->first[region + 1]; i++) {
		uint32_t other = surface_region(merger, list->beside[i]);
		if (other == region)
			continue;
		struct plane plane = plane_fit_solve(&merger->seeds.fits.items[other]);
		double error = plane_fit_error(fit, &plane);
		if (error < host.error && error <= SURFACE_ERROR_MAX && is_ahead(fit, &plane))
			host = (struct host){ other, error };
	}
	return host;
}

static int by_pixels(const void *left, const void *right)
{
	const struct small_region *a = left, *b = right;
	if (a->pixels != b->pixels)
		return a->pixels < b->pixels ? -1 : 1;
	return (a->region > b->region) - (a->region < b->region);
}

void surfaces_swallow(struct merger *merger, const struct surfaces_input *input)
{
	struct pool pool = { 0 };
	struct neighbours list = list_neighbours(&pool, merger);
	ARRAY(struct small_region) smalls = { 0 };
	for (uint32_t i = 0; i < merger->parent.count; i++)
		if (merger->seeds.fits.items[i].pixels <= input->swallow_px)
			ARRAY_PUSH(&smalls, (struct small_region){ merger->seeds.fits.items[i].pixels, i });
	ARRAY_SORT(&smalls, by_pixels);
	for (size_t i = 0; i < smalls.count; i++) {
		uint32_t region = smalls.items[i].region, pixels = merger->seeds.fits.items[region].pixels;
		if (surface_region(merger, region) != region)
			continue;
		struct host host = find_host(merger, &list, region);
		if (host.region == UINT32_MAX)
			continue;
		/* The host's plane stays as it is: guests do not bend it. */
		merger->parent.items[region] = host.region;
		merger->seeds.fits.items[host.region].pixels += pixels;
	}
	ARRAY_FINISH(&smalls);
	pool_finish(&pool);
}
