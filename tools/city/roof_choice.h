/* Which roof a building gets that the data says nothing about, and how high a roof is. The rule: tools/README.md,
 * "Heights". */
#ifndef BLVD_TOOLS_CITY_ROOF_CHOICE_H
#define BLVD_TOOLS_CITY_ROOF_CHOICE_H

#include "tools/city/city.h"
#include "tools/city/site.h"

/* How a region builds; from where it lies, corrected by the roofs that the data does give. */
struct roof_style {
	double flat;    /* share of flat roofs among blocks of flats and offices */
	double mansard; /* share of mansards among the others, in dense places */
	bool europe;
};
struct roof_style roof_style_of(const struct city *city);

/* Never ROOF_UNKNOWN. */
enum roof_shape roof_choose(const struct roof_style *style, const struct building *building, const struct site *site);

/* The height of a roof of this shape over this footprint; 0 for flat ones. */
double roof_height(const struct building *building, enum roof_shape shape, const struct site *site);

#endif
