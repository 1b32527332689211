/*
 * Lines of the kernel. A thread of its own takes the events as they come: the kernel keeps 16 a line (version 1 of its
 * interface), which a fast knob fills in a frame or two. It hands them over through a ring in the order of their time
 * stamps; because the lines are read one after the other, an event is held back for SETTLE_NS, in which an older one of
 * another line may still turn up.
 *
 * The thread also asks again for lines that could not be had, and looks twice a second whether the others are still
 * what they were: a chip that goes away wakes nobody in kernels before 6.5, and an edge that was lost leaves no trace
 * but the level.
 */
#ifdef BLVD_HAVE_GPIOD
#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/ring.h"
#include "platform/base/thread.h"
#include "platform/gpio/gpiod_shim.h"

#define RING_SIZE 4096
#define PENDING_MAX 256
#define SETTLE_NS NS_PER_MS
#define LOOK_NS (500 * NS_PER_MS)
#define DOUBT_NS (30 * NS_PER_MS)
#define ROUNDS_MAX 4 /* then the other lines have their turn */
#define FULL_PAUSE_NS (10 * NS_PER_MS)
#define CHIPS_MAX 32 /* looked through for a label */
#define STACK_BYTES (128u << 10)

struct line {
	struct gpio_line_config config;
	const char *name; /* in messages */
	struct gpiod_shim_line held;
	enum gpio_state state;
	bool level;
	bool level_due; /* edges were lost: the level is to be told */
	bool state_due; /* found no room in the ring */
	bool doubted;   /* its level was other than its last edge said */
	uint32_t number;
};

struct gpio_kernel {
	struct gpio gpio; /* first: a gpio of ours is one of these */
	/* the reader's */
	struct gpio_event *events; /* RING_SIZE */
	struct ring ring;
	/* the thread's */
	struct gpiod_shim shim;
	struct line lines[GPIO_LINES_MAX];
	struct gpio_event pending[PENDING_MAX]; /* ascending by time */
	unsigned pending_count;
	int64_t look_ns; /* next time */
	int stop_fd;
	pthread_t thread;
	bool started;
};

static bool hand_over(struct gpio_kernel *kernel, const struct gpio_event *event)
{
	int64_t place = ring_free(&kernel->ring);
	if (place < 0)
		return false;
	kernel->events[place] = *event;
	ring_put(&kernel->ring);
	return true;
}

/* What finds no room is dropped; the line's level or state is told when there is some again. */
static void release(struct gpio_kernel *kernel, const struct gpio_event *event)
{
	struct line *line = &kernel->lines[event->line];
	struct gpio_event out = *event;
	if (out.kind == GPIO_EDGE && line->level_due)
		out.kind = GPIO_LEVEL;
	bool there = hand_over(kernel, &out);
	if (out.kind == GPIO_STATE)
		line->state_due = !there;
	else
		line->level_due = !there;
}

static void release_until(struct gpio_kernel *kernel, int64_t time_ns)
{
	unsigned count = 0;
	while (count < kernel->pending_count && kernel->pending[count].time_ns <= time_ns)
		release(kernel, &kernel->pending[count++]);
	kernel->pending_count -= count;
	memmove(kernel->pending, kernel->pending + count, kernel->pending_count * sizeof(*kernel->pending));
}

static void hold_back(struct gpio_kernel *kernel, struct gpio_event event)
{
	if (kernel->pending_count == PENDING_MAX)
		release_until(kernel, kernel->pending[PENDING_MAX / 2].time_ns);
	unsigned at = kernel->pending_count++;
	for (; at > 0 && kernel->pending[at - 1].time_ns > event.time_ns; at--)
		kernel->pending[at] = kernel->pending[at - 1];
	kernel->pending[at] = event;
}

static void tell_level(struct gpio_kernel *kernel, unsigned index, bool level, int64_t now_ns)
{
	kernel->lines[index].level = level;
	hold_back(
		kernel, (struct gpio_event){ .time_ns = now_ns, .line = (uint8_t)index, .kind = GPIO_LEVEL, .level = level });
}

static enum gpio_state state_of(int status)
{
	switch (status) {
	case 0:
		return GPIO_GOOD;
	case -EBUSY:
		return GPIO_BUSY;
	case -ENOENT:
	case -ENODEV:
	case -ENXIO:
		return GPIO_GONE;
	default:
		return GPIO_REFUSED;
	}
}

static void set_state(struct gpio_kernel *kernel, unsigned index, int status, int64_t now_ns)
{
	struct line *line = &kernel->lines[index];
	enum gpio_state state = state_of(status);
	if (state == line->state)
		return;
	if (state != GPIO_GOOD)
		log_warn("gpio %s (%s line %u): %s: %s; trying again", line->name, line->config.chip, line->config.offset,
			gpio_state_name(state), strerror(-status));
	else if (line->state != GPIO_WAITING)
		log_info("gpio %s (%s line %u): there again", line->name, line->config.chip, line->config.offset);
	line->state = state;
	struct gpio_event event = { .time_ns = now_ns, .line = (uint8_t)index, .kind = GPIO_STATE };
	event.state = (uint8_t)state;
	hold_back(kernel, event);
}

