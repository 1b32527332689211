/* Relative axes are detents as they are; an absolute one is a counter. */
#include "platform/base/clock.h"
#include "platform/input/evdev.h"

#define TURN_MAX 64 /* in one report: more is a device gone mad */

static int32_t clamp(int32_t detents)
{
	return detents > TURN_MAX ? TURN_MAX : detents < -TURN_MAX ? -TURN_MAX : detents;
}

/* The shorter way round. */
static int32_t wheel_detents(struct evdev_decoder *decoder, int32_t value)
{
	int32_t by = value - decoder->wheel_at, turn = decoder->wheel_turn;
	decoder->wheel_at = value;
	if (turn > 0 && by > turn / 2)
		by -= turn;
	else if (turn > 0 && by < -(turn / 2))
		by += turn;
	return by;
}

static bool decode_turn(struct evdev_report *out, int32_t detents)
{
	out->kind = EVDEV_TURN;
	out->value = clamp(detents);
	return detents != 0;
}

static bool decode_sync(struct evdev_decoder *decoder, const struct input_event *event, struct evdev_report *out)
{
	if (event->code == SYN_DROPPED)
		decoder->dropped = true;
	else if (event->code == SYN_REPORT && decoder->dropped) {
		decoder->dropped = false;
		out->kind = EVDEV_RESET;
		return true;
	}
	return false;
}

bool evdev_decode(struct evdev_decoder *decoder, const struct input_event *event, struct evdev_report *out)
{
	*out = (struct evdev_report){ .time_ns = event->input_event_sec * NS_PER_S + event->input_event_usec * 1000 };
	if (event->type == EV_SYN)
		return decode_sync(decoder, event, out);
	if (decoder->dropped)
		return false;
	if (event->type == EV_KEY) {
		out->kind = EVDEV_KEY;
		out->key = event->code;
		out->value = event->value;
		return true;
	}
	if (event->type == EV_REL) {
		bool knob =
			event->code == REL_X || event->code == REL_DIAL || event->code == REL_WHEEL || event->code == REL_HWHEEL;
		return knob && decode_turn(out, event->value);
	}
	if (event->type == EV_ABS && decoder->has_wheel && (event->code == ABS_X || event->code == ABS_WHEEL))
		return decode_turn(out, wheel_detents(decoder, event->value));
	return false;
}
