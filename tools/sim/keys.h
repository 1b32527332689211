/*
 * The terminal that the car is driven from: keys as they are pressed, a line for typed commands, and one line that says
 * how things are. What was before comes back at the end, also after a signal that ends the program.
 */
#ifndef BLVD_TOOLS_SIM_KEYS_H
#define BLVD_TOOLS_SIM_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#define KEYS_LINE_MAX 160

struct keys {
	int in; /* -1: ended */
	bool terminal, typing;
	char line[KEYS_LINE_MAX];
	size_t length;
	size_t escape_length; /* of an arrow key, so far */
};

/* Takes standard input: a terminal is set to give keys, from anything else whole lines are read. */
void keys_open(struct keys *keys);
void keys_close(struct keys *keys);

/* The next command (say.c's words); NULL when there is none now. Valid until the next call. Never waits. */
const char *keys_next(struct keys *keys);

/* The line at the bottom; nothing without a terminal. */
void keys_show(const struct keys *keys, const char *status);

extern const char *const keys_help;

#endif
