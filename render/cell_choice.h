/*
 * Which stretch of the street a frame belongs to: the one that the last frame had while its view cell holds the eye
 * (so nothing flickers where view cells overlap), else the one the car is on, else the nearest.
 */
#ifndef BLVD_RENDER_CELL_CHOICE_H
#define BLVD_RENDER_CELL_CHOICE_H

#include "assets/pkg.h"
#include "nav/nav_view.h"

struct cell_choice {
	const struct pkg *pkg;
	uint32_t stretch; /* chosen last, PKG_NONE before the first */
	bool searched;
	int64_t searched_mm[3]; /* where the nearest one was last looked for */
	uint32_t nearest;
};

void cell_choice_init(struct cell_choice *choice, const struct pkg *pkg);

/* The stretch for this eye; PKG_NONE only when the package has none. `nav` may be NULL. Cost: a few steps inside a view
 * cell; a walk over all stretches outside, every few metres. */
uint32_t cell_choice_make(struct cell_choice *choice, const struct nav_view *nav, const int64_t eye_mm[3]);

/* The stretch under the car, PKG_NONE when it is on no street with one. */
uint32_t cell_choice_of_car(const struct pkg *pkg, const struct nav_view *nav);

#endif
