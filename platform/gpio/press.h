/*
 * A button's debounced level to presses: a short one is told at its end, a long one as soon as it is long. With
 * `repeat_ns` a press is told at its beginning and, while held for longer than `long_ms`, again and again.
 */
#ifndef BLVD_PLATFORM_GPIO_PRESS_H
#define BLVD_PLATFORM_GPIO_PRESS_H

#include <stdbool.h>
#include <stdint.h>

enum press_kind { PRESS_NONE, PRESS_SHORT, PRESS_LONG };

struct press {
	int64_t long_ns;
	int64_t repeat_ns; /* 0: does not repeat */
	bool down, told;
	int64_t down_ns, next_ns;
};

/* `time_ns` is that of the edge. */
enum press_kind press_feed(struct press *press, bool down, int64_t time_ns);
/* Known to be as it was last fed until `sure_ns`. At most one repetition a call, however late. */
enum press_kind press_settle(struct press *press, int64_t sure_ns);
/* Forgets a press under way: the line was lost. */
void press_cancel(struct press *press);

#endif
