#include "platform/base/notify.h"

#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "platform/base/clock.h"

/* The manager's address: a path, or with an @ a name in the abstract namespace. Returns its length, 0 when it is no
 * address. */
static socklen_t read_address(struct sockaddr_un *out, const char *name)
{
	size_t length = strlen(name);
	if ((name[0] != '/' && name[0] != '@') || !name[1] || length >= sizeof(out->sun_path))
		return 0;
	*out = (struct sockaddr_un){ .sun_family = AF_UNIX };
	memcpy(out->sun_path, name, length + 1);
	bool abstract = name[0] == '@';
	if (abstract)
		out->sun_path[0] = '\0';
	return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length + !abstract);
}

static int64_t read_beat(void)
{
	const char *period = getenv("WATCHDOG_USEC");
	const char *pid = getenv("WATCHDOG_PID");
	if (!period || (pid && strtoll(pid, NULL, 10) != (long long)getpid()))
		return 0;
	char *end;
	errno = 0;
	long long us = strtoll(period, &end, 10);
	if (errno || *end || us <= 0 || us > LLONG_MAX / 1000)
		return 0;
	return us * 1000 / 2;
}

static void send_text(struct notify *notify, const char *text)
{
	if (notify->fd >= 0 && send(notify->fd, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
		notify->lost++;
}

int notify_open(struct notify *notify)
{
	*notify = (struct notify){ .fd = -1, .beat_ns = read_beat() };
	const char *name = getenv("NOTIFY_SOCKET");
	int status = 0;
	if (name) {
		struct sockaddr_un address;
		socklen_t length = read_address(&address, name);
		notify->fd = length ? socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0) : -1;
		if (!length)
			status = -EINVAL;
		else if (notify->fd < 0 || connect(notify->fd, (const struct sockaddr *)&address, length) < 0)
			status = -errno;
		if (status < 0 && notify->fd >= 0) {
			close(notify->fd);
			notify->fd = -1;
		}
	}
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	unsetenv("WATCHDOG_PID");
	return status;
}

void notify_ready(struct notify *notify, const char *status)
{
	if (notify->ready)
		return;
	char text[256];
	snprintf(text, sizeof(text), "READY=1%s%s", status ? "\nSTATUS=" : "", status ? status : "");
	send_text(notify, text);
	notify->ready = true;
}

void notify_alive(struct notify *notify, int64_t now_ns)
{
	if (!notify->ready || !notify->beat_ns || now_ns < notify->next_ns)
		return;
	send_text(notify, "WATCHDOG=1");
	notify->next_ns = now_ns + notify->beat_ns;
}

void notify_status(struct notify *notify, const char *status)
{
	char text[256];
	snprintf(text, sizeof(text), "STATUS=%s", status);
	send_text(notify, text);
}

void notify_close(struct notify *notify)
{
	if (notify->fd > 0) {
		send_text(notify, "STOPPING=1");
		close(notify->fd);
	}
	*notify = (struct notify){ .fd = -1 };
}
