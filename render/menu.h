/*
 * The driver's menu in the picture: a card of at most MENU_VISIBLE_MAX rows on the right, so that the road ahead, the
 * next manoeuvre, the speed and the state of the inputs stay in sight. One row is the one that a push acts on. Words
 * are set at start; a frame only places them. What the rows mean is the owner's (board/menu.h).
 */
#ifndef BLVD_RENDER_MENU_H
#define BLVD_RENDER_MENU_H

#include "render/text.h"

#define MENU_ROWS_MAX 12
#define MENU_VISIBLE_MAX 6
#define MENU_NO_WORD 0xFF
#define MENU_NO_BAR (-1)

struct menu_words {
	struct text_line *lines;
	uint32_t count;
};

/* Returns 0 or -ENOMEM. The words must stay; the list need not. */
int menu_words_init(struct menu_words *words, struct arena *arena, const struct text_font *font,
	const char *const *list, uint32_t count);

struct menu_row {
	uint8_t label;          /* index of a word */
	uint8_t value;          /* or MENU_NO_WORD */
	int8_t bar;             /* 0 to 100 percent of a bar in the value's place, or MENU_NO_BAR */
	bool at_least, at_most; /* nothing before or after this value */
};

struct menu_view {
	struct menu_row rows[MENU_ROWS_MAX];
	uint8_t count, chosen; /* rows; index of the one that a push acts on */
	bool changing;         /* turning the knob changes the chosen row's value */
};

#endif
