/* Recorded logs as a bus: order, time, faults in the text, compressed files cut anywhere. */
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

#include "platform/can/can_bus.h"

#define MS INT64_C(1000000)
#define SECOND INT64_C(1000000000)

static _Alignas(64) uint8_t memory[1 << 20];
static struct arena arena;
static char path[] = "/tmp/blvd_replay_XXXXXX";

static void write_file(const void *data, size_t size)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(data, 1, size, file), size);
	fclose(file);
}

static int open_log(struct can_bus **bus, struct can_bus_config config)
{
	arena_init(&arena, "test", memory, sizeof(memory));
	config.path = path;
	return can_bus_open(bus, &can_replay_ops, &config, &arena);
}

static int open_text(struct can_bus **bus, const char *text, struct can_bus_config config)
{
	write_file(text, strlen(text));
	return open_log(bus, config);
}

static int read_all(struct can_bus *bus, struct can_frame_rx *frames, int capacity)
{
	int count = 0, n;
	do {
		n = can_bus_read(bus, INT64_MAX, frames + count, capacity - count);
		assert_true(n >= 0);
		count += n;
	} while (n > 0 && count < capacity);
	return count;
}

static void frames_come_when_their_time_has_come(void **state)
{
	(void)state;
	struct can_bus *bus;
	struct can_frame_rx frames[8];
	assert_int_equal(
		open_text(&bus, "(100.000000) can0 001#\n(100.010000) can1 002#\n(100.010000) can0 003#\n(100.5) can1 004#",
			(struct can_bus_config){ .start_ns = 7 * SECOND }),
		0);
	assert_int_equal(can_bus_read(bus, 7 * SECOND - 1, frames, 8), 0);
	assert_int_equal(can_bus_read(bus, 7 * SECOND, frames, 8), 1);
	assert_int_equal(frames[0].time_ns, 7 * SECOND);
	assert_int_equal(can_bus_read(bus, 7 * SECOND + 9 * MS, frames, 8), 0);
	assert_int_equal(can_bus_read(bus, 7 * SECOND + 10 * MS, frames, 1), 1);
	assert_int_equal(frames[0].id, 2);
	assert_int_equal(can_bus_read(bus, 7 * SECOND + 10 * MS, frames, 8), 1);
	assert_int_equal(frames[0].id, 3);
	assert_false(bus->ended);
	assert_int_equal(can_bus_read(bus, 8 * SECOND, frames, 8), 1); /* the last line has no newline */
	assert_int_equal(frames[0].time_ns, 7 * SECOND + 500 * MS);
	assert_int_equal(frames[0].time_ns + bus->wall_offset_ns, 100 * SECOND + 500 * MS);
	assert_true(bus->ended);
	assert_int_equal(bus->interface_count, 2);
	assert_int_equal(frames[0].bus, can_bus_index(bus, "can1"));
	can_bus_close(bus);
}

static void nonsense_lines_are_counted_and_passed_over(void **state)
{
	(void)state;
	struct can_bus *bus;
	struct can_frame_rx frames[8];
	assert_int_equal(
		open_text(&bus, "\n(100.0) can0 001#\nhello\n\r\n(100.1) can0 002#\r\n(100.2) can0 0#\n(100.3) can0 003#\n",
			(struct can_bus_config){ 0 }),
		0);
	assert_int_equal(read_all(bus, frames, 8), 3);
	assert_int_equal(bus->stats.bad, 2);
	assert_int_equal(bus->stats.bad_first, 3);
	assert_string_equal(bus->stats.bad_why, "no time in parentheses");
	can_bus_close(bus);
}

