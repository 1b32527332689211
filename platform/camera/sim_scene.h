/* What the simulated camera sees: a car park behind the car, by its own lens and mount, with the frame's number. */
#ifndef BLVD_PLATFORM_CAMERA_SIM_SCENE_H
#define BLVD_PLATFORM_CAMERA_SIM_SCENE_H

#include "platform/camera/camera.h"

/* Draws the whole picture; some hundred milliseconds. */
void sim_scene_draw(const struct camera_config *config, const struct camera_frame *into, uint8_t *memory);
/* The number, at the top left, and a bar that moves with it along the top edge. */
void sim_scene_number(const struct camera_frame *into, uint8_t *memory, uint32_t number);

#endif
