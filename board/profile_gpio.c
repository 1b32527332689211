/* "reverse = gpiochip0:17 active_low pull_up debounce_ms=20" */
#include "board/profile_gpio.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLANKS " \t,"
#define OFFSET_MAX 1023

struct setter {
	struct arena *arena;
	char *error;
	size_t error_size;
	enum profile_gpio_result result;
};

static const char *const names[CONTROL_LINE_COUNT] = { "reverse", "ignition", "night", "rotary_a", "rotary_b", "push",
	"back", "zoom_in", "zoom_out", "view" };

const char *control_line_name(enum control_line line)
{
	return names[line];
}

__attribute__((format(printf, 2, 3))) static bool wrong(struct setter *set, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	vsnprintf(set->error, set->error_size, format, args);
	va_end(args);
	set->result = PROFILE_GPIO_WRONG;
	return false;
}

static const char *keep(struct setter *set, const char *text)
{
	size_t size = strlen(text) + 1;
	char *copy = arena_alloc(set->arena, size, 1);
	if (copy)
		return memcpy(copy, text, size);
	set->result = PROFILE_GPIO_NO_MEMORY;
	return NULL;
}

static bool whole_number(const char *text, long low, long high, long *out)
{
	char *end;
	if (text[0] < '0' || text[0] > '9')
		return false;
	*out = strtol(text, &end, 10);
	return !*end && *out >= low && *out <= high;
}

/* "CHIP:OFFSET"; the chip may have colons of its own. */
static bool set_place(struct setter *set, struct profile_line *line, char *word)
{
	long offset;
	char *colon = strrchr(word, ':');
	if (!colon || colon == word || !whole_number(colon + 1, 0, OFFSET_MAX, &offset))
		return wrong(set, "'%.40s' is not CHIP:LINE with LINE a number up to %d", word, OFFSET_MAX);
	*colon = 0;
	line->at.chip = keep(set, word);
	line->at.offset = (unsigned)offset;
	return line->at.chip != NULL;
}

static bool set_time(struct setter *set, const char *key, const char *text, long high, int32_t *out)
{
	long value;
	if (!whole_number(text, 0, high, &value))
		return wrong(set, "%s is '%.40s', not a whole number from 0 to %ld", key, text, high);
	*out = (int32_t)value;
	return true;
}

static bool set_option(struct setter *set, struct profile_line *line, const char *word)
{
	static const char *const biases[] = { "as_is", "pull_up", "pull_down", "no_pull" };
	for (size_t i = 0; i < sizeof(biases) / sizeof(*biases); i++)
		if (!strcmp(word, biases[i])) {
			line->at.bias = (enum gpio_bias)i;
			return true;
		}
	if (!strcmp(word, "active_low") || !strcmp(word, "active_high")) {
		line->at.active_low = !strcmp(word, "active_low");
		return true;
	}
	if (!strncmp(word, "debounce_ms=", 12))
		return set_time(set, "debounce_ms", word + 12, 1000, &line->debounce_ms);
	if (!strncmp(word, "long_ms=", 8))
		return set_time(set, "long_ms", word + 8, 10000, &line->long_ms);
	return wrong(set,
		"'%.40s' is none of: active_low, active_high, pull_up, pull_down, no_pull, as_is, debounce_ms=N, long_ms=N",
		word);
}

static bool set_line(struct setter *set, struct profile_line *line, char *text, unsigned number)
{
	char *save = NULL, *word = strtok_r(text, BLANKS, &save);
	if (line->line)
		return wrong(set, "the same line again; it was in line %u", line->line);
	if (!word)
		return wrong(set, "CHIP:LINE expected");
	*line = (struct profile_line){ .line = number, .debounce_ms = -1, .long_ms = -1 };
	if (!set_place(set, line, word))
		return false;
	while ((word = strtok_r(NULL, BLANKS, &save)))
		if (!set_option(set, line, word))
			return false;
	return true;
}

static bool set_steps(struct setter *set, struct profile_gpio *out, const char *text)
{
	if (strcmp(text, "1") != 0 && strcmp(text, "2") != 0 && strcmp(text, "4") != 0)
		return wrong(set, "rotary_steps is '%.40s', not one of: 1, 2, 4", text);
	out->rotary_steps = (uint32_t)(text[0] - '0');
	return true;
}

static bool set_swapped(struct setter *set, struct profile_gpio *out, const char *text)
{
	out->rotary_swapped = !strcmp(text, "yes");
	return out->rotary_swapped || !strcmp(text, "no") || wrong(set, "rotary_swapped is '%.40s', not yes or no", text);
}

/* Separated by commas: the names of devices have blanks. */
static bool set_devices(struct setter *set, struct profile_gpio *out, char *text)
{
	char *save = NULL;
	for (char *word = strtok_r(text, ",", &save); word; word = strtok_r(NULL, ",", &save)) {
		word += strspn(word, " \t");
		for (size_t n = strlen(word); n > 0 && strchr(" \t", word[n - 1]); n--)
			word[n - 1] = 0;
		if (word[0] != '/' && strncmp(word, "name:", 5) != 0)
			return wrong(set, "'%.40s' is neither a path nor name:NAME", word);
		if (out->device_count == PROFILE_DEVICES_MAX)
			return wrong(set, "more than %d devices", PROFILE_DEVICES_MAX);
		if (!(out->devices[out->device_count] = keep(set, word)))
			return false;
		out->device_count++;
	}
	return true;
}

enum profile_gpio_result profile_gpio_set(struct profile_gpio *out, const char *section, const char *key, char *value,
	unsigned line, struct arena *arena, char *error, size_t error_size)
{
	struct setter set = { arena, error, error_size, PROFILE_GPIO_DONE };
	if (!strcmp(section, "input")) {
		if (strcmp(key, "devices") != 0)
			return PROFILE_GPIO_UNKNOWN;
		set_devices(&set, out, value);
		return set.result;
	}
	for (int i = 0; i < CONTROL_LINE_COUNT; i++)
		if (!strcmp(key, names[i])) {
			set_line(&set, &out->lines[i], value, line);
			return set.result;
		}
	if (!strcmp(key, "rotary_steps"))
		set_steps(&set, out, value);
	else if (!strcmp(key, "rotary_swapped"))
		set_swapped(&set, out, value);
	else
		return PROFILE_GPIO_UNKNOWN;
	return set.result;
}
