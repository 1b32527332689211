/* Buses on local sockets, and the thread that reads a live bus: here on local sockets too, so that any machine can. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/can/can_bus.h"
#include "platform/can/can_socket.h"

#define NODES 3
#define PATIENCE_NS (3 * NS_PER_S)
#define HELLO 0x1ABCDEF0 /* what meet() sends; may arrive late and then does not count */

static _Alignas(64) uint8_t memory[NODES][2 << 20];
static struct can_frame_rx frames[4096];
static char folder[64], address[100];

static struct can_bus *open_node(int node, const struct can_bus_ops *ops)
{
	const char *const names[] = { address };
	struct can_bus_config config = { .interfaces = names, .interface_count = 1 };
	struct arena arena;
	struct can_bus *bus;
	arena_init(&arena, "test", memory[node], sizeof(memory[node]));
	assert_int_equal(can_bus_open(&bus, ops, &config, &arena), 0);
	return bus;
}

static struct can_frame_rx frame_of(uint32_t id)
{
	return (struct can_frame_rx){ .id = id, .len = 8, .data = { 1, 2, 3, 4, 5, 6, 7, 8 } };
}

/* Reads until `wanted` frames have come; the others of the bus pass on what they hear meanwhile. */
static int read_patiently(struct can_bus *bus, struct can_bus *const *others, int wanted)
{
	static struct can_frame_rx passed[64];
	int64_t deadline_ns = clock_now_ns() + PATIENCE_NS;
	int count = 0;
	for (;;) {
		for (int i = 0; others && others[i]; i++)
			can_bus_read(others[i], INT64_MAX, passed, 64);
		int n = can_bus_read(bus, INT64_MAX, frames + count, 4096 - count);
		assert_true(n >= 0);
		for (int i = count, end = count + n; i < end; i++)
			if (frames[i].id != HELLO)
				frames[count++] = frames[i];
		if (count >= wanted || clock_now_ns() > deadline_ns)
			return count;
		clock_sleep_until(clock_now_ns() + NS_PER_MS);
	}
}

/* Writes until it is heard. */
static void meet(struct can_bus *from, struct can_bus *to, struct can_bus *const *others)
{
	struct can_frame_rx frame = frame_of(HELLO);
	int64_t deadline_ns = clock_now_ns() + PATIENCE_NS;
	static struct can_frame_rx passed[64];
	frame.flags = CAN_FRAME_EXT;
	while (clock_now_ns() < deadline_ns) {
		can_bus_write(from, &frame);
		for (int i = 0; others && others[i]; i++)
			can_bus_read(others[i], INT64_MAX, passed, 64);
		if (can_bus_read(to, INT64_MAX, passed, 64) > 0)
			return;
		clock_sleep_until(clock_now_ns() + 5 * NS_PER_MS);
	}
	fail_msg("they do not meet");
}

static void addresses_have_short_names(void **state)
{
	(void)state;
	static const struct {
		const char *spec, *name;
		bool address;
	} cases[] = {
		{ "can0", "can0", false },
		{ "unix:/run/car.sock", "car", true },
		{ "body=unix:/run/car.sock", "body", true },
		{ "unix:@car", "car", true },
		{ "unix:/a/a-rather-long-name.sock", "a-rather-long-n", true },
		{ "x y=unix:/a", "x_y", true },
		{ "unix:relative", "relative", true },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		char name[CANDUMP_NAME_SIZE];
		can_bus_short_name(cases[i].spec, name);
		assert_string_equal(name, cases[i].name);
		assert_int_equal(can_socket_is_address(cases[i].spec), cases[i].address);
	}
}

