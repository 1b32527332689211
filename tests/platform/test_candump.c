/* candump's text log: what it writes comes back byte for byte, and nonsense is refused with a reason. */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/rng.h"
#include "platform/can/candump.h"

static const struct line_case {
	const char *line;
	int64_t time_ns;
	uint32_t id;
	unsigned flags, len, fd_flags, raw_dlc;
} line_cases[] = {
	{ "(1436509052.249713) vcan0 123#DEADBEEF", 1436509052249713000, 0x123, 0, 4, 0, 0 },
	{ "(1436509052.249713) vcan0 7FF#", 1436509052249713000, 0x7FF, 0, 0, 0, 0 },
	{ "(0000000000.000001) c 000#00", 1000, 0, 0, 1, 0, 0 },
	{ "(1436509052.249713) can1 1FFFFFFF#1122334455667788", 1436509052249713000, 0x1FFFFFFF, CAN_FRAME_EXT, 8, 0, 0 },
	{ "(1436509052.249713) can1 00000123#11", 1436509052249713000, 0x123, CAN_FRAME_EXT, 1, 0, 0 },
	{ "(1436509052.249713) can1 123#R", 1436509052249713000, 0x123, CAN_FRAME_REMOTE, 0, 0, 0 },
	{ "(1436509052.249713) can1 123#R8", 1436509052249713000, 0x123, CAN_FRAME_REMOTE, 8, 0, 0 },
	{ "(1436509052.249713) can1 123#R8_E", 1436509052249713000, 0x123, CAN_FRAME_REMOTE, 8, 0, 14 },
	{ "(1436509052.249713) can1 123#1122334455667788_9", 1436509052249713000, 0x123, 0, 8, 0, 9 },
	{ "(1436509052.249713) can1 20000004#0001000000000000", 1436509052249713000, 4, CAN_FRAME_ERROR, 8, 0, 0 },
	{ "(1436509052.249713) can1 123##0", 1436509052249713000, 0x123, CAN_FRAME_FD, 0, 0, 0 },
	{ "(1436509052.249713) can1 12345678##3112233445566778899AABBCC", 1436509052249713000, 0x12345678,
		CAN_FRAME_FD | CAN_FRAME_EXT, 12, 3, 0 },
	{ "(1436509052.249713001) longest_name_15 123#DE", 1436509052249713001, 0x123, 0, 1, 0, 0 },
};

static void lines_come_back_byte_for_byte(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(line_cases) / sizeof(*line_cases); i++) {
		const struct line_case *c = &line_cases[i];
		struct candump_record record;
		const char *fault = candump_parse(c->line, strlen(c->line), &record);
		if (fault)
			fail_msg("%s: %s", c->line, fault);
		assert_int_equal(record.frame.time_ns, c->time_ns);
		assert_int_equal(record.frame.id, c->id);
		assert_int_equal(record.frame.flags, c->flags);
		assert_int_equal(record.frame.len, c->len);
		assert_int_equal(record.frame.fd_flags, c->fd_flags);
		assert_int_equal(record.frame.raw_dlc, c->raw_dlc);
		char line[CANDUMP_LINE_SIZE], expected[CANDUMP_LINE_SIZE];
		snprintf(expected, sizeof(expected), "%s\n", c->line);
		assert_int_equal(candump_format(record.interface, &record.frame, line), strlen(expected));
		assert_string_equal(line, expected);
	}
}

static void any_frame_survives_the_text(void **state)
{
	(void)state;
	static const uint8_t lengths[] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64 };
	struct rng rng = rng_seed(3);
	for (int i = 0; i < 20000; i++) {
		struct can_frame_rx frame = { .time_ns = (int64_t)rng_u32(&rng) * 1000000000 + rng_u32(&rng) };
		bool fd = rng_u32(&rng) & 1, extended = rng_u32(&rng) & 1;
		frame.flags = (uint8_t)((fd ? CAN_FRAME_FD : 0) | (extended ? CAN_FRAME_EXT : 0));
		frame.id = rng_u32(&rng) & (extended ? CAN_FRAME_EXT_MASK : CAN_FRAME_STD_MASK);
		frame.len = lengths[rng_u32(&rng) % (fd ? 16 : 9)];
		frame.fd_flags = fd ? rng_u32(&rng) & 15 : 0;
		for (int k = 0; k < frame.len; k++)
			frame.data[k] = (uint8_t)rng_u32(&rng);
		char line[CANDUMP_LINE_SIZE];
		struct candump_record back;
		size_t length = candump_format("fifteen_letters", &frame, line);
		assert_true(length < CANDUMP_LINE_SIZE);
		assert_null(candump_parse(line, length - 1, &back));
		assert_memory_equal(&back.frame, &frame, sizeof(frame));
	}
}

