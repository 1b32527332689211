/* From options to a motion: the steps in their order, and as short as the minutes ask for. */
#include <math.h>

#include "tools/drive/drive.h"

#define CUT_TRIES 12

/* Shortens the route until it ends in time. */
static int fit_minutes(struct drive *drive, struct drive_path *path, struct drive_motion *motion)
{
	double wanted_s = drive->options->minutes * 60.0, aim_s = wanted_s - 6.0;
	for (int i = 0; i < CUT_TRIES && motion->end_s > wanted_s; i++) {
		size_t at = path->points.count - 1;
		while (at > 1 && motion->time.items[at] > aim_s)
			at--;
		/* Somewhere within a street, not on a corner. */
		const struct drive_point *point = &path->points.items[at];
		double length = graph_length_m(&drive->graph, drive->route.halves[point->index]);
		double along = fmin(fmax(point->along_m, 0.25 * length), 0.75 * length);
		if (drive_cut(drive, point->index, along))
			return -1;
		motion_finish(motion);
		path_finish(path);
		guidance_build(&drive->guidance, &drive->route);
		path_build(drive, path);
		motion_build(drive, path, motion);
		aim_s -= 10.0;
	}
	return 0;
}

int drive_plan(struct drive *drive, struct drive_path *path, struct drive_motion *motion)
{
	*path = (struct drive_path){ 0 };
	*motion = (struct drive_motion){ 0 };
	if (drive_choose(drive))
		return -1;
	guidance_build(&drive->guidance, &drive->route);
	path_build(drive, path);
	motion_build(drive, path, motion);
	return drive->options->minutes > 0.0 ? fit_minutes(drive, path, motion) : 0;
}
