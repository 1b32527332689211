/*
 * CAN of the Linux kernel: one raw socket for all interfaces of the car, so that their frames arrive in one order.
 * It is not bound to an interface: one that goes away and comes back (a USB adapter, a driver reload) is heard again
 * without reopening. Frames of interfaces that nobody asked for are passed over.
 *
 * cangen into a slow reader lost a third of the frames with the default socket buffer: hence the large one, reading
 * in batches, and SO_RXQ_OVFL to know what was lost all the same. Whether interfaces are there and up is looked at four
 * times a second: asking costs microseconds and needs no right, where watching netlink would need one more kind of
 * socket in the sandbox.
 */
#include <errno.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/can/can_bus.h"
#include "platform/can/can_clock.h"
#include "platform/can/can_linux.h"

#define BATCH 64
#define LOOK_NS (250 * NS_PER_MS)
#define LOOK_AGAIN_NS (20 * NS_PER_MS) /* when a frame comes from an interface that is not known */
#define RECEIVE_BYTES (4 << 20)
#define CONTROL_SIZE (CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t)))

struct can_socket {
	struct can_bus bus; /* first: a can_bus of ours is one of these */
	int fd;
	int if_index[CAN_BUS_MAX]; /* 0: not there now */
	int64_t looked_ns;         /* at the interfaces */
	struct can_clock clock;
	uint32_t overflow; /* last count of the kernel, wraps */
	struct mmsghdr messages[BATCH];
	struct iovec vectors[BATCH];
	struct sockaddr_can addresses[BATCH];
	struct canfd_frame frames[BATCH];
	_Alignas(struct cmsghdr) char controls[BATCH][CONTROL_SIZE];
};

/* Finds out whether each interface is there and up. Returns -ENODEV for one that is no CAN interface. */
static int look_at_interfaces(struct can_socket *socket, int64_t now_ns)
{
	struct can_bus *bus = &socket->bus;
	socket->looked_ns = now_ns;
	for (unsigned i = 0; i < bus->interface_count; i++) {
		struct ifreq request = { 0 };
		memcpy(request.ifr_name, bus->interfaces[i].name, sizeof(bus->interfaces[i].name));
		socket->if_index[i] = 0;
		if (ioctl(socket->fd, SIOCGIFHWADDR, &request) == 0 && request.ifr_hwaddr.sa_family != ARPHRD_CAN)
			return -ENODEV;
		if (ioctl(socket->fd, SIOCGIFINDEX, &request) == 0)
			socket->if_index[i] = request.ifr_ifindex;
		bool up = socket->if_index[i] && ioctl(socket->fd, SIOCGIFFLAGS, &request) == 0 && request.ifr_flags & IFF_UP;
		if (!up)
			can_bus_note_health(bus, (uint8_t)i, CAN_HEALTH_DOWN, now_ns);
		else if (bus->interfaces[i].health == CAN_HEALTH_DOWN)
			can_bus_note_health(bus, (uint8_t)i, CAN_HEALTH_UNKNOWN, now_ns);
	}
	return 0;
}

static uint8_t find_index(const struct can_socket *socket, int if_index)
{
	for (unsigned i = 0; i < socket->bus.interface_count; i++)
		if (socket->if_index[i] == if_index)
			return (uint8_t)i;
	return CAN_BUS_NONE;
}

/* One that was deleted and made again has another index: its first frame is not to be lost. */
static uint8_t bus_of(struct can_socket *socket, int if_index, int64_t now_ns)
{
	uint8_t bus = find_index(socket, if_index);
	if (bus != CAN_BUS_NONE || now_ns - socket->looked_ns < LOOK_AGAIN_NS)
		return bus;
	look_at_interfaces(socket, now_ns);
	return find_index(socket, if_index);
}

static void want_receive_buffer(int fd, int bytes)
{
	/* FORCE goes beyond net.core.rmem_max and needs CAP_NET_ADMIN */
	if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof(bytes)) == 0)
		return;
	int got = 0;
	socklen_t size = sizeof(got);
	setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
	getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &got, &size);
	if (got / 2 < bytes) /* the kernel doubles it for its own use */
		log_warn("CAN receive buffer is %d KiB, not %d: raise net.core.rmem_max", got / 2048, bytes / 1024);
}

