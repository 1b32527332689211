/* Rows to settings. */
#include <math.h>
#include <string.h>

#include "tools/measure/tradeoff.h"

typedef ARRAY(double) values;

static struct spread take(values *of)
{
	struct spread out = spread_of(of->items, of->count);
	ARRAY_FINISH(of);
	return out;
}

#define SPREAD(out, rows, field)                                                                                       \
	do {                                                                                                               \
		values of = { 0 };                                                                                             \
		for (size_t i = 0; i < (rows)->count; i++)                                                                     \
			ARRAY_PUSH(&of, (double)(rows)->items[i].field);                                                           \
		*(out) = take(&of);                                                                                            \
	} while (0)

static void sum_speed(struct setting *out, const struct trial_rows *rows)
{
	SPREAD(&out->cpu_ms, &rows->rows, cpu_ms);
	SPREAD(&out->wall_ms, &rows->rows, wall_ms);
	SPREAD(&out->triangles, &rows->rows, triangles);
	SPREAD(&out->far_triangles, &rows->rows, far_triangles);
	SPREAD(&out->draws, &rows->rows, draws);
}

static void sum_accuracy(struct setting *out, const struct trial_rows *rows)
{
	out->psnr_db_worst = INFINITY;
	out->ssim_worst = 1.0;
	for (size_t i = 0; i < rows->rows.count; i++) {
		const struct trial_row *row = &rows->rows.items[i];
		if (!row->compared)
			continue;
		double uncovered = row->pixels ? (double)row->uncovered / (double)row->pixels : 0.0;
		out->compared++;
		out->psnr_db += row->psnr_db;
		out->ssim += row->ssim;
		out->flip += row->flip;
		out->precision += row->precision;
		out->recall += row->recall;
		out->precision_2 += row->precision_2;
		out->recall_2 += row->recall_2;
		out->uncovered_mean += uncovered;
		out->psnr_db_worst = fmin(out->psnr_db_worst, row->psnr_db);
		out->ssim_worst = fmin(out->ssim_worst, row->ssim);
		out->flip_worst = fmax(out->flip_worst, row->flip);
		out->uncovered_worst = fmax(out->uncovered_worst, uncovered);
		out->cracks += row->cracks;
		displacement_join(&out->displacement, &row->displacement);
	}
	double *means[] = { &out->psnr_db, &out->ssim, &out->flip, &out->precision, &out->recall, &out->precision_2,
		&out->recall_2, &out->uncovered_mean };
	for (size_t i = 0; i < sizeof(means) / sizeof(means[0]); i++)
		*means[i] /= fmax(1.0, out->compared);
}

static void sum_popping(struct setting *out, const struct trial_rows *rows)
{
	values inside = { 0 };
	for (size_t i = 0; i < rows->rows.count; i++) {
		const struct trial_row *row = &rows->rows.items[i];
		out->fallback_frames += row->fallback;
		out->late_frames += row->late;
		out->cell_changes += row->place == TRIAL_CHANGE;
		if (!row->popping_known)
			continue;
		if (row->place == TRIAL_INSIDE)
			ARRAY_PUSH(&inside, row->popping.rms);
		else if (row->place == TRIAL_CHANGE)
			out->popping_change_max = fmax(out->popping_change_max, row->popping.rms);
		else if (row->place == TRIAL_SETTLING)
			out->popping_settling_max = fmax(out->popping_settling_max, row->popping.rms);
	}
	out->popping_inside_p99 = take(&inside).p99;
	if (out->popping_inside_p99 > 0.0)
		out->popping_ratio = fmax(out->popping_change_max, out->popping_settling_max) / out->popping_inside_p99;
}

/* The reference shows itself. */
static void settle_reference(struct setting *full)
{
	full->psnr_db = full->psnr_db_worst = 99.0;
	full->ssim = full->ssim_worst = full->precision = full->recall = full->precision_2 = full->recall_2 = 1.0;
}

static const struct trial_rows *rows_of(const struct trial_result *trial, const char *name)
{
	for (uint32_t i = 0; i < trial->count; i++)
		if (!strcmp(trial->entrants[i].name, name))
			return &trial->rows[i];
	return NULL;
}

/* Where far things are in view: where the visible set has any. */
static double speed_up_pvs(const struct trial_result *trial, const struct trial_rows *rows)
{
	const struct trial_rows *pvs = rows_of(trial, "pvs");
	values theirs = { 0 }, ours = { 0 };
	if (!pvs || pvs == rows)
		return 0.0;
	for (size_t i = 0; i < rows->rows.count && i < pvs->rows.count; i++) {
		if (!pvs->rows.items[i].far_triangles)
			continue;
		ARRAY_PUSH(&theirs, pvs->rows.items[i].cpu_ms);
		ARRAY_PUSH(&ours, rows->rows.items[i].cpu_ms);
	}
	double slow = take(&theirs).median, fast = take(&ours).median;
	return fast > 0.0 ? slow / fast : 0.0;
}

