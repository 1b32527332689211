/*
 * The car's interfaces as they are now, read by a thread of their own: a frame of the picture that takes long loses no
 * frame of the bus, whatever the kernel's buffer is. The thread waits for the first frame, reads all there is, rests
 * for some milliseconds and looks again, so that a full bus costs 250 wake-ups a second and a silent one four; the
 * kernel's time stamps lose nothing by it. When the ring is full the thread stops reading, and the kernel's buffer is
 * the reserve.
 *
 * Kernel interfaces and local sockets may be mixed: each kind is one can_bus behind this one.
 */
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/worker.h"
#include "platform/can/can_bus.h"
#include "platform/can/can_socket.h"

#define RING_FRAMES 8192 /* a second of a full bus of 1 Mbit/s */
#define BATCH 64
#define FDS_MAX 64
#define REST_NS (4 * NS_PER_MS)
#define WAIT_MS 250 /* between two looks at interfaces that say nothing */

enum { KERNEL, SOCKETS, KINDS };

struct part {
	struct can_bus *bus;        /* NULL: no interface of this kind */
	uint8_t outer[CAN_BUS_MAX]; /* this part's interface -> ours */
	bool failed;                /* was told */
};

struct can_live {
	struct can_bus bus; /* first: a can_bus of ours is one of these. Of the reading thread nothing but these copies */
	struct worker thread;
	int wake_fd;
	atomic_bool stop;

	pthread_mutex_t parts_mutex; /* guards the parts; held while reading what is there, never while waiting */
	struct part parts[KINDS];
	uint8_t kind_of[CAN_BUS_MAX], inner[CAN_BUS_MAX]; /* constant */

	pthread_mutex_t ring_mutex; /* guards all below */
	struct can_interface interfaces[CAN_BUS_MAX];
	uint64_t dropped, steps_back;
	int64_t wall_offset_ns, cpu_ns, newest_ns;
	uint32_t first, count;
	struct can_frame_rx ring[RING_FRAMES];
	struct can_frame_rx batch[BATCH]; /* the reading thread's own */
};

static uint32_t room(struct can_live *live)
{
	pthread_mutex_lock(&live->ring_mutex);
	uint32_t free = RING_FRAMES - live->count;
	pthread_mutex_unlock(&live->ring_mutex);
	return free;
}

/* Both parts' frames in the order in which they were read. */
static void put(struct can_live *live, const struct part *part, const struct can_frame_rx *frames, int count)
{
	pthread_mutex_lock(&live->ring_mutex);
	for (int i = 0; i < count; i++) {
		struct can_frame_rx *to = &live->ring[(live->first + live->count++) % RING_FRAMES];
		*to = frames[i];
		to->bus = part->outer[frames[i].bus];
		if (to->time_ns < live->newest_ns)
			to->time_ns = live->newest_ns;
		live->newest_ns = to->time_ns;
	}
	pthread_mutex_unlock(&live->ring_mutex);
}

static void note_failure(struct part *part, int status)
{
	for (unsigned i = 0; i < part->bus->interface_count; i++)
		can_bus_note_health(part->bus, (uint8_t)i, CAN_HEALTH_DOWN, clock_now_ns());
	if (!part->failed)
		log_error("CAN cannot be read: %s", strerror(-status));
	part->failed = true;
}

/* Returns how many frames came. */
static int read_part(struct can_live *live, struct part *part)
{
	uint32_t free = room(live);
	int capacity = free < BATCH ? (int)free : BATCH;
	pthread_mutex_lock(&live->parts_mutex);
	int count = can_bus_read(part->bus, INT64_MAX, live->batch, capacity);
	if (count < 0)
		note_failure(part, count);
	pthread_mutex_unlock(&live->parts_mutex);
	if (count > 0)
		put(live, part, live->batch, count);
	return count > 0 ? count : 0;
}

/* Makes known what the parts say of themselves. */
static void publish(struct can_live *live)
{
	pthread_mutex_lock(&live->parts_mutex);
	pthread_mutex_lock(&live->ring_mutex);
	live->dropped = live->steps_back = 0;
	for (int k = 0; k < KINDS; k++) {
		const struct part *part = &live->parts[k];
		for (unsigned i = 0; part->bus && i < part->bus->interface_count; i++)
			live->interfaces[part->outer[i]] = part->bus->interfaces[i];
		if (!part->bus)
			continue;
		live->dropped += part->bus->stats.dropped;
		live->steps_back += part->bus->stats.steps_back;
		live->wall_offset_ns = part->bus->wall_offset_ns;
	}
	live->cpu_ns = clock_thread_ns();
	pthread_mutex_unlock(&live->ring_mutex);
	pthread_mutex_unlock(&live->parts_mutex);
}

static void wait_for_frames(struct can_live *live)
{
	struct pollfd polled[FDS_MAX + 1] = { { .fd = live->wake_fd, .events = POLLIN } };
	int fds[FDS_MAX];
	unsigned count = 0;
	pthread_mutex_lock(&live->parts_mutex);
	for (int k = 0; k < KINDS; k++)
		if (live->parts[k].bus)
			count += live->parts[k].bus->ops->fds(live->parts[k].bus, fds + count, FDS_MAX - count);
	pthread_mutex_unlock(&live->parts_mutex);
	for (unsigned i = 0; i < count; i++)
		polled[i + 1] = (struct pollfd){ .fd = fds[i], .events = POLLIN };
	poll(polled, room(live) ? count + 1 : 1, WAIT_MS);
}

