/* One CAN frame as everything here passes it on: classic or FD, with the time and the bus it came by. Plain data. */
#ifndef BLVD_PLATFORM_CAN_CAN_FRAME_H
#define BLVD_PLATFORM_CAN_CAN_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#define CAN_FRAME_DATA_MAX 64
#define CAN_FRAME_STD_MASK UINT32_C(0x7FF)
#define CAN_FRAME_EXT_MASK UINT32_C(0x1FFFFFFF)

enum can_frame_flag {
	CAN_FRAME_EXT = 1 << 0,    /* 29-bit identifier */
	CAN_FRAME_FD = 1 << 1,     /* up to 64 bytes */
	CAN_FRAME_REMOTE = 1 << 2, /* a request: `len` without data */
	CAN_FRAME_ERROR = 1 << 3, /* the controller's own report, never a car's message; `id` is the kernel's error class */
};

struct can_frame_rx {
	int64_t time_ns;  /* on the clock of whoever delivered it, see can_bus.h; ns since 1970 in a log's record */
	uint32_t id;      /* 11 or 29 bits, without flag bits */
	uint8_t bus;      /* index into the names of the can_bus that delivered it */
	uint8_t flags;    /* enum can_frame_flag */
	uint8_t len;      /* bytes of data: 0-8, or 12, 16, 20, 24, 32, 48, 64 with CAN_FRAME_FD */
	uint8_t raw_dlc;  /* 9-15 where a classic frame of 8 bytes said so on the wire, else 0 */
	uint8_t fd_flags; /* 4 bits as on the wire side of Linux: 1 bit rate switch, 2 error state */
	uint8_t data[CAN_FRAME_DATA_MAX]; /* zero from `len` on */
};

/* True when `len` bytes can be sent as one frame of this kind. */
static inline bool can_frame_len_valid(unsigned len, bool fd)
{
	if (len <= 8)
		return true;
	return fd && (len == 12 || len == 16 || len == 20 || len == 24 || len == 32 || len == 48 || len == 64);
}

#endif
