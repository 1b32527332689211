/*
 * CAN frames -> the state of the car, every input with its age. Signals are bound to inputs by the profile
 * (board/profile.h); here they are already definitions and numbers. A sample that is out of range, not a number, a
 * jump, or of a frame with a repeated or skipped counter, a wrong checksum or a cleared valid bit is not taken; what
 * was known before it ages until it is stale. Nothing is allocated, no clock is read: time comes with the frames and
 * the question.
 *
 * Frames: rates and angles clockwise positive (seen from above), as in nav.h; the bindings' scales bring a car that
 * counts to the left over.
 */
#ifndef BLVD_NAV_VEHICLE_H
#define BLVD_NAV_VEHICLE_H

#include "nav/nav.h"
#include "platform/can/checksum.h"
#include "platform/can/dbc.h"

/* Inputs: those that the driver can see (enum nav_signal), then some that only help them. */
enum vehicle_input {
	VEHICLE_SPEED = NAV_SIGNAL_SPEED,         /* m/s; without sign where the gear tells it */
	VEHICLE_YAW_RATE = NAV_SIGNAL_YAW_RATE,   /* rad/s */
	VEHICLE_HEADING = NAV_SIGNAL_HEADING,     /* rad from north */
	VEHICLE_STEERING = NAV_SIGNAL_STEERING,   /* rad at the steering wheel, or at the road wheels with ratio 1 */
	VEHICLE_GEAR = NAV_SIGNAL_GEAR,           /* enum nav_gear */
	VEHICLE_TURN_LAMP = NAV_SIGNAL_TURN_LAMP, /* enum nav_turn_lamp */
	VEHICLE_AMBIENT = NAV_SIGNAL_AMBIENT,     /* 0 dark to 1 daylight */
	VEHICLE_ODOMETER = NAV_SIGNAL_ODOMETER,   /* m */
	VEHICLE_LATITUDE = NAV_SIGNAL_LATITUDE,   /* deg */
	VEHICLE_LONGITUDE = NAV_SIGNAL_LONGITUDE, /* deg */
	VEHICLE_TURN_LEFT = NAV_SIGNAL_COUNT,     /* not 0: left lamp on; for cars with a signal a side */
	VEHICLE_TURN_RIGHT,
	VEHICLE_WHEEL_FRONT_LEFT, /* m/s */
	VEHICLE_WHEEL_FRONT_RIGHT,
	VEHICLE_WHEEL_REAR_LEFT,
	VEHICLE_WHEEL_REAR_RIGHT,
	VEHICLE_IGNITION, /* enum vehicle_ignition */
	VEHICLE_INPUT_COUNT,
};

enum vehicle_ignition { VEHICLE_IGNITION_UNKNOWN, VEHICLE_IGNITION_OFF, VEHICLE_IGNITION_ON };

#define VEHICLE_MAP_MAX 16
#define VEHICLE_ANY_BUS (-1)

struct vehicle_map {
	int64_t raw;
	uint8_t meaning; /* enum nav_gear, nav_turn_lamp or vehicle_ignition */
};

/* Why a sample was not taken. */
enum vehicle_fault {
	VEHICLE_FAULT_NONE,
	VEHICLE_FAULT_NOT_A_NUMBER,
	VEHICLE_FAULT_RANGE,
	VEHICLE_FAULT_JUMP,     /* faster than max_rate; believed when the next sample agrees with it */
	VEHICLE_FAULT_REPEATED, /* the counter did not move */
	VEHICLE_FAULT_COUNTER,  /* the counter skipped more than counter_skip */
	VEHICLE_FAULT_CHECKSUM,
	VEHICLE_FAULT_INVALID, /* the sender says so */
	VEHICLE_FAULT_UNKNOWN, /* a raw value that the map does not have */
	VEHICLE_FAULT_FROZEN,  /* the same raw value for longer than frozen_ns */
	VEHICLE_FAULT_COUNT,
};

struct vehicle_binding {
	const struct dbc_signal *signal; /* NULL: not in the profile */
	int bus;                         /* index, or VEHICLE_ANY_BUS */
	double scale, offset;            /* input = decoded * scale + offset, in the input's unit */
	double min, max;                 /* plausible, in the input's unit */
	double max_rate;                 /* largest change a second, input's unit; 0: not looked at */
	double quantum;                  /* one raw step in the input's unit: always allowed */
	int64_t spacing_ns; /* between two samples where they were sent: time stamps of delayed ones are closer */
	int64_t timeout_ns; /* older is stale; > 0 */
	int64_t frozen_ns;  /* 0: may stay the same for ever */
	bool wraps;         /* a full turn (in the input's unit: `turn`) is the same */
	double turn;
	const struct dbc_signal *counter; /* in the same message; NULL none. Counts up by one modulo its length in bits */
	unsigned counter_skip;            /* lost frames that are no fault */
	const struct dbc_signal *checksum;
	enum can_checksum checksum_kind;
	const struct dbc_signal *valid; /* in the same message: raw 0 means not valid; NULL none */
	unsigned map_count;             /* > 0: the raw value is looked up instead of scaled */
	struct vehicle_map map[VEHICLE_MAP_MAX];
};

