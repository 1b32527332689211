/* Commands in words. The keys are short for them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "tools/sim/sim.h"

#define FASTER_MPS (5.0 / 3.6)
#define STEERING_RATIO 15.0
#define DEG (180.0 / BLVD_PI)

const char *const sim_help =
	"gear P|R|N|D, faster, slower, stop, left, right, speed KM/H, steer DEGREES, lamp off|left|right|hazard,\n"
	"ignition on|off, light PERCENT|auto, factor F, line NAME 0|1, KIND[:TARGET][/SECONDS], clear [KIND|TARGET], quit\n"
	"faults: lost stuck noisy range counter checksum (of speed yaw_rate steering gear turn_lamp ambient odometer gnss\n"
	"wheels ignition destination all, MESSAGE or MESSAGE.SIGNAL), busoff/S, clock:S, camera:WORD/S, chatter:LINE/S\n";

static const char *say_gear(struct sim *sim, const char *word)
{
	static const char letters[] = "PRND";
	static const enum nav_gear gears[] = { NAV_GEAR_PARK, NAV_GEAR_REVERSE, NAV_GEAR_NEUTRAL, NAV_GEAR_DRIVE };
	const char *at = word && word[0] && !word[1] ? strchr(letters, word[0] & ~32) : NULL;
	if (!at)
		return "gear P, R, N or D";
	sim_take_wheel(sim);
	hand_gear(&sim->hand, gears[at - letters]);
	return NULL;
}

static const char *say_lamp(struct sim *sim, const char *word)
{
	static const struct {
		const char *name;
		int lamp;
	} lamps[] = { { "off", 0 }, { "left", -1 }, { "right", 1 }, { "hazard", 2 } };
	for (size_t i = 0; word && i < sizeof(lamps) / sizeof(lamps[0]); i++) {
		if (strcasecmp(word, lamps[i].name) != 0)
			continue;
		sim_take_wheel(sim);
		sim->hand.lamp = sim->hand.lamp == lamps[i].lamp ? 0 : lamps[i].lamp;
		return NULL;
	}
	return "lamp off, left, right or hazard";
}

static bool number(const char *word, double low, double high, double *out)
{
	char *end;
	if (!word)
		return false;
	*out = strtod(word, &end);
	return end != word && !*end && *out >= low && *out <= high;
}

static const char *say_ignition(struct sim *sim, const struct sim_world *world, const char *word)
{
	bool on = word ? !strcasecmp(word, "on") : !sim->ignition;
	if (word && !on && strcasecmp(word, "off") != 0)
		return "ignition on or off";
	sim_set_ignition(sim, on);
	if (world && world->line)
		world->line(world->context, "ignition", on);
	return NULL;
}

static const char *say_light(struct sim *sim, const char *word)
{
	double percent;
	if (word && !strcasecmp(word, "auto"))
		sim->light = -1.0;
	else if (number(word, 0.0, 100.0, &percent))
		sim->light = percent * 0.01;
	else
		return "light 0 to 100, or auto";
	return NULL;
}

static const char *say_line(const struct sim_world *world, const char *name, const char *level)
{
	if (!name || !level || (strcmp(level, "0") != 0 && strcmp(level, "1") != 0))
		return "line NAME 0 or 1";
	if (!world || !world->line)
		return "there is no board to simulate: --gpio";
	world->line(world->context, name, level[0] == '1');
	return NULL;
}

/* Along a route the pedals change how fast it is driven. */
static void pedal(struct sim *sim, double by)
{
	if (sim->by_hand)
		hand_faster(&sim->hand, by * FASTER_MPS);
	else
		sim->factor = fmin(fmax(sim->factor + 0.1 * by, 0.0), 3.0);
}

static const char *say_motion(struct sim *sim, const char *verb, const char *word)
{
	double value;
	if (!strcmp(verb, "faster") || !strcmp(verb, "slower")) {
		pedal(sim, verb[0] == 'f' ? 1.0 : -1.0);
		return NULL;
	}
	if (!strcmp(verb, "factor")) {
		if (!number(word, 0.0, 3.0, &value))
			return "factor 0 to 3";
		sim->factor = value;
		return NULL;
	}
	sim_take_wheel(sim);
	if (!strcmp(verb, "stop")) {
		hand_faster(&sim->hand, -1e3);
	} else if (!strcmp(verb, "left") || !strcmp(verb, "right")) {
		hand_push(&sim->hand, verb[0] == 'l' ? -1.0 : 1.0);
	} else if (!strcmp(verb, "speed")) {
		if (!number(word, 0.0, 250.0, &value))
			return "speed 0 to 250 km/h";
		hand_faster(&sim->hand, value / 3.6 - sim->hand.wanted_mps);
	} else {
		if (!number(word, -500.0, 500.0, &value))
			return "steer -500 to 500 degrees at the steering wheel, clockwise positive";
		hand_hold(&sim->hand, value / (STEERING_RATIO * DEG));
	}
	return NULL;
}

static bool is_one_of(const char *word, const char *const *words)
{
	for (; *words; words++)
		if (!strcmp(word, *words))
			return true;
	return false;
}

const char *sim_say(struct sim *sim, const struct sim_world *world, const char *text)
{
	static const char *const motions[] = { "faster", "slower", "stop", "left", "right", "speed", "steer", "factor",
		NULL };
	char copy[160], *save = NULL;
	if (snprintf(copy, sizeof(copy), "%s", text) >= (int)sizeof(copy))
		return "too long";
	const char *verb = strtok_r(copy, " \t\r\n", &save);
	const char *word = strtok_r(NULL, " \t\r\n", &save), *second = strtok_r(NULL, " \t\r\n", &save);
	if (!verb || verb[0] == '#')
		return NULL;
	if (is_one_of(verb, motions))
		return say_motion(sim, verb, word);
	if (!strcmp(verb, "gear"))
		return say_gear(sim, word);
	if (!strcmp(verb, "lamp"))
		return say_lamp(sim, word);
	if (!strcmp(verb, "ignition"))
		return say_ignition(sim, world, word);
	if (!strcmp(verb, "light"))
		return say_light(sim, word);
	if (!strcmp(verb, "line"))
		return say_line(world, word, second);
	if (!strcmp(verb, "clear")) {
		faults_clear(&sim->faults, word, sim->time_s);
		return NULL;
	}
	if (!strcmp(verb, "quit")) {
		sim->quit = true;
		return NULL;
	}
	char fault[160];
	snprintf(fault, sizeof(fault), "%s%s%s%s%s", verb, word ? " " : "", word ? word : "", second ? " " : "",
		second ? second : "");
	return faults_add(&sim->faults, fault, sim->time_s);
}
