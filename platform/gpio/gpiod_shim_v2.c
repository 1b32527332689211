/* libgpiod 2.x, as in Debian 13: a request outlives its chip, and events are numbered. */
#if BLVD_HAVE_GPIOD == 2
#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <stdio.h>

#include "platform/gpio/gpiod_shim.h"

#define KERNEL_EVENTS 256 /* that the kernel keeps for a line until they are read */

int gpiod_shim_init(struct gpiod_shim *shim, const char *consumer)
{
	*shim = (struct gpiod_shim){
		.consumer = consumer,
		.settings = gpiod_line_settings_new(),
		.config = gpiod_line_config_new(),
		.request_config = gpiod_request_config_new(),
		.events = gpiod_edge_event_buffer_new(GPIOD_SHIM_BATCH),
	};
	if (!shim->settings || !shim->config || !shim->request_config || !shim->events) {
		gpiod_shim_finish(shim);
		return -ENOMEM;
	}
	gpiod_request_config_set_consumer(shim->request_config, consumer);
	gpiod_request_config_set_event_buffer_size(shim->request_config, KERNEL_EVENTS);
	return 0;
}

void gpiod_shim_finish(struct gpiod_shim *shim)
{
	if (shim->events)
		gpiod_edge_event_buffer_free(shim->events);
	if (shim->request_config)
		gpiod_request_config_free(shim->request_config);
	if (shim->config)
		gpiod_line_config_free(shim->config);
	if (shim->settings)
		gpiod_line_settings_free(shim->settings);
	*shim = (struct gpiod_shim){ 0 };
}

int gpiod_shim_label(const char *path, char *label, size_t size)
{
	struct gpiod_chip *chip = gpiod_chip_open(path);
	if (!chip)
		return -errno;
	struct gpiod_chip_info *info = gpiod_chip_get_info(chip);
	int status = info ? 0 : -errno;
	if (info)
		snprintf(label, size, "%s", gpiod_chip_info_get_label(info));
	gpiod_chip_info_free(info);
	gpiod_chip_close(chip);
	return status;
}

static int configure(struct gpiod_shim *shim, const struct gpio_line_config *config)
{
	static const enum gpiod_line_bias biases[] = {
		[GPIO_BIAS_AS_IS] = GPIOD_LINE_BIAS_AS_IS,
		[GPIO_BIAS_PULL_UP] = GPIOD_LINE_BIAS_PULL_UP,
		[GPIO_BIAS_PULL_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
		[GPIO_BIAS_NONE] = GPIOD_LINE_BIAS_DISABLED,
	};
	struct gpiod_line_settings *settings = shim->settings;
	gpiod_line_settings_reset(settings);
	gpiod_line_config_reset(shim->config);
	gpiod_line_settings_set_active_low(settings, config->active_low);
	if (gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT) < 0 ||
		gpiod_line_settings_set_edge_detection(settings, GPIOD_LINE_EDGE_BOTH) < 0 ||
		gpiod_line_settings_set_bias(settings, biases[config->bias]) < 0 ||
		gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC) < 0 ||
		gpiod_line_config_add_line_settings(shim->config, &config->offset, 1, settings) < 0)
		return -errno;
	return 0;
}

int gpiod_shim_request(
	struct gpiod_shim *shim, const char *path, const struct gpio_line_config *config, struct gpiod_shim_line *line)
{
	int status = configure(shim, config);
	struct gpiod_chip *chip = status < 0 ? NULL : gpiod_chip_open(path);
	if (!chip)
		return status < 0 ? status : -errno;
	struct gpiod_line_request *request = gpiod_chip_request_lines(chip, shim->request_config, shim->config);
	status = request ? 0 : -errno;
	gpiod_chip_close(chip);
	if (request && fcntl(gpiod_line_request_get_fd(request), F_SETFL, O_NONBLOCK) < 0) {
		status = -errno;
		gpiod_line_request_release(request);
	}
	if (status == 0)
		*line = (struct gpiod_shim_line){ .request = request };
	return status;
}

void gpiod_shim_release(struct gpiod_shim_line *line)
{
	if (line->request)
		gpiod_line_request_release(line->request);
	*line = (struct gpiod_shim_line){ 0 };
}

int gpiod_shim_fd(const struct gpiod_shim_line *line)
{
	return gpiod_line_request_get_fd(line->request);
}

int gpiod_shim_level(const struct gpiod_shim_line *line)
{
	enum gpiod_line_value level;
	return gpiod_line_request_get_values(line->request, &level) < 0 ? -errno : level == GPIOD_LINE_VALUE_ACTIVE;
}

int gpiod_shim_read(struct gpiod_shim *shim, const struct gpiod_shim_line *line, struct gpiod_shim_event *events)
{
	int count = gpiod_line_request_read_edge_events(line->request, shim->events, GPIOD_SHIM_BATCH);
	if (count < 0)
		return errno == EAGAIN || errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count; i++) {
		struct gpiod_edge_event *event = gpiod_edge_event_buffer_get_event(shim->events, (unsigned long)i);
		events[i] = (struct gpiod_shim_event){
			.time_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(event),
			.level = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
			.number = (uint32_t)gpiod_edge_event_get_line_seqno(event),
		};
	}
	return count;
}

const char *gpiod_shim_name(void)
{
	static char name[32];
	snprintf(name, sizeof(name), "libgpiod %s", gpiod_api_version());
	return name;
}
#endif
