#include "tools/sim/devices.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/base/log.h"

static int look_at(const char *path, bool *folder)
{
	struct stat info;
	if (stat(path, &info) < 0) {
		int status = -errno;
		log_error("%s: %s", path, strerror(-status));
		return status;
	}
	*folder = S_ISDIR(info.st_mode);
	return 0;
}

int devices_open(struct devices *devices, const char *gpio, const char *camera)
{
	bool folder;
	*devices = (struct devices){ .gpio = gpio, .camera = camera };
	int status = gpio ? look_at(gpio, &devices->folder) : 0;
	return status || !camera ? status : look_at(camera, &folder);
}

/* A pipe without a reader is not waited for. */
static bool write_text(const char *path, const char *text)
{
	int fd = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_APPEND);
	if (fd < 0)
		return false;
	bool good = write(fd, text, strlen(text)) == (ssize_t)strlen(text);
	close(fd);
	return good;
}

static void write_or_tell(bool *told, const char *path, const char *text)
{
	bool good = write_text(path, text);
	if (!good && !*told)
		log_warn("%s: %s", path, errno == ENXIO ? "nobody reads it" : strerror(errno));
	*told = !good;
}

static void pull(struct devices *devices, const char *name, bool on)
{
	char path[512];
	if (snprintf(path, sizeof(path), "%s/pin-%s", devices->gpio, name) < (int)sizeof(path))
		write_or_tell(&devices->told[0], path, on ? "pull-down" : "pull-up");
}

static void tell_script(struct devices *devices, const char *name, const char *what)
{
	char text[128];
	if (snprintf(text, sizeof(text), "0 %s %s\n", name, what) < (int)sizeof(text))
		write_or_tell(&devices->told[0], devices->gpio, text);
}

void devices_line(struct devices *devices, const char *name, bool on)
{
	if (!devices->gpio)
		return;
	if (devices->folder)
		pull(devices, name, on);
	else
		tell_script(devices, name, on ? "1" : "0");
}

static void chatter(struct devices *devices, const struct fault_event *event)
{
	if (!devices->gpio) {
		if (event->begins)
			log_warn("there is no board to chatter: --gpio PATH");
		return;
	}
	if (!devices->folder) {
		if (event->begins)
			tell_script(devices, event->target, "bounce 24");
		return;
	}
	if (!event->begins)
		pull(devices, devices->line, false);
	snprintf(devices->line, sizeof(devices->line), "%s", event->begins ? event->target : "");
}

void devices_fault(struct devices *devices, const struct fault_event *event)
{
	if (event->kind == FAULT_CHATTER)
		chatter(devices, event);
	if (event->kind != FAULT_CAMERA || !event->begins)
		return;
	char text[80];
	snprintf(text, sizeof(text), "%s %g\n", event->target, event->seconds > 0.0 ? event->seconds : 3600.0);
	if (devices->camera)
		write_or_tell(&devices->told[1], devices->camera, text);
	else
		log_warn("there is no camera to fault: --camera PATH");
}

void devices_step(struct devices *devices)
{
	if (!devices->line[0])
		return;
	devices->level = !devices->level;
	pull(devices, devices->line, devices->level);
}
