#include "board/car.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "platform/base/clock.h"
#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "platform/base/vec.h"
#include "platform/can/dbc_boulevard.h"
#include "platform/can/dbc_obd2.h"

/* Longest alternative first costs nothing here: names are compared whole. */
enum quantity { SPEED, ANGULAR_RATE, ANGLE, LENGTH, SHARE, DEGREES, CODE };

static const struct unit {
	enum quantity quantity;
	const char *name;
	double factor; /* to the unit of nav/vehicle.h */
} units[] = {
	{ SPEED, "m/s", 1.0 },
	{ SPEED, "km/h", 1.0 / 3.6 },
	{ SPEED, "kmh", 1.0 / 3.6 },
	{ SPEED, "kph", 1.0 / 3.6 },
	{ SPEED, "mph", 0.44704 },
	{ SPEED, "kn", 1852.0 / 3600.0 },
	{ SPEED, "knots", 1852.0 / 3600.0 },
	{ ANGULAR_RATE, "rad/s", 1.0 },
	{ ANGULAR_RATE, "deg/s", BLVD_PI / 180.0 },
	{ ANGULAR_RATE, "deg/sec", BLVD_PI / 180.0 },
	{ ANGULAR_RATE, "degree/s", BLVD_PI / 180.0 },
	{ ANGLE, "rad", 1.0 },
	{ ANGLE, "deg", BLVD_PI / 180.0 },
	{ ANGLE, "degree", BLVD_PI / 180.0 },
	{ ANGLE, "degrees", BLVD_PI / 180.0 },
	{ LENGTH, "m", 1.0 },
	{ LENGTH, "km", 1000.0 },
	{ LENGTH, "mi", 1609.344 },
	{ SHARE, "%", 0.01 },
	{ SHARE, "", 1.0 },
	{ DEGREES, "deg", 1.0 },
	{ DEGREES, "degree", 1.0 },
	{ DEGREES, "degrees", 1.0 },
};

/* What an input is and, in the units of nav/vehicle.h, what a car can do: limits for a profile that says nothing.
 * Timeouts are for messages whose cycle time the definitions do not tell. */
static const struct input_kind {
	enum quantity quantity;
	double min, max, max_rate;
	double timeout_s;
	double turn; /* > 0: wraps */
} input_kinds[VEHICLE_INPUT_COUNT] = {
	[VEHICLE_SPEED] = { SPEED, -30.0, 110.0, 50.0, 1.0, 0 },
	[VEHICLE_YAW_RATE] = { ANGULAR_RATE, -3.5, 3.5, 0, 1.0, 0 },
	[VEHICLE_HEADING] = { ANGLE, -2.0 * BLVD_PI, 2.0 * BLVD_PI, 0, 2.0, 2.0 * BLVD_PI },
	[VEHICLE_STEERING] = { ANGLE, -20.0, 20.0, 0, 1.0, 0 },
	[VEHICLE_GEAR] = { CODE, 0, 0, 0, 3.0, 0 },
	[VEHICLE_TURN_LAMP] = { CODE, 0, 0, 0, 3.0, 0 },
	[VEHICLE_AMBIENT] = { SHARE, 0, 1.0001, 0, 10.0, 0 },
	[VEHICLE_ODOMETER] = { LENGTH, 0, 1e10, 0, 10.0, 0 },
	[VEHICLE_LATITUDE] = { DEGREES, -90, 90, 0, 3.0, 0 },
	[VEHICLE_LONGITUDE] = { DEGREES, -180, 360, 0, 3.0, 360 },
	[VEHICLE_TURN_LEFT] = { SHARE, -1e9, 1e9, 0, 3.0, 0 },
	[VEHICLE_TURN_RIGHT] = { SHARE, -1e9, 1e9, 0, 3.0, 0 },
	[VEHICLE_WHEEL_FRONT_LEFT] = { SPEED, -30.0, 110.0, 0, 1.0, 0 },
	[VEHICLE_WHEEL_FRONT_RIGHT] = { SPEED, -30.0, 110.0, 0, 1.0, 0 },
	[VEHICLE_WHEEL_REAR_LEFT] = { SPEED, -30.0, 110.0, 0, 1.0, 0 },
	[VEHICLE_WHEEL_REAR_RIGHT] = { SPEED, -30.0, 110.0, 0, 1.0, 0 },
	[VEHICLE_IGNITION] = { CODE, 0, 0, 0, 3.0, 0 },
};

