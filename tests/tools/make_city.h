/* Cities written by hand in a test: ways by points and tags. Header only. */
#ifndef BLVD_TESTS_TOOLS_MAKE_CITY_H
#define BLVD_TESTS_TOOLS_MAKE_CITY_H

#include <stdarg.h>
#include <stdlib.h>

#include "tools/bake/bake.h"

static inline void city_start(struct city *city, struct report *report)
{
	*report = (struct report){ 0 };
	*city = (struct city){ .name = "test", .right_hand_traffic = true, .report = report };
}

/* `nodes`: count x { id, x, y }, metres; id 0 is a node of its own. Returns the way for further tags; valid until the
 * next one is added. */
static inline struct way *city_street(struct city *city, int64_t id, size_t count, const double (*nodes)[3])
{
	struct way way = {
		.id = id,
		.nodes = POOL_ARRAY(&city->pool, struct way_node, count),
		.node_count = count,
		.street_class = PKG_STREET_RESIDENTIAL,
		.drivable = true,
		.lanes_forward = 1,
		.lanes_backward = 1,
		.width_m = 6.0,
		.speed_kmh = 50,
	};
	for (size_t i = 0; i < count; i++) {
		int64_t node = (int64_t)nodes[i][0];
		way.nodes[i] = (struct way_node){ node ? node : -(int64_t)(city->ways.count * 10000 + i + 1),
			{ nodes[i][1], nodes[i][2] }, 0 };
	}
	ARRAY_PUSH(&city->ways, way);
	return &city->ways.items[city->ways.count - 1];
}

#endif
