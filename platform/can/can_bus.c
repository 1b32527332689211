/* What both implementations share: names, counts, and what error frames mean. */
#include "platform/can/can_bus.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>

/* Error classes and details as in linux/can/error.h; kept here so that logs replay on any system. */
#define ERROR_CONTROLLER 0x004u
#define ERROR_BUS_OFF 0x040u
#define ERROR_RESTARTED 0x100u
#define DETAIL_WARNING 0x0Cu /* receive or transmit */
#define DETAIL_PASSIVE 0x30u
#define DETAIL_ACTIVE 0x40u

#define QUIET_NS INT64_C(2000000000) /* without an error frame all is well again */

int can_bus_write(struct can_bus *bus, const struct can_frame_rx *frame)
{
	return bus->ops->write ? bus->ops->write(bus, frame) : -EOPNOTSUPP;
}

void can_bus_close(struct can_bus *bus)
{
	if (bus)
		bus->ops->close(bus);
}

uint8_t can_bus_index(const struct can_bus *bus, const char *name)
{
	for (unsigned i = 0; i < bus->interface_count; i++)
		if (!strcmp(bus->interfaces[i].name, name))
			return (uint8_t)i;
	return CAN_BUS_NONE;
}

uint8_t can_bus_index_or_add(struct can_bus *bus, const char *name)
{
	uint8_t found = can_bus_index(bus, name);
	size_t length = strlen(name);
	if (found != CAN_BUS_NONE || bus->interface_count == CAN_BUS_MAX || length >= CANDUMP_NAME_SIZE)
		return found;
	struct can_interface *interface = &bus->interfaces[bus->interface_count];
	*interface = (struct can_interface){ .heard_ns = INT64_MIN };
	memcpy(interface->name, name, length);
	return (uint8_t)bus->interface_count++;
}

void can_bus_short_name(const char *spec, char out[CANDUMP_NAME_SIZE])
{
	const char *equals = strchr(spec, '='), *colon = strchr(spec, ':');
	size_t length = strlen(spec);
	if (equals) {
		length = (size_t)(equals - spec);
	} else if (colon) {
		const char *slash = strrchr(spec, '/');
		spec = slash ? slash + 1 : colon + 1;
		spec += *spec == '@';
		length = strcspn(spec, ".");
	}
	if (length >= CANDUMP_NAME_SIZE)
		length = CANDUMP_NAME_SIZE - 1;
	for (size_t i = 0; i < length; i++)
		out[i] = isgraph((unsigned char)spec[i]) ? spec[i] : '_';
	out[length] = 0;
}

void can_bus_note_health(struct can_bus *bus, uint8_t index, enum can_health health, int64_t time_ns)
{
	struct can_interface *interface = &bus->interfaces[index];
	if (interface->health == health)
		return;
	interface->health = health;
	interface->health_ns = time_ns;
}

static enum can_health health_told(const struct can_frame_rx *frame, enum can_health before)
{
	unsigned detail = frame->len > 1 ? frame->data[1] : 0;
	if (frame->id & ERROR_BUS_OFF)
		return CAN_HEALTH_OFF;
	if (frame->id & ERROR_RESTARTED)
		return CAN_HEALTH_ACTIVE;
	if (!(frame->id & ERROR_CONTROLLER))
		return before;
	if (detail & DETAIL_PASSIVE)
		return CAN_HEALTH_PASSIVE;
	if (detail & DETAIL_WARNING)
		return CAN_HEALTH_WARNING;
	return detail & DETAIL_ACTIVE ? CAN_HEALTH_ACTIVE : before;
}

void can_bus_note_frame(struct can_bus *bus, const struct can_frame_rx *frame)
{
	struct can_interface *interface = &bus->interfaces[frame->bus];
	bus->stats.frames++;
	bus->last_ns = frame->time_ns;
	enum can_health health = interface->health;
	if (frame->flags & CAN_FRAME_ERROR) {
		interface->error_frames++;
		interface->error_ns = frame->time_ns;
		health = health_told(frame, health);
	} else {
		interface->frames++;
		interface->heard_ns = frame->time_ns;
		/* A controller that is off or an interface that is down hears nothing; and not every driver tells when errors
		 * have become fewer. */
		bool quiet = interface->error_frames == 0 || frame->time_ns - interface->error_ns > QUIET_NS;
		if (health == CAN_HEALTH_UNKNOWN || health == CAN_HEALTH_OFF || health == CAN_HEALTH_DOWN || quiet)
			health = CAN_HEALTH_ACTIVE;
	}
	can_bus_note_health(bus, frame->bus, health, frame->time_ns);
}

const char *can_health_name(enum can_health health)
{
	static const char *const names[] = { "not heard", "active", "warning", "passive", "bus off", "down" };
	return (unsigned)health < sizeof(names) / sizeof(*names) ? names[health] : "?";
}