static const struct word_meaning {
	int input;
	const char *word;
	uint8_t meaning;
} word_meanings[] = {
	{ VEHICLE_GEAR, "P", NAV_GEAR_PARK },
	{ VEHICLE_GEAR, "Park", NAV_GEAR_PARK },
	{ VEHICLE_GEAR, "Parking", NAV_GEAR_PARK },
	{ VEHICLE_GEAR, "R", NAV_GEAR_REVERSE },
	{ VEHICLE_GEAR, "Reverse", NAV_GEAR_REVERSE },
	{ VEHICLE_GEAR, "N", NAV_GEAR_NEUTRAL },
	{ VEHICLE_GEAR, "Neutral", NAV_GEAR_NEUTRAL },
	{ VEHICLE_GEAR, "D", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Drive", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Forward", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "S", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Sport", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "M", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Manual", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "B", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "L", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Low", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "T", NAV_GEAR_DRIVE },
	{ VEHICLE_GEAR, "Unknown", NAV_GEAR_UNKNOWN },
	{ VEHICLE_IGNITION, "Off", VEHICLE_IGNITION_OFF },
	{ VEHICLE_IGNITION, "Accessory", VEHICLE_IGNITION_ON },
	{ VEHICLE_IGNITION, "On", VEHICLE_IGNITION_ON },
	{ VEHICLE_IGNITION, "Run", VEHICLE_IGNITION_ON },
	{ VEHICLE_IGNITION, "Start", VEHICLE_IGNITION_ON },
	{ VEHICLE_TURN_LAMP, "Off", NAV_TURN_LAMP_OFF },
	{ VEHICLE_TURN_LAMP, "None", NAV_TURN_LAMP_OFF },
	{ VEHICLE_TURN_LAMP, "Left", NAV_TURN_LAMP_LEFT },
	{ VEHICLE_TURN_LAMP, "Right", NAV_TURN_LAMP_RIGHT },
	{ VEHICLE_TURN_LAMP, "Hazard", NAV_TURN_LAMP_HAZARD },
	{ VEHICLE_TURN_LAMP, "Both", NAV_TURN_LAMP_HAZARD },
};

/* Says where in the profile something is wrong; always -EINVAL. */
__attribute__((format(printf, 3, 4))) static int fault(
	const struct profile *profile, const struct profile_signal *at, const char *format, ...)
{
	char text[300];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	log_error("%s:%u: %s", profile->path ? profile->path : "profile", at->line, text);
	return -EINVAL;
}

static const struct builtin_dbc {
	const char *name, *text;
	const size_t *size;
} builtin_dbcs[] = {
	{ PROFILE_DBC_BUILTIN, dbc_boulevard_text, &dbc_boulevard_size },
	{ PROFILE_DBC_OBD2, dbc_obd2_text, &dbc_obd2_size },
};

static const struct builtin_dbc *find_builtin(const char *name)
{
	for (size_t i = 0; i < sizeof(builtin_dbcs) / sizeof(*builtin_dbcs); i++)
		if (!strcmp(name, builtin_dbcs[i].name))
			return &builtin_dbcs[i];
	return NULL;
}

static int parse_file(struct dbc *out, const char *path, struct arena *arena)
{
	struct dbc_note error;
	struct file_map map = { 0 };
	const struct builtin_dbc *builtin = find_builtin(path);
	int status = builtin ? 0 : file_map_open(&map, path);
	if (status) {
		log_error("%s: %s", path, strerror(-status));
		return status;
	}
	const char *text = builtin ? builtin->text : (const char *)map.bytes.data;
	status = dbc_parse(out, text ? text : "", builtin ? *builtin->size : map.bytes.size, arena, &error);
	file_map_close(&map);
	if (status)
		log_error("%s:%u: %s", path, error.line, error.text);
	else if (out->warnings)
		log_warn(
			"%s:%u: %s (%u such in the file)", path, out->first_warning.line, out->first_warning.text, out->warnings);
	return status;
}

static const struct dbc_signal *find_signal(const struct car *car, const char *message, const char *name)
{
	const struct dbc_signal *signal = NULL;
	for (unsigned i = 0; i < car->dbc_count && !signal; i++)
		signal = dbc_find_signal(&car->dbc[i], message, name);
	return signal;
}

static bool message_known(const struct car *car, const char *name)
{
	for (unsigned i = 0; i < car->dbc_count; i++)
		if (dbc_find_message(&car->dbc[i], name))
			return true;
	return false;
}

/* A counter, checksum or valid bit: by name, in the message of the signal. */
static const struct dbc_signal *find_companion(const struct dbc_signal *signal, const char *name)
{
	const struct dbc_signal *other = signal->message->signals;
	while (other && strcmp(other->name, name) != 0)
		other = other->next;
	return other;
}

static bool unit_factor(enum quantity quantity, const char *name, double *factor)
{
	for (size_t i = 0; i < sizeof(units) / sizeof(*units); i++)
		if (units[i].quantity == quantity && !strcasecmp(units[i].name, name)) {
			*factor = units[i].factor;
			return true;
		}
	return false;
}

static bool word_meaning(int input, const char *word, uint8_t *meaning)
{
	for (size_t i = 0; i < sizeof(word_meanings) / sizeof(*word_meanings); i++)
		if (word_meanings[i].input == input && !strcasecmp(word_meanings[i].word, word)) {
			*meaning = word_meanings[i].meaning;
			return true;
		}
	if (input == VEHICLE_GEAR && isdigit((unsigned char)word[0]) && !word[1]) { /* "1" to "9" */
		*meaning = NAV_GEAR_DRIVE;
		return word[0] != '0';
	}
	return false;
}

static int map_from_profile(
	struct vehicle_binding *binding, int input, const struct profile *profile, const struct profile_signal *from)
{
	for (unsigned i = 0; i < from->map_count; i++) {
		struct vehicle_map *entry = &binding->map[binding->map_count++];
		entry->raw = from->map[i].raw;
		if (!word_meaning(input, from->map[i].meaning, &entry->meaning))
			return fault(profile, from, "map: '%.40s' is no %s", from->map[i].meaning,
				profile_input_name((enum vehicle_input)input));
	}
	return 0;
}

static int map_from_table(
	struct vehicle_binding *binding, int input, const struct profile *profile, const struct profile_signal *from)
{
	for (const struct dbc_value *value = binding->signal->values; value; value = value->next) {
		uint8_t meaning;
		if (!word_meaning(input, value->text, &meaning))
			continue;
		if (binding->map_count == VEHICLE_MAP_MAX)
			return fault(profile, from, "the value table of '%s' has more than %d entries: give map=", from->name,
				VEHICLE_MAP_MAX);
		binding->map[binding->map_count++] = (struct vehicle_map){ value->raw, meaning };
	}
	if (binding->map_count == 0)
		return fault(profile, from, "'%s' has no value table with words for %s: give map=", from->name,
			profile_input_name((enum vehicle_input)input));
	return 0;
}

static int bind_scale(
	struct vehicle_binding *binding, int input, const struct profile *profile, const struct profile_signal *from)
{
	const struct input_kind *kind = &input_kinds[input];
	const char *unit = from->unit ? from->unit : binding->signal->unit;
	double factor;
	if (!unit_factor(kind->quantity, unit, &factor))
		return fault(profile, from, "unit '%.40s' of '%s' is not one of %s: give unit=", unit, from->name,
			profile_input_name((enum vehicle_input)input));
	double scale = from->scale * from->sign * factor;
	binding->scale = scale;
	binding->offset = from->offset * from->sign * factor;
	binding->quantum = 1.5 * (scale < 0 ? -scale : scale) *
					   (binding->signal->scale < 0 ? -binding->signal->scale : binding->signal->scale);
	binding->min = from->has_min ? from->min * factor : kind->min;
	binding->max = from->has_max ? from->max * factor : kind->max;
	binding->max_rate = from->has_max_rate ? from->max_rate * factor : kind->max_rate;
	binding->wraps = kind->turn > 0.0;
	binding->turn = kind->turn;
	return 0;
}

static int64_t bind_spacing(const struct vehicle_binding *binding)
{
	static const int64_t usual_ms = 20;
	return NS_PER_MS * (binding->signal->message->cycle_ms ? binding->signal->message->cycle_ms : usual_ms);
}

static int64_t bind_timeout(const struct vehicle_binding *binding, int input, const struct profile_signal *from)
{
	int64_t cycles = 5 * NS_PER_MS * binding->signal->message->cycle_ms;
	if (from->has_timeout)
		return (int64_t)(from->timeout_s * 1e9);
	if (cycles > 0)
		return cycles < 200 * NS_PER_MS ? 200 * NS_PER_MS : cycles;
	return (int64_t)(input_kinds[input].timeout_s * 1e9);
}

static int bind_companions(
	struct vehicle_binding *binding, const struct profile *profile, const struct profile_signal *from)
{
	const char *const names[3] = { from->counter, from->checksum, from->valid };
	const struct dbc_signal **const to[3] = { &binding->counter, &binding->checksum, &binding->valid };
	for (int i = 0; i < 3; i++) {
		if (!names[i])
			continue;
		*to[i] = find_companion(binding->signal, names[i]);
		if (!*to[i])
			return fault(profile, from, "message '%s' has no signal '%.60s'", binding->signal->message->name, names[i]);
	}
	binding->checksum_kind = from->checksum_kind;
	/* By default up to half a turn of the counter may be lost: more cannot be told from going backwards. */
	if (binding->counter) {
		unsigned bits = binding->counter->length < 16 ? binding->counter->length : 16;
		binding->counter_skip = from->has_counter_skip ? from->counter_skip : (1u << bits) / 2 - 1;
	}
	return 0;
}

/* Index of an interface of the profile by the name that logs give it; -1 when there is none. */
static int find_bus(const struct profile *profile, const char *name)
{
	for (unsigned i = 0; i < profile->interface_count; i++) {
		char known[CANDUMP_NAME_SIZE];
		can_bus_short_name(profile->interfaces[i], known);
		if (!strcmp(known, name))
			return (int)i;
	}
	return -1;
}

static int bind_bus(struct vehicle_binding *binding, const struct profile *profile, const struct profile_signal *from)
{
	binding->bus = VEHICLE_ANY_BUS;
	if (!from->bus)
		return 0;
	int bus = find_bus(profile, from->bus);
	if (bus < 0)
		return fault(profile, from, "bus '%.40s' is not one of the interfaces in [can]", from->bus);
	binding->bus = bus;
	return 0;
}

static int bind_signal(struct car *car, int input, const struct profile *profile, const struct profile_signal *from)
{
	struct vehicle_binding *binding = &car->vehicle.inputs[input];
	binding->signal = find_signal(car, from->message, from->name);
	if (!binding->signal && from->message && !message_known(car, from->message))
		return fault(profile, from, "no message '%.60s' in the signal definitions", from->message);
	if (!binding->signal)
		return fault(profile, from, "no signal '%.60s%s%.60s' in the signal definitions",
			from->message ? from->message : "", from->message ? "." : "", from->name);
	binding->spacing_ns = bind_spacing(binding);
	binding->timeout_ns = bind_timeout(binding, input, from);
	binding->frozen_ns = (int64_t)(from->frozen_s * 1e9);
	int status = bind_bus(binding, profile, from);
	if (!status)
		status = bind_companions(binding, profile, from);
	if (status)
		return status;
	if (input_kinds[input].quantity != CODE)
		return bind_scale(binding, input, profile, from);
	return from->map_count ? map_from_profile(binding, input, profile, from)
						   : map_from_table(binding, input, profile, from);
}

static void add_filter(struct car *car, const struct dbc_message *message)
{
	for (unsigned i = 0; i < car->filter_count; i++)
		if (car->filters[i].id == message->id && car->filters[i].extended == message->extended)
			return;
	car->filters[car->filter_count++] = (struct can_bus_filter){ .id = message->id, .extended = message->extended };
}

/* Questions of other testers and answers, of both kinds of addressing. */
static void add_obd_filters(struct car *car)
{
	static const struct can_bus_filter filters[] = {
		{ .id = 0x7DF },
		{ .id = 0x7E0, .mask = 0x7F0 },
		{ .id = 0x18DA0000, .extended = true, .mask = 0x1FFE0000 },
	};
	for (size_t i = 0; i < sizeof(filters) / sizeof(*filters); i++)
		car->filters[car->filter_count++] = filters[i];
}

/* What is asked for is what the signals in use need. */
static int take_obd(struct car *car, const struct profile *profile)
{
	const struct profile_signal at = { .line = profile->obd_line };
	if (!profile->obd_interface)
		return 0;
	int bus = find_bus(profile, profile->obd_interface);
	if (bus < 0)
		return fault(profile, &at, "interface '%.40s' is not one of the interfaces in [can]", profile->obd_interface);
	car->obd = (struct obd_config){
		.bus = (uint8_t)bus, .rate_hz = profile->obd_rate_hz, .addressing = profile->obd_addressing
	};
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++) {
		const struct dbc_signal *signal = car->vehicle.inputs[i].signal;
		if (!signal || signal->message->id != OBD_ANSWER_ID || signal->message->extended || !signal->ranges)
			continue;
		if (car->obd.pid_count == OBD_PIDS_MAX || signal->ranges->low > 0xFF)
			return fault(profile, &at, "at most %d signals by OBD-II, of service 01", OBD_PIDS_MAX);
		car->obd.pids[car->obd.pid_count++] = (uint8_t)signal->ranges->low;
	}
	if (car->obd.pid_count == 0)
		return fault(profile, &at, "there is nothing to ask for: no signal is of an OBD-II answer (message 2024)");
	add_obd_filters(car);
	return 0;
}

