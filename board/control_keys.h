/* What keys mean: of the window's keyboard, and of input devices of the kernel. */
#ifndef BLVD_BOARD_CONTROL_KEYS_H
#define BLVD_BOARD_CONTROL_KEYS_H

#include "board/controls.h"

/* The control that a key of an input device stands for, CONTROL_LINE_COUNT for none: its press is judged by its length,
 * as that of a line is. */
enum control_line control_of_key(uint16_t key);

/* The action of a key that is no control of its own: arrows and letters of a keyboard. ACTION_NONE: nothing. */
enum action action_of_key(uint16_t key);

#endif
