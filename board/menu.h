/*
 * The menu that the knob alone can work: a push opens it, turning moves, a push selects, a long push goes back or
 * closes, and so does time. Flat on purpose: one list, a value a row, at most two pushes and a few detents to anything.
 *
 * No row is locked while the car moves: none asks for letters, for reading more than a word or for more than a few
 * glances (what the guidelines on distraction limit is text entry, moving text and tasks over 12 s), and all of them
 * are things that one may need to set right while driving, such as a picture too bright. The menu closes by itself
 * instead, sooner while the car moves.
 */
#ifndef BLVD_BOARD_MENU_H
#define BLVD_BOARD_MENU_H

#include "board/settings.h"
#include "render/menu.h"

#define MENU_MOVING_NS INT64_C(6000000000) /* closes after so long without a touch */
#define MENU_STANDING_NS INT64_C(20000000000)

struct menu {
	struct settings *settings; /* borrowed */
	struct settings before;    /* while changing: what a long push goes back to */
	bool open, changing;
	uint8_t row; /* of all, hidden ones included */
	int64_t touched_ns;
	bool has_brightness, has_route; /* set by the owner: rows without a meaning here are not shown */
	struct menu_view view;
};

void menu_init(struct menu *menu, struct settings *settings);

/* Returns false when the action is not the menu's: it is closed, or the action has a meaning of its own. */
bool menu_act(struct menu *menu, enum action action, int64_t now_ns);

/* Something else has the screen. */
void menu_close(struct menu *menu);

/* Once a frame; returns what is to be drawn, NULL while closed. */
const struct menu_view *menu_step(struct menu *menu, bool moving, int64_t now_ns);

/* All words that menu_step() uses, for the renderer to set at start. */
const char *const *menu_words(uint32_t *count);

#endif
