/* Rows are a table: a label, what it chooses from, and where the choice is. */
#include "board/menu.h"

#include <math.h>
#include <stddef.h>

enum word {
	WORD_VIEW,
	WORD_DRIVER,
	WORD_CHASE,
	WORD_HEADING_UP,
	WORD_NORTH_UP,
	WORD_LIGHT,
	WORD_AUTO,
	WORD_DAY,
	WORD_NIGHT,
	WORD_ZOOM,
	WORD_ROUTE,
	WORD_NAMES,
	WORD_OFF,
	WORD_ON,
	WORD_BRIGHTNESS,
	WORD_UNITS,
	WORD_KM,
	WORD_MILES,
	WORD_CLOSE,
	WORD_COUNT,
};

static const char *const words[WORD_COUNT] = {
	[WORD_VIEW] = "View",
	[WORD_DRIVER] = "Driver",
	[WORD_CHASE] = "Chase",
	[WORD_HEADING_UP] = "Heading up",
	[WORD_NORTH_UP] = "North up",
	[WORD_LIGHT] = "Light",
	[WORD_AUTO] = "Auto",
	[WORD_DAY] = "Day",
	[WORD_NIGHT] = "Night",
	[WORD_ZOOM] = "Zoom",
	[WORD_ROUTE] = "Guidance",
	[WORD_NAMES] = "Street names",
	[WORD_OFF] = "Off",
	[WORD_ON] = "On",
	[WORD_BRIGHTNESS] = "Brightness",
	[WORD_UNITS] = "Units",
	[WORD_KM] = "km",
	[WORD_MILES] = "Miles",
	[WORD_CLOSE] = "Close",
};

enum kind { KIND_CHOICE, KIND_SWITCH, KIND_ZOOM, KIND_PERCENT, KIND_CLOSE };

static const struct row {
	enum word label;
	enum kind kind;
	size_t field;    /* of struct settings: an int-sized enum, a bool or an int */
	enum word first; /* KIND_CHOICE: words in the order of the values */
	uint8_t count;   /* KIND_CHOICE */
} rows[] = {
	{ WORD_VIEW, KIND_CHOICE, offsetof(struct settings, view), WORD_DRIVER, CAMERA_KIND_COUNT },
	{ WORD_LIGHT, KIND_CHOICE, offsetof(struct settings, light), WORD_AUTO, LIGHT_COUNT },
	{ WORD_ZOOM, KIND_ZOOM, offsetof(struct settings, zoom), WORD_COUNT, 0 },
	{ WORD_ROUTE, KIND_SWITCH, offsetof(struct settings, route), WORD_OFF, 2 },
	{ WORD_NAMES, KIND_SWITCH, offsetof(struct settings, names), WORD_OFF, 2 },
	{ WORD_BRIGHTNESS, KIND_PERCENT, offsetof(struct settings, brightness), WORD_COUNT, 0 },
	{ WORD_UNITS, KIND_CHOICE, offsetof(struct settings, units), WORD_COUNT, 3 },
	{ WORD_CLOSE, KIND_CLOSE, 0, WORD_COUNT, 0 },
};
#define ROW_COUNT ((uint8_t)(sizeof(rows) / sizeof(*rows)))
static_assert(sizeof(rows) / sizeof(*rows) <= MENU_ROWS_MAX, "the picture has room for all rows");
static_assert(sizeof(enum camera_kind) == sizeof(int) && sizeof(enum light) == sizeof(int), "choices are ints");

const char *const *menu_words(uint32_t *count)
{
	*count = WORD_COUNT;
	return words;
}

void menu_init(struct menu *menu, struct settings *settings)
{
	*menu = (struct menu){ .settings = settings };
}

static bool shown(const struct menu *menu, uint8_t row)
{
	if (rows[row].label == WORD_BRIGHTNESS)
		return menu->has_brightness;
	return rows[row].label != WORD_ROUTE || menu->has_route;
}

static void *field(const struct menu *menu, const struct row *row)
{
	return (char *)menu->settings + row->field;
}

static int clamp(int value, int low, int high)
{
	return value < low ? low : value > high ? high : value;
}

void menu_close(struct menu *menu)
{
	menu->open = menu->changing = false;
}

/* One detent of a row's value. */
static void change(struct menu *menu, int by)
{
	const struct row *row = &rows[menu->row];
	int *value = field(menu, row);
	if (row->kind == KIND_CHOICE)
		*value = clamp(*value + by, 0, row->count - 1);
	else if (row->kind == KIND_PERCENT)
		*value = clamp(*value + by * SETTINGS_BRIGHTNESS_STEP, SETTINGS_BRIGHTNESS_MIN, 100);
	else if (row->kind == KIND_ZOOM)
		settings_zoom(menu->settings, by > 0 ? SETTINGS_DETENT_ZOOM : 1.0 / SETTINGS_DETENT_ZOOM);
}

