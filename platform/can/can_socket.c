/*
 * A CAN bus where the kernel has none: local sockets (SOCK_SEQPACKET) that carry what a raw CAN socket would. Who comes
 * first to `unix:PATH` makes the socket and passes frames on between the others, who come later; when it goes, the next
 * one takes its place. So programs may start, end and start again in any order, as on a real bus.
 *
 * Local sockets have no time stamps: a frame's time is that of reading it. A reader that is too slow loses frames,
 * which the writer counts; nothing ever waits.
 */
#include "platform/can/can_socket.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/can/can_linux.h"

#define PREFIX "unix:"
#define PEERS_MAX 8
#define LOOK_NS (250 * NS_PER_MS)
#define SEND_BYTES (1 << 20)

struct link {
	struct sockaddr_un address;
	socklen_t address_size;
	int listener; /* -1: somebody else made the socket, or nobody yet */
	ino_t inode;  /* of the socket file that we made */
	int peers[PEERS_MAX];
	unsigned peer_count;
	unsigned next_peer; /* to be read first, so that none starves the others */
};

struct can_socket {
	struct can_bus bus; /* first: a can_bus of ours is one of these */
	struct link links[CAN_BUS_MAX];
	int64_t looked_ns;
};

bool can_socket_is_address(const char *spec)
{
	const char *equals = strchr(spec, '='), *slash = strchr(spec, '/');
	if (equals && (!slash || equals < slash))
		spec = equals + 1;
	return !strncmp(spec, PREFIX, strlen(PREFIX));
}

static int parse_address(const char *spec, struct link *link)
{
	const char *path = strstr(spec, PREFIX);
	if (!path || !path[strlen(PREFIX)])
		return -EINVAL;
	path += strlen(PREFIX);
	size_t length = strlen(path);
	if (length >= sizeof(link->address.sun_path))
		return -ENAMETOOLONG;
	link->address.sun_family = AF_UNIX;
	memcpy(link->address.sun_path, path, length + 1);
	link->address_size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length + 1);
	if (path[0] == '@') { /* a name without a file */
		link->address.sun_path[0] = 0;
		link->address_size--;
	}
	return 0;
}

static bool has_file(const struct link *link)
{
	return link->address.sun_path[0] != 0;
}

static ino_t inode_of(const struct link *link)
{
	struct stat info;
	return stat(link->address.sun_path, &info) == 0 ? info.st_ino : 0;
}

static int open_socket(void)
{
	int bytes = SEND_BYTES, fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (fd >= 0)
		setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes)); /* as much of it as net.core.wmem_max allows */
	return fd;
}

/* Makes the socket. A file that a dead program left is replaced. */
static int become_first(struct link *link)
{
	int fd = open_socket();
	if (fd < 0)
		return -errno;
	if (has_file(link))
		unlink(link->address.sun_path);
	if (bind(fd, (struct sockaddr *)&link->address, link->address_size) < 0 || listen(fd, PEERS_MAX) < 0) {
		int status = -errno;
		close(fd);
		return status;
	}
	link->listener = fd;
	link->inode = has_file(link) ? inode_of(link) : 0;
	return 0;
}

static int attach(struct link *link)
{
	int fd = open_socket();
	if (fd < 0)
		return -errno;
	if (connect(fd, (struct sockaddr *)&link->address, link->address_size) == 0) {
		link->peers[link->peer_count++] = fd;
		return 0;
	}
	int status = -errno;
	close(fd);
	return status == -ECONNREFUSED || status == -ENOENT ? become_first(link) : status;
}

static void detach(struct link *link)
{
	for (unsigned i = 0; i < link->peer_count; i++)
		close(link->peers[i]);
	if (link->listener >= 0)
		close(link->listener);
	link->peer_count = 0;
	link->listener = -1;
}

static void lose_peer(struct can_socket *bus, uint8_t index, unsigned peer)
{
	struct link *link = &bus->links[index];
	close(link->peers[peer]);
	link->peers[peer] = link->peers[--link->peer_count];
	if (link->peer_count == 0)
		can_bus_note_health(&bus->bus, index, CAN_HEALTH_DOWN, clock_now_ns());
	bus->looked_ns = INT64_MIN;
}

