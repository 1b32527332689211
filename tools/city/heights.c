#include "tools/bake/bake.h"

void heights_infer(struct city *city)
{
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *building = &city->buildings.items[i];
		if (building->height_m <= 0.0) {
			building->height_source = building->levels > 0.0 ? HEIGHT_LEVELS : HEIGHT_KIND;
			building->levels = building->levels > 0.0 ? building->levels : 5.0;
			building->height_m = building->levels * 3.2;
		}
		if (building->levels <= 0.0)
			building->levels = fmax(1.0, floor(building->height_m / 3.2));
		if (building->roof_shape == ROOF_UNKNOWN)
			building->roof_shape = ROOF_FLAT;
		city->report->heights[building->height_source]++;
	}
}