static void lose(struct gpio_kernel *kernel, unsigned index, int status, int64_t now_ns)
{
	gpiod_shim_release(&kernel->lines[index].held); /* at once: the chip's number is free when nobody holds it */
	set_state(kernel, index, status, now_ns);
}

/* A path, a name in /dev, or the label of a chip. */
static int find_chip(const char *chip, char *path, size_t size)
{
	char label[64];
	int n = snprintf(path, size, "%s%s", chip[0] == '/' ? "" : "/dev/", chip);
	if (n > 0 && (size_t)n < size && (chip[0] == '/' || access(path, F_OK) == 0))
		return 0;
	for (int i = 0; i < CHIPS_MAX; i++) {
		snprintf(path, size, "/dev/gpiochip%d", i);
		if (access(path, F_OK) == 0 && gpiod_shim_label(path, label, sizeof(label)) == 0 && !strcmp(label, chip))
			return 0;
	}
	return -ENODEV;
}

static void ask_for(struct gpio_kernel *kernel, unsigned index, int64_t now_ns)
{
	struct line *line = &kernel->lines[index];
	char path[128];
	int status = find_chip(line->config.chip, path, sizeof(path));
	if (status == 0)
		status = gpiod_shim_request(&kernel->shim, path, &line->config, &line->held);
	int level = status == 0 ? gpiod_shim_level(&line->held) : status;
	if (level < 0) {
		lose(kernel, index, level, now_ns);
		return;
	}
	line->number = 0;
	set_state(kernel, index, 0, now_ns);
	tell_level(kernel, index, level > 0, now_ns);
}

/* An edge that did not arrive leaves the level other than the last one that did; so does one that is still on its way,
 * hence the second look. */
static void compare_level(struct gpio_kernel *kernel, unsigned index, int64_t now_ns)
{
	struct line *line = &kernel->lines[index];
	int level = gpiod_shim_level(&line->held);
	bool differs = level != line->level;
	if (level < 0)
		lose(kernel, index, level, now_ns);
	else if (line->level_due || (differs && line->doubted))
		tell_level(kernel, index, level > 0, now_ns);
	else if (differs && kernel->look_ns > now_ns + DOUBT_NS)
		kernel->look_ns = now_ns + DOUBT_NS;
	line->doubted = differs && !line->doubted;
}

/* Kernels before 5.7 stamp with the wall clock. */
static int64_t monotonic(int64_t time_ns)
{
	int64_t now_ns = clock_now_ns();
	return time_ns > now_ns + NS_PER_S ? time_ns - (clock_wall_ns() - now_ns) : time_ns;
}

/* Takes all that a line has. Two edges to the same level are a bounce too short for the kernel; a gap in the numbers or
 * a full batch is an overrun. */
static void drain(struct gpio_kernel *kernel, unsigned index)
{
	struct line *line = &kernel->lines[index];
	struct gpiod_shim_event events[GPIOD_SHIM_BATCH];
	int count, rounds = 0;
	do {
		count = gpiod_shim_read(&kernel->shim, &line->held, events);
		for (int i = 0; i < count; i++) {
			bool gap = events[i].number && events[i].number != line->number + 1;
			struct gpio_event event = { .time_ns = monotonic(events[i].time_ns), .line = (uint8_t)index };
			event.kind = gap ? GPIO_LEVEL : GPIO_EDGE;
			event.level = line->level = events[i].level;
			line->number = events[i].number;
			line->doubted = false;
			hold_back(kernel, event);
		}
	} while (count == GPIOD_SHIM_BATCH && ++rounds < ROUNDS_MAX);
	if (count < 0)
		lose(kernel, index, count, clock_now_ns());
	else if (rounds && kernel->look_ns > clock_now_ns() + DOUBT_NS)
		kernel->look_ns = clock_now_ns() + DOUBT_NS;
}

/* Twice a second: what is missing, what has changed unseen, what could not be told. */
static void look_round(struct gpio_kernel *kernel, int64_t now_ns)
{
	kernel->look_ns = now_ns + LOOK_NS;
	for (unsigned i = 0; i < kernel->gpio.line_count; i++) {
		struct line *line = &kernel->lines[i];
		if (!line->held.request)
			ask_for(kernel, i, now_ns);
		else
			compare_level(kernel, i, now_ns);
		if (line->state_due) {
			struct gpio_event event = { .time_ns = now_ns, .line = (uint8_t)i, .kind = GPIO_STATE };
			event.state = (uint8_t)line->state;
			hold_back(kernel, event);
		}
	}
}

