/* INI -> struct profile. libinih splits lines; the tables below say which keys there are and what they may be. */
#include "board/profile.h"

#include <errno.h>
#include <ini.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board/profile_sim.h"
#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "platform/can/can_socket.h"

struct reader {
	const char *at, *end;
	unsigned line;
	bool overlong;
	struct profile *profile;
	struct arena *arena;
	struct profile_error *error;
	int status;
};

__attribute__((format(printf, 2, 3))) static bool fail(struct reader *in, const char *format, ...)
{
	if (in->status)
		return false;
	va_list args;
	va_start(args, format);
	in->error->line = in->line;
	vsnprintf(in->error->text, sizeof(in->error->text), format, args);
	va_end(args);
	in->status = -EINVAL;
	return false;
}

static bool out_of_memory(struct reader *in)
{
	fail(in, "the profile does not fit in the memory set aside for it");
	in->status = -ENOMEM;
	return false;
}

static const char *keep(struct reader *in, const char *text)
{
	size_t size = strlen(text) + 1;
	char *copy = arena_alloc(in->arena, size, 1);
	if (copy)
		return memcpy(copy, text, size);
	out_of_memory(in);
	return NULL;
}

static bool parse_double(const char *text, double *out)
{
	char *stop;
	*out = strtod(text, &stop);
	return stop != text && !*stop && isfinite(*out);
}

static bool parse_bool(const char *text, bool *out)
{
	*out = !strcmp(text, "yes") || !strcmp(text, "true") || !strcmp(text, "1");
	return *out || !strcmp(text, "no") || !strcmp(text, "false") || !strcmp(text, "0");
}

/* A key that is a number: where it goes and what it may be. */
struct number_key {
	const char *section, *key;
	enum { KIND_U32, KIND_MIB, KIND_DOUBLE, KIND_SECONDS } kind;
	size_t field;
	double min, max;
};

#define FIELD(name) offsetof(struct profile, name)

static const struct number_key number_keys[] = {
	{ "display", "width", KIND_U32, FIELD(width), 64, 8192 },
	{ "display", "height", KIND_U32, FIELD(height), 64, 8192 },
	{ "display", "fps", KIND_U32, FIELD(fps), 1, 240 },
	{ "display", "fps_standstill", KIND_U32, FIELD(fps_standstill), 0, 240 },
	{ "display", "fps_ignition_off", KIND_U32, FIELD(fps_ignition_off), 0, 240 },
	{ "display", "brightness_day", KIND_DOUBLE, FIELD(brightness_day), 0.05, 1 },
	{ "display", "brightness_night", KIND_DOUBLE, FIELD(brightness_night), 0.05, 1 },
	{ "display", "msaa", KIND_U32, FIELD(samples), 0, 16 },
	{ "memory", "budget_mib", KIND_MIB, FIELD(budget_bytes), 16, 65536 },
	{ "car", "wheelbase_m", KIND_DOUBLE, FIELD(wheelbase_m), 0.5, 20 },
	{ "car", "track_m", KIND_DOUBLE, FIELD(track_m), 0.5, 5 },
	{ "car", "steering_ratio", KIND_DOUBLE, FIELD(steering_ratio), 0.5, 50 },
	{ "car", "steering_centre_deg", KIND_DOUBLE, FIELD(steering_centre_deg), -90, 90 },
	{ "car", "understeer_s2pm2", KIND_DOUBLE, FIELD(understeer_s2pm2), -0.01, 0.05 },
	{ "car", "width_m", KIND_DOUBLE, FIELD(width_m), 0.5, 4 },
	{ "car", "rear_overhang_m", KIND_DOUBLE, FIELD(rear_overhang_m), 0, 10 },
	{ "camera", "width", KIND_U32, FIELD(camera.width), 64, 4096 },
	{ "camera", "height", KIND_U32, FIELD(camera.height), 64, 4096 },
	{ "camera", "fps", KIND_U32, FIELD(camera.fps), 1, 240 },
	{ "camera", "fov_deg", KIND_DOUBLE, FIELD(camera.fov_deg), 10, 220 },
	{ "camera", "k1", KIND_DOUBLE, FIELD(camera.k1), -2, 2 },
	{ "camera", "k2", KIND_DOUBLE, FIELD(camera.k2), -2, 2 },
	{ "camera", "height_m", KIND_DOUBLE, FIELD(camera.height_m), 0.1, 5 },
	{ "camera", "pitch_deg", KIND_DOUBLE, FIELD(camera.pitch_deg), -20, 90 },
	{ "camera", "behind_axle_m", KIND_DOUBLE, FIELD(camera.behind_axle_m), -5, 15 },
	{ "camera", "offset_m", KIND_DOUBLE, FIELD(camera.offset_m), -2, 2 },
	{ "power", "off_after_s", KIND_SECONDS, FIELD(power.off_after_ns), 0.1, 3600 },
	{ "obd", "rate_hz", KIND_DOUBLE, FIELD(obd_rate_hz), 0.1, 20 },
	{ "start", "latitude", KIND_DOUBLE, FIELD(start.lat_deg), -90, 90 },
	{ "start", "longitude", KIND_DOUBLE, FIELD(start.lon_deg), -180, 360 },
	{ "start", "heading_deg", KIND_DOUBLE, FIELD(start_heading_deg), -360, 360 },
};

