/*
 * The text log of can-utils (`candump -l`), one frame a line, both ways:
 *
 *     (1436509052.249713) vcan0 123#DEADBEEF         classic, 11-bit id: three digits
 *     (1436509052.249713) vcan0 00000123#DE          29-bit id: eight digits
 *     (1436509052.249713) vcan0 123##1DEADBEEF       FD: one digit of flags, then the data
 *     (1436509052.249713) vcan0 123#R4               remote request for four bytes
 *     (1436509052.249713) vcan0 123#1122334455667788_C   classic, length code 12 on the wire
 *     (1436509052.249713) vcan0 20000004#0001000000000000   error frame
 *
 * What candump_format writes is what candump wrote, byte for byte; a line that was parsed formats to itself but for
 * lower-case digits, dots between bytes, spacing and a trailing direction mark. Nothing here allocates.
 */
#ifndef BLVD_PLATFORM_CAN_CANDUMP_H
#define BLVD_PLATFORM_CAN_CANDUMP_H

#include <stddef.h>

#include "platform/can/can_frame.h"

#define CANDUMP_NAME_SIZE 16  /* interface name with its NUL, as in Linux */
#define CANDUMP_LINE_SIZE 192 /* longest line with newline and NUL */

struct candump_record {
	char interface[CANDUMP_NAME_SIZE];
	struct can_frame_rx frame; /* time_ns since 1970; bus is 0, the caller knows its buses */
};

/* One line without its newline (a CR at the end is ignored). Returns NULL when it was understood, otherwise what is
 * wrong with it, a constant string; `out` is then undefined. */
const char *candump_parse(const char *line, size_t length, struct candump_record *out);

/* Writes the line with its newline and a NUL; returns its length without the NUL. `frame->time_ns` must not be
 * negative. Fractions are microseconds, or nanoseconds where the time has them. */
size_t candump_format(const char *interface, const struct can_frame_rx *frame, char line[CANDUMP_LINE_SIZE]);

/* Log writer over an open file; buffers whole lines, so that a file cut by a power loss ends at a line. */
struct candump_writer {
	int fd;         /* borrowed; -1 when closed */
	int error;      /* first -errno of a write, then nothing more is written */
	uint64_t lines; /* accepted */
	uint64_t lost;  /* not written because of `error` */
	size_t used;
	char buffer[1 << 16];
};

void candump_writer_init(struct candump_writer *writer, int fd);
void candump_writer_add(struct candump_writer *writer, const char *interface, const struct can_frame_rx *frame);

/* Returns 0 or the first -errno of this writer. Does not close the file. */
int candump_writer_flush(struct candump_writer *writer);

#endif