struct vehicle_config {
	struct vehicle_binding inputs[VEHICLE_INPUT_COUNT];
	double wheelbase_m;         /* > 0 with steering_ratio: yaw rate from the steering angle where there is no sensor */
	double steering_ratio;      /* steering wheel angle / road wheel angle */
	double understeer_s2pm2;    /* K in yaw rate = v tan(angle) / (wheelbase (1 + K v^2)); 0 neutral */
	double track_m;             /* > 0: yaw rate from the rear wheels where there is neither */
	bool speed_signed;          /* the speed signal itself is negative when reversing */
	double steering_centre_rad; /* reading when going straight */
};

/* Internal; public so that the caller provides the memory. */
struct vehicle_track {
	double value;       /* last taken */
	double candidate;   /* last refused as a jump */
	int64_t good_ns;    /* time of `value`; INT64_MIN never */
	int64_t seen_ns;    /* time of the last sample, taken or not; INT64_MIN never */
	int64_t changed_ns; /* when the raw value last changed */
	int64_t raw;
	uint64_t count; /* last counter */
	bool counting;  /* `count` is known */
	bool has_candidate;
	enum vehicle_fault fault; /* of the last sample */
	uint32_t taken;           /* samples, wraps */
	uint32_t faults[VEHICLE_FAULT_COUNT];
};

struct vehicle {
	const struct vehicle_config *config; /* borrowed, outlives this */
	struct vehicle_track inputs[VEHICLE_INPUT_COUNT];
	uint64_t frames_in;     /* all that were fed */
	uint64_t frames_used;   /* with at least one bound signal */
	uint64_t frames_bad;    /* of those, with at least one sample that was not taken */
	int64_t stale_ns_max;   /* oldest age seen by vehicle_sample of an input that had been good once */
	uint32_t latitude_used; /* `taken` of both at the last fix */
	uint32_t longitude_used;
	double fix_lat_deg, fix_lon_deg;
	int64_t fix_ns;
	uint32_t fixes;
};

enum vehicle_yaw_source { VEHICLE_YAW_NONE, VEHICLE_YAW_SENSOR, VEHICLE_YAW_STEERING, VEHICLE_YAW_WHEELS };

/* What is known of the car at one time. A value that is not `usable` is the last good one, or 0 if there never was. */
struct vehicle_state {
	int64_t time_ns;
	bool speed_usable;
	double speed_mps;     /* negative when reversing */
	int64_t speed_age_ns; /* of the signal it came from */
	enum vehicle_yaw_source yaw_source;
	double yaw_rate_rps; /* clockwise positive; 0 with VEHICLE_YAW_NONE */
	bool heading_usable;
	double heading_rad; /* clockwise from north, [0, 2 pi) */
	enum nav_gear gear;
	enum nav_turn_lamp turn_lamp;
	double ambient; /* 0 to 1; negative: unknown */
	enum vehicle_ignition ignition;
	bool odometer_usable;
	double odometer_m;
	/* Last satellite position with both coordinates. `fixes` counts them, so a reader sees a new one; wraps. */
	bool has_fix;
	double lat_deg, lon_deg;
	int64_t fix_time_ns;
	double fix_sigma_m; /* 0 unknown */
	uint32_t fixes;
	/* For the driver and the logs; see enum nav_signal_state. Ages are of the last good sample, INT64_MAX never. */
	enum nav_signal_state state[VEHICLE_INPUT_COUNT];
	int64_t age_ns[VEHICLE_INPUT_COUNT];
	double value[VEHICLE_INPUT_COUNT];
};

void vehicle_init(struct vehicle *vehicle, const struct vehicle_config *config);

/* Takes one frame; remote and error frames, and messages that nothing is bound to, cost a few comparisons. Times may
 * repeat or step back a little; they are never negative intervals here. */
void vehicle_feed(struct vehicle *vehicle, const struct can_frame_rx *frame);

/* The state at `now_ns`. Of all functions here only this notes stale_ns_max. */
void vehicle_sample(struct vehicle *vehicle, int64_t now_ns, struct vehicle_state *out);

/* Yaw rate of a bicycle: clockwise positive for a clockwise steering angle and forward speed. */
double vehicle_bicycle_yaw(const struct vehicle_config *config, double speed_mps, double steering_rad);

/* One word for logs and the screen: "range", "checksum"... */
const char *vehicle_fault_name(enum vehicle_fault fault);

#endif
