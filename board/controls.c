/* Lines -> levels -> actions. A frame's work is a few dozen events; all times are the edges' own. */
#include "board/controls.h"

#include <errno.h>
#include <string.h>

#include "board/control_keys.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"

#define DEBOUNCE_MS 10
#define DEBOUNCE_CAR_MS 20 /* lines of the car carry more noise than a knob's */
#define LONG_MS 700
#define REPEAT_NS (150 * NS_PER_MS)
#define BATCH 64
#define DEVICE_LAG_NS (5 * NS_PER_MS)

static void add_action(struct controls *controls, enum action action)
{
	controls->actions++;
	if (controls->queue_count == CONTROLS_QUEUE) {
		controls->actions_dropped++;
		return;
	}
	controls->queue[(controls->queue_first + controls->queue_count++) % CONTROLS_QUEUE] = action;
}

enum action controls_next(struct controls *controls)
{
	if (!controls->queue_count)
		return ACTION_NONE;
	enum action action = controls->queue[controls->queue_first];
	controls->queue_first = (controls->queue_first + 1) % CONTROLS_QUEUE;
	controls->queue_count--;
	return action;
}

static void turn(struct controls *controls, int detents)
{
	enum action action = (detents > 0) != controls->knob_swapped ? ACTION_TURN_RIGHT : ACTION_TURN_LEFT;
	for (int i = detents < 0 ? -detents : detents; i > 0; i--)
		add_action(controls, action);
}

static void press(struct controls *controls, enum control_line role, enum press_kind kind)
{
	static const enum action shorts[CONTROL_LINE_COUNT] = {
		[CONTROL_PUSH] = ACTION_PUSH,
		[CONTROL_BACK] = ACTION_BACK,
		[CONTROL_ZOOM_IN] = ACTION_ZOOM_IN,
		[CONTROL_ZOOM_OUT] = ACTION_ZOOM_OUT,
		[CONTROL_VIEW] = ACTION_VIEW,
	};
	if (kind == PRESS_LONG && role == CONTROL_PUSH)
		add_action(controls, ACTION_BACK);
	else if (kind != PRESS_NONE)
		add_action(controls, shorts[role]);
}

static struct control_switch *switch_of(struct controls *controls, enum control_line role)
{
	switch (role) {
	case CONTROL_REVERSE:
		return &controls->state.reverse;
	case CONTROL_IGNITION:
		return &controls->state.ignition;
	case CONTROL_NIGHT:
		return &controls->state.night;
	default:
		return NULL;
	}
}

/* A debounced level is new. */
static void take_level(struct controls *controls, enum control_line role)
{
	const struct debounce *contact = &controls->contact[role];
	struct control_switch *out = switch_of(controls, role);
	if (out)
		*out = (struct control_switch){ true, contact->level, contact->level_ns };
	else
		press(controls, role, press_feed(&controls->press[role], contact->level, contact->level_ns));
}

static void take_knob(struct controls *controls, enum control_line role, const struct gpio_event *event)
{
	unsigned contact = role == CONTROL_ROTARY_B;
	if (event->kind == GPIO_LEVEL)
		quadrature_level(&controls->knob, contact, event->level, event->time_ns);
	else
		turn(controls, quadrature_edge(&controls->knob, contact, event->level, event->time_ns));
}

/* A button that is down when its line is first heard, or again, has not been pushed by anyone we saw. */
static void take_first_level(struct controls *controls, enum control_line role, const struct gpio_event *event)
{
	struct debounce *contact = &controls->contact[role];
	debounce_feed(contact, event->level, event->time_ns);
	if (switch_of(controls, role)) {
		take_level(controls, role);
		return;
	}
	press_feed(&controls->press[role], event->level, event->time_ns);
	controls->press[role].told = true;
	controls->press[role].next_ns = INT64_MAX;
}

static void lose(struct controls *controls, enum control_line role)
{
	struct control_switch *out = switch_of(controls, role);
	controls->contact[role].known = false;
	press_cancel(&controls->press[role]);
	if (out)
		out->known = false;
	if (role == CONTROL_ROTARY_A || role == CONTROL_ROTARY_B)
		controls->knob.known[role == CONTROL_ROTARY_B] = false;
}

static void take_event(struct controls *controls, const struct gpio_event *event)
{
	enum control_line role = (enum control_line)controls->role[event->line];
	if (event->kind == GPIO_STATE) {
		if (event->state != GPIO_GOOD)
			lose(controls, role);
	} else if (role == CONTROL_ROTARY_A || role == CONTROL_ROTARY_B)
		take_knob(controls, role, event);
	else if (!controls->contact[role].known)
		take_first_level(controls, role, event);
	else if (debounce_feed(&controls->contact[role], event->level, event->time_ns))
		take_level(controls, role);
}