static int wait_ms(const struct gpio_kernel *kernel)
{
	int64_t wait_ns = kernel->look_ns - clock_now_ns();
	if (kernel->pending_count && wait_ns > SETTLE_NS)
		wait_ns = SETTLE_NS;
	return wait_ns > 0 ? (int)((wait_ns + NS_PER_MS - 1) / NS_PER_MS) : 0;
}

static void take_ready(struct gpio_kernel *kernel, const struct pollfd *fds)
{
	for (unsigned i = 0; i < kernel->gpio.line_count; i++) {
		if (fds[i].fd < 0 || !fds[i].revents)
			continue;
		if (fds[i].revents & (POLLERR | POLLHUP | POLLNVAL))
			lose(kernel, i, -ENODEV, clock_now_ns());
		else
			drain(kernel, i);
	}
}

static void *run(void *context)
{
	struct gpio_kernel *kernel = context;
	struct pollfd fds[GPIO_LINES_MAX + 1];
	const unsigned count = kernel->gpio.line_count;
	for (;;) {
		for (unsigned i = 0; i < count; i++) {
			const struct line *line = &kernel->lines[i];
			fds[i] = (struct pollfd){ line->held.request ? gpiod_shim_fd(&line->held) : -1, POLLIN, 0 };
		}
		fds[count] = (struct pollfd){ kernel->stop_fd, POLLIN, 0 };
		if (poll(fds, count + 1, wait_ms(kernel)) > 0) {
			if (fds[count].revents)
				return NULL;
			take_ready(kernel, fds);
		}
		int64_t now_ns = clock_now_ns();
		if (now_ns >= kernel->look_ns)
			look_round(kernel, now_ns);
		release_until(kernel, now_ns - SETTLE_NS);
		if (ring_free(&kernel->ring) < 0) /* a contact gone mad, or a picture that stands: no need to keep up */
			clock_sleep_until(now_ns + FULL_PAUSE_NS);
	}
}

static void kernel_close(struct gpio *gpio)
{
	struct gpio_kernel *kernel = (struct gpio_kernel *)gpio;
	uint64_t one = 1;
	if (kernel->started && write(kernel->stop_fd, &one, sizeof(one)) == sizeof(one))
		pthread_join(kernel->thread, NULL);
	kernel->started = false;
	for (unsigned i = 0; i < gpio->line_count; i++)
		gpiod_shim_release(&kernel->lines[i].held);
	gpiod_shim_finish(&kernel->shim);
	if (kernel->stop_fd >= 0)
		close(kernel->stop_fd);
	kernel->stop_fd = -1;
}

static int set_up(struct gpio_kernel *kernel, const struct gpio_config *config, struct arena *arena)
{
	kernel->events = ARENA_ARRAY(arena, struct gpio_event, RING_SIZE);
	kernel->ring.size = RING_SIZE;
	if (!kernel->events)
		return -ENOMEM;
	kernel->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (kernel->stop_fd < 0)
		return -errno;
	int status = gpiod_shim_init(&kernel->shim, config->consumer);
	if (status < 0)
		return status;
	for (unsigned i = 0; i < config->line_count; i++) {
		kernel->lines[i].config = config->lines[i];
		kernel->lines[i].name = config->names && config->names[i] ? config->names[i] : "line";
	}
	/* what can be had now is there before the first picture */
	int64_t now_ns = clock_now_ns();
	look_round(kernel, now_ns);
	release_until(kernel, INT64_MAX);
	log_debug("gpio by %s", gpiod_shim_name());
	status = thread_start(&kernel->thread, "gpio", STACK_BYTES, run, kernel);
	kernel->started = status == 0;
	return status;
}

static int kernel_open(const struct gpio_config *config, struct arena *arena, struct gpio **out)
{
	assert(config->line_count <= GPIO_LINES_MAX);
	size_t mark = arena_mark(arena);
	struct gpio_kernel *kernel = ARENA_ARRAY(arena, struct gpio_kernel, 1);
	if (!kernel)
		return -ENOMEM;
	kernel->gpio.ops = &gpio_libgpiod_ops;
	kernel->gpio.line_count = config->line_count;
	kernel->stop_fd = -1;
	int status = set_up(kernel, config, arena);
	if (status < 0) {
		kernel_close(&kernel->gpio);
		arena_release(arena, mark);
		return status;
	}
	*out = &kernel->gpio;
	return 0;
}

static int kernel_read(struct gpio *gpio, int64_t until_ns, struct gpio_event *events, int capacity)
{
	struct gpio_kernel *kernel = (struct gpio_kernel *)gpio;
	int count = 0;
	for (int64_t place; count < capacity && (place = ring_get(&kernel->ring)) >= 0;) {
		if (kernel->events[place].time_ns > until_ns)
			break;
		events[count++] = kernel->events[place];
		ring_take(&kernel->ring);
	}
	return count;
}

const struct gpio_ops gpio_libgpiod_ops = {
	.name = "libgpiod",
	.open = kernel_open,
	.read = kernel_read,
	.close = kernel_close,
};
#endif
