/* The DBC reader against hand-worked bit positions, its own encoder, the database files of the data folder and text
 * that is wrong in every way we could think of. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/file_map.h"
#include "platform/base/rng.h"
#include "platform/can/checksum.h"
#include "platform/can/dbc.h"
#include "platform/can/dbc_boulevard.h"

static _Alignas(64) uint8_t memory[4 << 20];
static struct arena arena;
static struct dbc dbc;
static struct dbc_note error;

static void fresh_arena(void)
{
	arena_init(&arena, "test", memory, sizeof(memory));
}

static int parse(const char *text)
{
	fresh_arena();
	return dbc_parse(&dbc, text, strlen(text), &arena, &error);
}

static struct can_frame_rx frame_of(uint32_t id, unsigned len, const uint8_t *data)
{
	struct can_frame_rx frame = { .id = id, .len = (uint8_t)len };
	memcpy(frame.data, data, len);
	return frame;
}

/* Bytes 01 23 45 67 89 AB CD EF. Worked by hand: little endian reads EFCDAB8967452301 and counts from its right end;
 * big endian reads 0123456789ABCDEF and counts from its left end, bit 7 of byte 0 first. */
static const struct bit_case {
	const char *layout;
	int64_t raw;
} bit_cases[] = {
	{ "0|8@1+", 0x01 },
	{ "8|8@1+", 0x23 },
	{ "0|16@1+", 0x2301 },
	{ "4|8@1+", 0x30 },   /* high nibble of 01, low nibble of 23 above it */
	{ "4|12@1+", 0x230 }, /* bits 4-15 of 2301 */
	{ "56|8@1+", 0xEF },
	{ "0|64@1+", (int64_t)UINT64_C(0xEFCDAB8967452301) },
	{ "0|64@1-", (int64_t)UINT64_C(0xEFCDAB8967452301) },
	{ "63|1@1+", 1 },
	{ "60|1@1+", 0 },
	{ "1|63@1+", INT64_C(0x77E6D5C4B3A29180) },
	{ "40|16@1-", (int16_t)0xCDAB },
	{ "33|10@1-", 0x1C4 }, /* AB89 >> 1 is 55C4: its low ten bits, the highest of them clear */
	{ "33|9@1-", -0x3C },  /* one less, and the highest is set: 1C4 - 200 */
	{ "7|8@0+", 0x01 },
	{ "15|8@0+", 0x23 },
	{ "7|16@0+", 0x0123 },
	{ "3|8@0+", 0x12 },   /* low nibble of 01, high nibble of 23 below it */
	{ "3|12@0+", 0x123 }, /* and all of 23 */
	{ "7|64@0+", INT64_C(0x0123456789ABCDEF) },
	{ "6|63@0+", INT64_C(0x0123456789ABCDEF) },
	{ "7|64@0-", INT64_C(0x0123456789ABCDEF) },
	{ "39|16@0-", (int16_t)0x89AB },
	{ "0|1@0+", 1 },
	{ "1|1@0+", 0 },
	{ "0|2@0+", 2 }, /* bit 0 of byte 0, then bit 7 of byte 1: 1, 0 */
	{ "0|3@0+", 4 },
	{ "0|4@0+", 9 }, /* 1, then 001 of 0010 */
	{ "63|8@0+", 0xEF },
	{ "59|4@0-", -1 }, /* F */
	{ "55|16@0+", 0xCDEF },
};

static void bits_are_read_in_both_orders(void **state)
{
	(void)state;
	static const uint8_t bytes[8] = { 0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF };
	struct can_frame_rx frame = frame_of(291, 8, bytes);
	for (size_t i = 0; i < sizeof(bit_cases) / sizeof(*bit_cases); i++) {
		char text[200];
		snprintf(text, sizeof(text), "BO_ 291 M: 8 X\n SG_ S : %s (1,0) [0|0] \"\" X\n", bit_cases[i].layout);
		assert_int_equal(parse(text), 0);
		assert_int_equal(dbc.warnings, 0);
		int64_t raw;
		assert_true(dbc_decode_raw(dbc.messages->signals, &frame, &raw));
		if (raw != bit_cases[i].raw)
			fail_msg("%s: got %llx, not %llx", bit_cases[i].layout, (long long)raw, (long long)bit_cases[i].raw);
	}
}

