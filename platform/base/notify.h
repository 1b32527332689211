/*
 * What a service tells its manager: that it is ready, that it still lives, that it stops. The protocol is systemd's
 * (sd_notify(3)): datagrams to the socket that NOTIFY_SOCKET names. Without that variable everything here does nothing,
 * so a program may call it always. Nothing blocks and nothing is allocated: a manager that does not read is not waited
 * for.
 */
#ifndef BLVD_PLATFORM_BASE_NOTIFY_H
#define BLVD_PLATFORM_BASE_NOTIFY_H

#include <stdbool.h>
#include <stdint.h>

struct notify {
	int fd;          /* -1: nobody listens */
	bool ready;      /* READY=1 was sent */
	int64_t beat_ns; /* between two signs of life; 0: none are asked for */
	int64_t next_ns;
	uint64_t lost; /* datagrams the manager had no room for */
};

/* Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID and removes them from the environment: no child shall speak for
 * us. The time between signs of life is half of WATCHDOG_USEC. Returns 0, also when there is no manager, or -errno: a
 * socket that is named and cannot be used. */
int notify_open(struct notify *notify);

/* Sends READY=1, once, with `status` (one line, NULL: none) for people to read. */
void notify_ready(struct notify *notify, const char *status);

/* Sends WATCHDOG=1 when it is time to; cheap, for every frame. Before notify_ready() it does nothing. */
void notify_alive(struct notify *notify, int64_t now_ns);

/* Sends a line for people to read. */
void notify_status(struct notify *notify, const char *status);

/* Sends STOPPING=1 and closes. Accepts one that was never opened or is zeroed. */
void notify_close(struct notify *notify);

#endif
