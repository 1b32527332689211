/* The poller against simulated cars, in steps of 10 ms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/can/dbc.h"
#include "platform/can/dbc_obd2.h"
#include "platform/can/obd.h"

#define STEP_NS (10 * NS_PER_MS)

struct car {
	bool asleep, extended, refuses_odometer;
	uint32_t unit, second_unit; /* 0: none */
	uint8_t speed_kmh;
	unsigned asked, answered;
};

static struct can_frame_rx answer_of(const struct car *car, uint32_t unit, const struct can_frame_rx *question)
{
	struct can_frame_rx answer = { .time_ns = question->time_ns + STEP_NS, .id = unit, .len = 8 };
	uint8_t pid = question->data[2];
	answer.flags = car->extended ? CAN_FRAME_EXT : 0;
	memcpy(answer.data, (uint8_t[8]){ 3, 0x41, pid, car->speed_kmh }, 8);
	if (pid == 0xA6)
		memcpy(answer.data, (uint8_t[8]){ 6, 0x41, pid, 0, 0, 0x10, 0 }, 8);
	if (pid == 0xA6 && car->refuses_odometer)
		memcpy(answer.data, (uint8_t[8]){ 3, 0x7F, 1, 0x12 }, 8);
	return answer;
}

/* Drives the poller for some seconds; the last answer that was to be decoded goes to `last`. */
static void drive(struct obd *obd, struct car *car, int64_t *now_ns, double seconds, struct can_frame_rx *last)
{
	for (int64_t end_ns = *now_ns + (int64_t)(seconds * 1e9); *now_ns < end_ns; *now_ns += STEP_NS) {
		struct can_frame_rx question;
		if (!obd_ask(obd, *now_ns, &question))
			continue;
		car->asked++;
		assert_int_equal(question.len, 8);
		assert_int_equal(question.data[0], 2);
		assert_int_equal(question.data[1], 1);
		if (car->asleep || car->extended != !!(question.flags & CAN_FRAME_EXT))
			continue;
		assert_int_equal(question.id, car->extended ? 0x18DB33F1 : 0x7DF);
		const uint32_t units[] = { car->unit, car->second_unit };
		for (int i = 0; i < 2; i++) {
			struct can_frame_rx answer = answer_of(car, units[i], &question);
			if (units[i] && obd_take(obd, &answer)) {
				car->answered++;
				*last = answer;
			}
		}
	}
}

static struct obd poller(enum obd_addressing addressing, unsigned pid_count)
{
	const struct obd_config config = {
		.pids = { 0x0D, 0xA6 }, .pid_count = pid_count, .rate_hz = 5.0, .addressing = addressing
	};
	struct obd obd;
	obd_init(&obd, &config, 0);
	return obd;
}

static void a_car_is_asked_at_the_rate_and_heard(void **state)
{
	(void)state;
	static const struct {
		enum obd_addressing addressing;
		bool extended;
		uint32_t unit;
	} cases[] = {
		{ OBD_ADDRESSING_AUTO, false, 0x7E8 },
		{ OBD_ADDRESSING_11, false, 0x7E9 },
		{ OBD_ADDRESSING_29, true, 0x18DAF110 },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct obd obd = poller(cases[i].addressing, 1);
		struct car car = { .unit = cases[i].unit, .extended = cases[i].extended, .speed_kmh = 50 };
		struct can_frame_rx last = { 0 };
		int64_t now_ns = 0;
		drive(&obd, &car, &now_ns, 10.0, &last);
		assert_in_range(car.asked, 48, 51);
		assert_int_equal(car.answered, car.asked);
		assert_int_equal(last.id, OBD_ANSWER_ID);
		assert_int_equal(last.flags, 0);
		assert_int_equal(last.data[3], 50);
	}
}

static void both_kinds_of_addressing_are_tried(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_AUTO, 1);
	struct car car = { .unit = 0x18DAF128, .extended = true, .speed_kmh = 7 };
	struct can_frame_rx last = { 0 };
	int64_t now_ns = 0;
	drive(&obd, &car, &now_ns, 10.0, &last);
	assert_true(car.answered > 35);
	assert_int_equal(last.data[3], 7);
}

