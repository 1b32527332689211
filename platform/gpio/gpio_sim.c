/* A queue of events ordered by time, filled by the script. */
#include "platform/gpio/gpio_sim.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/file_map.h"
#include "platform/base/log.h"

#define LINE_SIZE 160
#define BOUNCE_NS (300 * NS_PER_MS / 1000)
#define TURNS_MAX 100000
#define EVENTS_A_SCRIPT_BYTE 4 /* room for scripts full of short lines; turns take more, up to the queue's end */

struct gpio_sim {
	struct gpio gpio; /* first: a gpio of ours is one of these */
	const char *names[GPIO_LINES_MAX];
	bool first_level[GPIO_LINES_MAX];
	int64_t start_ns;
	bool started;
	struct gpio_event *queue; /* ascending by time from `first` on */
	size_t first, count, capacity;
	bool level[GPIO_LINES_MAX]; /* at the end of the queue */
	uint64_t dropped;
	int pipe; /* -1: none */
	char partial[LINE_SIZE];
	size_t partial_length;
};

static bool push(struct gpio_sim *sim, struct gpio_event event)
{
	if (sim->first > 0 && sim->first + sim->count == sim->capacity) {
		memmove(sim->queue, sim->queue + sim->first, sim->count * sizeof(*sim->queue));
		sim->first = 0;
	}
	if (sim->first + sim->count == sim->capacity) {
		sim->dropped++;
		return false;
	}
	size_t at = sim->first + sim->count++;
	for (; at > sim->first && sim->queue[at - 1].time_ns > event.time_ns; at--)
		sim->queue[at] = sim->queue[at - 1];
	sim->queue[at] = event;
	return true;
}

bool gpio_sim_set(struct gpio *gpio, unsigned line, bool level, int64_t time_ns)
{
	struct gpio_sim *sim = (struct gpio_sim *)gpio;
	assert(line < gpio->line_count);
	sim->level[line] = level;
	if (!sim->started && time_ns == sim->start_ns) {
		sim->first_level[line] = level;
		return true;
	}
	return push(sim, (struct gpio_event){ .time_ns = time_ns, .line = (uint8_t)line, .level = level });
}

static bool say_level(struct gpio_sim *sim, unsigned line, bool level, int64_t time_ns)
{
	struct gpio_event event = { .time_ns = time_ns, .line = (uint8_t)line, .kind = GPIO_LEVEL, .level = level };
	return push(sim, event);
}

bool gpio_sim_state(struct gpio *gpio, unsigned line, enum gpio_state state, int64_t time_ns)
{
	struct gpio_sim *sim = (struct gpio_sim *)gpio;
	assert(line < gpio->line_count);
	struct gpio_event event = { .time_ns = time_ns, .line = (uint8_t)line, .kind = GPIO_STATE };
	event.state = (uint8_t)state;
	return push(sim, event) && (state != GPIO_GOOD || say_level(sim, line, sim->level[line], time_ns));
}

uint64_t gpio_sim_dropped(const struct gpio *gpio)
{
	return ((const struct gpio_sim *)gpio)->dropped;
}

static int line_called(const struct gpio_sim *sim, const char *name)
{
	for (unsigned i = 0; i < sim->gpio.line_count; i++)
		if (sim->names[i] && !strcmp(sim->names[i], name))
			return (int)i;
	return -1;
}

/* a leads b clockwise */
static const char *turn(struct gpio_sim *sim, const char *words, int64_t time_ns)
{
	int a = line_called(sim, "rotary_a"), b = line_called(sim, "rotary_b"), detents;
	double rate = 400.0;
	if (a < 0 || b < 0)
		return "no line rotary_a, or no rotary_b";
	if (sscanf(words, "%d %lf", &detents, &rate) < 1 || abs(detents) > TURNS_MAX || !(rate > 0.0 && rate <= 1e6))
		return "a knob wants detents and, if any, edges a second";
	int leads = detents > 0 ? a : b, follows = detents > 0 ? b : a;
	for (int i = 0; i < abs(detents) * 4; i++) {
		int line = i % 2 == 0 ? leads : follows;
		gpio_sim_set(&sim->gpio, (unsigned)line, !sim->level[line], time_ns + (int64_t)(i * 1e9 / rate));
	}
	return NULL;
}

