/*
 * The checksums that cars put into their frames. Each is computed over the whole frame with the checksum's own bits
 * taken as zero, then cut to the signal's length.
 */
#ifndef BLVD_PLATFORM_CAN_CHECKSUM_H
#define BLVD_PLATFORM_CAN_CHECKSUM_H

#include "platform/can/dbc.h"

enum can_checksum {
	CAN_CHECKSUM_NONE,
	CAN_CHECKSUM_XOR,    /* all bytes, exclusive or; of their halves where the signal has 4 bits */
	CAN_CHECKSUM_SUM,    /* all bytes, sum */
	CAN_CHECKSUM_TOYOTA, /* length, the bytes of the identifier and all bytes, sum */
	CAN_CHECKSUM_CRC8,   /* SAE J1850 (polynomial 0x1D, start and final xor 0xFF) over the identifier's two low bytes,
							low first, then all bytes */
};

/* By name: none xor sum toyota crc8. False when there is no such. */
bool can_checksum_by_name(const char *name, enum can_checksum *out);

/* What the frame's checksum has to be. `signal` is where it is stored. */
uint64_t can_checksum_expected(
	enum can_checksum kind, const struct dbc_signal *signal, const struct can_frame_rx *frame);

/* True when the frame has the signal and it is right. */
bool can_checksum_good(enum can_checksum kind, const struct dbc_signal *signal, const struct can_frame_rx *frame);

/* Puts the right one; call last, after the counter and the values. Returns 0 or -EINVAL (outside the frame). */
int can_checksum_put(enum can_checksum kind, const struct dbc_signal *signal, struct can_frame_rx *frame);

#endif
