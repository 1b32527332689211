/* Buses on local sockets, see can_bus.h for how they are named. */
#ifndef BLVD_PLATFORM_CAN_CAN_SOCKET_H
#define BLVD_PLATFORM_CAN_CAN_SOCKET_H

#include "platform/can/can_bus.h"

/* Whether an interface is named by the address of a socket. */
bool can_socket_is_address(const char *spec);

#endif