static struct setting sum_up(const struct tradeoff_run *run, uint32_t which)
{
	const struct trial_result *trial = &run->trial;
	const struct trial_entrant *entrant = &trial->entrants[which];
	const struct trial_rows *rows = &trial->rows[which];
	struct setting out = { .tau_px = run->tau_px,
		.frames = (uint32_t)rows->rows.count,
		.start_ms = entrant->start_ms,
		.first_frame_ms = entrant->first_frame_ms };
	memcpy(out.name, entrant->name, sizeof(out.name));
	out.resident_bytes = entrant->cpu_bytes + entrant->gpu_bytes;
	struct setting full = { 0 };
	sum_speed(&out, rows);
	sum_speed(&full, &trial->rows[0]);
	out.speed_up = out.cpu_ms.median > 0.0 ? full.cpu_ms.median / out.cpu_ms.median : 0.0;
	out.speed_up_wall = out.wall_ms.median > 0.0 ? full.wall_ms.median / out.wall_ms.median : 0.0;
	out.speed_up_pvs = speed_up_pvs(trial, rows);
	sum_accuracy(&out, rows);
	sum_popping(&out, rows);
	if (which == 0)
		settle_reference(&out);
	return out;
}

static bool depends_on_tau(const char *name)
{
	static const char *const plain[] = { "full", "none", "pvs" };
	for (size_t i = 0; i < sizeof(plain) / sizeof(plain[0]); i++)
		if (!strcmp(name, plain[i]))
			return false;
	return true;
}

/* Times of different runs are compared by their ratio to `full` of the same run. */
static bool beats(const struct setting *a, const struct setting *b)
{
	return a->speed_up >= b->speed_up && a->flip <= b->flip && (a->speed_up > b->speed_up || a->flip < b->flip);
}

static void find_pareto(struct tradeoff *tradeoff)
{
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		struct setting *setting = &tradeoff->settings.items[i];
		setting->pareto = true;
		for (size_t k = 0; k < tradeoff->settings.count; k++)
			setting->pareto = setting->pareto && !beats(&tradeoff->settings.items[k], setting);
	}
}

void tradeoff_sum_up(struct tradeoff *tradeoff)
{
	tradeoff->settings.count = 0;
	for (size_t i = 0; i < tradeoff->runs.count; i++) {
		const struct tradeoff_run *run = &tradeoff->runs.items[i];
		for (uint32_t k = 0; k < run->trial.count; k++)
			if (i == 0 || depends_on_tau(run->trial.entrants[k].name))
				ARRAY_PUSH(&tradeoff->settings, sum_up(run, k));
	}
	find_pareto(tradeoff);
}

void tradeoff_finish(struct tradeoff *tradeoff)
{
	for (size_t i = 0; i < tradeoff->runs.count; i++)
		trial_result_finish(&tradeoff->runs.items[i].trial);
	ARRAY_FINISH(&tradeoff->runs);
	ARRAY_FINISH(&tradeoff->settings);
	pool_finish(&tradeoff->strings);
}

const struct setting *tradeoff_find(const struct tradeoff *tradeoff, const char *name, double tau_px)
{
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *setting = &tradeoff->settings.items[i];
		if (!strcmp(setting->name, name) && (tau_px < 0.0 || setting->tau_px == tau_px))
			return setting;
	}
	return NULL;
}

const struct setting *tradeoff_within_ms(const struct tradeoff *tradeoff, double cpu_ms)
{
	const struct setting *best = NULL;
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *setting = &tradeoff->settings.items[i];
		if (setting->cpu_ms.median <= cpu_ms && (!best || setting->flip < best->flip))
			best = setting;
	}
	return best;
}

const struct setting *tradeoff_within_flip(const struct tradeoff *tradeoff, double flip)
{
	const struct setting *best = NULL;
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *setting = &tradeoff->settings.items[i];
		if (setting->flip <= flip && (!best || setting->speed_up > best->speed_up))
			best = setting;
	}
	return best;
}

const struct setting *tradeoff_within_bytes(const struct tradeoff *tradeoff, uint64_t bytes)
{
	const struct setting *best = NULL;
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *setting = &tradeoff->settings.items[i];
		if (setting->resident_bytes <= bytes && (!best || setting->flip < best->flip))
			best = setting;
	}
	return best;
}
