/* Remote controls, gpio-keys and keyboards name the same thing in several ways. */
#include "board/control_keys.h"

#include <linux/input-event-codes.h>

enum action controls_action_of_key(enum display_key key)
{
	static const enum action actions[] = {
		[DISPLAY_KEY_UP] = ACTION_UP,
		[DISPLAY_KEY_DOWN] = ACTION_DOWN,
		[DISPLAY_KEY_LEFT] = ACTION_TURN_LEFT,
		[DISPLAY_KEY_RIGHT] = ACTION_TURN_RIGHT,
		[DISPLAY_KEY_ZOOM_IN] = ACTION_ZOOM_IN,
		[DISPLAY_KEY_ZOOM_OUT] = ACTION_ZOOM_OUT,
		[DISPLAY_KEY_CAMERA] = ACTION_VIEW,
		[DISPLAY_KEY_NIGHT] = ACTION_LIGHT,
		[DISPLAY_KEY_PAUSE] = ACTION_PAUSE,
		[DISPLAY_KEY_PUSH] = ACTION_PUSH,
		[DISPLAY_KEY_BACK] = ACTION_BACK,
		[DISPLAY_KEY_ESCAPE] = ACTION_ESCAPE,
		[DISPLAY_KEY_QUIT] = ACTION_QUIT,
	};
	return (size_t)key < sizeof(actions) / sizeof(*actions) ? actions[key] : ACTION_NONE;
}

static const struct {
	uint16_t key;
	uint8_t control;
} controls_of_keys[] = {
	{ KEY_ENTER, CONTROL_PUSH },
	{ KEY_KPENTER, CONTROL_PUSH },
	{ KEY_OK, CONTROL_PUSH },
	{ KEY_SELECT, CONTROL_PUSH },
	{ KEY_MENU, CONTROL_PUSH },
	{ BTN_0, CONTROL_PUSH },
	{ BTN_LEFT, CONTROL_PUSH },
	{ KEY_BACK, CONTROL_BACK },
	{ KEY_EXIT, CONTROL_BACK },
	{ KEY_ESC, CONTROL_BACK },
	{ KEY_BACKSPACE, CONTROL_BACK },
	{ BTN_1, CONTROL_BACK },
	{ KEY_ZOOMIN, CONTROL_ZOOM_IN },
	{ KEY_KPPLUS, CONTROL_ZOOM_IN },
	{ KEY_EQUAL, CONTROL_ZOOM_IN },
	{ KEY_ZOOMOUT, CONTROL_ZOOM_OUT },
	{ KEY_KPMINUS, CONTROL_ZOOM_OUT },
	{ KEY_MINUS, CONTROL_ZOOM_OUT },
	{ KEY_CAMERA, CONTROL_VIEW },
	{ KEY_C, CONTROL_VIEW },
};

enum control_line control_of_key(uint16_t key)
{
	for (size_t i = 0; i < sizeof(controls_of_keys) / sizeof(*controls_of_keys); i++)
		if (controls_of_keys[i].key == key)
			return (enum control_line)controls_of_keys[i].control;
	return CONTROL_LINE_COUNT;
}

enum action action_of_key(uint16_t key)
{
	switch (key) {
	case KEY_UP:
		return ACTION_UP;
	case KEY_DOWN:
		return ACTION_DOWN;
	case KEY_LEFT:
		return ACTION_TURN_LEFT;
	case KEY_RIGHT:
		return ACTION_TURN_RIGHT;
	case KEY_N:
		return ACTION_LIGHT;
	case KEY_SPACE:
		return ACTION_PAUSE;
	default:
		return ACTION_NONE;
	}
}
