#include "platform/gpio/press.h"

static enum press_kind begin(struct press *press, int64_t time_ns)
{
	press->down = true;
	press->down_ns = time_ns;
	press->next_ns = time_ns + press->long_ns;
	press->told = press->repeat_ns > 0;
	return press->told ? PRESS_SHORT : PRESS_NONE;
}

enum press_kind press_feed(struct press *press, bool down, int64_t time_ns)
{
	if (down == press->down)
		return PRESS_NONE;
	if (down)
		return begin(press, time_ns);
	press->down = false;
	if (press->told)
		return PRESS_NONE;
	return time_ns - press->down_ns >= press->long_ns ? PRESS_LONG : PRESS_SHORT;
}

enum press_kind press_settle(struct press *press, int64_t sure_ns)
{
	if (!press->down || sure_ns < press->next_ns)
		return PRESS_NONE;
	if (press->repeat_ns > 0) {
		press->next_ns += (1 + (sure_ns - press->next_ns) / press->repeat_ns) * press->repeat_ns;
		return PRESS_SHORT;
	}
	if (press->told)
		return PRESS_NONE;
	press->told = true;
	return PRESS_LONG;
}

void press_cancel(struct press *press)
{
	press->down = press->told = false;
}
