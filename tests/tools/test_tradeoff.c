/* What rows come to, worked by hand, and their files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tools/measure/tradeoff.h"

static void quantiles_are_values_of_the_set(void **state)
{
	(void)state;
	double values[] = { 5.0, 1.0, 4.0, 2.0, 3.0 };
	struct spread s = spread_of(values, 5);
	assert_true(s.median == 3.0 && s.p95 == 5.0 && s.max == 5.0 && fabs(s.mean - 3.0) < 1e-12);
	double hundred[100];
	for (int i = 0; i < 100; i++)
		hundred[i] = 100.0 - i;
	s = spread_of(hundred, 100);
	assert_true(s.median == 50.0 && s.p95 == 95.0 && s.p99 == 99.0 && s.p999 == 100.0);
	s = spread_of(NULL, 0);
	assert_true(s.median == 0.0 && s.max == 0.0);
}

static struct trial_row row_of(uint32_t frame, double cpu_ms)
{
	return (struct trial_row){ .frame = frame, .cpu_ms = cpu_ms, .wall_ms = 2.0 * cpu_ms, .place = TRIAL_INSIDE };
}

static const struct trial_config config = { .width = 64, .height = 64 };

/* Four frames of full (40 ms), pvs (20, something far in the last two only: 20 and 24), impostor (10, 10, 5, 8). */
static struct tradeoff three_ways(void)
{
	struct tradeoff out = { .config = &config };
	struct tradeoff_run run = { .tau_px = 1.0,
		.trial = { .count = 3, .entrants = { { .name = "full" }, { .name = "pvs" }, { .name = "impostor" } } } };
	static const double times[3][4] = { { 40, 40, 40, 40 }, { 18, 19, 20, 24 }, { 10, 10, 5, 8 } };
	for (int k = 0; k < 3; k++) {
		for (uint32_t i = 0; i < 4; i++) {
			struct trial_row row = row_of(i, times[k][i]);
			row.far_triangles = k == 1 && i >= 2 ? 100 : 0;
			ARRAY_PUSH(&run.trial.rows[k].rows, row);
		}
	}
	ARRAY_PUSH(&out.runs, run);
	return out;
}

static void speed_ups_are_ratios_of_medians(void **state)
{
	(void)state;
	struct tradeoff tradeoff = three_ways();
	tradeoff_sum_up(&tradeoff);
	assert_int_equal(tradeoff.settings.count, 3);
	const struct setting *impostor = tradeoff_find(&tradeoff, "impostor", 1.0);
	assert_non_null(impostor);
	assert_true(impostor->cpu_ms.median == 8.0 && impostor->speed_up == 5.0 && impostor->speed_up_wall == 5.0);
	assert_true(impostor->speed_up_pvs == 20.0 / 5.0);
	assert_true(tradeoff_find(&tradeoff, "full", -1.0)->speed_up == 1.0);
	assert_null(tradeoff_find(&tradeoff, "impostor", 2.0));
	tradeoff_finish(&tradeoff);
}

static void pops_are_judged_by_place(void **state)
{
	(void)state;
	struct tradeoff tradeoff = three_ways();
	struct trial_row *rows = tradeoff.runs.items[0].trial.rows[2].rows.items;
	static const double rms[4] = { 9.0, 0.5, 0.9, 0.6 };
	static const enum trial_place places[4] = { TRIAL_INSIDE, TRIAL_INSIDE, TRIAL_CHANGE, TRIAL_SETTLING };
	for (int i = 0; i < 4; i++) {
		rows[i].popping_known = i > 0; /* the first is not counted */
		rows[i].popping.rms = rms[i];
		rows[i].place = places[i];
	}
	tradeoff_sum_up(&tradeoff);
	const struct setting *s = tradeoff_find(&tradeoff, "impostor", 1.0);
	assert_int_equal(s->cell_changes, 1);
	assert_true(s->popping_inside_p99 == 0.5 && s->popping_change_max == 0.9 && s->popping_settling_max == 0.6);
	assert_true(fabs(s->popping_ratio - 1.8) < 1e-12);
	tradeoff_finish(&tradeoff);
}

