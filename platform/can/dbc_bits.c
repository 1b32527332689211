/* Values in frames: bits to raw to physical and back. At most nine byte steps a signal, no allocation. */
#include "platform/can/dbc.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

static unsigned min_u(unsigned a, unsigned b)
{
	return a < b ? a : b;
}

/* Position counted along the wire, from the most significant bit of byte 0: big-endian signals are contiguous there. */
static unsigned wire_position(const struct dbc_signal *signal)
{
	return signal->start / 8u * 8u + (7u - signal->start % 8u);
}

static bool fits(const struct dbc_signal *signal, const struct can_frame_rx *frame)
{
	unsigned first = signal->big_endian ? wire_position(signal) : signal->start;
	return first + signal->length <= min_u(frame->len, CAN_FRAME_DATA_MAX) * 8u;
}

static uint64_t get_big_endian(const uint8_t *data, unsigned at, unsigned length)
{
	uint64_t raw = 0;
	while (length) {
		unsigned room = 8 - at % 8, step = min_u(room, length);
		raw = raw << step | ((unsigned)data[at / 8] >> (room - step) & ((1u << step) - 1u));
		at += step;
		length -= step;
	}
	return raw;
}

static uint64_t get_little_endian(const uint8_t *data, unsigned at, unsigned length)
{
	uint64_t raw = 0;
	for (unsigned done = 0, step; done < length; done += step) {
		unsigned shift = (at + done) % 8;
		step = min_u(8 - shift, length - done);
		raw |= (uint64_t)((unsigned)data[(at + done) / 8] >> shift & ((1u << step) - 1u)) << done;
	}
	return raw;
}

static void put_bits(uint8_t *byte, unsigned shift, unsigned step, uint64_t part)
{
	unsigned mask = ((1u << step) - 1u) << shift;
	*byte = (uint8_t)((*byte & ~mask) | ((unsigned)part << shift & mask));
}

static void put_big_endian(uint8_t *data, unsigned at, unsigned length, uint64_t raw)
{
	while (length) {
		unsigned room = 8 - at % 8, step = min_u(room, length);
		put_bits(&data[at / 8], room - step, step, raw >> (length - step) & 0xFF);
		at += step;
		length -= step;
	}
}

static void put_little_endian(uint8_t *data, unsigned at, unsigned length, uint64_t raw)
{
	for (unsigned done = 0, step; done < length; done += step) {
		unsigned shift = (at + done) % 8;
		step = min_u(8 - shift, length - done);
		put_bits(&data[(at + done) / 8], shift, step, raw >> done & 0xFF);
	}
}

static uint64_t get(const struct dbc_signal *signal, const uint8_t *data)
{
	return signal->big_endian ? get_big_endian(data, wire_position(signal), signal->length)
							  : get_little_endian(data, signal->start, signal->length);
}

static int64_t sign_extend(uint64_t raw, unsigned length)
{
	assert(length >= 1 && length <= 64);
	uint64_t sign = UINT64_C(1) << (length - 1);
	return (int64_t)((raw ^ sign) - sign);
}

bool dbc_message_matches(const struct dbc_message *message, const struct can_frame_rx *frame)
{
	return message->id == frame->id && message->extended == ((frame->flags & CAN_FRAME_EXT) != 0) && !message->pseudo &&
		   !(frame->flags & (CAN_FRAME_REMOTE | CAN_FRAME_ERROR));
}

/* The parser refuses selector chains that are longer than this or closed. */
#define MUX_DEPTH 8

static bool selected(const struct dbc_signal *signal, const struct can_frame_rx *frame)
{
	for (int depth = 0; signal->is_multiplexed; depth++) {
		const struct dbc_signal *selector = signal->selector;
		if (!selector || depth == MUX_DEPTH || !fits(selector, frame))
			return false;
		uint64_t code = get(selector, frame->data);
		const struct dbc_mux_range *range = signal->ranges;
		while (range && (code < range->low || code > range->high))
			range = range->next;
		if (!range)
			return false;
		signal = selector;
	}
	return true;
}