static const char *act(struct gpio_sim *sim, unsigned line, const char *words, int64_t time_ns)
{
	struct gpio *gpio = &sim->gpio;
	int count;
	if (!strcmp(words, "0") || !strcmp(words, "1"))
		gpio_sim_set(gpio, line, words[0] == '1', time_ns);
	else if (!strcmp(words, "busy"))
		gpio_sim_state(gpio, line, GPIO_BUSY, time_ns);
	else if (!strcmp(words, "gone"))
		gpio_sim_state(gpio, line, GPIO_GONE, time_ns);
	else if (!strcmp(words, "good"))
		gpio_sim_state(gpio, line, GPIO_GOOD, time_ns);
	else if (!strcmp(words, "overrun"))
		say_level(sim, line, sim->level[line], time_ns);
	else if (sscanf(words, "bounce %d", &count) == 1 && count > 0 && count <= TURNS_MAX)
		for (int i = 0; i < count; i++)
			gpio_sim_set(gpio, line, !sim->level[line], time_ns + i * BOUNCE_NS);
	else
		return "not 0, 1, busy, gone, good, overrun or bounce N";
	return NULL;
}

const char *gpio_sim_say(struct gpio *gpio, const char *text, int64_t from_ns)
{
	struct gpio_sim *sim = (struct gpio_sim *)gpio;
	char name[32], words[64];
	double seconds;
	char line[LINE_SIZE];
	snprintf(line, sizeof(line), "%s", text);
	line[strcspn(line, "#\r\n")] = 0;
	if (!line[strspn(line, " \t")])
		return NULL;
	int fields = sscanf(line, "%lf %31s %63[^\n]", &seconds, name, words);
	if (fields != 3 || !(seconds >= 0.0 && seconds < 1e8))
		return "not SECONDS LINE WHAT";
	for (size_t n = strlen(words); n > 0 && strchr(" \t", words[n - 1]); n--)
		words[n - 1] = 0;
	int64_t time_ns = from_ns + (int64_t)(seconds * 1e9);
	if (!strcmp(name, "knob"))
		return turn(sim, words, time_ns);
	int index = line_called(sim, name);
	return index < 0 ? "no line of this name is configured" : act(sim, (unsigned)index, words, time_ns);
}

/* The whole file, in the order of its lines. */
static int read_script(struct gpio_sim *sim, const char *path, struct span text, int64_t start_ns)
{
	unsigned number = 0;
	for (size_t at = 0; at < text.size;) {
		const uint8_t *end = memchr(text.data + at, '\n', text.size - at);
		size_t length = end ? (size_t)(end - text.data) - at : text.size - at;
		char line[LINE_SIZE];
		size_t kept = length < sizeof(line) - 1 ? length : sizeof(line) - 1;
		memcpy(line, text.data + at, kept);
		line[kept] = 0;
		at += length + 1;
		number++;
		const char *wrong = gpio_sim_say(&sim->gpio, line, start_ns);
		if (!wrong)
			continue;
		log_error("%s:%u: %s", path, number, wrong);
		return -EINVAL;
	}
	if (sim->dropped)
		log_warn("%s: %llu events too many for the memory set aside; dropped", path, (unsigned long long)sim->dropped);
	return 0;
}

