/* What the driver can choose while driving, whichever control it came from. Plain values: whoever they concern reads
 * them every frame. */
#ifndef BLVD_BOARD_SETTINGS_H
#define BLVD_BOARD_SETTINGS_H

#include "board/controls.h"
#include "board/profile.h"
#include "render/frame.h"

enum light { LIGHT_AUTO, LIGHT_DAY, LIGHT_NIGHT, LIGHT_COUNT };

#define SETTINGS_BRIGHTNESS_MIN 10

struct settings {
	enum camera_kind view;
	double zoom; /* of struct camera: 0.25 to 4 */
	enum light light;
	int brightness; /* of the panel's light, percent, SETTINGS_BRIGHTNESS_MIN to 100; the display's side applies it */
	bool names;     /* of streets, in the picture */
	bool route;     /* guidance; false: the driver has stopped it */
	enum wording_units units; /* UNITS_AUTO: as the city has them */
};

void settings_init(struct settings *settings, const struct profile *profile, const struct options *options);
void settings_zoom(struct settings *settings, double factor);

/* To the renderer, every frame. */
void settings_apply(const struct settings *settings, struct renderer *renderer);

/* Does what an action asks for outside of the menu. Returns false for an action that is none of the settings'. */
bool settings_act(struct settings *settings, enum action action);

#endif