static void a_line_longer_than_the_buffer_is_one_bad_line(void **state)
{
	(void)state;
	static char text[300000];
	struct can_bus *bus;
	struct can_frame_rx frames[8];
	memset(text, 'x', sizeof(text));
	text[snprintf(text, 40, "(1.0) c 001#\n")] = 'x';
	snprintf(text + sizeof(text) - 40, 40, "\n(1.5) c 002#\n");
	assert_int_equal(open_text(&bus, text, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(read_all(bus, frames, 8), 2);
	assert_int_equal(bus->stats.bad, 1);
	assert_int_equal(bus->stats.lines, 3);
	can_bus_close(bus);
}

static void clock_steps_and_silences_are_bridged(void **state)
{
	(void)state;
	struct can_bus *bus;
	struct can_frame_rx frames[8];
	assert_int_equal(open_text(&bus,
						 "(100.0) c 001#\n(99.9) c 002#\n(100.1) c 003#\n" /* out of order by a little */
						 "(50.0) c 004#\n(50.2) c 005#\n"                  /* the clock was set back */
						 "(2000000000.0) c 006#\n(2000000000.1) c 007#\n", /* and forward */
						 (struct can_bus_config){ .max_gap_ns = 10 * SECOND }),
		0);
	static const int64_t expected[7] = { 0, 0, 100 * MS, 100 * MS, 300 * MS, 10300 * MS, 10400 * MS };
	assert_int_equal(read_all(bus, frames, 8), 7);
	for (int i = 0; i < 7; i++)
		assert_int_equal(frames[i].time_ns, expected[i]);
	assert_int_equal(bus->stats.steps_back, 2);
	assert_int_equal(bus->stats.gaps, 1);
	assert_int_equal(frames[6].time_ns + bus->wall_offset_ns, 2000000000 * SECOND + 100 * MS);
	can_bus_close(bus);
}

static void named_interfaces_have_the_first_indices(void **state)
{
	(void)state;
	struct can_bus *bus;
	struct can_frame_rx frames[32];
	static const char *const names[] = { "can1", "can0" };
	assert_int_equal(open_text(&bus, "(1.0) can0 001#\n(1.0) other 001#\n(1.0) can1 001#\n",
						 (struct can_bus_config){ .interfaces = names, .interface_count = 2 }),
		0);
	assert_int_equal(read_all(bus, frames, 8), 3);
	assert_int_equal(frames[0].bus, 1);
	assert_int_equal(frames[1].bus, 2);
	assert_int_equal(frames[2].bus, 0);
	can_bus_close(bus);
	char text[1000] = "";
	for (int i = 0; i < 20; i++)
		sprintf(text + strlen(text), "(1.0) can%d 001#\n", i);
	assert_int_equal(open_text(&bus, text, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(read_all(bus, frames, 32), CAN_BUS_MAX);
	assert_int_equal(bus->stats.dropped, 20 - CAN_BUS_MAX);
	can_bus_close(bus);
}

static void error_frames_tell_the_health_of_their_interface(void **state)
{
	(void)state;
	static const struct {
		const char *frame;
		enum can_health health;
	} cases[] = {
		{ "001#", CAN_HEALTH_ACTIVE },
		{ "20000004#0008000000000000", CAN_HEALTH_WARNING },
		{ "001#", CAN_HEALTH_WARNING },
		{ "20000004#0020000000000000", CAN_HEALTH_PASSIVE },
		{ "20000002#0000000000000000", CAN_HEALTH_PASSIVE }, /* lost arbitration says nothing of it */
		{ "20000004#0040000000000000", CAN_HEALTH_ACTIVE },
		{ "20000040#0000000000000000", CAN_HEALTH_OFF },
		{ "20000100#0000000000000000", CAN_HEALTH_ACTIVE },
		{ "20000040#", CAN_HEALTH_OFF },
		{ "001#", CAN_HEALTH_ACTIVE },
	};
	struct can_bus *bus;
	struct can_frame_rx frame;
	char text[1000] = "";
	size_t n = sizeof(cases) / sizeof(*cases);
	for (size_t i = 0; i < n; i++)
		sprintf(text + strlen(text), "(1.%zu) c %s\n", i, cases[i].frame);
	assert_int_equal(open_text(&bus, text, (struct can_bus_config){ 0 }), 0);
	for (size_t i = 0; i < n; i++) {
		assert_int_equal(can_bus_read(bus, INT64_MAX, &frame, 1), 1);
		assert_int_equal(bus->interfaces[0].health, cases[i].health);
	}
	assert_int_equal(bus->interfaces[0].error_frames, 7);
	assert_int_equal(can_bus_write(bus, &frame), -EOPNOTSUPP);
	can_bus_close(bus);
}

static size_t sample_log(char *text, int lines)
{
	size_t size = 0;
	for (int i = 0; i < lines; i++)
		size += (size_t)sprintf(
			text + size, "(%d.%06d) can0 %03X#%08X\n", 1000 + i / 100, i % 100 * 10000, i % 2048, i * 977);
	return size;
}

static void compressed_logs_read_the_same_and_may_be_joined_or_cut(void **state)
{
	(void)state;
	static char text[1 << 20];
	static uint8_t packed[1 << 20];
	struct can_bus *bus;
	static struct can_frame_rx plain[20000], got[20000];
	size_t size = sample_log(text, 10000);
	write_file(text, size);
	assert_int_equal(open_log(&bus, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(read_all(bus, plain, 20000), 10000);
	can_bus_close(bus);

	gzFile gz = gzopen(path, "wb"); /* two members, the first ending inside a line */
	assert_int_equal(gzwrite(gz, text, 1234), 1234);
	gzclose(gz);
	gz = gzopen(path, "ab");
	assert_int_equal(gzwrite(gz, text + 1234, (unsigned)size - 1234), size - 1234);
	gzclose(gz);
	assert_int_equal(open_log(&bus, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(read_all(bus, got, 20000), 10000);
	assert_memory_equal(got, plain, sizeof(*got) * 10000);
	assert_false(bus->stats.cut);
	can_bus_close(bus);

	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	size_t packed_size = fread(packed, 1, sizeof(packed), file);
	fclose(file);
	for (size_t cut = 0; cut < packed_size; cut += packed_size / 37 + 1) {
		write_file(packed, cut);
		int status = open_log(&bus, (struct can_bus_config){ 0 });
		if (status) {
			assert_int_equal(status, -ENODATA);
			assert_int_equal(arena.used, 0);
			continue;
		}
		int count = read_all(bus, got, 20000);
		assert_true(count < 10000 && bus->stats.cut);
		assert_true(bus->stats.bad <= 1);
		can_bus_close(bus);
	}
	packed[packed_size / 2] ^= 0x40;
	write_file(packed, packed_size);
	assert_int_equal(open_log(&bus, (struct can_bus_config){ 0 }), 0);
	read_all(bus, got, 20000);
	assert_true(bus->stats.cut);
	can_bus_close(bus);
}

static void what_is_no_log_is_refused(void **state)
{
	(void)state;
	struct can_bus *bus;
	arena_init(&arena, "test", memory, sizeof(memory));
	struct can_bus_config config = { .path = "/tmp" };
	assert_int_equal(can_bus_open(&bus, &can_replay_ops, &config, &arena), -EISDIR);
	config.path = "/nonexistent/file";
	assert_int_equal(can_bus_open(&bus, &can_replay_ops, &config, &arena), -ENOENT);
	assert_int_equal(open_text(&bus, "", (struct can_bus_config){ 0 }), -ENODATA);
	assert_int_equal(open_text(&bus, "one\ntwo\n", (struct can_bus_config){ 0 }), -ENODATA);
	arena_init(&arena, "test", memory, 1000);
	config.path = path;
	assert_int_equal(can_bus_open(&bus, &can_replay_ops, &config, &arena), -ENOMEM);
	assert_int_equal(arena.used, 0);
}

/* What --record does with a replay; and nothing of it takes memory from the heap. */
static void recorded_logs_of_real_cars_come_back_byte_for_byte(void **state)
{
	(void)state;
	static const char *const logs[] = { "comma2k19_rav4/rav4_19thAve_60s.candump.log.gz",
		"css_canedge/drive_2024-09-07_aarhus-skanderborg_32min.candump.log.gz",
		"eldominio_gpl3/hyundai_genesis_coupe_36s.candump.log.gz" };
	static char original[1 << 16], copy[1 << 16];
	static struct candump_writer writer;
	static struct can_frame_rx frames[64];
	for (size_t i = 0; i < sizeof(logs) / sizeof(*logs); i++) {
		char log[600];
		const char *data = getenv("BLVD_DATA");
		snprintf(log, sizeof(log), "%s/can/%s", data ? data : "", logs[i]);
		if (access(log, R_OK)) {
			print_message("skipped: no %s\n", log);
			continue;
		}
		struct can_bus *bus;
		struct can_bus_config config = { .path = log, .start_ns = 12345 };
		arena_init(&arena, "test", memory, sizeof(memory));
		assert_int_equal(can_bus_open(&bus, &can_replay_ops, &config, &arena), 0);
		int fd = open(path, O_RDWR | O_TRUNC | O_CLOEXEC), n;
		assert_true(fd >= 0);
		candump_writer_init(&writer, fd);
		size_t heap = mallinfo2().uordblks, used = arena.used;
		while ((n = can_bus_read(bus, INT64_MAX, frames, 64)) > 0)
			for (int k = 0; k < n; k++) {
				frames[k].time_ns += bus->wall_offset_ns;
				candump_writer_add(&writer, bus->interfaces[frames[k].bus].name, &frames[k]);
			}
		assert_int_equal(candump_writer_flush(&writer), 0);
		assert_int_equal(mallinfo2().uordblks, heap);
		assert_int_equal(arena.used, used);
		assert_int_equal(bus->stats.bad + bus->stats.steps_back + bus->stats.gaps + bus->stats.dropped, 0);
		can_bus_close(bus);
		gzFile gz = gzopen(log, "rb");
		assert_non_null(gz);
		lseek(fd, 0, SEEK_SET);
		do {
			n = gzread(gz, original, sizeof(original));
			assert_true(n >= 0);
			assert_int_equal(read(fd, copy, sizeof(copy)), n);
			assert_memory_equal(original, copy, (size_t)n);
		} while (n > 0);
		gzclose(gz);
		close(fd);
	}
}

/* Here the kernel may have CAN or not, and the interfaces may be there or not. */
static void the_kernel_bus_opens_or_says_why_not(void **state)
{
	(void)state;
	struct can_bus *bus = NULL;
	static const char *const names[] = { "vcanblvd" };
	static const struct can_bus_filter filters[] = { { .id = 0x100 }, { .id = 0x12345678, .extended = true } };
	struct can_bus_config config = {
		.interfaces = names, .interface_count = 1, .filters = filters, .filter_count = 2, .receive_bytes = 65536
	};
	arena_init(&arena, "test", memory, sizeof(memory));
	int status = can_bus_open(&bus, &can_socketcan_ops, &config, &arena);
	if (status) {
		assert_int_equal(arena.used, 0);
		print_message("skipped: no CAN in this kernel (%s)\n", strerror(-status));
		return;
	}
	struct can_frame_rx frame = { .bus = 0 };
	assert_int_equal(can_bus_read(bus, 0, &frame, 1), 0);
	if (bus->interfaces[0].health == CAN_HEALTH_DOWN)
		assert_int_equal(can_bus_write(bus, &frame), -ENODEV);
	can_bus_close(bus);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_come_when_their_time_has_come),
		cmocka_unit_test(nonsense_lines_are_counted_and_passed_over),
		cmocka_unit_test(a_line_longer_than_the_buffer_is_one_bad_line),
		cmocka_unit_test(clock_steps_and_silences_are_bridged),
		cmocka_unit_test(named_interfaces_have_the_first_indices),
		cmocka_unit_test(error_frames_tell_the_health_of_their_interface),
		cmocka_unit_test(compressed_logs_read_the_same_and_may_be_joined_or_cut),
		cmocka_unit_test(what_is_no_log_is_refused),
		cmocka_unit_test(recorded_logs_of_real_cars_come_back_byte_for_byte),
		cmocka_unit_test(the_kernel_bus_opens_or_says_why_not),
	};
	int fd = mkstemp(path);
	if (fd < 0)
		return 1;
	close(fd);
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	unlink(path);
	return failed;
}
