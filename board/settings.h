/* What the driver can choose while driving, whichever control it came from. Plain values: whoever they concern reads
 * them every frame. */
#ifndef BLVD_BOARD_SETTINGS_H
#define BLVD_BOARD_SETTINGS_H

#include "board/controls.h"
#include "board/profile.h"
#include "render/frame.h"

enum light { LIGHT_AUTO, LIGHT_DAY, LIGHT_NIGHT, LIGHT_COUNT };

#define SETTINGS_BRIGHTNESS_MIN 10
#define SETTINGS_BRIGHTNESS_STEP 5
#define SETTINGS_ZOOM_MIN 0.25 /* as struct camera has them */
#define SETTINGS_ZOOM_MAX 4.0
#define SETTINGS_DETENT_ZOOM 1.12 /* twenty detents a turn: from street to district */

struct settings {
	enum camera_kind view;
	double zoom; /* of struct camera: 0.25 to 4 */
	enum light light;
	int brightness;  /* of the panel's light, percent, SETTINGS_BRIGHTNESS_MIN to 100; the display's side applies it */
	bool names;      /* of streets, in the picture */
	bool route;      /* guidance; false: the driver has stopped it */
	uint32_t orders; /* destinations of the car, as last seen */
	enum wording_units units; /* UNITS_AUTO, UNITS_METRIC or UNITS_MILES_FEET; auto: as the city has them */
};

void settings_init(struct settings *settings, const struct profile *profile, const struct options *options);
void settings_zoom(struct settings *settings, double factor);

/* To the renderer, every frame. */
void settings_apply(const struct settings *settings, struct renderer *renderer);

/* What of them the overlay shows; the menu and states are the caller's to add. */
struct overlay_driver settings_driver(const struct settings *settings, const struct controls_state *car);
/* The night look is asked for: by choice, or by the car's lamps. */
bool settings_night(const struct settings *settings, const struct controls_state *car);

/* Takes the route out of what is shown while the driver does not want it. A new destination wants it again: `orders`
 * counts those of the car. */
void settings_filter(struct settings *settings, uint32_t orders, struct nav_view *view);

/* Does what an action asks for outside of the menu. Returns false for an action that is none of the settings'. */
bool settings_act(struct settings *settings, enum action action);

#endif
