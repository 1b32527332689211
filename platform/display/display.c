/* What all displays share: the choice by name and the ring of events. */
#include "platform/display/display.h"

#include <string.h>

#include "platform/display/shader_cache.h"

const struct display_ops *display_by_name(const char *name)
{
	static const struct display_ops *const all[] = {
		&display_surfaceless,
#ifdef BLVD_HAVE_GLFW
		&display_window,
#endif
#ifdef BLVD_HAVE_KMS
		&display_kms,
#endif
	};
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		if (!strcmp(all[i]->name, name))
			return all[i];
	return NULL;
}

int display_open(struct display *display, const struct display_ops *ops, const struct display_config *config)
{
	*display = (struct display){ .ops = ops, .width = config->width, .height = config->height, .dim = 1.0f };
	shader_cache_check();
	int err = ops->open(display, config);
	shader_cache_reserve();
	if (err)
		*display = (struct display){ 0 };
	return err;
}

void display_close(struct display *display)
{
	if (display->ops)
		display->ops->close(display);
	*display = (struct display){ 0 };
}

int display_use(struct display *display)
{
	return display->ops->use(display);
}

int display_present(struct display *display)
{
	return display->ops->present(display);
}

int display_show_pixels(struct display *display, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	return display->ops->show_pixels(display, rgba, width, height);
}

void display_set_brightness(struct display *display, float level)
{
	level = level < 0.0f ? 0.0f : level > 1.0f ? 1.0f : level;
	if (display->ops->set_brightness)
		display->ops->set_brightness(display, level);
	else
		display->dim = level;
}

void display_push(struct display *display, const struct display_event *event)
{
	if (display->event_count == DISPLAY_EVENTS_MAX) {
		display->event_first = (display->event_first + 1) % DISPLAY_EVENTS_MAX;
		display->event_count--;
	}
	display->events[(display->event_first + display->event_count) % DISPLAY_EVENTS_MAX] = *event;
	display->event_count++;
}

bool display_poll(struct display *display, struct display_event *out)
{
	if (!display->event_count)
		display->ops->pump(display);
	if (!display->event_count)
		return false;
	*out = display->events[display->event_first];
	display->event_first = (display->event_first + 1) % DISPLAY_EVENTS_MAX;
	display->event_count--;
	return true;
}
