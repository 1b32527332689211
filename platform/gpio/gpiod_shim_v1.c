/* libgpiod 1.x, as in Debian 12: chips own lines, a line is its own request. */
#if BLVD_HAVE_GPIOD == 1
#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <stdio.h>

#include "platform/base/clock.h"
#include "platform/gpio/gpiod_shim.h"

int gpiod_shim_init(struct gpiod_shim *shim, const char *consumer)
{
	*shim = (struct gpiod_shim){ .consumer = consumer };
	return 0;
}

void gpiod_shim_finish(struct gpiod_shim *shim)
{
	*shim = (struct gpiod_shim){ 0 };
}

int gpiod_shim_label(const char *path, char *label, size_t size)
{
	struct gpiod_chip *chip = gpiod_chip_open(path);
	if (!chip)
		return -errno;
	snprintf(label, size, "%s", gpiod_chip_label(chip));
	gpiod_chip_close(chip);
	return 0;
}

static int flags_of(const struct gpio_line_config *config)
{
	static const int biases[] = {
		[GPIO_BIAS_AS_IS] = 0,
		[GPIO_BIAS_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
		[GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
		[GPIO_BIAS_NONE] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
	};
	return biases[config->bias] | (config->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0);
}

int gpiod_shim_request(
	struct gpiod_shim *shim, const char *path, const struct gpio_line_config *config, struct gpiod_shim_line *line)
{
	int status;
	struct gpiod_chip *chip = gpiod_chip_open(path);
	if (!chip)
		return -errno;
	struct gpiod_line *made = gpiod_chip_get_line(chip, config->offset);
	if (!made || gpiod_line_request_both_edges_events_flags(made, shim->consumer, flags_of(config)) < 0 ||
		fcntl(gpiod_line_event_get_fd(made), F_SETFL, O_NONBLOCK) < 0) {
		status = -errno;
		gpiod_chip_close(chip);
		return status;
	}
	*line = (struct gpiod_shim_line){ .chip = chip, .request = made };
	return 0;
}

void gpiod_shim_release(struct gpiod_shim_line *line)
{
	if (line->chip)
		gpiod_chip_close(line->chip); /* and its lines */
	*line = (struct gpiod_shim_line){ 0 };
}

int gpiod_shim_fd(const struct gpiod_shim_line *line)
{
	return gpiod_line_event_get_fd(line->request);
}

int gpiod_shim_level(const struct gpiod_shim_line *line)
{
	int level = gpiod_line_get_value(line->request);
	return level < 0 ? -errno : level;
}

int gpiod_shim_read(struct gpiod_shim *shim, const struct gpiod_shim_line *line, struct gpiod_shim_event *events)
{
	(void)shim;
	struct gpiod_line_event taken[GPIOD_SHIM_BATCH];
	int count = gpiod_line_event_read_fd_multiple(gpiod_shim_fd(line), taken, GPIOD_SHIM_BATCH);
	if (count < 0)
		return errno == EAGAIN || errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count; i++)
		events[i] = (struct gpiod_shim_event){
			.time_ns = taken[i].ts.tv_sec * NS_PER_S + taken[i].ts.tv_nsec,
			.level = taken[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE,
		};
	return count;
}

const char *gpiod_shim_name(void)
{
	static char name[32];
	snprintf(name, sizeof(name), "libgpiod %s", gpiod_version_string());
	return name;
}
#endif
