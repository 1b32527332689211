/*
 * gpsd's socket: connects, asks to be told, takes lines. Nothing waits: a connection is under way or not, a line is
 * whole or not. Lost connections are tried again, the longer the more often they failed, at most every 8 s.
 */
#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/gnss/gnss.h"

#define PORT "2947"
#define LINE_MAX_BYTES 2048
#define READ_MAX_BYTES (64 << 10) /* at once: a flood does not stop the frames */
#define RETRY_FIRST_NS (500 * NS_PER_MS)
#define RETRY_MOST_NS (8 * NS_PER_S)
#define CONNECT_NS (5 * NS_PER_S)
#define SILENCE_NS (10 * NS_PER_S) /* gpsd says something every second */
#define FIX_TIMEOUT_NS (3 * NS_PER_S)

struct gpsd {
	struct gnss gnss; /* first: a gnss of ours is one of these */
	struct sockaddr_storage address;
	socklen_t address_size;
	int fd; /* -1: none */
	bool connected, told;
	int64_t since_ns; /* of the connection, or its beginning */
	int64_t heard_ns; /* last byte */
	int64_t fix_ns;
	int64_t retry_ns, pause_ns;
	char line[LINE_MAX_BYTES];
	size_t length;
	bool overlong;
};

static void drop(struct gpsd *gpsd, int64_t now_ns, const char *why)
{
	if (gpsd->fd >= 0)
		close(gpsd->fd);
	if (gpsd->connected || !gpsd->told)
		log_info("gpsd: %s; trying again", why);
	gpsd->told = true;
	gpsd->fd = -1;
	gpsd->connected = false;
	gpsd->length = 0;
	gpsd->overlong = false;
	gpsd->gnss.state = GNSS_AWAY;
	gpsd->retry_ns = now_ns + gpsd->pause_ns;
	gpsd->pause_ns = gpsd->pause_ns * 2 < RETRY_MOST_NS ? gpsd->pause_ns * 2 : RETRY_MOST_NS;
}

static void begin_connecting(struct gpsd *gpsd, int64_t now_ns)
{
	gpsd->since_ns = now_ns;
	gpsd->fd = socket(gpsd->address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (gpsd->fd < 0 ||
		(connect(gpsd->fd, (struct sockaddr *)&gpsd->address, gpsd->address_size) < 0 && errno != EINPROGRESS))
		drop(gpsd, now_ns, strerror(errno));
}

static void go_on_connecting(struct gpsd *gpsd, int64_t now_ns)
{
	static const char watch[] = "?WATCH={\"enable\":true,\"json\":true}\n";
	struct pollfd polled = { .fd = gpsd->fd, .events = POLLOUT };
	int error = 0;
	socklen_t size = sizeof(error);
	if (poll(&polled, 1, 0) == 0) {
		if (now_ns - gpsd->since_ns > CONNECT_NS)
			drop(gpsd, now_ns, "no answer");
		return;
	}
	getsockopt(gpsd->fd, SOL_SOCKET, SO_ERROR, &error, &size);
	if (!error && send(gpsd->fd, watch, sizeof(watch) - 1, MSG_NOSIGNAL) != (ssize_t)sizeof(watch) - 1)
		error = errno ? errno : EIO;
	if (error) {
		drop(gpsd, now_ns, strerror(error));
		return;
	}
	gpsd->connected = true;
	gpsd->told = false;
	gpsd->heard_ns = now_ns;
	gpsd->gnss.state = GNSS_WAITING;
	gpsd->gnss.stats.connections++;
}

static bool take_line(struct gpsd *gpsd, int64_t now_ns, struct gnss_fix *out)
{
	struct gnss_fix fix;
	bool whole = !gpsd->overlong;
	size_t length = gpsd->length;
	gpsd->length = 0;
	gpsd->overlong = false;
	gpsd->gnss.stats.lines++;
	if (!whole || (length > 0 && gpsd->line[0] != '{')) {
		gpsd->gnss.stats.bad++;
		return false;
	}
	enum gnss_line kind = gnss_parse(gpsd->line, length, &fix);
	if (kind == GNSS_LINE_NO_FIX)
		gpsd->gnss.state = GNSS_NO_FIX;
	if (kind != GNSS_LINE_FIX)
		return false;
	gpsd->pause_ns = RETRY_FIRST_NS; /* it is a receiver that works */
	gpsd->gnss.state = GNSS_GOOD;
	gpsd->gnss.stats.fixes++;
	gpsd->fix_ns = now_ns;
	*out = fix;
	out->time_ns = now_ns;
	return true;
}

static bool take_bytes(struct gpsd *gpsd, const char *bytes, size_t count, int64_t now_ns, struct gnss_fix *out)
{
	bool any = false;
	for (size_t i = 0; i < count; i++) {
		if (bytes[i] == '\n')
			any |= take_line(gpsd, now_ns, out);
		else if (gpsd->length < sizeof(gpsd->line))
			gpsd->line[gpsd->length++] = bytes[i];
		else
			gpsd->overlong = true;
	}
	return any;
}

static bool read_lines(struct gpsd *gpsd, int64_t now_ns, struct gnss_fix *out)
{
	char bytes[4096];
	bool any = false;
	for (size_t total = 0; total < READ_MAX_BYTES;) {
		ssize_t n = recv(gpsd->fd, bytes, sizeof(bytes), MSG_DONTWAIT);
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0 && errno == EAGAIN)
			break;
		if (n <= 0) {
			drop(gpsd, now_ns, n == 0 ? "it has closed the connection" : strerror(errno));
			return any;
		}
		total += (size_t)n;
		gpsd->heard_ns = now_ns;
		any |= take_bytes(gpsd, bytes, (size_t)n, now_ns, out);
	}
	return any;
}