static void every_layout_survives_encoding_and_touches_no_other_bit(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	for (int i = 0; i < 20000; i++) {
		struct dbc_message message = { .id = 5, .length = 8 };
		struct dbc_signal signal = { .message = &message, .scale = 1.0 };
		signal.big_endian = rng_u32(&rng) & 1;
		signal.type = rng_u32(&rng) & 1 ? DBC_SIGNED : DBC_UNSIGNED;
		signal.length = (uint8_t)(1 + rng_u32(&rng) % 64);
		signal.start = (uint16_t)(rng_u32(&rng) % 64);
		struct can_frame_rx frame = { .id = 5, .len = 8 }, before;
		for (int k = 0; k < 8; k++)
			frame.data[k] = (uint8_t)rng_u32(&rng);
		before = frame;
		int64_t raw = (int64_t)((uint64_t)rng_u32(&rng) << 32 | rng_u32(&rng)), got, old;
		uint64_t mask = ~UINT64_C(0) >> (64 - signal.length), bits = (uint64_t)raw & mask;
		bool negative = signal.type == DBC_SIGNED && bits >> (signal.length - 1);
		raw = (int64_t)(negative ? bits | ~mask : bits);
		if (!dbc_decode_raw(&signal, &frame, &old)) {
			assert_int_equal(dbc_encode_raw(&signal, raw, &frame), -EINVAL);
			assert_memory_equal(&frame, &before, sizeof(frame));
			continue;
		}
		assert_int_equal(dbc_encode_raw(&signal, raw, &frame), 0);
		assert_true(dbc_decode_raw(&signal, &frame, &got));
		assert_int_equal(got, raw);
		assert_int_equal(dbc_encode_raw(&signal, old, &frame), 0);
		assert_memory_equal(&frame, &before, sizeof(frame));
	}
}

static void a_signal_beyond_the_received_length_is_not_present(void **state)
{
	(void)state;
	assert_int_equal(
		parse("BO_ 1 M: 8 X\n SG_ A : 0|16@1+ (1,0) [0|0] \"\" X\n SG_ B : 17|10@0+ (1,0) [0|0] \"\" X\n"), 0);
	const struct dbc_signal *a = dbc_find_signal(&dbc, "M", "A"), *b = dbc_find_signal(&dbc, NULL, "B");
	uint8_t bytes[8] = { 0 };
	double value;
	struct can_frame_rx frame = frame_of(1, 1, bytes);
	assert_false(dbc_decode(a, &frame, &value));
	frame.len = 2;
	assert_true(dbc_decode(a, &frame, &value));
	frame.len = 3; /* B is bits 1 and 0 of byte 2 and all of byte 3 */
	assert_false(dbc_decode(b, &frame, &value));
	frame.len = 4;
	assert_true(dbc_decode(b, &frame, &value));
}

static void only_a_data_frame_of_the_same_kind_of_identifier_matches(void **state)
{
	(void)state;
	assert_int_equal(parse("BO_ 2147483649 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\n"), 0);
	uint8_t bytes[8] = { 7 };
	struct can_frame_rx frame = frame_of(1, 8, bytes);
	double value;
	assert_false(dbc_decode(dbc.messages->signals, &frame, &value));
	frame.flags = CAN_FRAME_EXT;
	assert_true(dbc_decode(dbc.messages->signals, &frame, &value));
	frame.flags = CAN_FRAME_EXT | CAN_FRAME_REMOTE;
	assert_false(dbc_decode(dbc.messages->signals, &frame, &value));
	assert_ptr_equal(dbc_find_id(&dbc, 1, true), dbc.messages);
	assert_null(dbc_find_id(&dbc, 1, false));
}

