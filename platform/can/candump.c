/* One pass over the line, no allocation, no locale, no errno. */
#include "platform/can/candump.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>

#define ERROR_FRAME_BIT UINT32_C(0x20000000)
#define NS_PER_SECOND INT64_C(1000000000)
#define SECONDS_MAX (INT64_MAX / NS_PER_SECOND - 1)

struct cursor {
	const char *at, *end;
};

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	if (c >= 'A' && c <= 'F')
		return c - 'A' + 10;
	return -1;
}

static bool take(struct cursor *in, char c)
{
	if (in->at == in->end || *in->at != c)
		return false;
	in->at++;
	return true;
}

static bool skip_blanks(struct cursor *in)
{
	const char *before = in->at;
	while (in->at < in->end && (*in->at == ' ' || *in->at == '\t'))
		in->at++;
	return in->at > before;
}

static bool parse_time(struct cursor *in, int64_t *time_ns)
{
	int64_t seconds = 0, fraction = 0, unit = NS_PER_SECOND;
	const char *start = in->at;
	for (; in->at < in->end && *in->at >= '0' && *in->at <= '9'; in->at++) {
		seconds = seconds * 10 + (*in->at - '0');
		if (seconds > SECONDS_MAX)
			return false;
	}
	if (in->at == start || !take(in, '.'))
		return false;
	for (; in->at < in->end && *in->at >= '0' && *in->at <= '9' && unit > 1; in->at++) {
		unit /= 10;
		fraction += (*in->at - '0') * unit;
	}
	*time_ns = seconds * NS_PER_SECOND + fraction;
	return unit < NS_PER_SECOND;
}

static bool parse_name(struct cursor *in, char name[CANDUMP_NAME_SIZE])
{
	size_t n = 0;
	for (; in->at<in->end && * in->at> ' ' && *in->at < 0x7F; in->at++) {
		if (n + 1 >= CANDUMP_NAME_SIZE)
			return false;
		name[n++] = *in->at;
	}
	name[n] = 0;
	return n > 0;
}

/* The number of digits says the kind: three standard, eight extended or error. */
static bool parse_id(struct cursor *in, struct can_frame_rx *frame)
{
	uint32_t id = 0;
	int digits = 0;
	for (; in->at < in->end && hex_digit(*in->at) >= 0 && digits < 9; in->at++, digits++)
		id = id << 4 | (uint32_t)hex_digit(*in->at);
	if (digits == 3 && id <= CAN_FRAME_STD_MASK) {
		frame->id = id;
		return true;
	}
	if (digits != 8 || id > (CAN_FRAME_EXT_MASK | ERROR_FRAME_BIT))
		return false;
	frame->flags = id & ERROR_FRAME_BIT ? CAN_FRAME_ERROR : CAN_FRAME_EXT;
	frame->id = id & CAN_FRAME_EXT_MASK;
	return true;
}

static bool parse_data(struct cursor *in, struct can_frame_rx *frame)
{
	unsigned limit = frame->flags & CAN_FRAME_FD ? CAN_FRAME_DATA_MAX : 8, n = 0;
	while (in->at < in->end && hex_digit(*in->at) >= 0) {
		if (n == limit || in->end - in->at < 2 || hex_digit(in->at[1]) < 0)
			return false;
		frame->data[n++] = (uint8_t)(hex_digit(in->at[0]) << 4 | hex_digit(in->at[1]));
		in->at += 2;
		if (n < limit)
			take(in, '.');
	}
	frame->len = (uint8_t)n;
	return can_frame_len_valid(n, frame->flags & CAN_FRAME_FD);
}

static bool parse_remote_length(struct cursor *in, struct can_frame_rx *frame)
{
	frame->flags |= CAN_FRAME_REMOTE;
	int digit = in->at < in->end ? hex_digit(*in->at) : -1;
	if (digit < 0)
		return true;
	in->at++;
	frame->len = (uint8_t)digit;
	return digit <= 8;
}

static bool parse_raw_dlc(struct cursor *in, struct can_frame_rx *frame)
{
	if (!take(in, '_'))
		return true;
	int digit = in->at < in->end ? hex_digit(*in->at) : -1;
	if (digit < 9 || frame->len != 8)
		return false;
	in->at++;
	frame->raw_dlc = (uint8_t)digit;
	return true;
}

static const char *parse_payload(struct cursor *in, struct can_frame_rx *frame)
{
	if (!take(in, '#'))
		return "no '#' after the identifier";
	if (take(in, '#')) {
		int digit = in->at < in->end ? hex_digit(*in->at) : -1;
		if (digit < 0 || frame->flags & CAN_FRAME_ERROR)
			return "no flags digit after '##'";
		in->at++;
		frame->flags |= CAN_FRAME_FD;
		frame->fd_flags = (uint8_t)digit;
		return parse_data(in, frame) ? NULL : "data is not bytes of a length that CAN FD has";
	}
	if (take(in, 'R')) {
		if (!parse_remote_length(in, frame))
			return "a remote frame asks for at most 8 bytes";
	} else if (!parse_data(in, frame)) {
		return "data is not at most 8 bytes in hexadecimal";
	}
	return parse_raw_dlc(in, frame) ? NULL : "a length code is 9 to F, after 8 bytes";
}

