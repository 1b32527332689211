/* Five by five; a few hundred multiplications a step. */
#include "nav/drift.h"

#include <string.h>

#include "platform/base/geo.h"

#define WANDER_M2PM 0.0004     /* along and across, m^2 a metre: wheels slip, lanes wind; 0.6 m after 1 km */
#define GYRO_RAD2PS 1e-7       /* noise of the rate, integrated */
#define TURN_SHARE 0.01        /* of every turn: scale of the yaw rate */
#define BLIND_TURN_RAD2PS 0.16 /* nobody tells the turn: 0.4 rad after a second */
#define HEADING_VAR_MAX 3.0    /* a heading knows no more than all directions */
#define BLIND_MAX_M 5000.0
#define WILD_SIGMA2 16.0

static void clear(struct drift *drift)
{
	memset(drift->cov, 0, sizeof(drift->cov));
	drift->blind_m = 0.0;
}

void drift_hold(struct drift *drift, const struct reckon *reckon, double heading_rad, double along_m, double across_m,
	double heading_sigma_rad)
{
	double s = sin(heading_rad), c = cos(heading_rad), a = along_m * along_m, b = across_m * across_m;
	clear(drift);
	drift->cov[DRIFT_EAST][DRIFT_EAST] = a * s * s + b * c * c;
	drift->cov[DRIFT_NORTH][DRIFT_NORTH] = a * c * c + b * s * s;
	drift->cov[DRIFT_EAST][DRIFT_NORTH] = drift->cov[DRIFT_NORTH][DRIFT_EAST] = (a - b) * s * c;
	drift->cov[DRIFT_HEADING][DRIFT_HEADING] = heading_sigma_rad * heading_sigma_rad;
	drift->cov[DRIFT_BIAS][DRIFT_BIAS] = reckon->bias_var;
	drift->cov[DRIFT_SCALE][DRIFT_SCALE] = reckon->scale_var;
}

bool drift_restore(struct drift *drift, const struct reckon *reckon, const double position_var[3], double heading_var)
{
	double e = position_var[0], n = position_var[1], en = position_var[2];
	if (!(e >= 0.0 && n >= 0.0 && e < 1e8 && n < 1e8 && en * en <= e * n && heading_var >= 0.0))
		return false;
	drift_hold(drift, reckon, 0.0, sqrt(n), sqrt(e), fmin(sqrt(heading_var), 2.0));
	drift->cov[DRIFT_EAST][DRIFT_NORTH] = drift->cov[DRIFT_NORTH][DRIFT_EAST] = en;
	return true;
}

/* cov = F cov F', where F is the unit matrix but for the first three rows. */
static void carry(struct drift *drift, double east_m, double north_m, double dt_s)
{
	/* the way gone turns with half of this step's error of the turn */
	const double f[3][DRIFT_SIZE] = {
		{ 1.0, 0.0, north_m, -0.5 * dt_s * north_m, east_m },
		{ 0.0, 1.0, -east_m, 0.5 * dt_s * east_m, north_m },
		{ 0.0, 0.0, 1.0, -dt_s, 0.0 },
	};
	double half[3][DRIFT_SIZE] = { { 0 } };
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < DRIFT_SIZE; k++)
			for (int j = 0; j < DRIFT_SIZE; j++)
				half[i][j] += f[i][k] * drift->cov[k][j];
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++) {
			drift->cov[i][j] = 0.0;
			for (int k = 0; k < DRIFT_SIZE; k++)
				drift->cov[i][j] += half[i][k] * f[j][k];
		}
		for (int j = 3; j < DRIFT_SIZE; j++)
			drift->cov[i][j] = drift->cov[j][i] = half[i][j];
	}
}

static void grow_blind(struct drift *drift, const struct reckon_step *step, const struct reckon_input *input)
{
	if (input->speed_valid) {
		drift->blind_mps = fabs(input->speed_mps);
		return;
	}
	drift->blind_m = fmin(drift->blind_m + drift->blind_mps * step->dt_s, BLIND_MAX_M);
}

