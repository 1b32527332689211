/*
 * Any frames into a car: decoding, judging, OBD-II, the destination. Input: for each frame a byte that chooses the
 * message (or, from 0xF0 on, any identifier), a byte of flags and length, a byte of time passed, then up to 8 bytes of
 * data. Messages have counters, checksums, floats and multiplexers; the car must never know a speed that no car has.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "board/car.h"
#include "nav/destination.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char profile_text[] =
	"[can]\ndbc = builtin:boulevard builtin:obd2\ninterfaces = a b\n[obd]\ninterface = b\n[car]\nwheelbase_m = 2.7\n"
	"track_m = 1.5\n[signals]\nspeed = MOTION.Speed counter=Counter checksum=Checksum:crc8 max_rate=50 frozen=5\n"
	"yaw_rate = MOTION.YawRate sign=-1 bus=a\nheading = GNSS_MOTION.Course unit=deg valid=CourseValid\n"
	"steering = STEERING.SteeringAngle counter=Counter counter_skip=1 checksum=Checksum:sum\n"
	"gear = DRIVETRAIN.Gear\nturn_lamp = BODY.TurnLamp\nambient = BODY.AmbientLight\n"
	"odometer = OBD2.Odometer timeout=2\nlatitude = GNSS_POSITION.Latitude valid=PositionValid\n"
	"longitude = GNSS_POSITION.Longitude valid=PositionValid max_rate=1\nturn_left = BODY.TurnLamp unit=%\n"
	"wheel_front_left = WHEELS.WheelFrontLeft\nwheel_front_right = WHEELS.WheelFrontRight max=50\n"
	"wheel_rear_left = WHEELS.WheelRearLeft\nwheel_rear_right = OBD2.VehicleSpeed\n";

static const uint32_t messages[] = { 256, 272, 288, 512, 528, 544, 768, 769, 770, 784, 0x7E8, 0x7E9, 0x7DF,
	0x18DAF110 };

static const struct car *make_car(void)
{
	static _Alignas(64) uint8_t memory[1 << 20];
	static struct car car;
	static bool made;
	struct arena arena;
	struct profile profile;
	struct profile_error error;
	if (made)
		return &car;
	arena_init(&arena, "fuzz", memory, sizeof(memory));
	if (profile_parse(&profile, NULL, profile_text, sizeof(profile_text) - 1, &arena, &error) ||
		car_init(&car, &profile, NULL, 0, NULL, 0, &arena))
		abort();
	made = true;
	return &car;
}

/* Takes the next frame off the input. */
static bool next_frame(const uint8_t **data, size_t *size, int64_t *now_ns, struct can_frame_rx *frame)
{
	if (*size < 3)
		return false;
	const uint8_t *head = *data;
	uint32_t any = head[0] | (uint32_t)head[1] << 8 | (uint32_t)head[2] << 16;
	bool known = head[0] < 0xF0;
	*frame = (struct can_frame_rx){ .id = known ? messages[head[0] % (sizeof(messages) / sizeof(*messages))] : any };
	frame->len = head[1] & 15;
	frame->bus = head[1] >> 4 & 1;
	frame->flags = frame->id > 0x7FF ? CAN_FRAME_EXT : 0;
	if (frame->len > 8) {
		frame->len = head[1] & 0x20 ? 64 : 8;
		frame->flags |= head[1] & 0x20 ? CAN_FRAME_FD : head[1] & 0x40 ? CAN_FRAME_REMOTE : CAN_FRAME_ERROR;
	}
	*now_ns += (int64_t)head[2] * head[2] * 100000; /* 0 to 6.5 s */
	frame->time_ns = head[1] & 0x80 ? *now_ns - 1000000 : *now_ns;
	*data += 3;
	*size -= 3;
	size_t have = *size < 8 ? *size : 8, wanted = frame->len < have ? frame->len : have;
	memcpy(frame->data, *data, wanted);
	*data += wanted;
	*size -= wanted;
	return true;
}

static void check(const struct vehicle_state *state)
{
	if (!isfinite(state->speed_mps) || !isfinite(state->yaw_rate_rps) || !isfinite(state->heading_rad))
		abort();
	if (state->speed_usable && fabs(state->speed_mps) > 110.0)
		abort();
	if (state->heading_usable && !(state->heading_rad >= 0.0 && state->heading_rad < 6.2831854))
		abort();
	if (state->has_fix && (fabs(state->lat_deg) > 90.0 || fabs(state->lon_deg) > 360.0))
		abort();
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++)
		if (state->age_ns[i] < 0 || !isfinite(state->value[i]))
			abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct car *car = make_car();
	struct vehicle vehicle;
	struct destination destination;
	struct obd obd;
	struct can_frame_rx frame, question;
	struct vehicle_state state;
	int64_t now_ns = 1000000000;
	vehicle_init(&vehicle, &car->vehicle);
	destination_init(&destination, car->destination);
	obd_init(&obd, &car->obd, now_ns);
	while (next_frame(&data, &size, &now_ns, &frame)) {
		obd_ask(&obd, now_ns, &question);
		if (!obd_take(&obd, &frame))
			continue;
		vehicle_feed(&vehicle, &frame);
		destination_feed(&destination, &frame);
		vehicle_sample(&vehicle, now_ns, &state);
		check(&state);
	}
	return 0;
}
