/* Dead reckoning; constant cost an update. */
#include "nav/reckon.h"

#include <math.h>

#include "platform/base/clock.h"
#include "platform/base/geo.h"

#define STILL_MPS 0.05
#define STILL_SETTLE_S 0.7           /* the body still rocks for a moment after the wheels stopped */
#define BIAS_MAX_RPS 0.06            /* 3.4 degrees a second; more is a broken sensor or a turntable */
#define BIAS_NOISE_RPS 0.003         /* one standing second's mean is this good */
#define BIAS_WALK_RPS2 (1e-5 * 1e-5) /* per second: drift with temperature */
#define TURN_GAP_NS NS_PER_S

void reckon_init(struct reckon *reckon, const struct reckon_config *config)
{
	*reckon = (struct reckon){ .config = *config, .speed_scale = 1.0 };
	if (reckon->config.gap_ns <= 0)
		reckon->config.gap_ns = 12 * NS_PER_S;
	reckon->scale_var = 0.02 * 0.02;
	reckon->bias_var = 0.02 * 0.02;
}

void reckon_place(struct reckon *reckon, const int64_t pos_mm[2], int32_t heading_bam)
{
	for (int k = 0; k < 2; k++) {
		reckon->pos_mm[k] = pos_mm[k];
		reckon->fraction_mm[k] = 0.0;
	}
	reckon->heading_bam = heading_bam;
	reckon->fraction_bam = 0.0;
}

void reckon_shift(struct reckon *reckon, double east_m, double north_m)
{
	const double by_m[2] = { east_m, north_m };
	for (int k = 0; k < 2; k++) {
		reckon->fraction_mm[k] += by_m[k] * 1e3;
		double whole = floor(reckon->fraction_mm[k]);
		reckon->pos_mm[k] += (int64_t)whole;
		reckon->fraction_mm[k] -= whole;
	}
}

void reckon_turn(struct reckon *reckon, double rad)
{
	double turns = rad / (2.0 * BLVD_PI);
	reckon->fraction_bam += (turns - floor(turns)) * 4294967296.0;
	double whole = floor(reckon->fraction_bam);
	reckon->heading_bam = (int32_t)((uint32_t)reckon->heading_bam + (uint32_t)(uint64_t)whole);
	reckon->fraction_bam -= whole;
}

static double yaw_of(const struct reckon *reckon, const struct reckon_input *input)
{
	if (!input->yaw_valid || !isfinite(input->yaw_rate_rps))
		return 0.0;
	return input->yaw_rate_rps - (input->yaw_biased ? reckon->yaw_bias_rps : 0.0);
}

static double speed_of(const struct reckon *reckon, const struct reckon_input *input)
{
	return input->speed_valid && isfinite(input->speed_mps) ? input->speed_mps * reckon->speed_scale : 0.0;
}

static bool stands(const struct reckon_input *input)
{
	return input->speed_valid && fabs(input->speed_mps) < STILL_MPS;
}

/* Scalar Kalman update of `value` with a measurement. */
static void kalman(double *value, double *var, double measured, double measured_var)
{
	double gain = *var / (*var + measured_var);
	*value += gain * (measured - *value);
	*var *= 1.0 - gain;
}

static void learn_bias_standing(struct reckon *reckon, const struct reckon_input *input, double dt_s)
{
	double said = input->yaw_rate_rps;
	if (!input->yaw_valid || !input->yaw_biased || !(fabs(said) <= BIAS_MAX_RPS) || reckon->still_s < STILL_SETTLE_S ||
		dt_s > 1.0)
		return;
	kalman(&reckon->yaw_bias_rps, &reckon->bias_var, said, BIAS_NOISE_RPS * BIAS_NOISE_RPS / dt_s);
}

/* The position moves along the chord: heading at the middle of the turn. */
static void move(struct reckon *reckon, const struct reckon_step *step)
{
	double half = 0.5 * step->turn_rad;
	double chord = fabs(half) > 1e-6 ? step->distance_m * sin(half) / half : step->distance_m;
	double heading = bam_to_rad(reckon->heading_bam) + half;
	reckon_shift(reckon, chord * sin(heading), chord * cos(heading));
	reckon_turn(reckon, step->turn_rad);
	reckon->travelled_m += fabs(step->distance_m);
}

struct reckon_step reckon_update(struct reckon *reckon, const struct reckon_input *input, int64_t now_ns)
{
	struct reckon_step step = { 0 };
	struct reckon_input before = reckon->started ? reckon->last : *input;
	int64_t dt_ns = reckon->started ? now_ns - reckon->time_ns : 0;
	reckon->last = *input;
	reckon->time_ns = now_ns;
	reckon->started = true;
	if (dt_ns < 0) {
		reckon->steps_back++;
		return step;
	}
	if (dt_ns == 0)
		return step;
	step.dt_s = (double)(dt_ns < reckon->config.gap_ns ? dt_ns : reckon->config.gap_ns) / (double)NS_PER_S;
	step.gap = dt_ns > TURN_GAP_NS;
	step.still = stands(input) && stands(&before);
	reckon->bias_var += BIAS_WALK_RPS2 * step.dt_s;
	if (step.still) {
		reckon->still_s += step.dt_s;
		learn_bias_standing(reckon, input, step.dt_s);
		return step;
	}
	reckon->still_s = 0.0;
	step.distance_m = 0.5 * (speed_of(reckon, &before) + speed_of(reckon, input)) * step.dt_s;
	double turn_s = step.gap ? (double)TURN_GAP_NS / (double)NS_PER_S : step.dt_s;
	step.turn_rad = 0.5 * (yaw_of(reckon, &before) + yaw_of(reckon, input)) * turn_s;
	move(reckon, &step);
	return step;
}

void reckon_bias_reference(struct reckon *reckon, double corrected_rad, double over_s, double sigma_rad)
{
	if (!(over_s > 0.5))
		return;
	double rate_var = 2.0 * sigma_rad * sigma_rad / (over_s * over_s) + 1e-6;
	kalman(&reckon->yaw_bias_rps, &reckon->bias_var, reckon->yaw_bias_rps - corrected_rad / over_s, rate_var);
	reckon->yaw_bias_rps = fmin(fmax(reckon->yaw_bias_rps, -BIAS_MAX_RPS), BIAS_MAX_RPS);
}

void reckon_distance_reference(struct reckon *reckon, double true_m, double reckoned_m, double sigma_m)
{
	if (!(reckoned_m > 1.0) || !(true_m > 0.0))
		return;
	double scale = reckon->speed_scale * true_m / reckoned_m;
	kalman(&reckon->speed_scale, &reckon->scale_var, scale, sigma_m * sigma_m / (reckoned_m * reckoned_m));
	reckon->scale_var += 1e-8;
	reckon->speed_scale = fmin(fmax(reckon->speed_scale, 0.9), 1.1);
}
