#include "platform/gpio/gpio.h"

static void note(struct gpio *gpio, const struct gpio_event *event)
{
	struct gpio_line *line = &gpio->lines[event->line];
	if (event->kind == GPIO_STATE) {
		gpio->stats.losses += line->state == GPIO_GOOD && event->state != GPIO_GOOD;
		line->state = (enum gpio_state)event->state;
		line->state_ns = event->time_ns;
		return;
	}
	line->level = event->level;
	gpio->stats.edges += event->kind == GPIO_EDGE;
	gpio->stats.resyncs += event->kind == GPIO_LEVEL;
}

int gpio_read(struct gpio *gpio, int64_t until_ns, struct gpio_event *events, int capacity)
{
	int count = gpio->ops->read(gpio, until_ns, events, capacity);
	for (int i = 0; i < count; i++)
		note(gpio, &events[i]);
	return count;
}

void gpio_close(struct gpio *gpio)
{
	if (gpio)
		gpio->ops->close(gpio);
}

const char *gpio_state_name(enum gpio_state state)
{
	static const char *const names[] = { "waiting", "good", "in use elsewhere", "missing", "refused" };
	return names[state];
}