bool dbc_decode_raw(const struct dbc_signal *signal, const struct can_frame_rx *frame, int64_t *raw)
{
	if (!dbc_message_matches(signal->message, frame) || !fits(signal, frame) || !selected(signal, frame))
		return false;
	uint64_t bits = get(signal, frame->data);
	*raw = signal->type == DBC_SIGNED ? sign_extend(bits, signal->length) : (int64_t)bits;
	return true;
}

static double raw_number(const struct dbc_signal *signal, int64_t raw)
{
	uint32_t word = (uint32_t)raw;
	float single;
	double number;
	switch (signal->type) {
	case DBC_FLOAT:
		memcpy(&single, &word, sizeof(single));
		return single;
	case DBC_DOUBLE:
		memcpy(&number, &raw, sizeof(number));
		return number;
	case DBC_SIGNED:
		return (double)raw;
	case DBC_UNSIGNED:
	default:
		return (double)(uint64_t)raw;
	}
}

bool dbc_decode(const struct dbc_signal *signal, const struct can_frame_rx *frame, double *value)
{
	int64_t raw;
	if (!dbc_decode_raw(signal, frame, &raw))
		return false;
	*value = raw_number(signal, raw) * signal->scale + signal->offset;
	return true;
}

void dbc_frame_init(const struct dbc_message *message, struct can_frame_rx *frame)
{
	*frame = (struct can_frame_rx){ .id = message->id };
	unsigned len = min_u(message->length, CAN_FRAME_DATA_MAX);
	if (message->extended)
		frame->flags |= CAN_FRAME_EXT;
	if (len > 8)
		frame->flags |= CAN_FRAME_FD;
	while (!can_frame_len_valid(len, true))
		len++;
	frame->len = (uint8_t)len;
}

int dbc_encode_raw(const struct dbc_signal *signal, int64_t raw, struct can_frame_rx *frame)
{
	if (!fits(signal, frame))
		return -EINVAL;
	if (signal->big_endian)
		put_big_endian(frame->data, wire_position(signal), signal->length, (uint64_t)raw);
	else
		put_little_endian(frame->data, signal->start, signal->length, (uint64_t)raw);
	return 0;
}

/* Nearest raw integer; the ends are powers of two, so the comparisons with them are exact. */
static int64_t raw_integer(const struct dbc_signal *signal, double number, int *status)
{
	bool is_signed = signal->type == DBC_SIGNED;
	double high = ldexp(1.0, is_signed ? signal->length - 1 : signal->length);
	double low = is_signed ? -high : 0.0;
	double rounded = nearbyint(number);
	if (rounded >= low && rounded < high)
		return is_signed ? (int64_t)rounded : (int64_t)(uint64_t)rounded;
	*status = -ERANGE;
	uint64_t all = ~UINT64_C(0) >> (64 - signal->length);
	if (is_signed)
		return rounded < low ? sign_extend(UINT64_C(1) << (signal->length - 1), signal->length) : (int64_t)(all >> 1);
	return rounded < low ? 0 : (int64_t)all;
}

int dbc_encode(const struct dbc_signal *signal, double value, struct can_frame_rx *frame)
{
	double number = (value - signal->offset) / signal->scale;
	if (!isfinite(number) || !fits(signal, frame))
		return -EINVAL;
	int status = 0;
	int64_t raw = 0;
	float single = (float)number;
	uint32_t word;
	switch (signal->type) {
	case DBC_FLOAT:
		if (!isfinite(single))
			return -EINVAL;
		memcpy(&word, &single, sizeof(word));
		raw = word;
		break;
	case DBC_DOUBLE:
		memcpy(&raw, &number, sizeof(raw));
		break;
	case DBC_SIGNED:
	case DBC_UNSIGNED:
		raw = raw_integer(signal, number, &status);
		break;
	}
	dbc_encode_raw(signal, raw, frame);
	return status;
}

const char *dbc_value_text(const struct dbc_signal *signal, int64_t raw)
{
	for (const struct dbc_value *value = signal->values; value; value = value->next)
		if (value->raw == raw)
			return value->text;
	return NULL;
}