void drift_step(
	struct drift *drift, const struct reckon *reckon, const struct reckon_step *step, const struct reckon_input *input)
{
	if (step->dt_s <= 0.0 || step->still)
		return;
	grow_blind(drift, step, input);
	double heading = bam_to_rad(reckon->heading_bam) - 0.5 * step->turn_rad, moved = fabs(step->distance_m);
	carry(drift, step->distance_m * sin(heading), step->distance_m * cos(heading), step->dt_s);
	drift->cov[DRIFT_EAST][DRIFT_EAST] += WANDER_M2PM * moved;
	drift->cov[DRIFT_NORTH][DRIFT_NORTH] += WANDER_M2PM * moved;
	double turned = TURN_SHARE * step->turn_rad;
	double heading_var = GYRO_RAD2PS * step->dt_s + turned * turned;
	if (!input->yaw_valid || step->gap)
		heading_var = BLIND_TURN_RAD2PS * step->dt_s;
	drift->cov[DRIFT_HEADING][DRIFT_HEADING] =
		fmin(drift->cov[DRIFT_HEADING][DRIFT_HEADING] + heading_var, HEADING_VAR_MAX);
}

bool drift_fix(
	struct drift *drift, double east_m, double north_m, double sigma_m, struct dvec2 *shift_m, double *turn_rad)
{
	/* within its way gone unseen the car may be anywhere */
	double blind2 = drift->blind_m * drift->blind_m, r = sigma_m * sigma_m;
	drift->cov[DRIFT_EAST][DRIFT_EAST] += blind2;
	drift->cov[DRIFT_NORTH][DRIFT_NORTH] += blind2;
	double a = drift->cov[DRIFT_EAST][DRIFT_EAST] + r, d = drift->cov[DRIFT_NORTH][DRIFT_NORTH] + r;
	double b = drift->cov[DRIFT_EAST][DRIFT_NORTH], det = a * d - b * b;
	double far = (d * east_m * east_m - 2.0 * b * east_m * north_m + a * north_m * north_m) / det;
	if (!(det > 0.0) || !(far <= WILD_SIGMA2)) {
		drift->cov[DRIFT_EAST][DRIFT_EAST] -= blind2;
		drift->cov[DRIFT_NORTH][DRIFT_NORTH] -= blind2;
		return false;
	}
	double gain[DRIFT_SIZE][2], rows[2][DRIFT_SIZE];
	for (int i = 0; i < DRIFT_SIZE; i++) {
		double e = drift->cov[i][DRIFT_EAST], n = drift->cov[i][DRIFT_NORTH];
		gain[i][0] = (e * d - n * b) / det;
		gain[i][1] = (n * a - e * b) / det;
	}
	memcpy(rows, drift->cov, sizeof(rows)); /* east and north are the first two */
	for (int i = 0; i < DRIFT_SIZE; i++)
		for (int j = 0; j < DRIFT_SIZE; j++)
			drift->cov[i][j] -= gain[i][0] * rows[0][j] + gain[i][1] * rows[1][j];
	*shift_m = (struct dvec2){ gain[DRIFT_EAST][0] * east_m + gain[DRIFT_EAST][1] * north_m,
		gain[DRIFT_NORTH][0] * east_m + gain[DRIFT_NORTH][1] * north_m };
	*turn_rad = gain[DRIFT_HEADING][0] * east_m + gain[DRIFT_HEADING][1] * north_m;
	drift->blind_m = 0.0;
	return true;
}

struct drift_ellipse drift_ellipse(const struct drift *drift)
{
	double e = drift->cov[DRIFT_EAST][DRIFT_EAST], n = drift->cov[DRIFT_NORTH][DRIFT_NORTH];
	double en = drift->cov[DRIFT_EAST][DRIFT_NORTH], mean = 0.5 * (e + n), half = hypot(0.5 * (n - e), en);
	return (struct drift_ellipse){
		.major_m = hypot(sqrt(fmax(mean + half, 0.0)), drift->blind_m),
		.minor_m = sqrt(fmax(mean - half, 0.0)),
		.heading_rad = 0.5 * atan2(2.0 * en, n - e),
	};
}