static void cancel_keys(struct controls *controls)
{
	for (int i = 0; i < CONTROL_LINE_COUNT; i++)
		press_cancel(&controls->key_press[i]);
}

static void take_key(struct controls *controls, const struct evdev_report *report)
{
	enum control_line role = control_of_key(report->key);
	enum action action = action_of_key(report->key);
	if (role != CONTROL_LINE_COUNT && report->value != 2)
		press(controls, role, press_feed(&controls->key_press[role], report->value != 0, report->time_ns));
	else if (action != ACTION_NONE && report->value != 0)
		add_action(controls, action);
}

static void take_report(struct controls *controls, const struct evdev_report *report)
{
	if (report->kind == EVDEV_TURN)
		turn(controls, report->value);
	else if (report->kind == EVDEV_KEY)
		take_key(controls, report);
	else
		cancel_keys(controls);
}

static void advance_devices(struct controls *controls, int64_t now_ns)
{
	struct evdev_report reports[BATCH];
	int count = BATCH;
	while (count == BATCH) {
		count = evdev_read(controls->devices, reports, BATCH);
		for (int i = 0; i < count; i++)
			take_report(controls, &reports[i]);
	}
	/* what the thread has not handed over yet is younger than this */
	for (int i = 0; i < CONTROL_LINE_COUNT; i++)
		press(controls, (enum control_line)i, press_settle(&controls->key_press[i], now_ns - DEVICE_LAG_NS));
}

static void settle(struct controls *controls, int64_t now_ns)
{
	for (unsigned i = 0; controls->gpio && i < controls->gpio->line_count; i++) {
		enum control_line role = (enum control_line)controls->role[i];
		struct debounce *contact = &controls->contact[role];
		if (!contact->known)
			continue;
		if (debounce_settle(contact, now_ns))
			take_level(controls, role);
		press(controls, role, press_settle(&controls->press[role], debounce_sure_ns(contact, now_ns)));
	}
}

void controls_advance(struct controls *controls, int64_t now_ns)
{
	struct gpio_event events[BATCH];
	int count = BATCH;
	controls->now_ns = now_ns;
	while (controls->gpio && count == BATCH) {
		count = gpio_read(controls->gpio, now_ns, events, BATCH);
		for (int i = 0; i < count; i++)
			take_event(controls, &events[i]);
	}
	settle(controls, now_ns);
	if (controls->devices)
		advance_devices(controls, now_ns);
}

static const char *line_fault(enum control_line role, enum gpio_state state)
{
	bool knob = role >= CONTROL_ROTARY_A;
	switch (state) {
	case GPIO_BUSY:
		return knob                      ? "Controls in use elsewhere"
			   : role == CONTROL_REVERSE ? "Reverse line in use elsewhere"
										 : "Car lines in use elsewhere";
	case GPIO_GONE:
	case GPIO_REFUSED:
		return knob ? "Controls lost" : role == CONTROL_REVERSE ? "Reverse line lost" : "Car lines lost";
	default:
		return NULL;
	}
}

/* Roles are in the order of what their loss costs. */
const char *controls_fault(const struct controls *controls)
{
	for (unsigned i = 0; controls->gpio && i < controls->gpio->line_count; i++) {
		enum control_line role = (enum control_line)controls->role[i];
		const char *words = line_fault(role, controls->gpio->lines[i].state);
		if (!words && debounce_chatters(&controls->contact[role], controls->now_ns))
			words = role == CONTROL_REVERSE ? "Reverse line chatters" : "A control's contact chatters";
		if (words)
			return words;
	}
	switch (controls->devices ? evdev_worst(controls->devices) : EVDEV_GOOD) {
	case EVDEV_BUSY:
		return "Controls in use elsewhere";
	case EVDEV_GONE:
	case EVDEV_REFUSED:
		return "Controls lost";
	default:
		return NULL;
	}
}

void controls_stats(const struct controls *controls, struct control_stats *out)
{
	const struct controls_state *state = &controls->state;
	*out = (struct control_stats){
		.configured = controls->gpio || controls->devices,
		.actions = controls->actions,
		.dropped = controls->actions_dropped,
		.fault = controls_fault(controls),
		.reverse = state->reverse.on,
		.ignition = state->ignition.on,
	};
	if (!controls->gpio)
		return;
	out->edges = controls->gpio->stats.edges;
	out->resyncs = controls->gpio->stats.resyncs;
	out->losses = controls->gpio->stats.losses;
}

