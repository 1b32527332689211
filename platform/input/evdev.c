/* The thread: opens, waits, reads in batches, hands over through a ring; a full ring drops, and says so by a reset. */
#include "platform/input/evdev.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/ring.h"
#include "platform/base/thread.h"

#define RING_SIZE 1024
#define BATCH 64
#define LOOK_NS (500 * NS_PER_MS)
#define NODES_MAX 64 /* looked through for a name */
#define STACK_BYTES (128u << 10)

struct device {
	const char *name;
	int fd; /* -1: not open */
	enum evdev_state state;
	bool reset_due, state_due; /* found no room in the ring */
	struct evdev_decoder decoder;
};

struct evdev {
	/* the reader's */
	struct evdev_report *reports; /* RING_SIZE */
	struct ring ring;
	enum evdev_state states[EVDEV_MAX];
	unsigned count;
	/* the thread's */
	struct device devices[EVDEV_MAX];
	int64_t look_ns;
	int stop_fd;
	pthread_t thread;
	bool started;
};

static bool hand_over(struct evdev *evdev, const struct evdev_report *report)
{
	int64_t place = ring_free(&evdev->ring);
	if (place < 0)
		return false;
	evdev->reports[place] = *report;
	ring_put(&evdev->ring);
	return true;
}

static void tell(struct evdev *evdev, unsigned index, struct evdev_report report)
{
	struct device *device = &evdev->devices[index];
	report.device = (uint8_t)index;
	if (device->reset_due && report.kind != EVDEV_STATE) {
		struct evdev_report reset = { .time_ns = report.time_ns, .device = report.device, .kind = EVDEV_RESET };
		device->reset_due = !hand_over(evdev, &reset);
	}
	if (hand_over(evdev, &report)) {
		device->state_due = device->state_due && report.kind != EVDEV_STATE;
		return;
	}
	if (report.kind == EVDEV_STATE)
		device->state_due = true;
	else
		device->reset_due = true;
}

static void tell_state(struct evdev *evdev, unsigned index, int64_t now_ns)
{
	tell(evdev, index,
		(struct evdev_report){ .time_ns = now_ns, .kind = EVDEV_STATE, .value = (int32_t)evdev->devices[index].state });
}

static enum evdev_state state_of(int status)
{
	switch (status) {
	case 0:
		return EVDEV_GOOD;
	case -EBUSY:
		return EVDEV_BUSY;
	case -ENOENT:
	case -ENODEV:
	case -ENXIO:
		return EVDEV_GONE;
	default:
		return EVDEV_REFUSED;
	}
}

static void set_state(struct evdev *evdev, unsigned index, int status, int64_t now_ns)
{
	struct device *device = &evdev->devices[index];
	enum evdev_state state = state_of(status);
	if (state == device->state)
		return;
	if (state != EVDEV_GOOD)
		log_warn("input %s: %s; trying again", device->name, strerror(-status));
	else if (device->state != EVDEV_WAITING)
		log_info("input %s: there again", device->name);
	device->state = state;
	tell_state(evdev, index, now_ns);
}

static void lose(struct evdev *evdev, unsigned index, int status, int64_t now_ns)
{
	struct device *device = &evdev->devices[index];
	if (device->fd >= 0)
		close(device->fd);
	device->fd = -1;
	set_state(evdev, index, status, now_ns);
}

static int open_node(const char *path)
{
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	return fd < 0 ? -errno : fd;
}

/* Returns a file descriptor or -errno. */
static int find_device(const char *name)
{
	char path[32], called[80] = "";
	if (strncmp(name, "name:", 5) != 0)
		return open_node(name);
	for (int i = 0; i < NODES_MAX; i++) {
		snprintf(path, sizeof(path), "/dev/input/event%d", i);
		int fd = open_node(path);
		if (fd < 0)
			continue;
		if (ioctl(fd, EVIOCGNAME(sizeof(called)), called) >= 0 && !strcmp(called, name + 5))
			return fd;
		close(fd);
	}
	return -ENODEV;
}

/* Who holds a device alone gets all of its events: a try tells. */
static int set_up_device(int fd)
{
	int clock = CLOCK_MONOTONIC;
	if (ioctl(fd, EVIOCSCLOCKID, &clock) < 0 || ioctl(fd, EVIOCGRAB, 1) < 0)
		return -errno;
	return ioctl(fd, EVIOCGRAB, 0) < 0 ? -errno : 0;
}

static void look_for_wheel(struct device *device)
{
	struct input_absinfo about;
	device->decoder = (struct evdev_decoder){ 0 };
	if (ioctl(device->fd, EVIOCGABS(ABS_X), &about) < 0 && ioctl(device->fd, EVIOCGABS(ABS_WHEEL), &about) < 0)
		return;
	device->decoder.has_wheel = true;
	device->decoder.wheel_at = about.value;
	device->decoder.wheel_turn = about.maximum > about.minimum ? about.maximum - about.minimum + 1 : 0;
}