/* More than the kernel takes means no filter: we pass over the rest ourselves. */
static int want_filters(int fd, const struct can_bus_config *config)
{
	struct can_filter filters[CAN_RAW_FILTER_MAX];
	if (config->filter_count == 0 || config->filter_count > CAN_RAW_FILTER_MAX)
		return 0;
	for (unsigned i = 0; i < config->filter_count; i++) {
		bool extended = config->filters[i].extended;
		filters[i].can_id = config->filters[i].id | (extended ? CAN_EFF_FLAG : 0);
		uint32_t bits = extended ? CAN_EFF_MASK : CAN_SFF_MASK, mask = config->filters[i].mask;
		filters[i].can_mask = (mask ? mask & bits : bits) | CAN_EFF_FLAG | CAN_RTR_FLAG;
	}
	socklen_t size = (socklen_t)(config->filter_count * sizeof(*filters));
	return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters, size) < 0 ? -errno : 0;
}

static int set_up(struct can_socket *socket, const struct can_bus_config *config)
{
	int on = 1;
	can_err_mask_t errors = CAN_ERR_MASK;
	struct sockaddr_can any = { .can_family = AF_CAN };
	int fd = socket->fd;
	if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors)) < 0 ||
		setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) < 0 ||
		setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on)) < 0)
		return -errno;
	if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) < 0)
		log_warn("CAN: kernel without FD frames, classic only");
	want_receive_buffer(fd, config->receive_bytes > 0 ? config->receive_bytes : RECEIVE_BYTES);
	int status = want_filters(fd, config);
	if (status)
		return status;
	return bind(fd, (struct sockaddr *)&any, sizeof(any)) < 0 ? -errno : 0;
}

static void prepare_messages(struct can_socket *socket)
{
	for (int i = 0; i < BATCH; i++) {
		socket->vectors[i] = (struct iovec){ &socket->frames[i], sizeof(socket->frames[i]) };
		socket->messages[i].msg_hdr = (struct msghdr){
			.msg_name = &socket->addresses[i],
			.msg_namelen = sizeof(socket->addresses[i]),
			.msg_iov = &socket->vectors[i],
			.msg_iovlen = 1,
			.msg_control = socket->controls[i],
			.msg_controllen = CONTROL_SIZE,
		};
	}
}

static void read_controls(struct can_socket *socket, struct msghdr *header, int64_t *wall_ns)
{
	for (struct cmsghdr *control = CMSG_FIRSTHDR(header); control; control = CMSG_NXTHDR(header, control)) {
		if (control->cmsg_level != SOL_SOCKET)
			continue;
		struct timespec stamp;
		uint32_t overflow;
		if (control->cmsg_type == SCM_TIMESTAMPNS) {
			memcpy(&stamp, CMSG_DATA(control), sizeof(stamp));
			*wall_ns = stamp.tv_sec * NS_PER_S + stamp.tv_nsec;
		} else if (control->cmsg_type == SO_RXQ_OVFL) {
			memcpy(&overflow, CMSG_DATA(control), sizeof(overflow));
			socket->bus.stats.dropped += (uint32_t)(overflow - socket->overflow);
			socket->overflow = overflow;
		}
	}
}

/* One batch. Returns how many messages came, or -errno; the frames of ours among them are added to `frames`. */
static int read_batch(struct can_socket *socket, struct can_frame_rx *frames, int capacity, int *count)
{
	prepare_messages(socket);
	int room = capacity - *count < BATCH ? capacity - *count : BATCH;
	int n = recvmmsg(socket->fd, socket->messages, (unsigned)room, MSG_DONTWAIT, NULL);
	if (n < 0)
		return -errno;
	int64_t wall_ns = clock_wall_ns(), now_ns = clock_now_ns();
	can_clock_set(&socket->clock, wall_ns, now_ns);
	socket->bus.wall_offset_ns = wall_ns - now_ns;
	for (int i = 0; i < n; i++) {
		int64_t stamp_ns = wall_ns;
		struct can_frame_rx frame;
		read_controls(socket, &socket->messages[i].msg_hdr, &stamp_ns);
		if (!can_linux_unpack(&socket->frames[i], socket->messages[i].msg_len, &frame))
			continue;
		frame.bus = bus_of(socket, socket->addresses[i].can_ifindex, now_ns);
		if (frame.bus == CAN_BUS_NONE)
			continue;
		frame.time_ns = can_clock_time(&socket->clock, stamp_ns, now_ns);
		can_bus_note_frame(&socket->bus, &frame);
		frames[(*count)++] = frame;
	}
	return n;
}

