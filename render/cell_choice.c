#include "render/cell_choice.h"

#include <math.h>
#include <stdlib.h>

#include "assets/cells.h"

#define SEARCH_AGAIN_MM 2000 /* the nearest stretch is looked for again after so much of a way */

void cell_choice_init(struct cell_choice *choice, const struct pkg *pkg)
{
	const struct nearest_stretch none = { .stretch = PKG_NONE };
	*choice = (struct cell_choice){ .pkg = pkg, .stretch = PKG_NONE, .here = none };
	for (uint32_t i = 0; i < CELL_CHOICE_AHEAD; i++)
		choice->ahead[i] = none;
}

uint32_t cell_choice_of_car(const struct pkg *pkg, const struct nav_view *nav)
{
	if (!nav || !nav->located || !nav->on_street || nav->half == PKG_NONE || nav->half / 2 >= pkg->graph.edge_count)
		return PKG_NONE;
	uint32_t edge = nav->half / 2;
	double along_mm = nav->along_m * 1000.0;
	if (nav->half & 1)
		along_mm = (double)pkg->graph.edges[edge].length_mm - along_mm;
	return cells_stretch_at(pkg, edge, llrint(along_mm));
}

/* No point of the view cell is nearer than this: from its start, along either axis. */
static double at_least_m(const struct pkg_stretch *stretch, const int64_t eye_mm[3])
{
	int64_t x = llabs(eye_mm[0] - stretch->start_mm[0]), y = llabs(eye_mm[1] - stretch->start_mm[1]);
	int64_t reach = (int64_t)(stretch->to_mm - stretch->from_mm) + stretch->overrun_mm + stretch->half_width_mm;
	return (double)((x > y ? x : y) - reach) * 1e-3;
}

static uint32_t find_nearest(const struct pkg *pkg, const int64_t eye_mm[3])
{
	uint32_t best = PKG_NONE;
	double best_m = INFINITY;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		if (at_least_m(&pkg->stretches[i], eye_mm) >= best_m)
			continue;
		double away_m = cells_distance_m(&pkg->stretches[i], eye_mm);
		if (away_m < best_m) {
			best_m = away_m;
			best = i;
		}
	}
	return best;
}

static bool moved(const struct nearest_stretch *nearest, const int64_t eye_mm[3])
{
	for (int axis = 0; axis < 3; axis++)
		if (llabs(eye_mm[axis] - nearest->searched_mm[axis]) > SEARCH_AGAIN_MM)
			return true;
	return !nearest->searched;
}

static uint32_t nearest_to(const struct pkg *pkg, struct nearest_stretch *nearest, const int64_t eye_mm[3])
{
	if (moved(nearest, eye_mm)) {
		nearest->stretch = find_nearest(pkg, eye_mm);
		nearest->searched = true;
		for (int axis = 0; axis < 3; axis++)
			nearest->searched_mm[axis] = eye_mm[axis];
	}
	return nearest->stretch;
}

static uint32_t choose(const struct cell_choice *choice, struct nearest_stretch *nearest, const struct nav_view *nav,
	const int64_t eye_mm[3])
{
	const struct pkg_stretch *stretches = choice->pkg->stretches;
	uint32_t car = cell_choice_of_car(choice->pkg, nav);
	if (choice->stretch != PKG_NONE && cells_holds_eye(&stretches[choice->stretch], eye_mm))
		return choice->stretch;
	if (car != PKG_NONE && cells_holds_eye(&stretches[car], eye_mm))
		return car;
	return nearest_to(choice->pkg, nearest, eye_mm);
}

uint32_t cell_choice_make(struct cell_choice *choice, const struct nav_view *nav, const int64_t eye_mm[3])
{
	choice->stretch = choose(choice, &choice->here, nav, eye_mm);
	return choice->stretch;
}

uint32_t cell_choice_take(struct cell_choice *choice, uint32_t stretch)
{
	choice->stretch = stretch;
	return stretch;
}

uint32_t cell_choice_ahead(
	struct cell_choice *choice, uint32_t place, const struct nav_view *nav, const int64_t eye_mm[3])
{
	return choose(choice, &choice->ahead[place], nav, eye_mm);
}
