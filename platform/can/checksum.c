#include "platform/can/checksum.h"

#include <string.h>

bool can_checksum_by_name(const char *name, enum can_checksum *out)
{
	static const char *const names[] = { "none", "xor", "sum", "toyota", "crc8" };
	for (unsigned i = 0; i < sizeof(names) / sizeof(*names); i++) {
		if (strcmp(name, names[i]) != 0)
			continue;
		*out = (enum can_checksum)i;
		return true;
	}
	return false;
}

/* Bit by bit: a handful of frames each 10 ms does not pay for a table. */
static unsigned crc8(unsigned crc, unsigned byte)
{
	crc ^= byte;
	for (int bit = 0; bit < 8; bit++)
		crc = crc & 0x80 ? (crc << 1 ^ 0x1D) & 0xFF : crc << 1;
	return crc;
}

static unsigned start_value(enum can_checksum kind, const struct can_frame_rx *frame)
{
	uint32_t id = frame->id;
	if (kind == CAN_CHECKSUM_TOYOTA)
		return frame->len + (id & 0xFF) + (id >> 8 & 0xFF) + (id >> 16 & 0xFF) + (id >> 24);
	if (kind == CAN_CHECKSUM_CRC8)
		return crc8(crc8(0xFF, id & 0xFF), id >> 8 & 0xFF);
	return 0;
}

uint64_t can_checksum_expected(
	enum can_checksum kind, const struct dbc_signal *signal, const struct can_frame_rx *frame)
{
	struct can_frame_rx bare = *frame;
	dbc_encode_raw(signal, 0, &bare);
	unsigned sum = start_value(kind, frame);
	for (unsigned i = 0; i < bare.len; i++) {
		if (kind == CAN_CHECKSUM_CRC8)
			sum = crc8(sum, bare.data[i]);
		else if (kind == CAN_CHECKSUM_XOR)
			sum ^= bare.data[i];
		else
			sum += bare.data[i];
	}
	if (kind == CAN_CHECKSUM_CRC8)
		sum ^= 0xFF;
	if (kind == CAN_CHECKSUM_XOR && signal->length == 4)
		sum ^= sum >> 4;
	return sum & (~UINT64_C(0) >> (64 - signal->length));
}

bool can_checksum_good(enum can_checksum kind, const struct dbc_signal *signal, const struct can_frame_rx *frame)
{
	int64_t raw;
	if (!dbc_decode_raw(signal, frame, &raw))
		return false;
	uint64_t bits = (uint64_t)raw & (~UINT64_C(0) >> (64 - signal->length));
	return bits == can_checksum_expected(kind, signal, frame);
}

int can_checksum_put(enum can_checksum kind, const struct dbc_signal *signal, struct can_frame_rx *frame)
{
	return dbc_encode_raw(signal, (int64_t)can_checksum_expected(kind, signal, frame), frame);
}