static bool set_number(struct reader *in, const struct number_key *key, const char *text)
{
	char *to = (char *)in->profile + key->field;
	double value;
	bool whole = key->kind == KIND_U32 || key->kind == KIND_MIB;
	if (!parse_double(text, &value) || value < key->min || value > key->max || (whole && value != floor(value)))
		return fail(in, "%s is '%.40s', not a %snumber from %g to %g", key->key, text, whole ? "whole " : "", key->min,
			key->max);
	uint32_t small = (uint32_t)value;
	uint64_t bytes = (uint64_t)value << 20;
	int64_t ns = (int64_t)(value * 1e9);
	switch (key->kind) {
	case KIND_U32:
		memcpy(to, &small, sizeof(small));
		break;
	case KIND_MIB:
		memcpy(to, &bytes, sizeof(bytes));
		break;
	case KIND_DOUBLE:
		memcpy(to, &value, sizeof(value));
		break;
	case KIND_SECONDS:
		memcpy(to, &ns, sizeof(ns));
		break;
	}
	return true;
}

/* Index of `text` in `words`, a list that ends with NULL; or -1, having failed with the list. */
static int choose(struct reader *in, const char *key, const char *text, const char *const *words)
{
	char list[120] = "";
	for (int i = 0; words[i]; i++) {
		if (!strcmp(text, words[i]))
			return i;
		size_t used = strlen(list);
		snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "", words[i]);
	}
	fail(in, "%s is '%.40s', not one of: %s", key, text, list);
	return -1;
}

/* The next word of a list separated by blanks or commas; NULL at the end. Cuts `*text` up. */
static char *next_word(char **text)
{
	char *word = *text + strspn(*text, " \t,");
	size_t length = strcspn(word, " \t,");
	if (!length)
		return NULL;
	*text = word + length + (word[length] != 0);
	word[length] = 0;
	return word;
}

static const char *beside_profile(struct reader *in, const char *name)
{
	const char *path = in->profile->path, *slash = path ? strrchr(path, '/') : NULL;
	char joined[1024];
	if (name[0] == '/' || !slash || !strncmp(name, "builtin:", strlen("builtin:")))
		return keep(in, name);
	int n = snprintf(joined, sizeof(joined), "%.*s/%s", (int)(slash - path), path, name);
	if (n < 0 || n >= (int)sizeof(joined)) {
		fail(in, "the path of '%.40s' is too long", name);
		return NULL;
	}
	return keep(in, joined);
}

static bool set_dbc(struct reader *in, char *text)
{
	struct profile *profile = in->profile;
	for (char *word; (word = next_word(&text));) {
		if (profile->dbc_count == PROFILE_DBC_MAX)
			return fail(in, "more than %d dbc files", PROFILE_DBC_MAX);
		const char *path = beside_profile(in, word);
		if (!path)
			return false;
		profile->dbc[profile->dbc_count++] = path;
	}
	return true;
}

static bool set_interfaces(struct reader *in, char *text)
{
	struct profile *profile = in->profile;
	for (char *word; (word = next_word(&text));) {
		if (strlen(word) >= CANDUMP_NAME_SIZE && !can_socket_is_address(word))
			return fail(in, "interface name '%.40s' is longer than %d characters", word, CANDUMP_NAME_SIZE - 1);
		if (profile->interface_count == CAN_BUS_MAX)
			return fail(in, "more than %d interfaces", CAN_BUS_MAX);
		const char *name = keep(in, word);
		if (!name)
			return false;
		profile->interfaces[profile->interface_count++] = name;
	}
	return true;
}