static void multiplexed_signals_are_present_with_their_selector_only(void **state)
{
	(void)state;
	assert_int_equal(parse("BO_ 2 M: 8 X\n"
						   " SG_ Early m1 : 16|8@1+ (1,0) [0|0] \"\" X\n" /* the selector may come later */
						   " SG_ Page M : 0|8@1+ (1,0) [0|0] \"\" X\n"
						   " SG_ Inner m2M : 8|8@1+ (1,0) [0|0] \"\" X\n"
						   " SG_ Deep m0 : 24|8@1+ (1,0) [0|0] \"\" X\n"
						   " SG_ Plain : 32|8@1+ (1,0) [0|0] \"\" X\n"
						   "SG_MUL_VAL_ 2 Deep Inner 3-4, 9-9;\n"),
		0);
	assert_int_equal(dbc.warnings, 0);
	static const struct {
		uint8_t page, inner;
		bool early, inner_present, deep;
	} cases[] = { { 0, 3, 0, 0, 0 }, { 1, 3, 1, 0, 0 }, { 2, 3, 0, 1, 1 }, { 2, 5, 0, 1, 0 }, { 2, 9, 0, 1, 1 } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		uint8_t bytes[8] = { cases[i].page, cases[i].inner };
		struct can_frame_rx frame = frame_of(2, 8, bytes);
		double v;
		assert_int_equal(dbc_decode(dbc_find_signal(&dbc, "M", "Early"), &frame, &v), cases[i].early);
		assert_int_equal(dbc_decode(dbc_find_signal(&dbc, "M", "Inner"), &frame, &v), cases[i].inner_present);
		assert_int_equal(dbc_decode(dbc_find_signal(&dbc, "M", "Deep"), &frame, &v), cases[i].deep);
		assert_true(dbc_decode(dbc_find_signal(&dbc, "M", "Plain"), &frame, &v));
	}
}

static void floats_decode_and_encode(void **state)
{
	(void)state;
	assert_int_equal(parse("BO_ 3 M: 16 X\n SG_ F : 0|32@1- (2,1) [0|0] \"\" X\n SG_ D : 39|64@0- (1,0) [0|0] \"\" X\n"
						   "SIG_VALTYPE_ 3 F : 1;\nSIG_VALTYPE_ 3 D : 2;\n"),
		0);
	struct can_frame_rx frame;
	dbc_frame_init(dbc.messages, &frame);
	assert_int_equal(frame.len, 16);
	assert_true(frame.flags & CAN_FRAME_FD);
	const struct dbc_signal *f = dbc_find_signal(&dbc, "M", "F"), *d = dbc_find_signal(&dbc, "M", "D");
	assert_int_equal(dbc_encode(f, 4.0, &frame), 0); /* raw 1.5 = 3FC00000 */
	static const uint8_t expected[4] = { 0x00, 0x00, 0xC0, 0x3F };
	assert_memory_equal(frame.data, expected, 4);
	assert_int_equal(dbc_encode(d, -0.1, &frame), 0);
	double value;
	assert_true(dbc_decode(d, &frame, &value));
	assert_true(value == -0.1);
	frame.data[2] = 0x80, frame.data[3] = 0x7F; /* infinity */
	assert_true(dbc_decode(f, &frame, &value));
	assert_true(isinf(value));
	assert_int_equal(dbc_encode(f, NAN, &frame), -EINVAL);
	assert_int_equal(dbc_encode(f, 1e300, &frame), -EINVAL);
}

