#include "nav/doubt.h"

#define ALONG_LEAST_M 1.0
#define ACROSS_M 1.8 /* within a lane */
#define HEADING_SIGMA 0.05
#define BLIND_M 5.0         /* gone unseen: from here on it matters */
#define CONFIRMED_M 150.0   /* driven on streets that fit: a remembered place is right */
#define CONFIRMED_SHARE 0.8 /* of the belief on one half-edge */
#define WILD_IN_A_ROW 5     /* fixes that disagree alike are right */

void doubt_init(struct nav *nav)
{
	nav->sure_ns = INT64_MIN;
	nav->place = NAV_PLACE_UNKNOWN;
}

static struct dvec2 reckoned(const struct nav *nav)
{
	return (struct dvec2){ (double)nav->reckon.pos_mm[0] * 1e-3, (double)nav->reckon.pos_mm[1] * 1e-3 };
}

void doubt_grow(struct nav *nav, const struct nav_input *input, const struct reckon_step *step)
{
	drift_step(&nav->drift, &nav->reckon, step, &input->motion);
	if (input->motion.speed_valid && nav->was_blind && nav->drift.blind_m > BLIND_M && nav->match.on_street) {
		match_blur(&nav->match, nav->drift.blind_m, true);
		nav->drift.blind_m = 0.0;
	}
	nav->was_blind = !input->motion.speed_valid;
}

void doubt_fix(struct nav *nav, struct dvec2 at_m, double sigma_m)
{
	struct dvec2 here = reckoned(nav), shift;
	double turn;
	bool taken = drift_fix(&nav->drift, at_m.x - here.x, at_m.y - here.y, fmax(sigma_m, 3.0), &shift, &turn);
	nav->wild_fixes = taken ? 0 : nav->wild_fixes + 1;
	if (taken) {
		reckon_shift(&nav->reckon, shift.x, shift.y);
		reckon_turn(&nav->reckon, turn);
		match_heading_corrected(&nav->match, turn);
		return;
	}
	if (nav->wild_fixes < WILD_IN_A_ROW)
		return;
	reckon_shift(&nav->reckon, at_m.x - here.x, at_m.y - here.y);
	drift_hold(&nav->drift, &nav->reckon, 0.0, 2.0 * sigma_m, 2.0 * sigma_m, 1.0);
	nav->wild_fixes = 0;
}

bool doubt_refutes_memory(struct nav *nav, struct dvec2 at_m, double sigma_m)
{
	if (!nav->remembered)
		return false;
	struct dvec2 here = reckoned(nav);
	double sigma = hypot(drift_ellipse(&nav->drift).major_m, sigma_m);
	nav->remembered = false;
	return hypot(at_m.x - here.x, at_m.y - here.y) > 4.0 * sigma + 20.0;
}

static enum nav_place judge(const struct nav *nav)
{
	double limit = nav->place == NAV_PLACE_DRIFTING ? DOUBT_END_M : DOUBT_BEGIN_M;
	if (!nav->match.located)
		return NAV_PLACE_UNKNOWN;
	if (nav->remembered)
		return NAV_PLACE_REMEMBERED;
	return drift_ellipse(&nav->drift).major_m > limit ? NAV_PLACE_DRIFTING : NAV_PLACE_SURE;
}

void doubt_settle(struct nav *nav, const struct nav_input *input, const struct reckon_step *step)
{
	bool on_street = nav->match.located && nav->match.on_street;
	/* a standing car learns nothing: what was remembered or measured stays as good as it was */
	if (on_street && input->motion.speed_valid && !step->still && step->dt_s > 0.0) {
		double heading = bam_to_rad(nav->reckon.heading_bam) + nav->match.offset_rad;
		drift_hold(
			&nav->drift, &nav->reckon, heading, fmax(nav->match.uncertainty_m, ALONG_LEAST_M), ACROSS_M, HEADING_SIGMA);
	}
	if (nav->remembered && on_street && nav->reckon.travelled_m - nav->remembered_at_m > CONFIRMED_M &&
		nav->match.confidence > CONFIRMED_SHARE && drift_ellipse(&nav->drift).major_m < DOUBT_BEGIN_M)
		nav->remembered = nav->turned_unseen = false;
	nav->place = judge(nav);
	if (nav->place == NAV_PLACE_SURE)
		nav->sure_ns = nav->reckon.time_ns;
}

void doubt_view(const struct nav *nav, struct nav_doubt *out)
{
	struct drift_ellipse ellipse = drift_ellipse(&nav->drift);
	*out = (struct nav_doubt){
		.place = nav->place,
		.age_ns = INT64_MAX,
		.major_m = ellipse.major_m,
		.minor_m = ellipse.minor_m,
		.heading_bam = bam_from_rad(ellipse.heading_rad),
	};
	if (nav->sure_ns != INT64_MIN)
		out->age_ns = nav->reckon.time_ns > nav->sure_ns ? nav->reckon.time_ns - nav->sure_ns : 0;
}
