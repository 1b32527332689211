/*
 * Guide lines on a reversing picture, through the camera's own lens: the car's width straight back with marks at 0.5,
 * 1, 2 and 3 m behind the bumper in red, yellow and green, and where the rear corners will go with the wheels as they
 * stand. Lines lie on level ground; nothing is known of slopes and of what stands there.
 */
#ifndef BLVD_RENDER_GUIDE_H
#define BLVD_RENDER_GUIDE_H

#include <stdbool.h>

#include "platform/camera/lens.h"
#include "render/canvas.h"

struct guide_config {
	struct lens lens;
	struct camera_mount mount;
	double wheelbase_m; /* 0: unknown, no path */
	double width_m;     /* of the car */
	double overhang_m;  /* from the rear axle to the bumper */
	bool mirror;        /* the picture is shown as a mirror shows it */
};

/* Where a point of the ground, or above it, is on the screen: `picture` is the box of the whole picture. False where
 * the picture does not show it. */
bool guide_place(const struct guide_config *config, const struct box *picture, double back_m, double right_m,
	double up_m, struct vec2 *out);

/* Where a point of the car's outline is once the rear axle has gone back by `travel_m`, the road wheels at `angle_rad`
 * (clockwise positive, as the driver turns them). On concentric circles about the point where the axles' lines meet. */
struct dvec2 guide_moved(
	const struct guide_config *config, double angle_rad, double travel_m, double back_m, double right_m);

/* `angle_known` false: no path. `brightness` 0 to 1 for the night. */
void guide_draw(struct canvas *canvas, const struct guide_config *config, const struct box *picture, bool angle_known,
	double angle_rad, float scale, float brightness);

#endif