static void other_spellings_are_understood(void **state)
{
	(void)state;
	static const char *const lines[] = { "(1.5) c 123#dead", "  (1.5)  c\t123#DE.AD", "(1.500000) c 123#DEAD\r",
		"(1.5) c 123#DEAD  ", "(1.5) c 123#DEAD T" };
	for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++) {
		struct candump_record record;
		assert_null(candump_parse(lines[i], strlen(lines[i]), &record));
		assert_int_equal(record.frame.time_ns, 1500000000);
		assert_int_equal(record.frame.len, 2);
		assert_int_equal(record.frame.data[1], 0xAD);
	}
}

static void nonsense_is_refused(void **state)
{
	(void)state;
	static const char *const lines[] = { "", " ", "hello", "(", "()", "(1)", "(1.) c 123#", "(.5) c 123#",
		"(-1.5) c 123#", "(1.5 c 123#", "(1.5)c 123#", "(1.5) 123#", "(1.5) name_of_16_chars 123#", "(1.5) c 12#",
		"(1.5) c 1234#", "(1.5) c 800#", "(1.5) c 123456789#", "(1.5) c 40000000#", "(1.5) c 123", "(1.5) c 123#1",
		"(1.5) c 123#1X", "(1.5) c 123#112233445566778899", "(1.5) c 123##", "(1.5) c 123##X",
		"(1.5) c 123##0112233445566778899", "(1.5) c 123#R9", "(1.5) c 123#11_9", "(1.5) c 123#1122334455667788_8",
		"(1.5) c 123#11 22", "(99999999999999999999.5) c 123#", "(9223372036.9) c 123#", "(1.0000000001) c 123#",
		"(nan) c 123#" };
	for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++) {
		struct candump_record record;
		if (!candump_parse(lines[i], strlen(lines[i]), &record))
			fail_msg("understood: %s", lines[i]);
	}
}

static void damaged_lines_never_crash(void **state)
{
	(void)state;
	struct rng rng = rng_seed(5);
	for (int i = 0; i < 50000; i++) {
		const char *source = line_cases[rng_u32(&rng) % (sizeof(line_cases) / sizeof(*line_cases))].line;
		size_t length = rng_u32(&rng) % (strlen(source) + 1);
		char *line = malloc(length ? length : 1); /* exact, so that reading past the end is seen */
		assert_non_null(line);
		memcpy(line, source, length);
		if (length)
			line[rng_u32(&rng) % length] = (char)rng_u32(&rng);
		struct candump_record record;
		char text[CANDUMP_LINE_SIZE];
		if (!candump_parse(line, length, &record))
			candump_format(record.interface, &record.frame, text);
		free(line);
	}
}

static void the_writer_writes_whole_lines_and_keeps_the_first_error(void **state)
{
	(void)state;
	static struct candump_writer writer;
	char path[] = "/tmp/blvd_candump_XXXXXX";
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	struct can_frame_rx frame = { .id = 0x123, .len = 8 };
	candump_writer_init(&writer, fd);
	for (int i = 0; i < 5000; i++) {
		frame.time_ns = i * INT64_C(1000000);
		candump_writer_add(&writer, "can0", &frame);
	}
	assert_int_equal(candump_writer_flush(&writer), 0);
	assert_int_equal(lseek(fd, 0, SEEK_END), 5000 * strlen("(0000000000.000000) can0 123#0000000000000000\n"));
	assert_int_equal(writer.lines, 5000);
	close(fd);
	unlink(path);

	fd = open("/dev/full", O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return;
	candump_writer_init(&writer, fd);
	for (int i = 0; i < 5000; i++)
		candump_writer_add(&writer, "can0", &frame);
	assert_int_equal(candump_writer_flush(&writer), -ENOSPC);
	assert_true(writer.lost > 0);
	close(fd);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lines_come_back_byte_for_byte),
		cmocka_unit_test(any_frame_survives_the_text),
		cmocka_unit_test(other_spellings_are_understood),
		cmocka_unit_test(nonsense_is_refused),
		cmocka_unit_test(damaged_lines_never_crash),
		cmocka_unit_test(the_writer_writes_whole_lines_and_keeps_the_first_error),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
