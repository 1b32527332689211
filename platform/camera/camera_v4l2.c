#include <errno.h>

#include "platform/camera/camera.h"

static int v4l2_open(struct camera_device *camera, const struct camera_config *config, struct arena *arena)
{
	(void)camera;
	(void)config;
	(void)arena;
	return -ENODEV;
}

const struct camera_ops camera_v4l2 = { .name = "v4l2", .open = v4l2_open };