static void frames_of_every_kind_arrive_as_they_were_sent(void **state)
{
	(void)state;
	static const struct can_frame_rx sent[] = {
		{ .id = 0x123, .len = 4, .data = { 1, 2, 3, 4 } },
		{ .id = 0x7FF, .len = 0 },
		{ .id = 0x123, .len = 8, .flags = CAN_FRAME_EXT, .data = { 0xFF } },
		{ .id = 0x100, .len = 3, .flags = CAN_FRAME_REMOTE },
		{ .id = 0x100, .len = 8, .raw_dlc = 12 },
		{ .id = 0x100, .len = 64, .flags = CAN_FRAME_FD, .fd_flags = 5, .data = { 9, 8, 7 } },
		{ .id = 0x40, .len = 8, .flags = CAN_FRAME_ERROR },
	};
	enum { N = sizeof(sent) / sizeof(*sent) };
	for (int first = 0; first < 2; first++) { /* whichever made the socket */
		struct can_bus *nodes[2] = { open_node(0, &can_socket_ops), open_node(1, &can_socket_ops) };
		struct can_bus *from = nodes[first], *to = nodes[!first];
		for (int i = 0; i < N; i++)
			assert_int_equal(can_bus_write(from, &sent[i]), 0);
		assert_int_equal(read_patiently(to, NULL, N), N);
		for (int i = 0; i < N; i++) {
			struct can_frame_rx expected = sent[i];
			expected.time_ns = frames[i].time_ns;
			assert_memory_equal(&frames[i], &expected, sizeof(expected));
		}
		assert_int_equal(to->interfaces[0].health, CAN_HEALTH_OFF);
		can_bus_close(nodes[0]);
		can_bus_close(nodes[1]);
	}
	assert_int_not_equal(access(strchr(address, '/'), F_OK), 0);
}

static void everybody_hears_everybody_else(void **state)
{
	(void)state;
	struct can_bus *nodes[NODES + 1] = { 0 };
	for (int i = 0; i < NODES; i++)
		nodes[i] = open_node(i, &can_socket_ops);
	for (int from = 0; from < NODES; from++)
		for (int to = 0; to < NODES; to++) {
			struct can_frame_rx frame = frame_of((uint32_t)(from * NODES + to));
			struct can_bus *const others[] = { nodes[0], NULL };
			if (from == to)
				continue;
			assert_int_equal(can_bus_write(nodes[from], &frame), 0);
			assert_int_equal(read_patiently(nodes[to], to ? others : NULL, 1), 1);
			assert_int_equal(frames[0].id, frame.id);
			for (int i = 0; i < NODES; i++)
				while (can_bus_read(nodes[i], INT64_MAX, frames, 64) > 0)
					;
		}
	for (int i = 0; i < NODES; i++)
		can_bus_close(nodes[i]);
}

static void the_bus_outlives_who_made_it(void **state)
{
	(void)state;
	struct can_bus *first = open_node(0, &can_socket_ops), *second = open_node(1, &can_socket_ops);
	struct can_bus *third = open_node(2, &can_socket_ops);
	struct can_bus *const helpers[] = { first, NULL };
	meet(second, third, helpers);
	can_bus_close(first);
	assert_int_equal(can_bus_read(second, INT64_MAX, frames, 64), 0);
	assert_int_equal(second->interfaces[0].health, CAN_HEALTH_DOWN);
	meet(second, third, NULL);
	meet(third, second, NULL);
	assert_int_equal(second->interfaces[0].health, CAN_HEALTH_ACTIVE);
	can_bus_close(second);
	can_bus_close(third);
}

static void a_file_that_a_dead_program_left_is_replaced(void **state)
{
	(void)state;
	const char *path = strchr(address, '/');
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fclose(file);
	struct can_bus *a = open_node(0, &can_socket_ops), *b = open_node(1, &can_socket_ops);
	meet(a, b, NULL);
	assert_int_equal(unlink(path), 0); /* and one that is deleted under us is made again */
	clock_sleep_until(clock_now_ns() + 300 * NS_PER_MS);
	can_bus_read(a, INT64_MAX, frames, 64);
	assert_int_equal(access(path, F_OK), 0);
	meet(b, a, NULL);
	can_bus_close(a);
	can_bus_close(b);
}

static void a_full_queue_is_said_and_never_waits(void **state)
{
	(void)state;
	struct can_bus *from = open_node(0, &can_socket_ops), *to = open_node(1, &can_socket_ops);
	struct can_frame_rx frame = frame_of(1);
	int written = 0, status = 0;
	for (; written < 100000 && !status; written += !status)
		status = can_bus_write(from, &frame);
	assert_int_equal(status, -ENOBUFS);
	assert_true(written > 100);
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 4096), written < 4096 ? written : 4096);
	can_bus_close(from);
	can_bus_close(to);
}