static void accuracy_is_of_compared_frames(void **state)
{
	(void)state;
	struct tradeoff tradeoff = three_ways();
	struct trial_row *rows = tradeoff.runs.items[0].trial.rows[2].rows.items;
	rows[0].flip = 5.0; /* not compared: ignored */
	for (int i = 1; i < 3; i++) {
		rows[i].compared = true;
		rows[i].flip = i * 0.1;
		rows[i].psnr_db = 40.0 - i;
		rows[i].pixels = 1000;
		rows[i].uncovered = (uint64_t)i;
		rows[i].displacement = (struct displacement_count){ .pixels = { [4] = 9, [5] = 1 }, .max_px = 1.0 + i };
	}
	tradeoff_sum_up(&tradeoff);
	const struct setting *s = tradeoff_find(&tradeoff, "impostor", 1.0);
	assert_int_equal(s->compared, 2);
	assert_true(fabs(s->flip - 0.15) < 1e-12 && s->flip_worst == 0.2 && s->psnr_db_worst == 38.0);
	assert_true(fabs(s->uncovered_mean - 0.0015) < 1e-12 && s->uncovered_worst == 0.002);
	assert_true(displacement_share(&s->displacement, 1.0) == 0.9 && s->displacement.max_px == 3.0);
	struct judged_row table[JUDGED_ROWS_MAX];
	assert_true(tradeoff_judge(&tradeoff, table) >= 10);
	tradeoff_finish(&tradeoff);
}

static void the_front_and_the_advice_follow(void **state)
{
	(void)state;
	struct tradeoff tradeoff = { 0 };
	static const struct setting settings[] = {
		{ .name = "full", .speed_up = 1, .cpu_ms = { .median = 40 }, .flip = 0.0, .resident_bytes = 400 },
		{ .name = "pvs", .speed_up = 2, .cpu_ms = { .median = 20 }, .flip = 0.0, .resident_bytes = 300 },
		{ .name = "impostor", .speed_up = 8, .cpu_ms = { .median = 5 }, .flip = 0.02, .resident_bytes = 60 },
		{ .name = "none", .speed_up = 7, .cpu_ms = { .median = 6 }, .flip = 0.3, .resident_bytes = 50 },
	};
	for (size_t i = 0; i < 4; i++)
		ARRAY_PUSH(&tradeoff.settings, settings[i]);
	assert_string_equal(tradeoff_within_ms(&tradeoff, 100)->name, "full");
	assert_string_equal(tradeoff_within_ms(&tradeoff, 16)->name, "impostor");
	assert_null(tradeoff_within_ms(&tradeoff, 4));
	assert_string_equal(tradeoff_within_flip(&tradeoff, 0.01)->name, "pvs");
	assert_string_equal(tradeoff_within_flip(&tradeoff, 0.05)->name, "impostor");
	assert_string_equal(tradeoff_within_bytes(&tradeoff, 55)->name, "none");
	assert_string_equal(tradeoff_within_bytes(&tradeoff, 100)->name, "impostor");
	assert_null(tradeoff_within_bytes(&tradeoff, 10));
	tradeoff_finish(&tradeoff);
}

static void rows_come_back_from_their_file(void **state)
{
	(void)state;
	char path[] = "/tmp/blvd-rows-XXXXXX";
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	close(fd);
	struct trial_rows out = { 0 }, back = { 0 };
	struct trial_row row = row_of(17, 12.25);
	row.stretch = UINT32_MAX;
	row.gpu_bytes = UINT64_C(1) << 40;
	row.compared = row.popping_known = true;
	row.ssim = 0.875;
	row.displacement = (struct displacement_count){ .pixels = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 }, .max_px = 15.5 };
	ARRAY_PUSH(&out.rows, row);
	row.frame++;
	ARRAY_PUSH(&out.rows, row);
	assert_int_equal(trial_rows_write(&out, path), 0);
	assert_int_equal(trial_rows_read(&back, path), 0);
	assert_int_equal(back.rows.count, 2);
	const struct trial_row *got = &back.rows.items[0];
	assert_int_equal(got->frame, 17);
	assert_true(got->stretch == UINT32_MAX && got->gpu_bytes == row.gpu_bytes && got->compared);
	assert_true(got->ssim == 0.875 && got->cpu_ms == 12.25 && got->displacement.pixels[9] == 10);
	FILE *file = fopen(path, "a");
	fputs("1,2,3\n", file);
	fclose(file);
	assert_int_equal(trial_rows_read(&back, path), -EBADMSG);
	unlink(path);
	assert_int_equal(trial_rows_read(&back, path), -ENOENT);
	ARRAY_FINISH(&out.rows);
	ARRAY_FINISH(&back.rows);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quantiles_are_values_of_the_set),
		cmocka_unit_test(speed_ups_are_ratios_of_medians),
		cmocka_unit_test(pops_are_judged_by_place),
		cmocka_unit_test(accuracy_is_of_compared_frames),
		cmocka_unit_test(the_front_and_the_advice_follow),
		cmocka_unit_test(rows_come_back_from_their_file),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
