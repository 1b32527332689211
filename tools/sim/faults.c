#include "tools/sim/faults.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "platform/can/checksum.h"

static const char *const kind_names[FAULT_KINDS] = { "lost", "stuck", "noisy", "range", "counter", "checksum", "busoff",
	"clock", "camera", "chatter" };

/* What boulevard's profile calls them, in the virtual car's definitions. */
static const struct target {
	const char *name, *messages[3], *signal;
	double noise;
} targets[] = {
	{ "speed", { "MOTION" }, "Speed", 25.0 },
	{ "yaw_rate", { "MOTION" }, "YawRate", 12.0 },
	{ "steering", { "STEERING" }, "SteeringAngle", 90.0 },
	{ "gear", { "DRIVETRAIN" }, "Gear", 2.0 },
	{ "turn_lamp", { "BODY" }, "TurnLamp", 2.0 },
	{ "ambient", { "BODY" }, "AmbientLight", 30.0 },
	{ "odometer", { "ODOMETER" }, "Odometer", 1.0 },
	{ "ignition", { "POWER" }, "Ignition", 1.0 },
	{ "destination", { "DESTINATION" }, NULL, 0.0 },
	{ "wheels", { "WHEELS" }, NULL, 0.0 },
	{ "gnss", { "GNSS_POSITION", "GNSS_MOTION", "GNSS_TIME" }, NULL, 0.0 },
};

void faults_init(struct faults *faults, const struct dbc *dbc, uint64_t seed)
{
	*faults = (struct faults){ .dbc = dbc, .rng = rng_seed(seed ^ 0xFA) };
}

static const struct dbc_signal *signal_named(const struct dbc_message *message, const char *name)
{
	const struct dbc_signal *signal = message ? message->signals : NULL;
	while (signal && strcasecmp(signal->name, name) != 0)
		signal = signal->next;
	return signal;
}

static const struct dbc_message *message_named(const struct dbc *dbc, const char *name)
{
	char upper[FAULT_TEXT_MAX];
	size_t i = 0;
	for (; name[i] && i + 1 < sizeof(upper); i++)
		upper[i] = (char)(name[i] >= 'a' && name[i] <= 'z' ? name[i] - 32 : name[i]);
	upper[i] = 0;
	return dbc_find_message(dbc, upper);
}

static bool known_target(const struct faults *faults, struct fault *fault)
{
	for (size_t i = 0; i < sizeof(targets) / sizeof(targets[0]); i++) {
		if (strcasecmp(targets[i].name, fault->target) != 0)
			continue;
		for (int m = 0; m < 3 && targets[i].messages[m]; m++)
			fault->messages[m] = dbc_find_message(faults->dbc, targets[i].messages[m]);
		if (targets[i].signal)
			fault->signal = signal_named(fault->messages[0], targets[i].signal);
		fault->noise = targets[i].noise;
		return true;
	}
	return false;
}

static bool resolve(const struct faults *faults, struct fault *fault)
{
	char name[FAULT_TEXT_MAX];
	if (!strcasecmp(fault->target, "all") || known_target(faults, fault))
		return true;
	snprintf(name, sizeof(name), "%s", fault->target);
	char *dot = strchr(name, '.');
	if (dot)
		*dot = 0;
	fault->messages[0] = message_named(faults->dbc, name);
	if (dot) {
		fault->signal = signal_named(fault->messages[0], dot + 1);
		if (fault->signal)
			fault->noise = 0.02 * fabs(fault->signal->scale) * ldexp(1.0, (int)fault->signal->length);
	}
	return fault->messages[0] && (!dot || fault->signal);
}