static void move(struct menu *menu, int by)
{
	int row = menu->row + by;
	while (row >= 0 && row < ROW_COUNT && !shown(menu, (uint8_t)row))
		row += by;
	if (row >= 0 && row < ROW_COUNT)
		menu->row = (uint8_t)row;
}

static void push(struct menu *menu)
{
	const struct row *row = &rows[menu->row];
	if (row->kind == KIND_CLOSE) {
		menu->open = false;
	} else if (row->kind == KIND_SWITCH) {
		bool *value = field(menu, row);
		*value = !*value;
	} else {
		menu->changing = !menu->changing;
		menu->before = *menu->settings;
	}
}

static void back(struct menu *menu)
{
	if (menu->changing)
		*menu->settings = menu->before;
	else
		menu->open = false;
	menu->changing = false;
}

static bool open_menu(struct menu *menu, enum action action, int64_t now_ns)
{
	if (action != ACTION_PUSH)
		return false;
	menu->open = true;
	menu->changing = false;
	menu->row = 0;
	menu->touched_ns = now_ns;
	return true;
}

bool menu_act(struct menu *menu, enum action action, int64_t now_ns)
{
	if (!menu->open)
		return open_menu(menu, action, now_ns);
	bool right = action == ACTION_TURN_RIGHT;
	switch (action) {
	case ACTION_TURN_RIGHT:
	case ACTION_TURN_LEFT:
		if (menu->changing)
			change(menu, right ? 1 : -1);
		else
			move(menu, right ? 1 : -1);
		break;
	case ACTION_UP: /* the arrow keys point at rows; a value grows upwards */
	case ACTION_DOWN:
		if (menu->changing)
			change(menu, action == ACTION_UP ? 1 : -1);
		else
			move(menu, action == ACTION_UP ? -1 : 1);
		break;
	case ACTION_PUSH:
		push(menu);
		break;
	case ACTION_BACK:
	case ACTION_ESCAPE:
		back(menu);
		break;
	default:
		return false;
	}
	menu->touched_ns = now_ns;
	return true;
}

/* The zoom's place on its scale, which is one of ratios. */
static int8_t zoom_percent(double zoom)
{
	double share = log2(zoom / SETTINGS_ZOOM_MIN) / log2(SETTINGS_ZOOM_MAX / SETTINGS_ZOOM_MIN);
	return (int8_t)clamp((int)lround(100.0 * share), 0, 100);
}

static struct menu_row show_row(const struct menu *menu, const struct row *row)
{
	static const enum word units[] = { WORD_AUTO, WORD_KM, WORD_MILES };
	struct menu_row out = { .label = (uint8_t)row->label, .value = MENU_NO_WORD, .bar = MENU_NO_BAR };
	const int *value = field(menu, row);
	switch (row->kind) {
	case KIND_CHOICE:
		out.value = (uint8_t)(row->label == WORD_UNITS ? units[*value] : row->first + (unsigned)*value);
		out.at_least = *value == 0;
		out.at_most = *value == row->count - 1;
		break;
	case KIND_SWITCH:
		out.value = (uint8_t)(row->first + *(const bool *)field(menu, row));
		break;
	case KIND_PERCENT:
		out.bar = (int8_t)((*value - SETTINGS_BRIGHTNESS_MIN) * 100 / (100 - SETTINGS_BRIGHTNESS_MIN));
		break;
	case KIND_ZOOM:
		out.bar = zoom_percent(menu->settings->zoom);
		break;
	case KIND_CLOSE:
		break;
	}
	if (out.bar != MENU_NO_BAR) {
		out.at_least = out.bar == 0;
		out.at_most = out.bar == 100;
	}
	return out;
}

const struct menu_view *menu_step(struct menu *menu, bool moving, int64_t now_ns)
{
	if (!menu->open)
		return NULL;
	if (now_ns - menu->touched_ns > (moving ? MENU_MOVING_NS : MENU_STANDING_NS)) {
		menu_close(menu);
		return NULL;
	}
	if (!shown(menu, menu->row)) {
		menu->changing = false;
		move(menu, 1); /* the last row is always there */
	}
	struct menu_view *view = &menu->view;
	*view = (struct menu_view){ .changing = menu->changing };
	for (uint8_t i = 0; i < ROW_COUNT; i++) {
		if (!shown(menu, i))
			continue;
		if (i == menu->row)
			view->chosen = view->count;
		view->rows[view->count++] = show_row(menu, &rows[i]);
	}
	return view;
}
