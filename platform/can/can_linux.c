#include "platform/can/can_linux.h"

#include <string.h>

bool can_linux_unpack(const struct canfd_frame *in, size_t size, struct can_frame_rx *out)
{
	bool fd = size == CANFD_MTU;
	unsigned limit = fd ? CAN_FRAME_DATA_MAX : 8;
	*out = (struct can_frame_rx){ 0 };
	if (size != CAN_MTU && size != CANFD_MTU)
		return false;
	out->len = (uint8_t)(in->len < limit ? in->len : limit);
	if (fd) {
		out->flags |= CAN_FRAME_FD;
		out->fd_flags = in->flags & 15;
	} else {
		out->raw_dlc = ((const struct can_frame *)(const void *)in)->len8_dlc;
	}
	if (in->can_id & CAN_ERR_FLAG) {
		out->flags |= CAN_FRAME_ERROR;
		out->id = in->can_id & CAN_ERR_MASK;
	} else if (in->can_id & CAN_EFF_FLAG) {
		out->flags |= CAN_FRAME_EXT;
		out->id = in->can_id & CAN_EFF_MASK;
	} else {
		out->id = in->can_id & CAN_SFF_MASK;
	}
	if (in->can_id & CAN_RTR_FLAG && !(in->can_id & CAN_ERR_FLAG))
		out->flags |= CAN_FRAME_REMOTE;
	else
		memcpy(out->data, in->data, out->len);
	return true;
}

size_t can_linux_pack(const struct can_frame_rx *in, struct canfd_frame *out)
{
	bool fd = in->flags & CAN_FRAME_FD;
	*out = (struct canfd_frame){ .can_id = in->id, .len = in->len };
	if (fd)
		out->flags = in->fd_flags & 15;
	else
		((struct can_frame *)(void *)out)->len8_dlc = in->raw_dlc;
	if (in->flags & CAN_FRAME_ERROR)
		out->can_id |= CAN_ERR_FLAG;
	else if (in->flags & CAN_FRAME_EXT)
		out->can_id |= CAN_EFF_FLAG;
	if (in->flags & CAN_FRAME_REMOTE)
		out->can_id |= CAN_RTR_FLAG;
	memcpy(out->data, in->data, in->len);
	return fd ? CANFD_MTU : CAN_MTU;
}