const char *candump_parse(const char *line, size_t length, struct candump_record *out)
{
	struct cursor in = { line, line + length };
	*out = (struct candump_record){ 0 };
	if (length && in.end[-1] == '\r')
		in.end--;
	skip_blanks(&in);
	if (!take(&in, '('))
		return "no time in parentheses";
	if (!parse_time(&in, &out->frame.time_ns) || !take(&in, ')'))
		return "the time is not seconds with a fraction";
	if (!skip_blanks(&in) || !parse_name(&in, out->interface) || !skip_blanks(&in))
		return "no interface name of 1 to 15 characters";
	if (!parse_id(&in, &out->frame))
		return "the identifier is not 3 or 8 hexadecimal digits in range";
	const char *fault = parse_payload(&in, &out->frame);
	if (fault)
		return fault;
	if (skip_blanks(&in) && (take(&in, 'R') || take(&in, 'T'))) /* candump -x marks the direction */
		skip_blanks(&in);
	return in.at == in.end ? NULL : "more text after the frame";
}

static char *put_decimal(char *to, uint64_t value, int digits)
{
	char reversed[20];
	int n = 0;
	while (value || n < digits) {
		reversed[n++] = (char)('0' + value % 10);
		value /= 10;
	}
	while (n)
		*to++ = reversed[--n];
	return to;
}

static char *put_hex(char *to, uint32_t value, int digits)
{
	for (int i = digits - 1; i >= 0; i--)
		*to++ = "0123456789ABCDEF"[value >> (4 * i) & 15];
	return to;
}

static char *put_id(char *to, const struct can_frame_rx *frame)
{
	if (frame->flags & CAN_FRAME_ERROR)
		return put_hex(to, frame->id | ERROR_FRAME_BIT, 8);
	return put_hex(to, frame->id, frame->flags & CAN_FRAME_EXT ? 8 : 3);
}

static char *put_payload(char *to, const struct can_frame_rx *frame)
{
	*to++ = '#';
	if (frame->flags & CAN_FRAME_FD) {
		*to++ = '#';
		to = put_hex(to, frame->fd_flags & 15, 1);
	}
	if (frame->flags & CAN_FRAME_REMOTE) {
		*to++ = 'R';
		if (frame->len)
			to = put_hex(to, frame->len, 1);
	} else {
		for (unsigned i = 0; i < frame->len; i++)
			to = put_hex(to, frame->data[i], 2);
	}
	if (frame->raw_dlc) {
		*to++ = '_';
		to = put_hex(to, frame->raw_dlc, 1);
	}
	return to;
}

size_t candump_format(const char *interface, const struct can_frame_rx *frame, char line[CANDUMP_LINE_SIZE])
{
	assert(frame->time_ns >= 0 && frame->len <= CAN_FRAME_DATA_MAX);
	char *to = line;
	int64_t fraction = frame->time_ns % NS_PER_SECOND;
	*to++ = '(';
	to = put_decimal(to, (uint64_t)(frame->time_ns / NS_PER_SECOND), 10);
	*to++ = '.';
	to = fraction % 1000 ? put_decimal(to, (uint64_t)fraction, 9) : put_decimal(to, (uint64_t)fraction / 1000, 6);
	*to++ = ')';
	*to++ = ' ';
	size_t name_length = strnlen(interface, CANDUMP_NAME_SIZE - 1);
	memcpy(to, interface, name_length);
	to += name_length;
	*to++ = ' ';
	to = put_payload(put_id(to, frame), frame);
	*to++ = '\n';
	*to = 0;
	return (size_t)(to - line);
}

void candump_writer_init(struct candump_writer *writer, int fd)
{
	writer->fd = fd;
	writer->error = 0;
	writer->lines = writer->lost = 0;
	writer->used = 0;
}

int candump_writer_flush(struct candump_writer *writer)
{
	size_t done = 0;
	while (done < writer->used && !writer->error) {
		ssize_t n = write(writer->fd, writer->buffer + done, writer->used - done);
		if (n > 0)
			done += (size_t)n;
		else if (n < 0 && errno != EINTR)
			writer->error = -errno;
	}
	writer->used = 0;
	return writer->error;
}

void candump_writer_add(struct candump_writer *writer, const char *interface, const struct can_frame_rx *frame)
{
	if (writer->used + CANDUMP_LINE_SIZE > sizeof(writer->buffer))
		candump_writer_flush(writer);
	if (writer->error) {
		writer->lost++;
		return;
	}
	writer->used += candump_format(interface, frame, writer->buffer + writer->used);
	writer->lines++;
}
