/*
 * What the renderer knows of the drive: one flat snapshot a frame, no pointers out. nav_update() (nav.h) makes it.
 *
 * Frames: positions are the city frame in int64 mm; headings are binary angles (platform/base/geo.h), 0 north,
 * clockwise.
 */
#ifndef BLVD_NAV_NAV_VIEW_H
#define BLVD_NAV_NAV_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#define NAV_ROUTE_AHEAD_MAX 192 /* half-edges of the route handed to the renderer */
#define NAV_TEXT_MAX 64
#define NAV_LIKELY_MAX 16

enum nav_manoeuvre {
	NAV_MANOEUVRE_NONE,
	NAV_MANOEUVRE_STRAIGHT,
	NAV_MANOEUVRE_SLIGHT_LEFT,
	NAV_MANOEUVRE_LEFT,
	NAV_MANOEUVRE_SHARP_LEFT,
	NAV_MANOEUVRE_SLIGHT_RIGHT,
	NAV_MANOEUVRE_RIGHT,
	NAV_MANOEUVRE_SHARP_RIGHT,
	NAV_MANOEUVRE_U_TURN,
	NAV_MANOEUVRE_ROUNDABOUT, /* take exit number `exit` */
	NAV_MANOEUVRE_KEEP_LEFT,
	NAV_MANOEUVRE_KEEP_RIGHT,
	NAV_MANOEUVRE_MERGE,
	NAV_MANOEUVRE_ARRIVE,
};

/* State of one input that the driver can see. */
enum nav_signal_state {
	NAV_SIGNAL_ABSENT,  /* not in the profile */
	NAV_SIGNAL_WAITING, /* in the profile, never seen */
	NAV_SIGNAL_GOOD,
	NAV_SIGNAL_STALE,       /* older than its timeout */
	NAV_SIGNAL_IMPLAUSIBLE, /* out of range, bad counter or checksum, jumps */
};

enum nav_signal {
	NAV_SIGNAL_SPEED,
	NAV_SIGNAL_YAW_RATE,
	NAV_SIGNAL_HEADING,
	NAV_SIGNAL_STEERING,
	NAV_SIGNAL_GEAR,
	NAV_SIGNAL_TURN_LAMP,
	NAV_SIGNAL_AMBIENT,
	NAV_SIGNAL_ODOMETER,
	NAV_SIGNAL_LATITUDE,
	NAV_SIGNAL_LONGITUDE,
	NAV_SIGNAL_COUNT,
};

/* State of the car's buses: that of the one that is worst off. */
enum nav_bus_state {
	NAV_BUS_GOOD,   /* or there is none, or nothing was heard of them yet */
	NAV_BUS_ERRORS, /* the controller sees many errors (error passive) */
	NAV_BUS_OFF,    /* the controller has cut itself off */
	NAV_BUS_DOWN,   /* the interface is down or gone */
};

#define NAV_BUS_NAME_SIZE 16

enum nav_gear { NAV_GEAR_UNKNOWN, NAV_GEAR_PARK, NAV_GEAR_REVERSE, NAV_GEAR_NEUTRAL, NAV_GEAR_DRIVE };
enum nav_turn_lamp { NAV_TURN_LAMP_OFF, NAV_TURN_LAMP_LEFT, NAV_TURN_LAMP_RIGHT, NAV_TURN_LAMP_HAZARD };

/* What is known of the car's place. */
enum nav_place {
	NAV_PLACE_UNKNOWN,
	NAV_PLACE_SURE,
	NAV_PLACE_REMEMBERED, /* from the last run, and nothing has confirmed it yet */
	NAV_PLACE_DRIFTING,   /* reckoned for so long without a street or a fix that it may be wrong by doubt.major_m */
};

/* Where the car may be, one sigma around its shown place. */
struct nav_doubt {
	enum nav_place place;
	int64_t age_ns; /* since the place was last sure; 0 while it is, INT64_MAX never */
	double major_m, minor_m;
	int32_t heading_bam; /* of the longer axis */
};

struct nav_step {
	enum nav_manoeuvre manoeuvre;
	uint8_t exit;                /* roundabout exit, from 1 */
	int32_t angle_bam;           /* turn, clockwise positive */
	double distance_m;           /* from the car */
	uint32_t street;             /* STRS offset of the street after it, 0 none */
	uint32_t from_half, to_half; /* the half-edges on both sides of it */
	int32_t at_mm[3];
};

struct nav_view {
	int64_t time_ns; /* of this snapshot, monotonic or simulated */
	int64_t wall_ns; /* since 1970 UTC; 0 unknown: for the sun and the arrival time */

	/* the car, matched to the street */
	bool located;   /* false: no position known yet; the rest of this group is meaningless */
	bool on_street; /* false: off the graph (car park); position is dead reckoning alone */
	int64_t pos_mm[3];
	int32_t heading_bam;
	double speed_mps;     /* negative when reversing */
	double yaw_rate_rps;  /* clockwise positive */
	double uncertainty_m; /* one sigma along the street */
	struct nav_doubt doubt;
	uint32_t half;   /* half-edge being driven, or PKG_NONE */
	double along_m;  /* from its origin */
	double offset_m; /* lateral, right of its centre line is positive */

	/* street and limit */
	uint32_t street;   /* STRS offset of its name, 0 none */
	int32_t limit_kmh; /* 0 none */
	bool limit_posted;

	/* route: half-edges from where the car is on it (index 0, the half-edge being driven unless off_route) on */
	bool routed;
	bool off_route; /* a new route is being looked for */
	uint32_t route_count;
	uint32_t route[NAV_ROUTE_AHEAD_MAX];
	double route_end_along_m; /* where on the last half-edge the destination is, when the whole rest fits */
	bool route_complete;      /* the last of route[] is the last of the route */
	double remaining_m;
	double remaining_s;
	struct nav_step next, after_next;
	uint32_t reroutes;

	/* stretches of the package's far field that the car is on or may soon be on, the most urgent first (likely.h); none
	 * without a position or a far field */
	uint32_t likely_count;
	uint32_t likely[NAV_LIKELY_MAX];

	/* inputs */
	enum nav_gear gear;
	enum nav_turn_lamp turn_lamp;
	double ambient; /* 0 dark to 1 full daylight; negative: unknown */
	enum nav_signal_state signal[NAV_SIGNAL_COUNT];
	int64_t signal_age_ns[NAV_SIGNAL_COUNT]; /* INT64_MAX: never seen */
	enum nav_bus_state bus;
	char bus_name[NAV_BUS_NAME_SIZE]; /* of the bus in that state; "" with NAV_BUS_GOOD */
	int64_t bus_age_ns;               /* for how long */
};

#endif