static const char *const input_names[VEHICLE_INPUT_COUNT] = {
	[VEHICLE_SPEED] = "speed",
	[VEHICLE_YAW_RATE] = "yaw_rate",
	[VEHICLE_HEADING] = "heading",
	[VEHICLE_STEERING] = "steering",
	[VEHICLE_GEAR] = "gear",
	[VEHICLE_TURN_LAMP] = "turn_lamp",
	[VEHICLE_AMBIENT] = "ambient",
	[VEHICLE_ODOMETER] = "odometer",
	[VEHICLE_LATITUDE] = "latitude",
	[VEHICLE_LONGITUDE] = "longitude",
	[VEHICLE_TURN_LEFT] = "turn_left",
	[VEHICLE_TURN_RIGHT] = "turn_right",
	[VEHICLE_WHEEL_FRONT_LEFT] = "wheel_front_left",
	[VEHICLE_WHEEL_FRONT_RIGHT] = "wheel_front_right",
	[VEHICLE_WHEEL_REAR_LEFT] = "wheel_rear_left",
	[VEHICLE_WHEEL_REAR_RIGHT] = "wheel_rear_right",
	[VEHICLE_IGNITION] = "ignition",
};

const char *profile_input_name(enum vehicle_input input)
{
	return input_names[input];
}

/* "0:park,1:reverse" */
static bool set_map(struct reader *in, struct profile_signal *signal, char *text)
{
	for (char *word; (word = next_word(&text));) {
		char *colon = strchr(word, ':'), *stop;
		if (!colon || colon == word || !colon[1])
			return fail(in, "map: '%.40s' is not number:meaning", word);
		if (signal->map_count == VEHICLE_MAP_MAX)
			return fail(in, "map has more than %d entries", VEHICLE_MAP_MAX);
		struct profile_map *entry = &signal->map[signal->map_count++];
		*colon = 0;
		entry->raw = strtoll(word, &stop, 0);
		if (*stop)
			return fail(in, "map: '%.40s' is not a whole number", word);
		entry->meaning = keep(in, colon + 1);
		if (!entry->meaning)
			return false;
	}
	return true;
}

static bool set_checksum(struct reader *in, struct profile_signal *signal, char *text)
{
	char *colon = strchr(text, ':');
	if (!colon || !can_checksum_by_name(colon + 1, &signal->checksum_kind))
		return fail(in, "checksum is '%.40s', not SIGNAL:KIND with KIND one of: xor, sum, toyota, crc8", text);
	*colon = 0;
	signal->checksum = keep(in, text);
	return signal->checksum != NULL;
}

/* Options of a signal that are numbers. */
static const struct signal_number {
	const char *key;
	size_t value, has; /* `has` 0: no such field; offset 0 is `line` */
	double min, max;
} signal_numbers[] = {
	{ "scale", offsetof(struct profile_signal, scale), 0, -1e12, 1e12 },
	{ "offset", offsetof(struct profile_signal, offset), 0, -1e12, 1e12 },
	{ "sign", offsetof(struct profile_signal, sign), 0, -1, 1 },
	{ "timeout", offsetof(struct profile_signal, timeout_s), offsetof(struct profile_signal, has_timeout), 0.001,
		3600 },
	{ "frozen", offsetof(struct profile_signal, frozen_s), 0, 0, 86400 },
	{ "min", offsetof(struct profile_signal, min), offsetof(struct profile_signal, has_min), -1e15, 1e15 },
	{ "max", offsetof(struct profile_signal, max), offsetof(struct profile_signal, has_max), -1e15, 1e15 },
	{ "max_rate", offsetof(struct profile_signal, max_rate), offsetof(struct profile_signal, has_max_rate), 0, 1e15 },
};

static bool set_signal_number(
	struct reader *in, struct profile_signal *signal, const struct signal_number *key, const char *text)
{
	double value;
	if (!parse_double(text, &value) || value < key->min || value > key->max)
		return fail(in, "%s is '%.40s', not a number from %g to %g", key->key, text, key->min, key->max);
	if ((!strcmp(key->key, "scale") || !strcmp(key->key, "sign")) && value == 0.0)
		return fail(in, "%s is 0", key->key);
	memcpy((char *)signal + key->value, &value, sizeof(value));
	if (key->has)
		*(bool *)((char *)signal + key->has) = true;
	return true;
}