static void encoding_rounds_and_stops_at_the_ends(void **state)
{
	(void)state;
	assert_int_equal(
		parse("BO_ 4 M: 8 X\n SG_ S : 0|12@1- (0.5,-3) [0|0] \"\" X\n SG_ U : 16|4@1+ (1,0) [0|0] \"\" X\n"), 0);
	static const struct {
		const char *name;
		double in;
		int status;
		double out;
	} cases[] = {
		{ "S", 10.0, 0, 10.0 },
		{ "S", 10.2, 0, 10.0 },
		{ "S", -1026.9, 0, -1027.0 },
		{ "S", 5000.0, -ERANGE, 2047 * 0.5 - 3 },
		{ "S", -5000.0, -ERANGE, -2048 * 0.5 - 3 },
		{ "U", 15.4, 0, 15.0 },
		{ "U", 16.0, -ERANGE, 15.0 },
		{ "U", -1.0, -ERANGE, 0.0 },
	};
	struct can_frame_rx frame;
	dbc_frame_init(dbc.messages, &frame);
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		const struct dbc_signal *signal = dbc_find_signal(&dbc, "M", cases[i].name);
		double value;
		assert_int_equal(dbc_encode(signal, cases[i].in, &frame), cases[i].status);
		assert_true(dbc_decode(signal, &frame, &value));
		assert_true(value == cases[i].out);
	}
}

static const struct fault_case {
	const char *text;
	unsigned line;
	const char *says;
} fault_cases[] = {
	{ "", 0, "no message" },
	{ "hello\nworld\n", 0, "no message" },
	{ "BO_ x M: 8 X\n", 1, "no message number" },
	{ "\n\nBO_ 1 : 8 X\n", 3, "no name" },
	{ "BO_ 2048 M: 8 X\n", 1, "no CAN identifier" },
	{ "BO_ 99999999999999999999 M: 8 X\n", 1, "no message number" },
	{ "BO_ 1 M 8 X\n", 1, "': length'" },
	{ "BO_ 1 M: 8 X\n SG_\n", 2, "no name" },
	{ " SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\n", 1, "before any BO_" },
	{ "BO_ 1 M: 8 X\n SG_ A 0|8@1+ (1,0) [0|0] \"\" X\n", 2, "multiplexer" },
	{ "BO_ 1 M: 8 X\n SG_ A m : 0|8@1+ (1,0) [0|0] \"\" X\n", 2, "no number" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8 (1,0) [0|0] \"\" X\n", 2, "start|length@order" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@2+ (1,0) [0|0] \"\" X\n", 2, "start|length@order" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|0@1+ (1,0) [0|0] \"\" X\n", 2, "0 bits" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|65@1+ (1,0) [0|0] \"\" X\n", 2, "65 bits" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (0,0) [0|0] \"\" X\n", 2, "scale 0" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (nan,0) [0|0] \"\" X\n", 2, "(scale,offset)" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1e999,0) [0|0] \"\" X\n", 2, "(scale,offset)" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0,0] \"\" X\n", 2, "[min|max]" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] X\n", 2, "quotes" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"km X\n", 2, "never closed" },
	{ "BO_ 1 M: 8 X\nCM_ \"abc\n\n", 2, "never closed" },
	{ "BO_ 1 M: 8 X\n\nCM_ BO_ 1 \"a\"\n", 3, "never closed by a ';'" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\nVAL_ 1 A 0 \"a\" b \"c\";\n", 3, "number, text" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\nSIG_VALTYPE_ 1 A : 1;\n", 3, "8 bits cannot be a float" },
	{ "BO_ 1 M: 8 X\n SG_ A m0 : 0|8@1+ (1,0) [0|0] \"\" X\n SG_ B m0 : 8|8@1+ (1,0) [0|0] \"\" X\n"
	  "SG_MUL_VAL_ 1 A B 0-0;\nSG_MUL_VAL_ 1 B A 0-0;\n",
		2, "circle" },
	{ "BO_ 1 M: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\nSG_MUL_VAL_ 1 A A x;\n", 3, "low-high" },
};

static void faults_name_their_line(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(fault_cases) / sizeof(*fault_cases); i++) {
		assert_int_equal(parse(fault_cases[i].text), -EINVAL);
		if (error.line != fault_cases[i].line || !strstr(error.text, fault_cases[i].says))
			fail_msg("case %zu: line %u: %s", i, error.line, error.text);
		assert_int_equal(arena.used, 0);
	}
	fresh_arena();
	assert_int_equal(dbc_parse(&dbc, "BO_ 1 M: 8 X\n\0", 14, &arena, &error), -EINVAL);
	assert_non_null(strstr(error.text, "not a text file"));
}