static void take_callers(struct link *link)
{
	int fd;
	while (link->listener >= 0 && (fd = accept4(link->listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0) {
		int bytes = SEND_BYTES;
		setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
		if (link->peer_count < PEERS_MAX)
			link->peers[link->peer_count++] = fd;
		else
			close(fd);
	}
}

/* Now and then, and whenever somebody has left: is the socket still ours or theirs? */
static void look_at_links(struct can_socket *bus, int64_t now_ns)
{
	bus->looked_ns = now_ns;
	for (unsigned i = 0; i < bus->bus.interface_count; i++) {
		struct link *link = &bus->links[i];
		if (link->listener >= 0 && has_file(link) && inode_of(link) != link->inode)
			detach(link); /* the file was deleted, or another program has made it anew */
		if (link->listener < 0 && link->peer_count == 0 && attach(link) < 0)
			can_bus_note_health(&bus->bus, (uint8_t)i, CAN_HEALTH_DOWN, now_ns);
	}
}

static bool is_time_to_look(const struct can_socket *bus, int64_t now_ns)
{
	return bus->looked_ns == INT64_MIN || now_ns - bus->looked_ns >= LOOK_NS;
}

static void pass_on(struct link *link, int from, const struct canfd_frame *frame, size_t size)
{
	for (unsigned i = 0; i < link->peer_count && link->listener >= 0; i++)
		if (link->peers[i] != from)
			send(link->peers[i], frame, size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/* Returns how many frames were added. */
static int read_peer(struct can_socket *bus, uint8_t index, unsigned peer, struct can_frame_rx *frames, int capacity)
{
	struct link *link = &bus->links[index];
	int count = 0, fd = link->peers[peer];
	while (count < capacity) {
		struct canfd_frame frame;
		ssize_t n = recv(fd, &frame, sizeof(frame), MSG_DONTWAIT);
		if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
			lose_peer(bus, index, peer);
		}
		if (n <= 0)
			break;
		pass_on(link, fd, &frame, (size_t)n);
		if (!can_linux_unpack(&frame, (size_t)n, &frames[count]))
			continue;
		int64_t now_ns = clock_now_ns();
		frames[count].bus = index;
		frames[count].time_ns = now_ns > bus->bus.last_ns ? now_ns : bus->bus.last_ns;
		can_bus_note_frame(&bus->bus, &frames[count++]);
	}
	return count;
}

static int socket_read(struct can_bus *base, int64_t until_ns, struct can_frame_rx *frames, int capacity)
{
	struct can_socket *bus = (struct can_socket *)base;
	int64_t now_ns = clock_now_ns();
	int count = 0;
	(void)until_ns; /* nothing arrives from the future */
	base->wall_offset_ns = clock_wall_ns() - now_ns;
	if (is_time_to_look(bus, now_ns))
		look_at_links(bus, now_ns);
	for (unsigned i = 0; i < base->interface_count; i++) {
		struct link *link = &bus->links[i];
		take_callers(link);
		for (unsigned k = 0; k < link->peer_count && count < capacity; k++) {
			unsigned peer = (link->next_peer + k) % link->peer_count;
			count += read_peer(bus, (uint8_t)i, peer, frames + count, capacity - count);
		}
		link->next_peer = link->peer_count ? (link->next_peer + 1) % link->peer_count : 0;
	}
	return count;
}

static int socket_write(struct can_bus *base, const struct can_frame_rx *frame)
{
	struct can_socket *bus = (struct can_socket *)base;
	struct canfd_frame out;
	if (frame->bus >= base->interface_count)
		return -ENODEV;
	struct link *link = &bus->links[frame->bus];
	size_t size = can_linux_pack(frame, &out);
	unsigned full = 0;
	int64_t now_ns = clock_now_ns();
	if (is_time_to_look(bus, now_ns))
		look_at_links(bus, now_ns);
	take_callers(link);
	for (unsigned i = link->peer_count; i-- > 0;) {
		if (send(link->peers[i], &out, size, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0)
			continue;
		if (errno == EAGAIN)
			full++;
		else
			lose_peer(bus, frame->bus, i);
	}
	if (link->peer_count == 0)
		return -ENETDOWN;
	return full ? -ENOBUFS : 0;
}

static unsigned socket_fds(struct can_bus *base, int *fds, unsigned capacity)
{
	struct can_socket *bus = (struct can_socket *)base;
	unsigned count = 0;
	for (unsigned i = 0; i < base->interface_count; i++) {
		const struct link *link = &bus->links[i];
		if (link->listener >= 0 && count < capacity)
			fds[count++] = link->listener;
		for (unsigned k = 0; k < link->peer_count && count < capacity; k++)
			fds[count++] = link->peers[k];
	}
	return count;
}

static void socket_close(struct can_bus *base)
{
	struct can_socket *bus = (struct can_socket *)base;
	for (unsigned i = 0; i < base->interface_count; i++) {
		struct link *link = &bus->links[i];
		if (link->listener >= 0 && has_file(link) && inode_of(link) == link->inode)
			unlink(link->address.sun_path);
		detach(link);
	}
}

static int add_links(struct can_socket *bus, const struct can_bus_config *config)
{
	for (unsigned i = 0; i < config->interface_count; i++) {
		char name[CANDUMP_NAME_SIZE];
		can_bus_short_name(config->interfaces[i], name);
		if (can_bus_index_or_add(&bus->bus, name) != i)
			return -EINVAL;
		bus->links[i].listener = -1;
		int status = parse_address(config->interfaces[i], &bus->links[i]);
		if (status)
			return status;
	}
	return config->interface_count ? 0 : -EINVAL;
}

static int socket_open(const struct can_bus_config *config, struct arena *arena, struct can_bus **out)
{
	size_t mark = arena_mark(arena);
	struct can_socket *made = ARENA_ARRAY(arena, struct can_socket, 1);
	if (!made)
		return -ENOMEM;
	made->bus.ops = &can_socket_ops;
	made->bus.last_ns = INT64_MIN;
	int status = add_links(made, config);
	if (status) {
		arena_release(arena, mark);
		return status;
	}
	look_at_links(made, clock_now_ns());
	for (unsigned i = 0; i < made->bus.interface_count; i++)
		if (made->bus.interfaces[i].health == CAN_HEALTH_DOWN)
			log_warn("CAN %s cannot be opened; trying again", config->interfaces[i]);
	*out = &made->bus;
	return 0;
}

const struct can_bus_ops can_socket_ops = {
	.name = "socket",
	.open = socket_open,
	.read = socket_read,
	.write = socket_write,
	.fds = socket_fds,
	.close = socket_close,
};
