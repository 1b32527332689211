/*
 * A live recording of the bus as a candump log. Frames go into a ring; a thread of its own formats and writes them, so
 * that a slow or full disk costs the picture nothing. A recording has a limit: at half of it PATH becomes PATH.1 (what
 * was PATH.1 goes) and PATH begins anew, so that the newest is kept. When the disk is full or fails, the file is cut
 * back to its last whole line and writing is tried again every second; what finds no room meanwhile is lost and
 * counted.
 */
#ifndef BLVD_PLATFORM_CAN_CAN_RECORD_H
#define BLVD_PLATFORM_CAN_CAN_RECORD_H

#include "platform/base/arena.h"
#include "platform/can/candump.h"

struct can_record_config {
	const char *path;     /* borrowed; an older recording there is overwritten */
	uint64_t limit_bytes; /* of PATH and PATH.1 together; 0: none */
	bool wait;            /* for room in the ring, never losing a frame but to the disk: for replays */
};

struct can_record_stats {
	uint64_t lines, bytes; /* written */
	uint64_t lost;         /* frames that were not */
	int error;             /* first -errno of the file; 0 none */
};

struct can_record;

/* Returns 0 or -errno of the file or the thread; -ENOMEM also when the arena is full. Logs nothing. */
int can_record_open(struct can_record **out, const struct can_record_config *config, struct arena *arena);

/* `frame->time_ns` is wall time; `frame->bus` < 16 and always the same for a `name` (copied). Waits only as the
 * configuration says. One thread at a time. */
void can_record_add(struct can_record *record, const char *name, const struct can_frame_rx *frame);

void can_record_stats(struct can_record *record, struct can_record_stats *out);

/* Writes what is left, once, and closes. NULL is fine. Returns 0, or the first -errno when frames were lost by it. */
int can_record_close(struct can_record *record);

#endif
