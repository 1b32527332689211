/*
 * A satellite receiver beside the bus: gpsd over TCP (gnss_gpsd.c), or a recorded log of what gpsd said (gnss_log.c).
 * A receiver that is not there, goes away or says nothing is a state; it is tried again until gnss_close(). No call
 * waits, but for the name of a host, which is looked up once at the start.
 */
#ifndef BLVD_PLATFORM_GNSS_GNSS_H
#define BLVD_PLATFORM_GNSS_GNSS_H

#include "platform/base/arena.h"
#include "platform/gnss/fix.h"

enum gnss_state {
	GNSS_AWAY,    /* nobody answers */
	GNSS_WAITING, /* connected, no fix yet */
	GNSS_NO_FIX,  /* the receiver says that it has none */
	GNSS_GOOD,
	GNSS_ENDED, /* a log's end */
};

struct gnss_config {
	const char *source;     /* gpsd: "HOST:PORT", "[::1]:2947", "HOST", or "" for localhost:2947. Log: a file */
	int64_t wall_offset_ns; /* log: UTC less the reader's clock; 0: the first line is at the first read */
};

struct gnss_stats {
	uint64_t lines, fixes, bad; /* bad: too long, or no JSON of gpsd's */
	uint32_t connections;
};

struct gnss;

/* All mandatory. */
struct gnss_ops {
	const char *name;
	/* Returns 0 or -errno: a missing daemon is no error, a missing log or an unknown host is (logged). */
	int (*open)(const struct gnss_config *config, struct arena *arena, struct gnss **out);
	/* The newest fix that came until `now_ns`; false when none did since the last call. */
	bool (*read)(struct gnss *gnss, int64_t now_ns, struct gnss_fix *out);
	void (*close)(struct gnss *gnss);
};

struct gnss {
	const struct gnss_ops *ops;
	enum gnss_state state;
	struct gnss_stats stats;
};

extern const struct gnss_ops gnss_gpsd_ops;
extern const struct gnss_ops gnss_log_ops;

/* By what it is called: "gpsd", "gpsd:HOST:PORT", or a file. Returns 0 or -errno, logged. */
int gnss_open(struct gnss **out, const char *spec, int64_t wall_offset_ns, struct arena *arena);
bool gnss_read(struct gnss *gnss, int64_t now_ns, struct gnss_fix *out); /* NULL is fine */
void gnss_close(struct gnss *gnss);                                      /* NULL is fine */

#endif