static void a_full_arena_is_said_and_given_back(void **state)
{
	(void)state;
	for (size_t size = 0; size < 20000; size += 61) {
		arena_init(&arena, "small", memory, size);
		int status = dbc_parse(&dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &error);
		if (!status)
			return;
		assert_int_equal(status, -ENOMEM);
		assert_int_equal(arena.used, 0);
		assert_non_null(strstr(error.text, "do not fit"));
	}
}

static void what_names_nothing_is_a_warning(void **state)
{
	(void)state;
	assert_int_equal(
		parse("BO_ 1 M: 1 X\n SG_ A : 0|16@1+ (1,0) [0|0] \"\" X\n\nVAL_ 9 B 0 \"x\" ;\nVAL_ 1 B 0 \"x\" ;\n"
			  "SOMETHING new 1 2 3\nBO_ 1 N: 8 X\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\n"),
		0);
	assert_int_equal(dbc.warnings, 4);
	assert_int_equal(dbc.first_warning.line, 2);
	assert_string_equal(dbc_find_id(&dbc, 1, false)->name, "M");
}

/* The text cut anywhere, and with any byte changed, parses or is refused; run under the sanitizers. */
static void damaged_text_never_crashes(void **state)
{
	(void)state;
	static char text[16384];
	assert_true(dbc_boulevard_size > 0 && dbc_boulevard_size < sizeof(text));
	for (size_t cut = 0; cut < dbc_boulevard_size; cut += 3) {
		char *exact = malloc(cut ? cut : 1); /* so that reading past the end is seen */
		assert_non_null(exact);
		memcpy(exact, dbc_boulevard_text, cut);
		fresh_arena();
		dbc_parse(&dbc, exact, cut, &arena, &error);
		free(exact);
	}
	struct rng rng = rng_seed(11);
	size_t size = dbc_boulevard_size > 0 ? dbc_boulevard_size : 1;
	for (int i = 0; i < 3000; i++) {
		memcpy(text, dbc_boulevard_text, dbc_boulevard_size);
		for (int k = 0; k < 3; k++)
			text[rng_u32(&rng) % size] = "\"();:|@M m0-9\n\\\t,x"[rng_u32(&rng) % 18];
		fresh_arena();
		dbc_parse(&dbc, text, dbc_boulevard_size, &arena, &error);
	}
}

static void the_virtual_car_is_without_fault(void **state)
{
	(void)state;
	fresh_arena();
	assert_int_equal(dbc_parse(&dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &error), 0);
	if (dbc.warnings)
		fail_msg("line %u: %s", dbc.first_warning.line, dbc.first_warning.text);
	for (const struct dbc_message *message = dbc.messages; message; message = message->next) {
		assert_true(message->cycle_ms > 0);
		uint64_t used = 0; /* no two signals share a bit */
		for (const struct dbc_signal *signal = message->signals; signal; signal = signal->next) {
			struct can_frame_rx frame;
			uint64_t bits;
			dbc_frame_init(message, &frame);
			assert_int_equal(dbc_encode_raw(signal, -1, &frame), 0);
			memcpy(&bits, frame.data, 8);
			assert_int_equal(used & bits, 0);
			used |= bits;
		}
	}
	const struct dbc_signal *gear = dbc_find_signal(&dbc, "DRIVETRAIN", "Gear");
	assert_string_equal(dbc_value_text(gear, 3), "Drive");
	assert_null(dbc_value_text(gear, 5));
}

