/*
 * Asking a car for values by OBD-II (ISO 15031-5 service 01 over ISO 15765-4), for cars whose own messages nobody has
 * described. One question at a time, in single frames: to everybody (identifier 7DF, or 18DB33F1), answered by a
 * control unit (7E8 to 7EF, or 18DAF100 to 18DAF1FF). The first unit that knows a value is listened to until it falls
 * silent.
 *
 * It is polite: never more than `rate_hz` questions a second, none while another tester asks, and when nobody answers
 * the pauses double from 1 to 30 seconds. It writes nothing itself: obd_ask() says what to send, or that there is
 * nothing to send. Plain data, no clock, no allocation.
 */
#ifndef BLVD_PLATFORM_CAN_OBD_H
#define BLVD_PLATFORM_CAN_OBD_H

#include "platform/can/can_frame.h"

#define OBD_PIDS_MAX 8
#define OBD_ANSWER_ID 0x7E8 /* what obd_take() gives every answer: definitions are written for this one */

enum obd_addressing {
	OBD_ADDRESSING_AUTO, /* 11 bits first, then in turn until somebody answers */
	OBD_ADDRESSING_11,
	OBD_ADDRESSING_29,
};

struct obd_config {
	uint8_t bus;
	uint8_t pids[OBD_PIDS_MAX]; /* the first is asked for most of the time, the others one in five */
	unsigned pid_count;         /* 0: never asks */
	double rate_hz;             /* > 0 */
	enum obd_addressing addressing;
};

struct obd {
	struct obd_config config;
	int64_t next_ns;    /* not before */
	int64_t asked_ns;   /* INT64_MIN: no question is open */
	int64_t backoff_ns; /* 0: somebody answers */
	unsigned misses;    /* questions in a row that nobody answered */
	unsigned turn;      /* counts the questions */
	uint8_t pid;        /* of the last question */
	uint8_t refused;    /* a bit for each of config.pids that a unit has said it does not know */
	bool extended;      /* 29 bits, now */
	bool met;           /* somebody has answered by this addressing */
	bool has_unit;
	uint32_t unit; /* identifier of the unit that is listened to */
	uint64_t questions, answers;
};

void obd_init(struct obd *obd, const struct obd_config *config, int64_t now_ns);

/* True when `question` should be sent now; time goes into the frame too. */
bool obd_ask(struct obd *obd, int64_t now_ns, struct can_frame_rx *question);

/* The question could not be sent: the same as silence, at once. */
void obd_failed(struct obd *obd, int64_t now_ns);

/* To be shown every frame of the bus. False when the frame is of OBD-II and not to be decoded: a question, another unit
 * than the one listened to, an answer of another kind. An answer to be decoded has OBD_ANSWER_ID afterwards. All other
 * frames are true and stay as they are. */
bool obd_take(struct obd *obd, struct can_frame_rx *frame);

#endif
