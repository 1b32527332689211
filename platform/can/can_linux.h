/*
 * A frame as the kernel's CAN sockets carry it: struct can_frame (16 bytes) or struct canfd_frame (72 bytes), which of
 * them the size tells. Shared by what speaks to the kernel (can_socketcan.c) and what stands in for it (can_socket.c).
 */
#ifndef BLVD_PLATFORM_CAN_CAN_LINUX_H
#define BLVD_PLATFORM_CAN_CAN_LINUX_H

#include <linux/can.h>
#include <stdbool.h>
#include <stddef.h>

#include "platform/can/can_frame.h"

/* `size` is that of the datagram. False when it is no frame; else all of `out` is set but time and bus, which are 0. */
bool can_linux_unpack(const struct canfd_frame *in, size_t size, struct can_frame_rx *out);

/* Returns the size of the datagram. */
size_t can_linux_pack(const struct can_frame_rx *in, struct canfd_frame *out);

#endif
