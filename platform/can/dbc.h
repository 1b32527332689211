/*
 * Signal definitions of a CAN database (DBC) and their values in frames.
 *
 * Read: BO_, SG_ (both byte orders, signed, unsigned, multiplexed and extended multiplexed), VAL_, SIG_VALTYPE_,
 * SG_MUL_VAL_, and of BA_ the message cycle time. All else is skipped. The whole database lives in the caller's arena,
 * names included; the text may go afterwards. Everything is const once parsed and may be read from any thread.
 *
 * Bit numbers are the format's own: bit b of a frame is bit b % 8 of byte b / 8, counting from the least significant.
 * A little-endian (Intel, @1) signal names its least significant bit and grows to higher numbers; a big-endian
 * (Motorola, @0) signal names its most significant bit and grows to lower bits, then to bit 7 of the next byte.
 */
#ifndef BLVD_PLATFORM_CAN_DBC_H
#define BLVD_PLATFORM_CAN_DBC_H

#include <stddef.h>

#include "platform/base/arena.h"
#include "platform/can/can_frame.h"

#define DBC_NAME_MAX 128 /* longest name of a message or signal, without the NUL */

enum dbc_type { DBC_UNSIGNED, DBC_SIGNED, DBC_FLOAT, DBC_DOUBLE };

struct dbc_value {
	const struct dbc_value *next;
	int64_t raw;
	const char *text;
};

/* Raw values of the selector with which a multiplexed signal is in the frame, both ends included. */
struct dbc_mux_range {
	const struct dbc_mux_range *next;
	uint64_t low, high;
};

struct dbc_signal {
	struct dbc_signal *next; /* in its message, in file order */
	const struct dbc_message *message;
	const char *name;
	const char *unit;
	uint16_t start; /* bit number, see above */
	uint8_t length; /* bits, 1 to 64 */
	bool big_endian;
	enum dbc_type type;
	double scale, offset; /* value = raw * scale + offset; scale is not 0 */
	double min, max;      /* as the file says; both 0 where it does not say */
	bool is_selector;
	bool is_multiplexed;                /* present only with the ranges of `selector` */
	const struct dbc_signal *selector;  /* NULL unless multiplexed */
	const struct dbc_mux_range *ranges; /* any of them */
	const struct dbc_value *values;     /* value table, file order; NULL none */
	unsigned line;
};

struct dbc_message {
	struct dbc_message *next, *next_in_bucket;
	const char *name;
	uint32_t id;       /* 11 or 29 bits */
	bool extended;     /* 29-bit */
	bool pseudo;       /* holds signals that belong to no frame; never matches one */
	uint16_t length;   /* bytes */
	uint32_t cycle_ms; /* GenMsgCycleTime; 0 unknown */
	struct dbc_signal *signals;
	unsigned signal_count;
	unsigned line;
};

struct dbc_note {
	unsigned line; /* from 1; 0 concerns the whole file */
	char text[160];
};

struct dbc {
	struct dbc_message *messages; /* file order */
	unsigned message_count, signal_count;
	struct dbc_message **buckets;
	unsigned
		warnings; /* things that were tolerated: what names nothing, signals outside their message, twice the same */
	struct dbc_note first_warning;
};

/* Returns 0, -EINVAL (`error` says where and what) or -ENOMEM (arena full; `error` says so). `out` is valid on 0 only;
 * on failure the arena is rolled back. */
int dbc_parse(struct dbc *out, const char *text, size_t size, struct arena *arena, struct dbc_note *error);

const struct dbc_message *dbc_find_message(const struct dbc *dbc, const char *name);
const struct dbc_message *dbc_find_id(const struct dbc *dbc, uint32_t id, bool extended);

/* By exact names; `message` NULL: any, the first in file order. NULL when there is none. */
const struct dbc_signal *dbc_find_signal(const struct dbc *dbc, const char *message, const char *name);

/* True when the frame carries this message: identifier and kind, neither remote nor error. */
bool dbc_message_matches(const struct dbc_message *message, const struct can_frame_rx *frame);

/* True and the raw value (sign-extended for DBC_SIGNED, the bits for floats) when the signal is in the frame: the
 * message matches, the frame is long enough, and the multiplexer selects it. */
bool dbc_decode_raw(const struct dbc_signal *signal, const struct can_frame_rx *frame, int64_t *raw);

/* The same, scaled. A float signal may decode to NaN or infinity. */
bool dbc_decode(const struct dbc_signal *signal, const struct can_frame_rx *frame, double *value);

/* An empty frame of the message: identifier, kind, length, zero data, time and bus 0. A message longer than 8 bytes
 * becomes an FD frame of the next valid length. */
void dbc_frame_init(const struct dbc_message *message, struct can_frame_rx *frame);

/* Puts the value into the frame, rounded to the nearest raw value; other bits stay. The multiplexer is the caller's to
 * set. Returns 0, -ERANGE (the nearest end of the raw range was put), -EINVAL (not finite, or outside the frame;
 * nothing was put). */
int dbc_encode(const struct dbc_signal *signal, double value, struct can_frame_rx *frame);
int dbc_encode_raw(const struct dbc_signal *signal, int64_t raw, struct can_frame_rx *frame);

/* Text of a raw value in the signal's table, or NULL. */
const char *dbc_value_text(const struct dbc_signal *signal, int64_t raw);

#endif
