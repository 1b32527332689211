/* Jobs are done in order, each once; nothing is lost at the end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "platform/base/worker.h"

#define JOBS 1000

struct sums {
	uint32_t order[JOBS], count;
};

static void note(void *context, uint32_t job)
{
	struct sums *sums = context;
	sums->order[sums->count++] = job;
}

static void jobs_are_done_in_order(void **state)
{
	(void)state;
	static struct sums sums;
	struct worker worker;
	assert_int_equal(worker_init(&worker, "test", note, &sums), 0);
	uint32_t given = 0, taken = 0, job;
	while (taken < JOBS) {
		while (given < JOBS && worker_give(&worker, given * 7))
			given++;
		assert_true(worker_take(&worker, true, &job));
		assert_int_equal(job, taken * 7);
		taken++;
	}
	assert_false(worker_take(&worker, true, &job)); /* does not wait for what nobody gave */
	worker_finish(&worker);
	assert_int_equal(sums.count, JOBS);
	for (uint32_t i = 0; i < JOBS; i++)
		assert_int_equal(sums.order[i], i * 7);
}

static void a_full_queue_refuses(void **state)
{
	(void)state;
	static struct sums sums;
	struct worker worker;
	assert_int_equal(worker_init(&worker, "test", note, &sums), 0);
	for (uint32_t i = 0; i < WORKER_JOBS_MAX; i++)
		assert_true(worker_give(&worker, i));
	assert_false(worker_give(&worker, 1));
	uint32_t job;
	assert_true(worker_take(&worker, true, &job));
	assert_true(worker_give(&worker, 1));
	worker_finish(&worker);
}

static void finishing_needs_no_beginning(void **state)
{
	(void)state;
	struct worker worker = { 0 };
	worker_finish(&worker);
	worker_finish(&worker);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(jobs_are_done_in_order),
		cmocka_unit_test(a_full_queue_refuses),
		cmocka_unit_test(finishing_needs_no_beginning),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
