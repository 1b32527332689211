/*
 * Buildings put in order among one another, whatever source they came from: heights that contradict themselves, the
 * same building twice, parts and their outlines. Runs once, after all buildings are read.
 */
#ifndef BLVD_TOOLS_READ_SETTLE_H
#define BLVD_TOOLS_READ_SETTLE_H

#include "tools/read/shape.h"

/* `preferred_first`: buildings from this index on come from a building set and win over those before it. Pass the
 * number of buildings when there is no set. `dropped` receives the ids of those of OSM (before that index) that went.
 */
typedef ARRAY(int64_t) id_array;
void settle_buildings(struct city *city, struct shaper *shaper, size_t preferred_first, id_array *dropped);

#endif
