#include "render/sky.h"

int sky_init(struct sky *sky, struct gfx *gfx)
{
	*sky = (struct sky){ .gfx = gfx };
	struct gfx_program_desc program = { .vertex = "sky.vert", .fragment = "sky.frag", .blocks = { "Frame" } };
	int err = gfx_program_create(gfx, &program, &sky->program);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = { .program = sky->program, .depth = GFX_DEPTH_TEST };
	return gfx_pipeline_create(gfx, &pipeline, &sky->pipeline);
}

void sky_finish(struct sky *sky)
{
	if (!sky->gfx)
		return;
	gfx_pipeline_destroy(sky->gfx, sky->pipeline);
	gfx_program_destroy(sky->gfx, sky->program);
	*sky = (struct sky){ 0 };
}

static void put(float out[4], struct vec3 v)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

void sky_draw(const struct sky *sky, const struct view *view, gfx_buffer frame_block)
{
	float constants[3][4] = { 0 };
	put(constants[0], view->forward);
	put(constants[1], vec3_scale(view->right, view->tan_half_x));
	put(constants[2], vec3_scale(view->up, view->tan_half_y));
	struct gfx_draw draw = {
		.pipeline = sky->pipeline,
		.count = 3,
		.blocks = { frame_block },
		.constants = &constants[0][0],
		.constant_count = 3,
	};
	gfx_depth_range(sky->gfx, 0.0f, 1.0f);
	gfx_draw(sky->gfx, &draw);
}
