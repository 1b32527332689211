/* The kernel's CAN, on a virtual interface vcan0 where there is one (tests/sim/test_can_in_uml.sh makes one without
 * root); otherwise everything but the refusal is skipped. */
#include <errno.h>
#include <net/if.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/can/can_bus.h"

static _Alignas(64) uint8_t memory[2][1 << 20];
static struct arena arenas[2];
static struct can_frame_rx frames[4096];

static int open_bus(int which, struct can_bus **bus, struct can_bus_config config)
{
	static const char *const names[] = { "vcan_gone", "vcan0" };
	config.interfaces = names;
	config.interface_count = 2;
	arena_init(&arenas[which], "test", memory[which], sizeof(memory[which]));
	return can_bus_open(bus, &can_socketcan_ops, &config, &arenas[which]);
}

static bool no_vcan(void)
{
	if (if_nametoindex("vcan0"))
		return false;
	print_message("skipped: no vcan0\n");
	return true;
}

static void a_kernel_without_can_is_refused(void **state)
{
	(void)state;
	struct can_bus *bus;
	int status = open_bus(0, &bus, (struct can_bus_config){ 0 });
	if (status) {
		assert_true(status == -EAFNOSUPPORT || status == -EPROTONOSUPPORT || status == -EPERM);
		assert_int_equal(arenas[0].used, 0);
		return;
	}
	assert_int_equal(bus->interfaces[0].health, CAN_HEALTH_DOWN);
	assert_int_equal(can_bus_read(bus, 0, frames, 1), 0);
	frames[0] = (struct can_frame_rx){ .bus = 0 };
	assert_int_equal(can_bus_write(bus, &frames[0]), -ENODEV);
	can_bus_close(bus);
}

static void frames_of_every_kind_arrive_as_they_were_sent(void **state)
{
	(void)state;
	static const struct can_frame_rx sent[] = {
		{ .bus = 1, .id = 0x123, .len = 4, .data = { 1, 2, 3, 4 } },
		{ .bus = 1, .id = 0x7FF, .len = 0 },
		{ .bus = 1, .id = 0x123, .len = 8, .flags = CAN_FRAME_EXT, .data = { 0xFF } },
		{ .bus = 1, .id = 0x12345678, .len = 8, .flags = CAN_FRAME_EXT },
		{ .bus = 1, .id = 0x100, .len = 3, .flags = CAN_FRAME_REMOTE },
		{ .bus = 1, .id = 0x100, .len = 64, .flags = CAN_FRAME_FD, .fd_flags = 5, .data = { 9, 8, 7 } },
	};
	enum { N = sizeof(sent) / sizeof(*sent) };
	struct can_bus *from, *to;
	if (no_vcan())
		return;
	assert_int_equal(open_bus(0, &from, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(open_bus(1, &to, (struct can_bus_config){ 0 }), 0);
	int64_t before = clock_now_ns();
	for (int i = 0; i < N; i++)
		assert_int_equal(can_bus_write(from, &sent[i]), 0);
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 4096), N);
	int64_t after = clock_now_ns(), last = before - NS_PER_MS;
	for (int i = 0; i < N; i++) {
		assert_true(frames[i].time_ns >= last && frames[i].time_ns <= after);
		last = frames[i].time_ns;
		frames[i].time_ns = 0;
		frames[i].fd_flags &= 3; /* kernels from 5.14 add the mark of an FD frame, others do not */
		struct can_frame_rx expected = sent[i];
		expected.fd_flags &= 3;
		assert_memory_equal(&frames[i], &expected, sizeof(expected));
	}
	assert_int_equal(to->interfaces[1].health, CAN_HEALTH_ACTIVE);
	assert_int_equal(to->interfaces[1].frames, N);
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 4096), 0);
	can_bus_close(from);
	can_bus_close(to);
}

static void only_the_identifiers_in_use_are_received(void **state)
{
	(void)state;
	static const struct can_bus_filter filters[] = { { .id = 0x100 }, { .id = 0x200, .extended = true } };
	struct can_bus *from, *to;
	if (no_vcan())
		return;
	assert_int_equal(open_bus(0, &from, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(open_bus(1, &to, (struct can_bus_config){ .filters = filters, .filter_count = 2 }), 0);
	for (uint32_t id = 0x100; id <= 0x200; id += 0x80)
		for (int extended = 0; extended < 2; extended++) {
			struct can_frame_rx frame = { .bus = 1, .id = id, .flags = extended ? CAN_FRAME_EXT : 0 };
			assert_int_equal(can_bus_write(from, &frame), 0);
		}
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 4096), 2);
	assert_true(frames[0].id == 0x100 && frames[0].flags == 0);
	assert_true(frames[1].id == 0x200 && frames[1].flags == CAN_FRAME_EXT);
	can_bus_close(from);
	can_bus_close(to);
}

