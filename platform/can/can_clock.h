/*
 * The kernel stamps frames with the wall clock, which may be set at any moment, by a year too; here they are brought to
 * the monotonic clock. A stamp was taken between the frame before it and now, so when the clock has just been set it is
 * known which of the two settings it is from. Plain data; asks no clock itself.
 */
#ifndef BLVD_PLATFORM_CAN_CAN_CLOCK_H
#define BLVD_PLATFORM_CAN_CAN_CLOCK_H

#include <stdint.h>

struct can_clock {
	int64_t offset_ns; /* wall - monotonic, now */
	int64_t before_ns; /* the same before the wall clock was set last */
	int64_t floor_ns;  /* no frame is earlier: the last one, or the opening of the socket */
};

/* Both clocks at one moment, before any frame. */
void can_clock_init(struct can_clock *clock, int64_t wall_ns, int64_t now_ns);

/* Both clocks again, right after frames were read. */
void can_clock_set(struct can_clock *clock, int64_t wall_ns, int64_t now_ns);

/* Monotonic time of the next frame of the batch, by its stamp: from that of the frame before it to `now_ns`. */
int64_t can_clock_time(struct can_clock *clock, int64_t stamp_ns, int64_t now_ns);

#endif
