/*
 * What goes wrong on the bus: faults that begin and end on command or at set times, applied to frames on their way out.
 * A fault is written KIND[:TARGET][/SECONDS], without seconds it lasts until it is cleared:
 *
 *     lost:speed/5      the messages that carry it are not sent
 *     stuck:yaw_rate    the value stays what it was; counters and checksums go on
 *     noisy:steering    it jumps about
 *     range:speed       it is what the definitions can hold at most, and no car can do
 *     counter:gear      the message's counter stands still
 *     checksum:motion   the message's checksum is wrong
 *     busoff/3          error frames, then nothing at all, then a restart
 *     clock:-31536000   the time that the bus says jumps by so many seconds
 *     camera:frozen/2   told to the simulated camera
 *     chatter:reverse   a line bounces
 *
 * Targets of the bus: speed yaw_rate steering gear turn_lamp ambient odometer gnss wheels ignition destination, a
 * message (MOTION) or a signal (MOTION.Speed), or all.
 */
#ifndef BLVD_TOOLS_SIM_FAULTS_H
#define BLVD_TOOLS_SIM_FAULTS_H

#include "platform/base/rng.h"
#include "platform/can/dbc.h"

#define FAULTS_MAX 32
#define FAULT_TEXT_MAX 48

enum fault_kind {
	FAULT_LOST,
	FAULT_STUCK,
	FAULT_NOISY,
	FAULT_RANGE,
	FAULT_COUNTER,
	FAULT_CHECKSUM,
	FAULT_BUS_OFF,
	FAULT_CLOCK,
	FAULT_CAMERA,
	FAULT_CHATTER,
	FAULT_KINDS,
};

struct fault {
	enum fault_kind kind;
	char target[FAULT_TEXT_MAX];
	double start_s, seconds; /* seconds 0: until cleared */
	bool begun;
	const struct dbc_message *messages[3]; /* of the bus's; all of them NULL: every one */
	const struct dbc_signal *signal;       /* of messages[0]; NULL where it is about messages */
	double noise;                          /* one sigma, in the signal's unit */
	int64_t raw;                           /* stuck at */
	bool raw_known;
};

struct faults {
	const struct dbc *dbc; /* borrowed */
	struct fault items[FAULTS_MAX];
	unsigned count;
	struct rng rng;
};

/* What a fault's beginning or end asks of others than the bus; `kind` FAULT_KINDS: nothing. */
struct fault_event {
	enum fault_kind kind;
	bool begins;
	double seconds; /* it lasts; 0: until cleared */
	char target[FAULT_TEXT_MAX];
};

void faults_init(struct faults *faults, const struct dbc *dbc, uint64_t seed);

/* Adds one that begins at `start_s`. Returns NULL, or what is wrong with it. Valid until the next call. */
const char *faults_add(struct faults *faults, const char *text, double start_s);
/* "TIME:KIND[:TARGET][/SECONDS]". */
const char *faults_script(struct faults *faults, const char *text);
/* Ends those that have begun: all, or those of a kind, or of KIND:TARGET. Their ends are told by faults_step(). */
void faults_clear(struct faults *faults, const char *what, double now_s);

/* Begins and ends what is due; call until it tells nothing more. */
struct fault_event faults_step(struct faults *faults, double now_s);

/* A frame on its way out. Returns false when it is not sent. */
bool faults_apply(struct faults *faults, struct can_frame_rx *frame);

bool faults_active(const struct faults *faults, enum fault_kind kind);
/* The active ones in words, "" when there are none. */
void faults_describe(const struct faults *faults, double now_s, char *out, size_t size);

#endif