static void try_device(struct evdev *evdev, unsigned index, int64_t now_ns)
{
	struct device *device = &evdev->devices[index];
	int fd = find_device(device->name), status = fd < 0 ? fd : set_up_device(fd);
	if (fd >= 0 && status < 0)
		close(fd);
	if (status == 0) {
		device->fd = fd;
		look_for_wheel(device);
	}
	set_state(evdev, index, status, now_ns);
}

static void look_round(struct evdev *evdev, int64_t now_ns)
{
	evdev->look_ns = now_ns + LOOK_NS;
	for (unsigned i = 0; i < evdev->count; i++) {
		if (evdev->devices[i].fd < 0)
			try_device(evdev, i, now_ns);
		if (evdev->devices[i].state_due)
			tell_state(evdev, i, now_ns);
	}
}

static void drain(struct evdev *evdev, unsigned index)
{
	struct device *device = &evdev->devices[index];
	struct input_event events[BATCH];
	ssize_t size;
	do {
		size = read(device->fd, events, sizeof(events));
		for (ssize_t i = 0; i < size / (ssize_t)sizeof(*events); i++) {
			struct evdev_report report;
			if (evdev_decode(&device->decoder, &events[i], &report))
				tell(evdev, index, report);
		}
	} while (size == (ssize_t)sizeof(events));
	if (size < 0 && errno != EAGAIN && errno != EINTR)
		lose(evdev, index, -errno, clock_now_ns());
}

static void *run(void *context)
{
	struct evdev *evdev = context;
	struct pollfd fds[EVDEV_MAX + 1];
	for (;;) {
		for (unsigned i = 0; i < evdev->count; i++)
			fds[i] = (struct pollfd){ evdev->devices[i].fd, POLLIN, 0 };
		fds[evdev->count] = (struct pollfd){ evdev->stop_fd, POLLIN, 0 };
		int64_t wait_ns = evdev->look_ns - clock_now_ns();
		poll(fds, evdev->count + 1, wait_ns > 0 ? (int)(wait_ns / NS_PER_MS) + 1 : 0);
		if (fds[evdev->count].revents)
			return NULL;
		for (unsigned i = 0; i < evdev->count; i++)
			if (fds[i].fd >= 0 && fds[i].revents & POLLIN)
				drain(evdev, i);
			else if (fds[i].fd >= 0 && fds[i].revents)
				lose(evdev, i, -ENODEV, clock_now_ns());
		int64_t now_ns = clock_now_ns();
		if (now_ns >= evdev->look_ns)
			look_round(evdev, now_ns);
	}
}

static int set_up(struct evdev *evdev, const char *const *names, unsigned count, struct arena *arena)
{
	evdev->stop_fd = -1;
	evdev->reports = ARENA_ARRAY(arena, struct evdev_report, RING_SIZE);
	evdev->ring.size = RING_SIZE;
	if (!evdev->reports)
		return -ENOMEM;
	evdev->count = count;
	for (unsigned i = 0; i < count; i++)
		evdev->devices[i] = (struct device){ .name = names[i], .fd = -1 };
	evdev->stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (evdev->stop_fd < 0)
		return -errno;
	look_round(evdev, clock_now_ns());
	int status = thread_start(&evdev->thread, "input", STACK_BYTES, run, evdev);
	evdev->started = status == 0;
	return status;
}

int evdev_open(struct evdev **out, const char *const *names, unsigned count, struct arena *arena)
{
	assert(count <= EVDEV_MAX);
	size_t mark = arena_mark(arena);
	struct evdev *evdev = ARENA_ARRAY(arena, struct evdev, 1);
	if (!evdev)
		return -ENOMEM;
	int status = set_up(evdev, names, count, arena);
	if (status < 0) {
		evdev_close(evdev);
		arena_release(arena, mark);
		return status;
	}
	*out = evdev;
	return 0;
}

void evdev_close(struct evdev *evdev)
{
	uint64_t one = 1;
	if (!evdev)
		return;
	if (evdev->started && write(evdev->stop_fd, &one, sizeof(one)) == sizeof(one))
		pthread_join(evdev->thread, NULL);
	evdev->started = false;
	for (unsigned i = 0; i < evdev->count; i++) {
		if (evdev->devices[i].fd >= 0)
			close(evdev->devices[i].fd);
		evdev->devices[i].fd = -1;
	}
	if (evdev->stop_fd >= 0)
		close(evdev->stop_fd);
	evdev->stop_fd = -1;
}

int evdev_read(struct evdev *evdev, struct evdev_report *reports, int capacity)
{
	int count = 0;
	for (int64_t place; count < capacity && (place = ring_get(&evdev->ring)) >= 0; ring_take(&evdev->ring)) {
		const struct evdev_report *report = &evdev->reports[place];
		if (report->kind == EVDEV_STATE)
			evdev->states[report->device] = (enum evdev_state)report->value;
		reports[count++] = *report;
	}
	return count;
}

enum evdev_state evdev_worst(const struct evdev *evdev)
{
	enum evdev_state worst = EVDEV_GOOD;
	for (unsigned i = 0; i < evdev->count; i++)
		if (evdev->states[i] > worst)
			worst = evdev->states[i];
	return worst;
}