/* Which kinds are about what: every target is looked at once, when it is named. */
static const char *check_target(const struct faults *faults, struct fault *fault)
{
	static char error[160];
	char *end;
	switch (fault->kind) {
	case FAULT_BUS_OFF:
		return NULL;
	case FAULT_CLOCK:
		strtod(fault->target, &end);
		return end != fault->target && !*end ? NULL : "clock wants seconds";
	case FAULT_CAMERA:
	case FAULT_CHATTER:
		return fault->target[0] ? NULL : "which camera fault, which line?";
	default:
		break;
	}
	snprintf(error, sizeof(error), "no message or signal '%s'", fault->target);
	if (!resolve(faults, fault))
		return error;
	bool by_value = fault->kind == FAULT_STUCK || fault->kind == FAULT_NOISY || fault->kind == FAULT_RANGE;
	snprintf(error, sizeof(error), "'%s' is no single signal", fault->target);
	if (by_value && !fault->signal)
		return error;
	const char *needs = fault->kind == FAULT_COUNTER ? "Counter" : "Checksum";
	snprintf(error, sizeof(error), "'%s' has no %s", fault->target, needs);
	if ((fault->kind == FAULT_COUNTER || fault->kind == FAULT_CHECKSUM) && !signal_named(fault->messages[0], needs))
		return error;
	return NULL;
}

/* "KIND[:TARGET][/SECONDS]"; blanks do for colon and slash. */
static const char *parse(const char *text, struct fault *fault)
{
	char copy[2 * FAULT_TEXT_MAX], *save = NULL;
	if (snprintf(copy, sizeof(copy), "%s", text) >= (int)sizeof(copy))
		return "too long";
	const char *kind = strtok_r(copy, ": /", &save), *target = strtok_r(NULL, " /", &save);
	int k = 0;
	while (kind && k < FAULT_KINDS && strcasecmp(kind, kind_names[k]) != 0)
		k++;
	if (!kind || k == FAULT_KINDS)
		return "no such fault; there are lost stuck noisy range counter checksum busoff clock camera chatter";
	fault->kind = (enum fault_kind)k;
	const char *seconds = k == FAULT_BUS_OFF ? target : strtok_r(NULL, " /", &save);
	if (k != FAULT_BUS_OFF && target && snprintf(fault->target, sizeof(fault->target), "%s", target) >= FAULT_TEXT_MAX)
		return "too long";
	char *end = NULL;
	fault->seconds = seconds ? strtod(seconds, &end) : 0.0;
	if (seconds && (*end || !(fault->seconds > 0.0 && fault->seconds < 1e6)))
		return "seconds are a number above 0";
	return k != FAULT_BUS_OFF && !target ? "of what?" : NULL;
}

const char *faults_add(struct faults *faults, const char *text, double start_s)
{
	struct fault fault = { .start_s = start_s };
	const char *wrong = parse(text, &fault);
	if (!wrong)
		wrong = check_target(faults, &fault);
	if (!wrong && faults->count == FAULTS_MAX)
		wrong = "too many faults at once";
	if (!wrong)
		faults->items[faults->count++] = fault;
	return wrong;
}

const char *faults_script(struct faults *faults, const char *text)
{
	char *end;
	double at = strtod(text, &end);
	if (end == text || *end != ':' || !(at >= 0.0 && at < 1e6))
		return "TIME:KIND[:TARGET][/SECONDS] expected";
	return faults_add(faults, end + 1, at);
}

static bool is_about(const struct fault *fault, const char *what)
{
	size_t kind = strcspn(what, ": ");
	if (strlen(kind_names[fault->kind]) != kind || strncasecmp(what, kind_names[fault->kind], kind) != 0)
		return !strcasecmp(what, fault->target);
	return !what[kind] || !strcasecmp(what + kind + 1, fault->target);
}

void faults_clear(struct faults *faults, const char *what, double now_s)
{
	for (unsigned i = 0; i < faults->count; i++) {
		struct fault *fault = &faults->items[i];
		if (fault->begun && (!what || !*what || is_about(fault, what)))
			fault->seconds = fmax(now_s - fault->start_s, 1e-9);
	}
}

struct fault_event faults_step(struct faults *faults, double now_s)
{
	struct fault_event event = { .kind = FAULT_KINDS };
	for (unsigned i = 0; i < faults->count; i++) {
		struct fault *fault = &faults->items[i];
		bool ends = fault->begun && ((fault->seconds > 0.0 && now_s >= fault->start_s + fault->seconds) ||
										fault->kind == FAULT_CLOCK); /* a jump has no length */
		if (!ends && (fault->begun || now_s < fault->start_s))
			continue;
		event.kind = fault->kind;
		event.begins = !ends;
		event.seconds = fault->seconds;
		memcpy(event.target, fault->target, sizeof(event.target));
		fault->begun = true;
		if (ends)
			faults->items[i] = faults->items[--faults->count];
		return event;
	}
	return event;
}