static bool gpsd_read(struct gnss *gnss, int64_t now_ns, struct gnss_fix *out)
{
	struct gpsd *gpsd = (struct gpsd *)gnss;
	if (gpsd->fd < 0 && now_ns >= gpsd->retry_ns)
		begin_connecting(gpsd, now_ns);
	if (gpsd->fd >= 0 && !gpsd->connected)
		go_on_connecting(gpsd, now_ns);
	if (!gpsd->connected)
		return false;
	bool any = read_lines(gpsd, now_ns, out);
	if (gpsd->connected && now_ns - gpsd->heard_ns > SILENCE_NS)
		drop(gpsd, now_ns, "silent for 10 s");
	if (gnss->state == GNSS_GOOD && now_ns - gpsd->fix_ns > FIX_TIMEOUT_NS)
		gnss->state = GNSS_NO_FIX;
	return any;
}

static void gpsd_close(struct gnss *gnss)
{
	struct gpsd *gpsd = (struct gpsd *)gnss;
	if (gpsd->fd >= 0)
		close(gpsd->fd);
	gpsd->fd = -1;
}

/* "HOST:PORT", "[::1]:2947", "HOST", "". */
static bool split(const char *source, char host[256], char port[16])
{
	const char *colon = strrchr(source, ':'), *bracket = strchr(source, ']');
	if (colon && bracket && colon < bracket)
		colon = NULL;
	size_t length = colon ? (size_t)(colon - source) : strlen(source);
	snprintf(port, 16, "%s", colon ? colon + 1 : PORT);
	if (length > 1 && source[0] == '[' && source[length - 1] == ']') {
		source++;
		length -= 2;
	}
	if (length >= 256 || !port[0])
		return false;
	snprintf(host, 256, "%.*s", (int)length, length ? source : "");
	return true;
}

static int look_up(struct gpsd *gpsd, const char *source)
{
	struct addrinfo hints = { .ai_socktype = SOCK_STREAM }, *found = NULL;
	char host[256], port[16];
	int err = split(source, host, port) ? getaddrinfo(host[0] ? host : "localhost", port, &hints, &found) : EAI_NONAME;
	if (err) {
		log_error("gpsd at '%s': %s", source, gai_strerror(err));
		return -EHOSTUNREACH;
	}
	memcpy(&gpsd->address, found->ai_addr, found->ai_addrlen);
	gpsd->address_size = found->ai_addrlen;
	freeaddrinfo(found);
	return 0;
}

static int gpsd_open(const struct gnss_config *config, struct arena *arena, struct gnss **out)
{
	struct gpsd *made = ARENA_ARRAY(arena, struct gpsd, 1);
	if (!made)
		return -ENOMEM;
	made->gnss.ops = &gnss_gpsd_ops;
	made->fd = -1;
	made->pause_ns = RETRY_FIRST_NS;
	made->retry_ns = INT64_MIN;
	int status = look_up(made, config->source);
	if (!status)
		*out = &made->gnss;
	return status;
}

const struct gnss_ops gnss_gpsd_ops = {
	.name = "gpsd",
	.open = gpsd_open,
	.read = gpsd_read,
	.close = gpsd_close,
};
