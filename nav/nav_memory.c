/* From one run to the next: what is worth keeping of the place, and going on from it. */
#include "nav/doubt.h"

#define FAR_M 1000.0 /* from any street of this city: another place on earth */
#define RADIUS_M 15.0
#define SAME_PLACE_M 30.0 /* a half-edge that is farther away than this is not the one that was meant */
#define SIGMA_MAX_M 500.0

bool nav_remember(const struct nav *nav, struct nav_memory *out)
{
	if (!nav->match.located)
		return false;
	struct dvec2 at = { (double)nav->reckon.pos_mm[0] * 1e-3, (double)nav->reckon.pos_mm[1] * 1e-3 };
	struct geo_point geo = geo_from_plane(&nav->pkg->frame, at);
	const double(*cov)[DRIFT_SIZE] = nav->drift.cov;
	double blind2 = nav->drift.blind_m * nav->drift.blind_m;
	*out = (struct nav_memory){
		.lat_deg = geo.lat_deg,
		.lon_deg = geo.lon_deg,
		.height_m = nav->height_m,
		.heading_rad = bam_to_rad(nav->reckon.heading_bam),
		.position_var = { cov[DRIFT_EAST][DRIFT_EAST] + blind2, cov[DRIFT_NORTH][DRIFT_NORTH] + blind2,
			cov[DRIFT_EAST][DRIFT_NORTH] },
		.heading_var = cov[DRIFT_HEADING][DRIFT_HEADING],
		.speed_scale = nav->reckon.speed_scale,
		.scale_var = nav->reckon.scale_var,
		.yaw_bias_rps = nav->reckon.yaw_bias_rps,
		.bias_var = nav->reckon.bias_var,
		.half = nav->match.half,
		.on_street = nav->match.on_street,
		.along_m = nav->match.along_m,
	};
	return true;
}

static bool within(double value, double low, double high)
{
	return value >= low && value <= high; /* false for what is no number */
}

/* A night changes the bias; the scale is the tyres'. */
static void restore_sensors(struct nav *nav, const struct nav_memory *memory)
{
	struct reckon *reckon = &nav->reckon;
	if (within(memory->speed_scale, 0.9, 1.1) && within(memory->scale_var, 0.0, reckon->scale_var)) {
		reckon->speed_scale = memory->speed_scale;
		reckon->scale_var = fmin(memory->scale_var + 0.002 * 0.002, reckon->scale_var);
	}
	if (within(memory->yaw_bias_rps, -0.06, 0.06) && within(memory->bias_var, 0.0, reckon->bias_var)) {
		reckon->yaw_bias_rps = memory->yaw_bias_rps;
		reckon->bias_var = fmin(memory->bias_var + 0.003 * 0.003, reckon->bias_var);
	}
}

static bool same_half(const struct nav *nav, const struct nav_memory *memory, struct dvec2 at)
{
	if (memory->half >= nav->graph.net->half_count ||
		!within(memory->along_m, -1.0, graph_length_m(&nav->graph, memory->half) + 1.0))
		return false;
	struct dvec3 there = graph_at(&nav->graph, memory->half, memory->along_m).at_m;
	return hypot(there.x - at.x, there.y - at.y) < SAME_PLACE_M;
}

static bool restore_match(struct nav *nav, const struct nav_memory *memory, struct dvec2 at, bool same_package)
{
	double sigma = fmin(drift_ellipse(&nav->drift).major_m, SIGMA_MAX_M), radius = fmax(RADIUS_M, 2.0 * sigma);
	int32_t heading = nav->reckon.heading_bam;
	bool found = false;
	if (memory->on_street && same_package && same_half(nav, memory, at)) {
		match_place(&nav->match, memory->half, memory->along_m, fmax(sigma, 1.0), heading);
		return true;
	}
	for (; !found && radius < 2.0 * FAR_M; radius *= 2.0)
		found = memory->on_street ? match_place_near(&nav->match, at, fmin(radius, FAR_M), true, heading)
								  : match_place_off(&nav->match, at, fmin(radius, FAR_M), heading);
	return found;
}

bool nav_restore(struct nav *nav, const struct nav_memory *memory, bool same_package)
{
	restore_sensors(nav, memory);
	if (!within(memory->lat_deg, -90.0, 90.0) || !within(memory->lon_deg, -360.0, 360.0) ||
		!within(memory->heading_rad, -10.0, 10.0) || !within(memory->height_m, -1e4, 1e4))
		return false;
	struct dvec2 at = geo_to_plane(&nav->pkg->frame, (struct geo_point){ memory->lat_deg, memory->lon_deg });
	struct graph_hit nearest;
	if (!(hypot(at.x, at.y) < 1e6) || !graph_nearest(&nav->graph, at, FAR_M, &nearest, 1))
		return false;
	struct reckon before = nav->reckon;
	const int64_t pos_mm[2] = { llrint(at.x * 1e3), llrint(at.y * 1e3) };
	reckon_place(&nav->reckon, pos_mm, bam_from_rad(memory->heading_rad));
	if (!drift_restore(&nav->drift, &nav->reckon, memory->position_var, memory->heading_var))
		drift_hold(&nav->drift, &nav->reckon, 0.0, 50.0, 50.0, 0.5);
	if (!restore_match(nav, memory, at, same_package)) {
		nav->reckon = before;
		return false;
	}
	nav->height_m = memory->height_m;
	if (nav->match.on_street)
		nav->height_m = graph_at(&nav->graph, nav->match.half, nav->match.along_m).at_m.z;
	nav->heading_known = nav->remembered = true;
	nav->remembered_at_m = nav->reckon.travelled_m;
	nav->place = NAV_PLACE_REMEMBERED;
	return true;
}

void nav_moved_unseen(struct nav *nav, double by_m)
{
	if (!nav->match.located || !(by_m > 0.0))
		return;
	match_blur(&nav->match, by_m, false);
	nav->moved_unseen = nav->turned_unseen = true;
	nav->drift.blind_m = fmin(nav->drift.blind_m + by_m, 5000.0);
}
