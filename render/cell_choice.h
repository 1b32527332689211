/*
 * Which stretch of the street a frame belongs to: the one that the last frame had while its view cell holds the eye
 * (so nothing flickers where view cells overlap), else the one the car is on, else the nearest.
 */
#ifndef BLVD_RENDER_CELL_CHOICE_H
#define BLVD_RENDER_CELL_CHOICE_H

#include "assets/pkg.h"
#include "nav/nav_view.h"

/* The stretch nearest to a point that moves, looked for again every few metres. */
struct nearest_stretch {
	bool searched;
	int64_t searched_mm[3]; /* where it was last looked for */
	uint32_t stretch;
};

#define CELL_CHOICE_AHEAD 3 /* places that are looked at beforehand */
struct cell_choice {
	const struct pkg *pkg;
	uint32_t stretch; /* chosen last, PKG_NONE before the first */
	struct nearest_stretch here, ahead[CELL_CHOICE_AHEAD];
};

void cell_choice_init(struct cell_choice *choice, const struct pkg *pkg);

/* The stretch for this eye; PKG_NONE only when the package has none. `nav` may be NULL. Cost: a few steps inside a view
 * cell; a walk over all stretches outside, every few metres. */
uint32_t cell_choice_make(struct cell_choice *choice, const struct nav_view *nav, const int64_t eye_mm[3]);

/* The stretch that it would choose for another eye of the same car, to be loaded beforehand: where the eye cuts a
 * corner it passes view cells of streets that the car does not take. Changes nothing that is chosen. `place` is below
 * CELL_CHOICE_AHEAD; each remembers what it found. */
uint32_t cell_choice_ahead(
	struct cell_choice *choice, uint32_t place, const struct nav_view *nav, const int64_t eye_mm[3]);

/* Another one that holds the eye is drawn, because it is there and the chosen one is not: from now on it is the chosen
 * one. Returns it. */
uint32_t cell_choice_take(struct cell_choice *choice, uint32_t stretch);

/* The stretch under the car, PKG_NONE when it is on no street with one. */
uint32_t cell_choice_of_car(const struct pkg *pkg, const struct nav_view *nav);

#endif