/* Lines as they come; what is wrong is said and passed over. */
static void read_pipe(struct gpio_sim *sim, int64_t now_ns)
{
	char text[256];
	ssize_t n = read(sim->pipe, text, sizeof(text));
	for (ssize_t i = 0; i < n; i++) {
		if (text[i] != '\n') {
			if (sim->partial_length < LINE_SIZE - 1)
				sim->partial[sim->partial_length++] = text[i];
			continue;
		}
		sim->partial[sim->partial_length] = 0;
		sim->partial_length = 0;
		const char *wrong = gpio_sim_say(&sim->gpio, sim->partial, now_ns);
		if (wrong)
			log_warn("gpio: '%s': %s", sim->partial, wrong);
	}
}

static int make_queue(struct gpio_sim *sim, struct arena *arena, size_t script_bytes)
{
	sim->capacity = GPIO_SIM_QUEUE_MIN + script_bytes * EVENTS_A_SCRIPT_BYTE;
	sim->queue = ARENA_ARRAY(arena, struct gpio_event, sim->capacity);
	return sim->queue ? 0 : -ENOMEM;
}

/* Before all else that happens at the start. */
static void start_lines(struct gpio_sim *sim)
{
	for (unsigned i = 0; i < sim->gpio.line_count; i++) {
		struct gpio_event event = { .time_ns = sim->start_ns - 1, .line = (uint8_t)i, .kind = GPIO_STATE };
		event.state = GPIO_GOOD;
		push(sim, event);
		say_level(sim, i, sim->first_level[i], sim->start_ns - 1);
	}
	sim->started = true;
}

static int take_script(struct gpio_sim *sim, const struct gpio_config *config, struct arena *arena)
{
	struct stat about;
	struct file_map map = { 0 };
	int status;
	if (config->script && stat(config->script, &about) == 0 && S_ISFIFO(about.st_mode)) {
		/* for writing too: it does not end when a writer leaves */
		sim->pipe = open(config->script, O_RDWR | O_NONBLOCK | O_CLOEXEC);
		if (sim->pipe < 0) {
			status = -errno;
			log_error("%s: %s", config->script, strerror(-status));
			return status;
		}
	} else if (config->script && (status = file_map_open(&map, config->script)) < 0) {
		log_error("%s: %s", config->script, strerror(-status));
		return status;
	}
	status = make_queue(sim, arena, map.bytes.size);
	if (!status) {
		status = read_script(sim, config->script, map.bytes, config->start_ns);
		start_lines(sim);
	}
	file_map_close(&map);
	return status;
}

static void sim_close(struct gpio *gpio)
{
	struct gpio_sim *sim = (struct gpio_sim *)gpio;
	if (sim->pipe >= 0)
		close(sim->pipe);
	sim->pipe = -1;
}

static int sim_open(const struct gpio_config *config, struct arena *arena, struct gpio **out)
{
	assert(config->line_count <= GPIO_LINES_MAX);
	size_t mark = arena_mark(arena);
	struct gpio_sim *sim = ARENA_ARRAY(arena, struct gpio_sim, 1);
	if (!sim)
		return -ENOMEM;
	sim->gpio.ops = &gpio_sim_ops;
	sim->gpio.line_count = config->line_count;
	sim->start_ns = config->start_ns;
	for (unsigned i = 0; config->names && i < config->line_count; i++)
		sim->names[i] = config->names[i];
	sim->pipe = -1;
	int status = take_script(sim, config, arena);
	if (status < 0) {
		sim_close(&sim->gpio);
		arena_release(arena, mark);
		return status;
	}
	*out = &sim->gpio;
	return 0;
}

static int sim_read(struct gpio *gpio, int64_t until_ns, struct gpio_event *events, int capacity)
{
	struct gpio_sim *sim = (struct gpio_sim *)gpio;
	int count = 0;
	if (sim->pipe >= 0)
		read_pipe(sim, until_ns);
	while (count < capacity && sim->count > 0 && sim->queue[sim->first].time_ns <= until_ns) {
		events[count++] = sim->queue[sim->first++];
		sim->count--;
	}
	return count;
}

const struct gpio_ops gpio_sim_ops = {
	.name = "sim",
	.open = sim_open,
	.read = sim_read,
	.close = sim_close,
};