static void take_interfaces(
	struct car *car, const struct profile *profile, const char *const *interfaces, unsigned interface_count)
{
	unsigned wanted = interface_count > profile->interface_count ? interface_count : profile->interface_count;
	car->interface_count = wanted < CAN_BUS_MAX ? wanted : CAN_BUS_MAX;
	for (unsigned i = 0; i < car->interface_count; i++)
		car->interfaces[i] = i < interface_count ? interfaces[i] : profile->interfaces[i];
}

static void take_destination(struct car *car)
{
	for (unsigned i = 0; i < car->dbc_count && !car->destination; i++) {
		const struct dbc_message *message = dbc_find_message(&car->dbc[i], "DESTINATION");
		if (!message)
			continue;
		car->destination = &car->dbc[i];
		add_filter(car, message);
	}
}

static void take_geometry(struct car *car, const struct profile *profile)
{
	car->vehicle.wheelbase_m = profile->wheelbase_m;
	car->vehicle.track_m = profile->track_m;
	car->vehicle.steering_ratio = profile->steering_ratio;
	car->vehicle.understeer_s2pm2 = profile->understeer_s2pm2;
	car->vehicle.steering_centre_rad = profile->steering_centre_deg * (BLVD_PI / 180.0);
	car->vehicle.speed_signed = profile->speed_signed;
}

int car_init(struct car *car, const struct profile *profile, const char *const *dbc, unsigned dbc_count,
	const char *const *interfaces, unsigned interface_count, struct arena *arena)
{
	*car = (struct car){ 0 };
	if (dbc_count == 0) {
		dbc = profile->dbc;
		dbc_count = profile->dbc_count;
	}
	for (unsigned i = 0; i < dbc_count && i < PROFILE_DBC_MAX; i++) {
		int status = parse_file(&car->dbc[i], dbc[i], arena);
		if (status)
			return status;
		car->dbc_count++;
	}
	take_interfaces(car, profile, interfaces, interface_count);
	take_geometry(car, profile);
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++) {
		if (!profile->signals[i].line)
			continue;
		int status = bind_signal(car, i, profile, &profile->signals[i]);
		if (status)
			return status;
		add_filter(car, car->vehicle.inputs[i].signal->message);
	}
	take_destination(car);
	return take_obd(car, profile);
}
