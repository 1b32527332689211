#include "board/settings.h"

#include <math.h>

#define BUTTON_ZOOM 1.25

void settings_init(struct settings *settings, const struct profile *profile, const struct options *options)
{
	static const enum wording_units units[] = {
		[PROFILE_UNITS_AUTO] = UNITS_AUTO,
		[PROFILE_UNITS_METRIC] = UNITS_METRIC,
		[PROFILE_UNITS_IMPERIAL] = UNITS_MILES_FEET,
	};
	static const enum light lights[] = {
		[PROFILE_STYLE_DAY] = LIGHT_DAY,
		[PROFILE_STYLE_NIGHT] = LIGHT_NIGHT,
	};
	*settings = (struct settings){
		.zoom = 1.0,
		.brightness = 100,
		.names = true,
		.route = true,
		.units = units[profile->units],
	};
	if ((size_t)profile->style < sizeof(lights) / sizeof(*lights))
		settings->light = lights[profile->style];
	int view = options->camera_view ? camera_from_name(options->camera_view) : -1;
	if (view >= 0)
		settings->view = (enum camera_kind)view;
}

void settings_apply(const struct settings *settings, struct renderer *renderer)
{
	struct camera *camera = renderer_camera(renderer);
	camera->kind = settings->view;
	camera->zoom = settings->zoom;
}

void settings_zoom(struct settings *settings, double factor)
{
	settings->zoom = fmin(SETTINGS_ZOOM_MAX, fmax(SETTINGS_ZOOM_MIN, settings->zoom * factor));
}

struct overlay_driver settings_driver(const struct settings *settings, const struct controls_state *car)
{
	return (struct overlay_driver){
		.units = settings->units,
		.no_names = !settings->names,
		.light_chosen = settings->light != LIGHT_AUTO || car->night.on,
	};
}

bool settings_night(const struct settings *settings, const struct controls_state *car)
{
	return settings->light == LIGHT_NIGHT || (settings->light == LIGHT_AUTO && car->night.on);
}

void settings_filter(struct settings *settings, uint32_t orders, struct nav_view *view)
{
	settings->route = settings->route || orders != settings->orders;
	settings->orders = orders;
	if (settings->route)
		return;
	view->routed = view->off_route = false;
	view->route_count = 0;
	view->next.manoeuvre = view->after_next.manoeuvre = NAV_MANOEUVRE_NONE;
}

bool settings_act(struct settings *settings, enum action action)
{
	switch (action) {
	case ACTION_TURN_RIGHT:
		settings_zoom(settings, SETTINGS_DETENT_ZOOM);
		return true;
	case ACTION_TURN_LEFT:
		settings_zoom(settings, 1.0 / SETTINGS_DETENT_ZOOM);
		return true;
	case ACTION_UP:
	case ACTION_ZOOM_IN:
		settings_zoom(settings, BUTTON_ZOOM);
		return true;
	case ACTION_DOWN:
	case ACTION_ZOOM_OUT:
		settings_zoom(settings, 1.0 / BUTTON_ZOOM);
		return true;
	case ACTION_VIEW:
		settings->view = (enum camera_kind)((settings->view + 1) % CAMERA_KIND_COUNT);
		return true;
	case ACTION_LIGHT:
		settings->light = settings->light == LIGHT_NIGHT ? LIGHT_AUTO : LIGHT_NIGHT;
		return true;
	default:
		return false;
	}
}