static void a_silent_car_is_asked_less_and_less_and_again_when_it_wakes(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_11, 1);
	struct car car = { .unit = 0x7E8, .asleep = true };
	struct can_frame_rx last = { 0 };
	int64_t now_ns = 0;
	drive(&obd, &car, &now_ns, 600.0, &last);
	assert_in_range(car.asked, 10, 30);
	car.asleep = false;
	drive(&obd, &car, &now_ns, 40.0, &last);
	assert_true(car.answered > 40); /* within the longest pause of 30 s */
	unsigned asked = car.asked;
	drive(&obd, &car, &now_ns, 10.0, &last);
	assert_in_range(car.asked - asked, 48, 51);
}

static void what_is_refused_is_not_asked_again_and_again(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_11, 2);
	struct car car = { .unit = 0x7E8, .refuses_odometer = true };
	struct can_frame_rx last = { 0 };
	int64_t now_ns = 0;
	drive(&obd, &car, &now_ns, 60.0, &last);
	assert_int_equal(car.asked - car.answered, 1);
	obd = poller(OBD_ADDRESSING_11, 2);
	car = (struct car){ .unit = 0x7E8 };
	now_ns = 0;
	drive(&obd, &car, &now_ns, 60.0, &last);
	assert_int_equal(car.asked, car.answered);
}

static void one_of_two_units_is_listened_to(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_11, 1);
	struct car car = { .unit = 0x7E8, .second_unit = 0x7E9 };
	struct can_frame_rx last = { 0 };
	int64_t now_ns = 0;
	drive(&obd, &car, &now_ns, 10.0, &last);
	assert_int_equal(car.answered, car.asked);
	car.unit = 0; /* it falls silent: the other is heard after some questions */
	unsigned answered = car.answered;
	drive(&obd, &car, &now_ns, 10.0, &last);
	assert_true(car.answered - answered > 30);
}

static void another_tester_has_the_bus_to_itself(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_11, 1);
	struct car car = { .unit = 0x7E8, .speed_kmh = 30 };
	struct can_frame_rx last = { 0 };
	int64_t now_ns = 0;
	drive(&obd, &car, &now_ns, 2.0, &last);
	unsigned asked = car.asked;
	for (int i = 0; i < 10; i++) {
		struct can_frame_rx other = { .time_ns = now_ns, .id = 0x7DF, .len = 8, .data = { 2, 1, 0x0D } };
		struct can_frame_rx answer = answer_of(&car, 0x7E8, &other);
		assert_false(obd_take(&obd, &other));
		assert_true(obd_take(&obd, &answer)); /* what it is told we hear too */
		drive(&obd, &car, &now_ns, 1.0, &last);
	}
	assert_int_equal(car.asked, asked);
	drive(&obd, &car, &now_ns, 10.0, &last);
	assert_true(car.asked - asked > 20);
}