/* A small buffer overflows and the loss is known; the default one takes a second of a full bus. */
static void what_the_kernel_drops_is_counted(void **state)
{
	(void)state;
	static const struct {
		int receive_bytes;
		uint64_t drops_at_least, drops_at_most;
	} cases[] = { { 16384, 1000, 3999 }, { 0, 0, 0 } };
	struct can_bus *from, *to;
	if (no_vcan())
		return;
	for (int k = 0; k < 2; k++) {
		assert_int_equal(open_bus(0, &from, (struct can_bus_config){ 0 }), 0);
		assert_int_equal(open_bus(1, &to, (struct can_bus_config){ .receive_bytes = cases[k].receive_bytes }), 0);
		for (uint32_t i = 0; i < 4000; i++) {
			struct can_frame_rx frame = { .bus = 1, .id = 0x123, .len = 8 };
			memcpy(frame.data, &i, sizeof(i));
			assert_int_equal(can_bus_write(from, &frame), 0);
		}
		int got = can_bus_read(to, INT64_MAX, frames, 4096);
		struct can_frame_rx last = { .bus = 1, .id = 0x123 };
		assert_int_equal(can_bus_write(from, &last), 0);
		got += can_bus_read(to, INT64_MAX, frames, 4096); /* the next frame brings the count of what was lost */
		print_message("buffer of %d bytes: %d received, %llu dropped\n", cases[k].receive_bytes, got,
			(unsigned long long)to->stats.dropped);
		assert_int_equal((uint64_t)got + to->stats.dropped, 4001);
		assert_true(to->stats.dropped >= cases[k].drops_at_least && to->stats.dropped <= cases[k].drops_at_most);
		can_bus_close(from);
		can_bus_close(to);
	}
}

static void wait_for_a_look(void)
{
	clock_sleep_until(clock_now_ns() + 300 * NS_PER_MS);
}

/* Needs the right to take the interface down, as in the simulated machine. */
static void an_interface_that_goes_and_comes_back_is_heard_again(void **state)
{
	(void)state;
	struct can_bus *from, *to;
	if (no_vcan() || !getenv("BLVD_VCAN_CONTROL")) {
		print_message("skipped: not ours to take down\n");
		return;
	}
	assert_int_equal(open_bus(0, &from, (struct can_bus_config){ 0 }), 0);
	assert_int_equal(open_bus(1, &to, (struct can_bus_config){ 0 }), 0);
	struct can_frame_rx frame = { .bus = 1, .id = 1 };
	assert_int_equal(can_bus_write(from, &frame), 0);
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 1), 1);
	assert_int_equal(system("ip link set vcan0 down"), 0);
	wait_for_a_look();
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 1), 0);
	assert_int_equal(to->interfaces[1].health, CAN_HEALTH_DOWN);
	assert_true(can_bus_write(from, &frame) < 0);
	assert_int_equal(system("ip link del vcan0"), 0);
	wait_for_a_look();
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 1), 0);
	assert_int_equal(system("ip link add vcan0 type vcan && ip link set vcan0 mtu 72 up"), 0);
	wait_for_a_look();
	assert_int_equal(can_bus_read(from, INT64_MAX, frames, 1), 0); /* `to` has not looked when the frame comes */
	assert_int_equal(can_bus_write(from, &frame), 0);
	assert_int_equal(can_bus_read(to, INT64_MAX, frames, 1), 1);
	assert_int_equal(to->interfaces[1].health, CAN_HEALTH_ACTIVE);
	can_bus_close(from);
	can_bus_close(to);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_kernel_without_can_is_refused),
		cmocka_unit_test(frames_of_every_kind_arrive_as_they_were_sent),
		cmocka_unit_test(only_the_identifiers_in_use_are_received),
		cmocka_unit_test(what_the_kernel_drops_is_counted),
		cmocka_unit_test(an_interface_that_goes_and_comes_back_is_heard_again),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
