/*
 * Where CAN frames come from, behind one table of functions: a recorded log (can_replay.c), the kernel
 * (can_socketcan.c), local sockets that stand in for it (can_socket.c), or any of the last two read by a thread of its
 * own (can_live.c). One can_bus stands for all interfaces of the car; a frame's `bus` is an index into its names.
 * Frames come in the order of their times, and times never step back. Memory is taken from the arena when opening;
 * nothing is allocated later. One thread at a time.
 *
 * An interface is named as the kernel names it ("can0") or by the address of a local socket, with or without a short
 * name for it: "unix:/run/car.sock" is bus "car", "body=unix:/run/car.sock" is bus "body", "unix:@car" needs no file.
 * On such a socket a datagram is one struct can_frame (16 bytes) or struct canfd_frame (72 bytes) of linux/can.h, error
 * frames included; what has another size is passed over. Any number of programs up to nine may meet at an address, in
 * any order; each hears what the others write.
 */
#ifndef BLVD_PLATFORM_CAN_CAN_BUS_H
#define BLVD_PLATFORM_CAN_CAN_BUS_H

#include <stddef.h>

#include "platform/base/arena.h"
#include "platform/can/can_frame.h"
#include "platform/can/candump.h"

#define CAN_BUS_MAX 16
#define CAN_BUS_NONE 0xFF

/* What a controller says of itself by error frames, or the kernel of the interface. */
enum can_health {
	CAN_HEALTH_UNKNOWN, /* nothing heard yet */
	CAN_HEALTH_ACTIVE,
	CAN_HEALTH_WARNING,
	CAN_HEALTH_PASSIVE,
	CAN_HEALTH_OFF,  /* bus off: the controller has stopped sending */
	CAN_HEALTH_DOWN, /* the interface is down or gone */
};

struct can_interface {
	char name[CANDUMP_NAME_SIZE];
	enum can_health health;
	int64_t health_ns; /* when it became so, on the frames' clock */
	int64_t heard_ns;  /* last data frame; INT64_MIN never */
	int64_t error_ns;  /* last error frame, if there was one */
	uint64_t frames, error_frames;
};

struct can_bus_stats {
	uint64_t frames;    /* handed out, error and remote frames included */
	uint64_t bad;       /* replay: lines that are no frame */
	uint64_t bad_first; /* replay: number of the first, from 1; 0 none */
	const char *bad_why;
	uint64_t dropped;      /* kernel: lost before we read them; replay: of an interface beyond CAN_BUS_MAX */
	uint64_t steps_back;   /* times that went back: by less than CAN_STEP_NS the frame is set to the last time, by
							  more the log's clock was set and the replay goes on from the last time */
	uint64_t gaps;         /* replay: silences longer than max_gap_ns, shortened to that */
	uint64_t lines;        /* replay */
	int64_t reader_cpu_ns; /* live: CPU time that the reading thread has used */
	bool cut;              /* replay: the compressed log ends in the middle or is damaged there */
};

#define CAN_STEP_NS INT64_C(1000000000)

struct can_bus_filter {
	uint32_t id;
	bool extended;
	uint32_t mask; /* of the identifier's bits that count; 0: all */
};

struct can_bus_config {
	const char *path;   /* replay: the log, plain or gzip */
	int64_t start_ns;   /* replay: time given to the first frame */
	int64_t max_gap_ns; /* replay: longer silences are shortened; 0: 60 s */
	const char *const
		*interfaces; /* kernel: to open, at least one; replay: names that get the first indices, may be none */
	unsigned interface_count;
	const struct can_bus_filter *filters; /* kernel: identifiers wanted; none: all. Replay ignores them */
	unsigned filter_count;
	int receive_bytes; /* kernel: socket buffer; 0: 4 MiB */
};

struct can_bus;

/* All mandatory but write and fds. */
struct can_bus_ops {
	const char *name;
	/* Returns 0 or -errno; logs nothing but warnings. -ENODATA: a log without a single frame. */
	int (*open)(const struct can_bus_config *config, struct arena *arena, struct can_bus **out);
	/* Up to `capacity` frames not later than `until_ns`; returns how many, 0 when there is none now, or -errno for a
	 * fault that will not pass. Never waits. */
	int (*read)(struct can_bus *bus, int64_t until_ns, struct can_frame_rx *frames, int capacity);
	/* Sends `frame` on interface frame->bus. Returns 0 or -errno; -ENOBUFS when the queue is full. NULL: cannot. */
	int (*write)(struct can_bus *bus, const struct can_frame_rx *frame);
	/* File descriptors that become readable when there is something to read, at most `capacity`; returns how many. They
	 * may change with every read. NULL: there are none. */
	unsigned (*fds)(struct can_bus *bus, int *fds, unsigned capacity);
	void (*close)(struct can_bus *bus);
};

struct can_bus {
	const struct can_bus_ops *ops;
	struct can_interface interfaces[CAN_BUS_MAX];
	unsigned interface_count;
	struct can_bus_stats stats;
	int64_t wall_offset_ns; /* add to the newest frame's time for ns since 1970 */
	int64_t last_ns;        /* time of the newest frame handed out */
	bool ended;             /* nothing will come any more */
};

extern const struct can_bus_ops can_replay_ops;
extern const struct can_bus_ops can_socketcan_ops;
extern const struct can_bus_ops can_socket_ops; /* config.interfaces are all addresses */
extern const struct can_bus_ops can_live_ops;

static inline int can_bus_open(
	struct can_bus **out, const struct can_bus_ops *ops, const struct can_bus_config *config, struct arena *arena)
{
	return ops->open(config, arena, out);
}
static inline int can_bus_read(struct can_bus *bus, int64_t until_ns, struct can_frame_rx *frames, int capacity)
{
	return bus->ops->read(bus, until_ns, frames, capacity);
}
int can_bus_write(struct can_bus *bus, const struct can_frame_rx *frame);
void can_bus_close(struct can_bus *bus); /* NULL is fine */

/* Index of a name, CAN_BUS_NONE if there is none. The second adds it at the end while there is room. */
uint8_t can_bus_index(const struct can_bus *bus, const char *name);
uint8_t can_bus_index_or_add(struct can_bus *bus, const char *name);

/* What an interface is called in logs and profiles, at most 15 characters: the kernel's name itself, the short name of
 * an address, or the last part of its path without what follows a dot. */
void can_bus_short_name(const char *spec, char out[CANDUMP_NAME_SIZE]);

/* For implementations: counts the frame and takes an error frame's word for the health of its interface. */
void can_bus_note_frame(struct can_bus *bus, const struct can_frame_rx *frame);
void can_bus_note_health(struct can_bus *bus, uint8_t index, enum can_health health, int64_t time_ns);

/* "active", "bus off"... */
const char *can_health_name(enum can_health health);

#endif