static int socketcan_read(struct can_bus *bus, int64_t until_ns, struct can_frame_rx *frames, int capacity)
{
	struct can_socket *socket = (struct can_socket *)bus;
	int count = 0;
	(void)until_ns; /* nothing arrives from the future */
	if (clock_now_ns() - socket->looked_ns >= LOOK_NS)
		look_at_interfaces(socket, clock_now_ns());
	while (count < capacity) {
		int n = read_batch(socket, frames, capacity, &count);
		if (n == -ENETDOWN || n == -ENODEV) { /* told once by an interface that went away */
			look_at_interfaces(socket, clock_now_ns());
			break;
		}
		if (n == 0 || n == -EAGAIN || n == -EINTR)
			break;
		if (n < 0)
			return count ? count : n;
	}
	return count;
}

static int socketcan_write(struct can_bus *bus, const struct can_frame_rx *frame)
{
	struct can_socket *socket = (struct can_socket *)bus;
	if (frame->bus >= bus->interface_count || !socket->if_index[frame->bus])
		return -ENODEV;
	struct canfd_frame out;
	struct sockaddr_can to = { .can_family = AF_CAN, .can_ifindex = socket->if_index[frame->bus] };
	size_t size = can_linux_pack(frame, &out);
	ssize_t n = sendto(socket->fd, &out, size, MSG_DONTWAIT, (struct sockaddr *)&to, sizeof(to));
	if (n == (ssize_t)size)
		return 0;
	return n < 0 ? -errno : -EIO;
}

static unsigned socketcan_fds(struct can_bus *bus, int *fds, unsigned capacity)
{
	if (capacity == 0)
		return 0;
	fds[0] = ((struct can_socket *)bus)->fd;
	return 1;
}

static void socketcan_close(struct can_bus *bus)
{
	struct can_socket *socket = (struct can_socket *)bus;
	if (socket->fd >= 0)
		close(socket->fd);
	socket->fd = -1;
}

static int add_interfaces(struct can_socket *socket, const struct can_bus_config *config)
{
	for (unsigned i = 0; i < config->interface_count; i++)
		if (can_bus_index_or_add(&socket->bus, config->interfaces[i]) == CAN_BUS_NONE)
			return -EINVAL;
	if (socket->bus.interface_count == 0)
		return -EINVAL;
	int status = look_at_interfaces(socket, clock_now_ns());
	for (unsigned i = 0; i < socket->bus.interface_count && !status; i++)
		if (socket->bus.interfaces[i].health == CAN_HEALTH_DOWN)
			log_warn("CAN interface %s is not up; waiting for it", socket->bus.interfaces[i].name);
	return status;
}

static int socketcan_open(const struct can_bus_config *config, struct arena *arena, struct can_bus **out)
{
	size_t mark = arena_mark(arena);
	struct can_socket *made = ARENA_ARRAY(arena, struct can_socket, 1);
	if (!made)
		return -ENOMEM;
	int status = 0;
	made->bus.ops = &can_socketcan_ops;
	made->bus.last_ns = INT64_MIN;
	can_clock_init(&made->clock, clock_wall_ns(), clock_now_ns());
	made->fd = socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
	if (made->fd < 0) {
		status = -errno;
		goto err_release;
	}
	status = set_up(made, config);
	if (!status)
		status = add_interfaces(made, config);
	if (status)
		goto err_close;
	*out = &made->bus;
	return 0;
err_close:
	close(made->fd);
err_release:
	arena_release(arena, mark);
	return status;
}

const struct can_bus_ops can_socketcan_ops = {
	.name = "socketcan",
	.open = socketcan_open,
	.read = socketcan_read,
	.write = socketcan_write,
	.fds = socketcan_fds,
	.close = socketcan_close,
};