static void work(void *context, uint32_t job)
{
	struct can_live *live = context;
	(void)job;
	while (!live->stop) {
		int total = 0;
		for (int k = 0; k < KINDS; k++)
			for (int n = BATCH; live->parts[k].bus && n == BATCH && !live->stop; total += n)
				n = read_part(live, &live->parts[k]);
		publish(live);
		if (total)
			clock_sleep_until(clock_now_ns() + REST_NS);
		else
			wait_for_frames(live);
	}
}

static int live_read(struct can_bus *bus, int64_t until_ns, struct can_frame_rx *frames, int capacity)
{
	struct can_live *live = (struct can_live *)bus;
	int count = 0;
	pthread_mutex_lock(&live->ring_mutex);
	for (; count < capacity && live->count && live->ring[live->first].time_ns <= until_ns; count++) {
		frames[count] = live->ring[live->first];
		live->first = (live->first + 1) % RING_FRAMES;
		live->count--;
	}
	memcpy(bus->interfaces, live->interfaces, sizeof(bus->interfaces));
	bus->stats.dropped = live->dropped;
	bus->stats.steps_back = live->steps_back;
	bus->stats.reader_cpu_ns = live->cpu_ns;
	bus->wall_offset_ns = live->wall_offset_ns;
	pthread_mutex_unlock(&live->ring_mutex);
	bus->stats.frames += (uint64_t)count;
	if (count)
		bus->last_ns = frames[count - 1].time_ns;
	return count;
}

static int live_write(struct can_bus *bus, const struct can_frame_rx *frame)
{
	struct can_live *live = (struct can_live *)bus;
	if (frame->bus >= bus->interface_count)
		return -ENODEV;
	struct part *part = &live->parts[live->kind_of[frame->bus]];
	struct can_frame_rx out = *frame;
	out.bus = live->inner[frame->bus];
	pthread_mutex_lock(&live->parts_mutex);
	int status = can_bus_write(part->bus, &out);
	pthread_mutex_unlock(&live->parts_mutex);
	return status;
}

static void close_parts(struct can_live *live)
{
	for (int k = 0; k < KINDS; k++)
		can_bus_close(live->parts[k].bus);
	pthread_mutex_destroy(&live->parts_mutex);
	pthread_mutex_destroy(&live->ring_mutex);
}

static void live_close(struct can_bus *bus)
{
	struct can_live *live = (struct can_live *)bus;
	uint64_t one = 1;
	live->stop = true;
	if (write(live->wake_fd, &one, sizeof(one)) < 0)
		log_debug("the CAN thread ends with its next look"); /* cannot be: the counter is far from full */
	worker_finish(&live->thread);
	close(live->wake_fd);
	close_parts(live);
}

/* The interfaces of one kind, in their order. */
static int open_part(struct can_live *live, int kind, const struct can_bus_config *config, struct arena *arena)
{
	const char *names[CAN_BUS_MAX];
	struct can_bus_config own = *config;
	struct part *part = &live->parts[kind];
	own.interfaces = names;
	own.interface_count = 0;
	for (unsigned i = 0; i < config->interface_count; i++) {
		if (can_socket_is_address(config->interfaces[i]) != (kind == SOCKETS))
			continue;
		live->kind_of[i] = (uint8_t)kind;
		live->inner[i] = (uint8_t)own.interface_count;
		part->outer[own.interface_count] = (uint8_t)i;
		names[own.interface_count++] = config->interfaces[i];
	}
	if (own.interface_count == 0)
		return 0;
	return can_bus_open(&part->bus, kind == SOCKETS ? &can_socket_ops : &can_socketcan_ops, &own, arena);
}

static int add_names(struct can_live *live, const struct can_bus_config *config)
{
	for (unsigned i = 0; i < config->interface_count; i++) {
		char name[CANDUMP_NAME_SIZE];
		can_bus_short_name(config->interfaces[i], name);
		if (can_bus_index_or_add(&live->bus, name) != i) {
			log_error("CAN interface '%s': the same name again, or more than %d", name, CAN_BUS_MAX);
			return -EINVAL;
		}
	}
	return config->interface_count ? 0 : -EINVAL;
}

static int start_thread(struct can_live *live)
{
	int status = worker_init(&live->thread, "can", work, live);
	if (!status)
		worker_give(&live->thread, 0);
	return status;
}

static int open_parts(struct can_live *live, const struct can_bus_config *config, struct arena *arena)
{
	int status = add_names(live, config);
	for (int k = 0; k < KINDS && !status; k++)
		status = open_part(live, k, config, arena);
	return status;
}

static int live_open(const struct can_bus_config *config, struct arena *arena, struct can_bus **out)
{
	size_t mark = arena_mark(arena);
	struct can_live *live = ARENA_ARRAY(arena, struct can_live, 1);
	if (!live)
		return -ENOMEM;
	live->bus.ops = &can_live_ops;
	live->bus.last_ns = live->newest_ns = INT64_MIN;
	pthread_mutex_init(&live->parts_mutex, NULL);
	pthread_mutex_init(&live->ring_mutex, NULL);
	int status = open_parts(live, config, arena);
	if (status)
		goto err_close_parts;
	publish(live);
	memcpy(live->bus.interfaces, live->interfaces, sizeof(live->interfaces));
	live->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (live->wake_fd < 0) {
		status = -errno;
		goto err_close_parts;
	}
	status = start_thread(live);
	if (status)
		goto err_close_wake;
	*out = &live->bus;
	return 0;
err_close_wake:
	close(live->wake_fd);
err_close_parts:
	close_parts(live);
	arena_release(arena, mark);
	return status;
}

const struct can_bus_ops can_live_ops = {
	.name = "live",
	.open = live_open,
	.read = live_read,
	.write = live_write,
	.close = live_close,
};