static void bad_addresses_are_refused(void **state)
{
	(void)state;
	static const char *const bad[] = { "unix:",
		"unix:/0123456789012345678901234567890123456789012345678901234567890123456789"
		"0123456789012345678901234567890123456789" };
	for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
		struct can_bus_config config = { .interfaces = &bad[i], .interface_count = 1 };
		struct arena arena;
		struct can_bus *bus;
		arena_init(&arena, "test", memory[0], sizeof(memory[0]));
		assert_true(can_bus_open(&bus, &can_live_ops, &config, &arena) < 0);
		assert_int_equal(arena.used, 0);
	}
}

static void the_thread_hands_over_what_came_in_time(void **state)
{
	(void)state;
	struct can_bus *from = open_node(0, &can_socket_ops), *to = open_node(1, &can_live_ops);
	int64_t before_ns = clock_now_ns(), last_ns = before_ns;
	meet(from, to, NULL);
	for (uint32_t i = 0; i < 2000; i++) {
		struct can_frame_rx frame = frame_of(i);
		while (can_bus_write(from, &frame) == -ENOBUFS)
			clock_sleep_until(clock_now_ns() + NS_PER_MS);
	}
	clock_sleep_until(clock_now_ns() + 20 * NS_PER_MS);
	assert_int_equal(can_bus_read(to, before_ns, frames, 4096), 0); /* none of them is that old */
	assert_int_equal(read_patiently(to, NULL, 2000), 2000);
	for (uint32_t i = 0; i < 2000; i++) {
		assert_int_equal(frames[i].id, i);
		assert_true(frames[i].time_ns >= last_ns);
		last_ns = frames[i].time_ns;
	}
	assert_true(last_ns <= clock_now_ns());
	assert_true(to->stats.reader_cpu_ns > 0 && to->stats.dropped == 0);
	assert_int_equal(to->interfaces[0].health, CAN_HEALTH_ACTIVE);
	struct can_frame_rx frame = frame_of(0x700);
	assert_int_equal(can_bus_write(to, &frame), 0);
	assert_int_equal(read_patiently(from, NULL, 1), 1);
	can_bus_close(from);
	int64_t deadline_ns = clock_now_ns() + PATIENCE_NS;
	while (to->interfaces[0].health != CAN_HEALTH_DOWN && clock_now_ns() < deadline_ns) {
		can_bus_read(to, INT64_MAX, frames, 1);
		clock_sleep_until(clock_now_ns() + NS_PER_MS);
	}
	assert_int_equal(to->interfaces[0].health, CAN_HEALTH_DOWN);
	can_bus_close(to);
}

/* The ring is full and so is the socket: nothing of what was accepted is lost when the reader comes back. */
static void a_reader_that_sleeps_loses_nothing_that_was_accepted(void **state)
{
	(void)state;
	struct can_bus *from = open_node(0, &can_socket_ops), *to = open_node(1, &can_live_ops);
	meet(from, to, NULL);
	uint32_t sent = 0;
	for (int refused = 0; refused < 20;) {
		struct can_frame_rx frame = frame_of(sent & 0x7FF);
		if (can_bus_write(from, &frame) == 0) {
			sent++;
			refused = 0;
			continue;
		}
		refused++;
		clock_sleep_until(clock_now_ns() + 2 * NS_PER_MS);
	}
	assert_true(sent > 8192);
	for (uint32_t got = 0; got < sent;) {
		int n = read_patiently(to, NULL, 1);
		assert_true(n > 0);
		for (int i = 0; i < n; i++, got++)
			assert_int_equal(frames[i].id, got & 0x7FF);
	}
	can_bus_close(from);
	can_bus_close(to);
}

static int make_folder(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/blvd-can-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(address, sizeof(address), "unix:%s/x.sock", folder);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	return rmdir(folder); /* empty: sockets go with who made them */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(addresses_have_short_names),
		cmocka_unit_test(frames_of_every_kind_arrive_as_they_were_sent),
		cmocka_unit_test(everybody_hears_everybody_else),
		cmocka_unit_test(the_bus_outlives_who_made_it),
		cmocka_unit_test(a_file_that_a_dead_program_left_is_replaced),
		cmocka_unit_test(a_full_queue_is_said_and_never_waits),
		cmocka_unit_test(bad_addresses_are_refused),
		cmocka_unit_test(the_thread_hands_over_what_came_in_time),
		cmocka_unit_test(a_reader_that_sleeps_loses_nothing_that_was_accepted),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