static void a_checksum_is_put_and_seen_to_be_wrong(void **state)
{
	(void)state;
	fresh_arena();
	assert_int_equal(dbc_parse(&dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &error), 0);
	const struct dbc_signal *sum = dbc_find_signal(&dbc, "MOTION", "Checksum");
	for (int kind = CAN_CHECKSUM_XOR; kind <= CAN_CHECKSUM_CRC8; kind++) {
		struct can_frame_rx frame;
		dbc_frame_init(sum->message, &frame);
		dbc_encode(dbc_find_signal(&dbc, "MOTION", "Speed"), 50.0, &frame);
		assert_int_equal(can_checksum_put((enum can_checksum)kind, sum, &frame), 0);
		assert_true(can_checksum_good((enum can_checksum)kind, sum, &frame));
		for (int bit = 0; bit < 64; bit++) {
			frame.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
			assert_false(can_checksum_good((enum can_checksum)kind, sum, &frame));
			frame.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		}
	}
	/* A frame of a real car: 0B4 of the RAV4 log. */
	static const uint8_t rav4[8] = { 0, 0, 0, 0, 0x1D, 0x0B, 0x7A, 0x5E };
	struct dbc_message message = { .id = 0xB4, .length = 8 };
	struct dbc_signal last = { .message = &message, .start = 63, .length = 8, .big_endian = true, .scale = 1 };
	struct can_frame_rx frame = frame_of(0xB4, 8, rav4);
	assert_true(can_checksum_good(CAN_CHECKSUM_TOYOTA, &last, &frame));
	/* The check value of CRC-8 SAE J1850: "123456789" gives 4B; here 31 32 is the identifier. */
	static const uint8_t digits[8] = { '3', '4', '5', '6', '7', '8', '9', 0 };
	frame = frame_of(0x3231, 7, digits);
	struct dbc_signal beyond = last;
	beyond.start = 200;
	assert_int_equal(can_checksum_expected(CAN_CHECKSUM_CRC8, &beyond, &frame), 0x4B);
}

static void database_files_of_real_cars_parse(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		unsigned messages, signals;
	} files[] = { { "canedge3-internal-gnss", 9, 39 }, { "canmod-gps", 9, 39 }, { "hyundai_can_generated", 146, 1325 },
		{ "obd2_min", 1, 8 }, { "toyota_new_mc_pt_generated", 58, 353 } };
	const char *folder = getenv("BLVD_DATA");
	for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++) {
		char path[500];
		struct file_map map;
		snprintf(path, sizeof(path), "%s/can/dbc/%s.dbc", folder ? folder : "", files[i].name);
		if (file_map_open(&map, path)) {
			print_message("skipped: no %s\n", path);
			continue;
		}
		fresh_arena();
		if (dbc_parse(&dbc, (const char *)map.bytes.data, map.bytes.size, &arena, &error))
			fail_msg("%s:%u: %s", path, error.line, error.text);
		print_message("%s: %u messages, %u signals, %zu bytes; %u warnings, line %u: %s\n", files[i].name,
			dbc.message_count, dbc.signal_count, arena.used, dbc.warnings, dbc.first_warning.line,
			dbc.first_warning.text);
		if (files[i].messages) {
			assert_int_equal(dbc.message_count, files[i].messages);
			assert_int_equal(dbc.signal_count, files[i].signals);
		}
		file_map_close(&map);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bits_are_read_in_both_orders),
		cmocka_unit_test(every_layout_survives_encoding_and_touches_no_other_bit),
		cmocka_unit_test(a_signal_beyond_the_received_length_is_not_present),
		cmocka_unit_test(only_a_data_frame_of_the_same_kind_of_identifier_matches),
		cmocka_unit_test(multiplexed_signals_are_present_with_their_selector_only),
		cmocka_unit_test(floats_decode_and_encode),
		cmocka_unit_test(encoding_rounds_and_stops_at_the_ends),
		cmocka_unit_test(faults_name_their_line),
		cmocka_unit_test(a_full_arena_is_said_and_given_back),
		cmocka_unit_test(what_names_nothing_is_a_warning),
		cmocka_unit_test(damaged_text_never_crashes),
		cmocka_unit_test(the_virtual_car_is_without_fault),
		cmocka_unit_test(a_checksum_is_put_and_seen_to_be_wrong),
		cmocka_unit_test(database_files_of_real_cars_parse),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
