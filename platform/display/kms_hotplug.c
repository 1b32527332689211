/*
 * Panels that come and go: the kernel broadcasts a message ("change@/devices/...", then KEY=VALUE, each ended by a NUL)
 * on a netlink socket, which needs neither a daemon nor a library. Where the socket is refused, the panel is asked
 * every two seconds.
 */
#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/display/kms.h"

#define ASK_NS (2 * NS_PER_S)
#define GROUP_KERNEL 1

void kms_hotplug_open(struct kms_hotplug *hotplug)
{
	struct sockaddr_nl address = { .nl_family = AF_NETLINK, .nl_groups = GROUP_KERNEL };
	*hotplug = (struct kms_hotplug){ .fd = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK,
										 NETLINK_KOBJECT_UEVENT) };
	if (hotplug->fd >= 0 && bind(hotplug->fd, (struct sockaddr *)&address, sizeof(address))) {
		close(hotplug->fd);
		hotplug->fd = -1;
	}
	if (hotplug->fd < 0)
		log_debug("no messages of the kernel (%s): the panel is asked every 2 s", strerror(errno));
}

void kms_hotplug_close(struct kms_hotplug *hotplug)
{
	if (hotplug->fd >= 0)
		close(hotplug->fd);
	*hotplug = (struct kms_hotplug){ .fd = -1 };
}

static bool has_word(const char *message, size_t size, const char *word)
{
	size_t length = strlen(word) + 1; /* with its NUL */
	for (size_t at = 0; at + length <= size; at++)
		if (!memcmp(message + at, word, length) && (at == 0 || !message[at - 1]))
			return true;
	return false;
}

/* Reads all messages; true when one is about DRM. Only the kernel itself (port 0) is believed. */
static bool read_messages(int fd)
{
	char message[4096];
	bool drm = false;
	for (;;) {
		struct sockaddr_nl from = { 0 };
		socklen_t from_size = sizeof(from);
		ssize_t size = recvfrom(fd, message, sizeof(message), 0, (struct sockaddr *)&from, &from_size);
		if (size < 0 && errno == ENOBUFS)
			drm = true; /* some were lost: it may have been among them */
		else if (size < 0)
			return drm;
		else if (from.nl_pid == 0)
			drm = drm || has_word(message, (size_t)size, "SUBSYSTEM=drm");
	}
}

bool kms_hotplug_poll(struct kms_hotplug *hotplug, int64_t now_ns)
{
	if (hotplug->fd >= 0)
		return read_messages(hotplug->fd);
	if (!hotplug->asked_ns) /* the start has asked */
		hotplug->asked_ns = now_ns;
	if (now_ns - hotplug->asked_ns < ASK_NS)
		return false;
	hotplug->asked_ns = now_ns;
	return true;
}