/* Also where the profile has no such line: keys of devices are judged by the same lengths. */
static void set_times(struct controls *controls, enum control_line role, const struct profile_line *line)
{
	bool said = line->line > 0;
	int32_t hold_ms = role <= CONTROL_NIGHT ? DEBOUNCE_CAR_MS : DEBOUNCE_MS, long_ms = LONG_MS;
	if (said && line->debounce_ms >= 0)
		hold_ms = line->debounce_ms;
	if (said && line->long_ms >= 0)
		long_ms = line->long_ms;
	struct press *held = &controls->press[role];
	controls->contact[role].hold_ns = hold_ms * NS_PER_MS;
	held->long_ns = long_ms * NS_PER_MS;
	if (role == CONTROL_ZOOM_IN || role == CONTROL_ZOOM_OUT)
		held->repeat_ns = REPEAT_NS;
	controls->key_press[role] = *held;
}

/* The script of "sim:FILE", "" for "sim" alone; NULL for a real chip. */
static const char *sim_script(const struct options *options)
{
	if (!options->gpio || strncmp(options->gpio, "sim", 3) != 0)
		return NULL;
	return options->gpio[3] == ':' ? options->gpio + 4 : options->gpio[3] ? NULL : "";
}

/* A log is replayed without the board's lines, unless they are asked for; never on a simulated clock, which they do not
 * know. */
static const struct gpio_ops *choose_ops(const struct options *options, bool simulated)
{
	if (sim_script(options))
		return &gpio_sim_ops;
	if (simulated || (options->replay && !options->gpio))
		return NULL;
#ifdef BLVD_HAVE_GPIOD
	return &gpio_libgpiod_ops;
#else
	log_warn("this program was built without libgpiod: the profile's lines are not read");
	return NULL;
#endif
}

/* With a script every control is there, whether the profile has a pin for it or not. A car without an ignition line is
 * on, so this one only where the profile has it. */
static bool wanted(const struct profile *profile, int role, bool scripted)
{
	return profile->gpio.lines[role].line > 0 || (scripted && role != CONTROL_IGNITION);
}

static int open_lines(struct controls *controls, const struct options *options, const struct profile *profile,
	bool simulated, struct arena *arena)
{
	struct gpio_line_config lines[GPIO_LINES_MAX];
	const char *names[GPIO_LINES_MAX], *script = sim_script(options);
	unsigned count = 0;
	quadrature_init(&controls->knob, script ? 4 : profile->gpio.rotary_steps);
	for (int role = 0; role < CONTROL_LINE_COUNT; role++) {
		const struct profile_line *line = &profile->gpio.lines[role];
		if (!wanted(profile, role, script != NULL))
			continue;
		lines[count] = line->at;
		if (options->gpio)
			lines[count].chip = options->gpio;
		names[count] = control_line_name((enum control_line)role);
		controls->role[count++] = (uint8_t)role;
	}
	const struct gpio_ops *ops = count ? choose_ops(options, simulated) : NULL;
	if (!ops && options->gpio)
		log_warn("--gpio %s: %s", options->gpio, count ? "not with a simulated clock" : "no lines in the profile");
	if (!ops)
		return 0;
	struct gpio_config config = {
		.consumer = "boulevard",
		.lines = lines,
		.line_count = count,
		.script = script && *script ? script : NULL,
		.names = names,
		.start_ns = controls->now_ns,
	};
	return gpio_open(&controls->gpio, ops, &config, arena);
}

int controls_open(struct controls *controls, const struct options *options, const struct profile *profile,
	bool simulated, int64_t now_ns, struct arena *arena)
{
	const struct profile_gpio *gpio = &profile->gpio;
	*controls = (struct controls){ .knob_swapped = gpio->rotary_swapped, .now_ns = now_ns };
	for (int role = 0; role < CONTROL_LINE_COUNT; role++)
		set_times(controls, (enum control_line)role, &gpio->lines[role]);
	int status = open_lines(controls, options, profile, simulated, arena);
	if (status == 0 && gpio->device_count && !simulated && !options->replay)
		status = evdev_open(&controls->devices, gpio->devices, gpio->device_count, arena);
	return status;
}

void controls_close(struct controls *controls)
{
	gpio_close(controls->gpio);
	evdev_close(controls->devices);
	controls->gpio = NULL;
	controls->devices = NULL;
}