static bool concerns(const struct fault *fault, const struct can_frame_rx *frame)
{
	if (!fault->begun || fault->kind >= FAULT_CLOCK)
		return false;
	if (!fault->messages[0])
		return true; /* all */
	for (int m = 0; m < 3 && fault->messages[m]; m++)
		if (dbc_message_matches(fault->messages[m], frame))
			return true;
	return false;
}

static void change_value(struct faults *faults, struct fault *fault, struct can_frame_rx *frame)
{
	const struct dbc_signal *signal = fault->signal;
	double value;
	if (fault->kind == FAULT_STUCK) {
		if (!fault->raw_known)
			fault->raw_known = dbc_decode_raw(signal, frame, &fault->raw);
		dbc_encode_raw(signal, fault->raw, frame);
	} else if (fault->kind == FAULT_RANGE) {
		unsigned bits = signal->type == DBC_SIGNED ? signal->length - 1u : signal->length;
		dbc_encode_raw(signal, (int64_t)((UINT64_C(1) << bits) - 1), frame);
	} else if (fault->kind == FAULT_NOISY && dbc_decode(signal, frame, &value)) {
		dbc_encode(signal, value + fault->noise * rng_range(&faults->rng, -1.7, 1.7), frame);
	}
}

/* What comes after the value: a receiver must not see by these that something was changed. */
static void protect(const struct faults *faults, struct can_frame_rx *frame)
{
	const struct dbc_message *message = dbc_find_id(faults->dbc, frame->id, (frame->flags & CAN_FRAME_EXT) != 0);
	const struct dbc_signal *checksum = signal_named(message, "Checksum");
	if (checksum)
		can_checksum_put(CAN_CHECKSUM_CRC8, checksum, frame);
}

static void stop_counter(struct fault *fault, struct can_frame_rx *frame)
{
	const struct dbc_signal *counter = signal_named(fault->messages[0], "Counter");
	if (!counter)
		return;
	if (!fault->raw_known)
		fault->raw_known = dbc_decode_raw(counter, frame, &fault->raw);
	dbc_encode_raw(counter, fault->raw, frame);
}

bool faults_apply(struct faults *faults, struct can_frame_rx *frame)
{
	bool spoilt = false;
	for (unsigned i = 0; i < faults->count; i++) {
		struct fault *fault = &faults->items[i];
		if (!concerns(fault, frame))
			continue;
		if (fault->kind == FAULT_LOST || fault->kind == FAULT_BUS_OFF)
			return false;
		if (fault->kind == FAULT_COUNTER)
			stop_counter(fault, frame);
		else
			change_value(faults, fault, frame);
		spoilt |= fault->kind == FAULT_CHECKSUM;
	}
	protect(faults, frame);
	const struct dbc_message *message = dbc_find_id(faults->dbc, frame->id, false);
	const struct dbc_signal *checksum = spoilt ? signal_named(message, "Checksum") : NULL;
	int64_t raw;
	if (checksum && dbc_decode_raw(checksum, frame, &raw))
		dbc_encode_raw(checksum, (raw ^ 0x5A) & 0xFF, frame);
	return true;
}

bool faults_active(const struct faults *faults, enum fault_kind kind)
{
	for (unsigned i = 0; i < faults->count; i++)
		if (faults->items[i].begun && faults->items[i].kind == kind)
			return true;
	return false;
}

void faults_describe(const struct faults *faults, double now_s, char *out, size_t size)
{
	size_t used = 0;
	out[0] = 0;
	for (unsigned i = 0; i < faults->count && used + 1 < size; i++) {
		const struct fault *fault = &faults->items[i];
		if (!fault->begun)
			continue;
		int n = snprintf(out + used, size - used, "%s%s%s%s %.0f s", used ? ", " : "", kind_names[fault->kind],
			fault->target[0] ? " " : "", fault->target, now_s - fault->start_s);
		used += n > 0 ? (size_t)n : 0;
	}
}