static void only_answers_to_service_1_are_decoded(void **state)
{
	(void)state;
	static const struct {
		struct can_frame_rx frame;
		bool taken;
	} cases[] = {
		{ { .id = 0x123, .len = 8, .data = { 3, 0x41, 0x0D, 50 } }, true }, /* not OBD: passed on */
		{ { .id = 0x7E8, .len = 8, .data = { 3, 0x41, 0x0D, 50 } }, true },
		{ { .id = 0x7EF, .len = 4, .data = { 3, 0x41, 0x0D, 50 } }, true },
		{ { .id = 0x7E8, .len = 3, .data = { 3, 0x41, 0x0D } }, false },
		{ { .id = 0x7E8, .len = 0 }, false },
		{ { .id = 0x7E8, .len = 8, .data = { 4, 0x62, 0xF1, 0x0D, 50 } }, false },
		{ { .id = 0x7E8, .len = 8, .data = { 0x10, 0x14, 0x41, 0x0D } }, false },
		{ { .id = 0x7E8, .len = 8, .data = { 0x21, 0x41, 0x0D, 50 } }, false },
		{ { .id = 0x7E8, .len = 8, .data = { 3, 0x7F, 1, 0x12 } }, false },
		{ { .id = 0x7E0, .len = 8, .data = { 2, 1, 0x0D } }, false },
		{ { .id = 0x18DAF110, .flags = CAN_FRAME_EXT, .len = 8, .data = { 3, 0x41, 0x0D, 50 } }, true },
		{ { .id = 0x18DA10F1, .flags = CAN_FRAME_EXT, .len = 8, .data = { 2, 1, 0x0D } }, false },
		{ { .id = 0x7E8, .bus = 1, .len = 8, .data = { 4, 0x62, 0xF1, 0x0D, 50 } }, true }, /* another bus */
		{ { .id = 0x7E8, .len = 8, .flags = CAN_FRAME_REMOTE }, true },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct obd obd = poller(OBD_ADDRESSING_AUTO, 1);
		struct can_frame_rx frame = cases[i].frame;
		assert_int_equal(obd_take(&obd, &frame), cases[i].taken);
	}
}

static void nothing_is_asked_that_was_not_asked_for(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_AUTO, 0);
	struct can_frame_rx question;
	for (int64_t now_ns = 0; now_ns < 100 * NS_PER_S; now_ns += STEP_NS)
		assert_false(obd_ask(&obd, now_ns, &question));
}

static void a_bus_that_takes_nothing_is_left_alone(void **state)
{
	(void)state;
	struct obd obd = poller(OBD_ADDRESSING_11, 1);
	struct can_frame_rx question;
	unsigned tries = 0;
	for (int64_t now_ns = 0; now_ns < 300 * NS_PER_S; now_ns += STEP_NS)
		if (obd_ask(&obd, now_ns, &question)) {
			tries++;
			obd_failed(&obd, now_ns);
		}
	assert_in_range(tries, 8, 16);
}

static void the_definitions_decode_an_answer(void **state)
{
	(void)state;
	static _Alignas(64) uint8_t memory[1 << 16];
	struct arena arena;
	struct dbc dbc;
	struct dbc_note error;
	double value;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(dbc_parse(&dbc, dbc_obd2_text, dbc_obd2_size, &arena, &error), 0);
	assert_int_equal(dbc.warnings, 0);
	const struct dbc_signal *speed = dbc_find_signal(&dbc, "OBD2", "VehicleSpeed");
	const struct dbc_signal *odometer = dbc_find_signal(&dbc, "OBD2", "Odometer");
	struct can_frame_rx frame = { .id = OBD_ANSWER_ID, .len = 8, .data = { 3, 0x41, 0x0D, 88 } };
	assert_true(dbc_decode(speed, &frame, &value) && value == 88.0);
	assert_false(dbc_decode(odometer, &frame, &value));
	frame.data[1] = 0x62;
	assert_false(dbc_decode(speed, &frame, &value));
	frame = (struct can_frame_rx){ .id = OBD_ANSWER_ID, .len = 8, .data = { 6, 0x41, 0xA6, 0, 1, 0, 0 } };
	assert_true(dbc_decode(odometer, &frame, &value) && value > 6553.59 && value < 6553.61);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_car_is_asked_at_the_rate_and_heard),
		cmocka_unit_test(both_kinds_of_addressing_are_tried),
		cmocka_unit_test(a_silent_car_is_asked_less_and_less_and_again_when_it_wakes),
		cmocka_unit_test(what_is_refused_is_not_asked_again_and_again),
		cmocka_unit_test(one_of_two_units_is_listened_to),
		cmocka_unit_test(another_tester_has_the_bus_to_itself),
		cmocka_unit_test(only_answers_to_service_1_are_decoded),
		cmocka_unit_test(nothing_is_asked_that_was_not_asked_for),
		cmocka_unit_test(a_bus_that_takes_nothing_is_left_alone),
		cmocka_unit_test(the_definitions_decode_an_answer),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