static bool set_counter_skip(struct reader *in, struct profile_signal *signal, const char *text)
{
	double value;
	if (!parse_double(text, &value) || value < 0 || value > 1e6 || value != floor(value))
		return fail(in, "counter_skip is '%.40s', not a whole number from 0 to 1000000", text);
	signal->counter_skip = (unsigned)value;
	signal->has_counter_skip = true;
	return true;
}

static bool set_signal_text(struct reader *in, const char **to, const char *text)
{
	*to = keep(in, text);
	return *to != NULL;
}

static bool set_option(struct reader *in, struct profile_signal *signal, const char *key, char *value)
{
	for (size_t i = 0; i < sizeof(signal_numbers) / sizeof(*signal_numbers); i++)
		if (!strcmp(key, signal_numbers[i].key))
			return set_signal_number(in, signal, &signal_numbers[i], value);
	if (!strcmp(key, "bus"))
		return set_signal_text(in, &signal->bus, value);
	if (!strcmp(key, "unit"))
		return set_signal_text(in, &signal->unit, value);
	if (!strcmp(key, "counter"))
		return set_signal_text(in, &signal->counter, value);
	if (!strcmp(key, "valid"))
		return set_signal_text(in, &signal->valid, value);
	if (!strcmp(key, "counter_skip"))
		return set_counter_skip(in, signal, value);
	if (!strcmp(key, "checksum"))
		return set_checksum(in, signal, value);
	if (!strcmp(key, "map"))
		return set_map(in, signal, value);
	return fail(in, "a signal has no option '%.40s'", key);
}

/* "Message.Signal option=value ..." Blanks separate here, commas belong to map. */
static bool set_signal(struct reader *in, struct profile_signal *signal, char *text)
{
	char *save = NULL, *word = strtok_r(text, " \t", &save);
	if (signal->line)
		return fail(in, "the same input again; it was in line %u", signal->line);
	if (!word)
		return fail(in, "Message.Signal expected");
	*signal = (struct profile_signal){ .line = in->line, .scale = 1.0, .sign = 1.0 };
	char *dot = strchr(word, '.');
	if (dot) {
		*dot = 0;
		signal->message = keep(in, word);
	}
	signal->name = keep(in, dot ? dot + 1 : word);
	while (!in->status && (word = strtok_r(NULL, " \t", &save))) {
		char *equals = strchr(word, '=');
		if (!equals || equals == word || !equals[1])
			return fail(in, "'%.40s' is not option=value", word);
		*equals = 0;
		set_option(in, signal, word, equals + 1);
	}
	if (signal->has_min && signal->has_max && signal->min > signal->max)
		return fail(in, "min is greater than max");
	return !in->status;
}

static bool unknown(struct reader *in, const char *section, const char *key)
{
	log_warn("%s:%u: no key '%s' in [%s]; ignored", in->profile->path ? in->profile->path : "profile", in->line, key,
		section);
	in->profile->warnings++;
	return true;
}

static bool set_obd(struct reader *in, const char *key, const char *value)
{
	static const char *const addressings[] = { "auto", "11bit", "29bit", NULL };
	struct profile *profile = in->profile;
	if (!strcmp(key, "interface")) {
		profile->obd_line = in->line;
		profile->obd_interface = keep(in, value);
		return profile->obd_interface != NULL;
	}
	if (strcmp(key, "addressing") != 0)
		return unknown(in, "obd", key);
	int choice = choose(in, key, value, addressings);
	profile->obd_addressing = (enum obd_addressing)choice;
	return choice >= 0;
}

static bool set_in_signals(struct reader *in, const char *key, char *value)
{
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++)
		if (!strcmp(key, input_names[i]))
			return set_signal(in, &in->profile->signals[i], value);
	return unknown(in, "signals", key);
}

static bool set_in_gpio(struct reader *in, const char *section, const char *key, char *value)
{
	char error[160];
	switch (profile_gpio_set(&in->profile->gpio, section, key, value, in->line, in->arena, error, sizeof(error))) {
	case PROFILE_GPIO_DONE:
		return true;
	case PROFILE_GPIO_WRONG:
		return fail(in, "%s", error);
	case PROFILE_GPIO_NO_MEMORY:
		return out_of_memory(in);
	case PROFILE_GPIO_UNKNOWN:
		break;
	}
	return unknown(in, section, key);
}

