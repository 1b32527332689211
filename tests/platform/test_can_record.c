/* Recording: nothing lost, bounded, and what a full disk does. The disk is made full by a limit on file sizes. */
#include <errno.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/can/can_record.h"

#define LINE_BYTES (sizeof("(0000000000.000000) can0 123#0000000000000000\n") - 1)

static _Alignas(64) uint8_t memory[4 << 20];
static char folder[64], path[100], old_path[110];

static struct can_record *open_record(uint64_t limit_bytes, bool wait)
{
	const struct can_record_config config = { .path = path, .limit_bytes = limit_bytes, .wait = wait };
	struct can_record *record;
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(can_record_open(&record, &config, &arena), 0);
	return record;
}

/* A millisecond between two, numbered in the time. */
static void add_frames(struct can_record *record, uint32_t from, uint32_t count)
{
	for (uint32_t i = from; i < from + count; i++) {
		struct can_frame_rx frame = { .id = 0x123, .len = 8, .time_ns = i * NS_PER_MS };
		can_record_add(record, "can0", &frame);
	}
}

/* Lines of a file, each whole, numbers rising; `first` and `last` are theirs. */
static uint32_t count_lines(const char *name, uint32_t *first, uint32_t *last)
{
	char line[CANDUMP_LINE_SIZE];
	uint32_t count = 0;
	FILE *file = fopen(name, "r");
	assert_non_null(file);
	while (fgets(line, sizeof(line), file)) {
		struct candump_record parsed;
		size_t length = strlen(line);
		assert_true(length && line[length - 1] == '\n');
		assert_null(candump_parse(line, length - 1, &parsed));
		uint32_t number = (uint32_t)(parsed.frame.time_ns / NS_PER_MS);
		assert_true(count == 0 || number > *last);
		*last = number;
		if (count++ == 0)
			*first = number;
	}
	fclose(file);
	return count;
}

static void wait_for_lines(struct can_record *record, uint64_t lines)
{
	struct can_record_stats stats = { 0 };
	for (int64_t end_ns = clock_now_ns() + 5 * NS_PER_S; clock_now_ns() < end_ns;) {
		can_record_stats(record, &stats);
		if (stats.lines >= lines)
			return;
		clock_sleep_until(clock_now_ns() + 10 * NS_PER_MS);
	}
	fail_msg("%llu of %llu lines after 5 s", (unsigned long long)stats.lines, (unsigned long long)lines);
}

static void every_frame_is_a_line(void **state)
{
	(void)state;
	uint32_t first = 0, last = 0;
	struct can_record *record = open_record(0, true);
	add_frames(record, 0, 100000); /* many rings full */
	assert_int_equal(can_record_close(record), 0);
	assert_int_equal(count_lines(path, &first, &last), 100000);
	assert_int_equal(first, 0);
	assert_int_equal(last, 99999);
}

static void a_few_frames_are_written_within_a_second(void **state)
{
	(void)state;
	struct can_record *record = open_record(0, false);
	add_frames(record, 0, 3);
	wait_for_lines(record, 3);
	assert_int_equal(can_record_close(record), 0);
}

static void the_newest_are_kept_within_the_limit(void **state)
{
	(void)state;
	enum { LIMIT = 400000 };
	uint32_t first = 0, last = 0, old_first = 0, old_last = 0;
	struct can_record *record = open_record(LIMIT, true);
	add_frames(record, 0, 50000);
	assert_int_equal(can_record_close(record), 0);
	uint32_t new_lines = count_lines(path, &first, &last), old_lines = count_lines(old_path, &old_first, &old_last);
	assert_true((new_lines + old_lines) * LINE_BYTES <= LIMIT);
	assert_true((new_lines + old_lines) * LINE_BYTES > LIMIT / 3);
	assert_int_equal(last, 49999);
	assert_int_equal(old_last + 1, first);
	assert_int_equal(last - old_first + 1, new_lines + old_lines);
	unlink(old_path);
}

static void limit_file_size(rlim_t bytes)
{
	struct rlimit limit;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
	limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void a_full_disk_is_counted_and_tried_again(void **state)
{
	(void)state;
	struct can_record_stats stats;
	uint32_t first = 0, last = 0;
	signal(SIGXFSZ, SIG_IGN);
	struct can_record *record = open_record(0, false);
	limit_file_size(100000); /* not a whole number of lines */
	add_frames(record, 0, 1000);
	wait_for_lines(record, 1000);
	add_frames(record, 1000, 10000);
	clock_sleep_until(clock_now_ns() + 700 * NS_PER_MS);
	add_frames(record, 11000, 30000); /* more than the ring: they do not wait */
	can_record_stats(record, &stats);
	assert_int_equal(stats.error, -EFBIG);
	assert_true(stats.lost > 10000);
	limit_file_size(RLIM_INFINITY);
	wait_for_lines(record, 10000);
	add_frames(record, 50000, 10);
	assert_int_equal(can_record_close(record), -EFBIG);
	uint32_t lines = count_lines(path, &first, &last);
	assert_int_equal(last, 50009);
	assert_true(lines > 10000 && lines <= 41010 - stats.lost);
}

static void what_cannot_be_opened_is_refused(void **state)
{
	(void)state;
	const struct can_record_config config = { .path = "/tmp/no such folder/x" };
	struct can_record *record;
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(can_record_open(&record, &config, &arena), -ENOENT);
	assert_int_equal(arena.used, 0);
	arena_init(&arena, "test", memory, 1000);
	assert_int_equal(can_record_open(&record, &config, &arena), -ENOMEM);
	assert_int_equal(can_record_close(NULL), 0);
}

static int make_folder(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/blvd-record-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/x.candump", folder);
	snprintf(old_path, sizeof(old_path), "%s.1", path);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_frame_is_a_line),
		cmocka_unit_test(a_few_frames_are_written_within_a_second),
		cmocka_unit_test(the_newest_are_kept_within_the_limit),
		cmocka_unit_test(a_full_disk_is_counted_and_tried_again),
		cmocka_unit_test(what_cannot_be_opened_is_refused),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
