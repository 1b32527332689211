/*
 * The board profile: one INI file for one display in one car. It says how large the picture and the memory are, which
 * CAN interfaces and signal definitions there are, and which signal is which. board/README.md tells every key;
 * board/profiles/ has examples. Without a file the profile of the virtual car (profiles/sim.ini) is used, which is
 * compiled in.
 *
 * Reading a profile touches no other file: the signals are names here. car_init (board/car.h) finds them.
 */
#ifndef BLVD_BOARD_PROFILE_H
#define BLVD_BOARD_PROFILE_H

#include "board/power.h"
#include "board/profile_gpio.h"
#include "nav/vehicle.h"
#include "platform/base/arena.h"
#include "platform/base/geo.h"
#include "platform/camera/camera.h"
#include "platform/can/can_bus.h"
#include "platform/can/obd.h"

#define PROFILE_DBC_MAX 8
#define PROFILE_DBC_BUILTIN "builtin:boulevard" /* the virtual car's definitions, without a file */
#define PROFILE_DBC_OBD2 "builtin:obd2"         /* those of OBD-II answers */

enum profile_style { PROFILE_STYLE_AUTO, PROFILE_STYLE_DAY, PROFILE_STYLE_DUSK, PROFILE_STYLE_NIGHT };
enum profile_units { PROFILE_UNITS_AUTO, PROFILE_UNITS_METRIC, PROFILE_UNITS_IMPERIAL };

/* How pictures reach a panel. */
enum profile_buffers { PROFILE_BUFFERS_AUTO, PROFILE_BUFFERS_GBM, PROFILE_BUFFERS_DUMB };

struct profile_map {
	int64_t raw;
	const char *meaning;
};

/* One line of [signals]. Strings are NULL where the line does not say; numbers have a `has_` or a stated default. */
struct profile_signal {
	unsigned line;       /* 0: this input is not in the profile */
	const char *message; /* NULL: any */
	const char *name;
	const char *bus;  /* NULL: any */
	const char *unit; /* NULL: as the definitions say */
	double scale, offset;
	double sign; /* 1 or -1 */
	bool has_timeout, has_min, has_max, has_max_rate, has_counter_skip;
	double timeout_s, frozen_s, min, max, max_rate;
	const char *counter;
	unsigned counter_skip;
	const char *checksum;
	enum can_checksum checksum_kind;
	const char *valid;
	unsigned map_count;
	struct profile_map map[VEHICLE_MAP_MAX];
};

/* Showing the camera's buffers without a copy: where the GPU is real, always where it can be, never. */
enum profile_zero_copy { PROFILE_ZERO_COPY_AUTO, PROFILE_ZERO_COPY_YES, PROFILE_ZERO_COPY_NO };

/* The section [camera]. */
struct profile_camera {
	const char *device; /* "/dev/video0", "sim" or "sim:SCRIPT"; NULL: none */
	uint32_t width, height, fps;
	enum camera_format format;
	bool mirror;  /* shown as a mirror shows it */
	bool repeats; /* the same picture again is a frozen one */
	enum profile_zero_copy zero_copy;
	enum lens_kind lens;
	double fov_deg, k1, k2;
	double height_m, pitch_deg, behind_axle_m, offset_m;
};

struct profile {
	const char *path; /* as it was given; "built-in profile" */
	uint32_t width, height;
	uint32_t fps;
	uint32_t fps_standstill, fps_ignition_off; /* 0: as fps */
	uint32_t samples;                          /* MSAA; 0 or 1: none */
	const char *device, *connector, *mode;     /* of a panel; NULL: whatever is there */
	const char *vt, *backlight;                /* NULL: the active one; none */
	uint32_t rotation_deg;                     /* clockwise; a multiple of 90 */
	enum profile_buffers buffers;
	double brightness_day, brightness_night; /* 0 to 1 */
	enum profile_style style;
	enum profile_units units;
	uint64_t budget_bytes;
	bool has_start, has_heading;
	struct geo_point start;
	double start_heading_deg;
	unsigned dbc_count;
	const char *dbc[PROFILE_DBC_MAX]; /* ready to open: relative names are relative to the profile's folder */
	unsigned interface_count;
	const char *interfaces[CAN_BUS_MAX];
	const char *obd_interface; /* NULL: nothing is asked, and nothing is ever sent */
	unsigned obd_line;
	double obd_rate_hz;
	enum obd_addressing obd_addressing;
	double wheelbase_m, track_m; /* 0: not said */
	double width_m, rear_overhang_m;
	double steering_ratio;
	double steering_centre_deg;
	double understeer_s2pm2;
	bool speed_signed;
	struct profile_signal signals[VEHICLE_INPUT_COUNT];
	struct profile_gpio gpio;
	struct power_config power;
	const char *gnss; /* a receiver beside the bus; NULL none */
	struct profile_camera camera;
	unsigned warnings; /* unknown keys; each was logged */
};

struct profile_error {
	unsigned line; /* 0: the whole file */
	char text[200];
};

/* `text` need not end with a NUL. `path` is kept in `out` and used for relative names; NULL: none. Everything else is
 * copied into the arena. Returns 0, -EINVAL (`error` says where and what) or -ENOMEM. */
int profile_parse(struct profile *out, const char *path, const char *text, size_t size, struct arena *arena,
	struct profile_error *error);

/* `path` NULL: the built-in profile. Returns 0 or -errno, having logged one line that names the file and place. The
 * path is borrowed. */
int profile_load(struct profile *out, const char *path, struct arena *arena);

/* The key in [signals] of an input: "speed", "wheel_rear_left"... */
const char *profile_input_name(enum vehicle_input input);

#endif