static bool set_rotation(struct reader *in, const char *value)
{
	static const char *const turns[] = { "0", "90", "180", "270", NULL };
	int choice = choose(in, "rotation", value, turns);
	in->profile->rotation_deg = choice > 0 ? (uint32_t)choice * 90 : 0;
	return choice >= 0;
}

static bool set_buffers(struct reader *in, const char *value)
{
	static const char *const ways[] = { "auto", "gbm", "dumb", NULL };
	int choice = choose(in, "buffers", value, ways);
	in->profile->buffers = choice >= 0 ? (enum profile_buffers)choice : PROFILE_BUFFERS_AUTO;
	return choice >= 0;
}

/* A key of the panel, kept as it is. False: not one of these. */
static bool is_panel_text(struct reader *in, const char *key, const char *value, bool *done)
{
	const struct {
		const char *key;
		const char **to;
	} texts[] = { { "device", &in->profile->device }, { "connector", &in->profile->connector },
		{ "mode", &in->profile->mode }, { "vt", &in->profile->vt }, { "backlight", &in->profile->backlight } };
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		if (strcmp(key, texts[i].key) != 0)
			continue;
		*texts[i].to = keep(in, value);
		*done = *texts[i].to != NULL;
		return true;
	}
	return false;
}

static bool set_in_camera(struct reader *in, const char *key, char *value)
{
	static const char *const ways[] = { "auto", "yes", "no", NULL };
	static const char *const lenses[] = { "pinhole", "fisheye", NULL };
	static const char *const formats[] = { "auto", "yuyv", "uyvy", "nv12", "rgbx", "bgrx", "mjpeg", NULL };
	struct profile_camera *camera = &in->profile->camera;
	int at;
	if (!strcmp(key, "device")) {
		camera->device = strcmp(value, "none") != 0 ? keep(in, value) : NULL;
	} else if (!strcmp(key, "lens")) {
		at = choose(in, key, value, lenses);
		if (at >= 0)
			camera->lens = (enum lens_kind)at;
	} else if (!strcmp(key, "zero_copy")) {
		at = choose(in, key, value, ways);
		if (at >= 0)
			camera->zero_copy = (enum profile_zero_copy)at;
	} else if (!strcmp(key, "format")) {
		at = choose(in, key, value, formats);
		if (at >= 0)
			camera->format = camera_format_by_name(value);
	} else if (!strcmp(key, "mirror") || !strcmp(key, "repeats")) {
		bool *to = !strcmp(key, "mirror") ? &camera->mirror : &camera->repeats;
		return parse_bool(value, to) || fail(in, "%s is '%.40s', not yes or no", key, value);
	} else {
		return unknown(in, "camera", key);
	}
	return !in->status;
}

static bool set_word(struct reader *in, const char *section, const char *key, char *value)
{
	static const char *const styles[] = { "auto", "day", "dusk", "night", NULL };
	static const char *const units[] = { "auto", "metric", "imperial", NULL };
	static const char *const offs[] = { "stay", "end", NULL };
	struct profile *profile = in->profile;
	int choice;
	if (!strcmp(section, "display") && !strcmp(key, "style")) {
		choice = choose(in, key, value, styles);
		profile->style = (enum profile_style)choice;
		return choice >= 0;
	}
	if (!strcmp(section, "display") && !strcmp(key, "units")) {
		choice = choose(in, key, value, units);
		profile->units = (enum profile_units)choice;
		return choice >= 0;
	}
	bool done;
	if (!strcmp(section, "display") && is_panel_text(in, key, value, &done))
		return done;
	if (!strcmp(section, "display") && !strcmp(key, "rotation"))
		return set_rotation(in, value);
	if (!strcmp(section, "display") && !strcmp(key, "buffers"))
		return set_buffers(in, value);
	if (!strcmp(section, "gnss") && !strcmp(key, "source"))
		return (profile->gnss = keep(in, value)) != NULL;
	if (!strcmp(section, "power") && !strcmp(key, "off")) {
		choice = choose(in, key, value, offs);
		profile->power.ends = choice == 1;
		return choice >= 0;
	}
	if (!strcmp(section, "car") && !strcmp(key, "speed_signed"))
		return parse_bool(value, &profile->speed_signed) || fail(in, "speed_signed is '%.40s', not yes or no", value);
	if (!strcmp(section, "can") && !strcmp(key, "dbc"))
		return set_dbc(in, value);
	if (!strcmp(section, "can") && !strcmp(key, "interfaces"))
		return set_interfaces(in, value);
	return unknown(in, section, key);
}

/* inih's callback: not 0 means understood. */
static int set_key(void *user, const char *section, const char *key, const char *value)
{
	struct reader *in = user;
	char copy[256];
	if (in->status || in->overlong)
		return 0;
	size_t size_of_value = strlen(value) + 1;
	if (size_of_value > sizeof(copy))
		return fail(in, "the value of %s is too long", key);
	memcpy(copy, value, size_of_value);
	for (size_t i = 0; i < sizeof(number_keys) / sizeof(*number_keys); i++)
		if (!strcmp(section, number_keys[i].section) && !strcmp(key, number_keys[i].key)) {
			in->profile->has_start |= number_keys[i].field == FIELD(start.lat_deg);
			in->profile->has_heading |= number_keys[i].field == FIELD(start_heading_deg);
			return set_number(in, &number_keys[i], value);
		}
	if (!strcmp(section, "camera"))
		return set_in_camera(in, key, copy);
	if (!strcmp(section, "gpio") || !strcmp(section, "input"))
		return set_in_gpio(in, section, key, copy);
	if (!strcmp(section, "signals"))
		return set_in_signals(in, key, copy);
	return strcmp(section, "obd") ? set_word(in, section, key, copy) : set_obd(in, key, copy);
}

/* Hands inih one line, without leading blanks: an indented line would be taken as more of the value before. */
static char *read_line(char *to, int size, void *user)
{
	struct reader *in = user;
	if (in->at == in->end)
		return NULL;
	in->line++;
	while (in->at < in->end && (*in->at == ' ' || *in->at == '\t'))
		in->at++;
	const char *end = memchr(in->at, '\n', (size_t)(in->end - in->at));
	size_t length = (size_t)((end ? end : in->end) - in->at);
	if (length > (size_t)size - 2) {
		if (in->at[0] != '#' && in->at[0] != ';') {
			fail(in, "the line is longer than %d characters", size - 2);
			in->overlong = true;
		}
		to[0] = 0;
	} else {
		memcpy(to, in->at, length);
		to[length] = 0;
	}
	in->at = end ? end + 1 : in->end;
	return to;
}

static void defaults(struct profile *out, const char *path)
{
	*out = (struct profile){
		.path = path,
		.width = 1280,
		.height = 720,
		.fps = 60,
		.samples = 4,
		.brightness_day = 1.0,
		.brightness_night = 1.0,
		.budget_bytes = UINT64_C(512) << 20,
		.steering_ratio = 15.0,
		.width_m = 1.8,
		.rear_overhang_m = 1.0,
		.obd_rate_hz = 5.0,
		.gpio = { .rotary_steps = 4 },
		.camera = { .width = 1280,
			.height = 720,
			.fps = 30,
			.mirror = true,
			.repeats = true,
			.fov_deg = 110.0,
			.height_m = 0.95,
			.pitch_deg = 32.0,
			.behind_axle_m = 0.9 },
	};
}

int profile_parse(struct profile *out, const char *path, const char *text, size_t size, struct arena *arena,
	struct profile_error *error)
{
	struct reader in = { .at = text, .end = text + size, .profile = out, .arena = arena, .error = error };
	defaults(out, path);
	*error = (struct profile_error){ 0 };
	if (memchr(text, 0, size)) {
		fail(&in, "not a text file");
		return in.status;
	}
	int first_error = ini_parse_stream(read_line, &in, set_key, &in);
	if (!in.status && first_error > 0) {
		in.line = (unsigned)first_error;
		fail(&in, "neither [section], key = value nor a comment");
	}
	return in.status;
}

int profile_load(struct profile *out, const char *path, struct arena *arena)
{
	struct profile_error error;
	struct file_map map = { 0 };
	const char *name = path ? path : "built-in profile";
	int status = path ? file_map_open(&map, path) : 0;
	if (status) {
		log_error("%s: %s", path, strerror(-status));
		return status;
	}
	const char *text = path ? (const char *)map.bytes.data : profile_sim_text;
	size_t size = path ? map.bytes.size : profile_sim_size;
	status = profile_parse(out, path, text ? text : "", size, arena, &error);
	file_map_close(&map);
	if (status)
		log_error("%s:%u: %s", name, error.line, error.text);
	out->path = name;
	return status;
}
