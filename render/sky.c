#include "render/sky.h"

#include <math.h>

#define GRID_VERTICES (16 * 16 * 6) /* of sky.vert */
#define AUREOLE_RAD 0.34f           /* beyond, the sun adds less than 1/512 to the sky */
#define STARS_SEEN 0.01f            /* of sky.frag */

static int make(struct sky *sky, enum sky_kind kind)
{
	struct gfx_program_desc program = {
		.vertex = "sky.vert",
		.fragment = "sky.frag",
		.defines = kind == SKY_GRID ? "#define GRID 1\n" : NULL,
		.blocks = { "Frame" },
	};
	int err = gfx_program_create(sky->gfx, &program, &sky->programs[kind]);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = { .program = sky->programs[kind], .depth = GFX_DEPTH_TEST };
	return gfx_pipeline_create(sky->gfx, &pipeline, &sky->pipelines[kind]);
}

int sky_init(struct sky *sky, struct gfx *gfx)
{
	*sky = (struct sky){ .gfx = gfx };
	int err = make(sky, SKY_EVERY_PIXEL);
	return err ? err : make(sky, SKY_GRID);
}

void sky_finish(struct sky *sky)
{
	if (!sky->gfx)
		return;
	for (int kind = 0; kind < SKY_KIND_COUNT; kind++) {
		gfx_pipeline_destroy(sky->gfx, sky->pipelines[kind]);
		gfx_program_destroy(sky->gfx, sky->programs[kind]);
	}
	*sky = (struct sky){ 0 };
}

/* Can a pixel of this view show more than the gradient? */
static bool sun_or_stars(const struct view *view, const struct light_state *light)
{
	if (light->stars > STARS_SEEN)
		return true;
	float corner = atanf(hypotf(view->tan_half_x, view->tan_half_y));
	float away = acosf(fminf(fmaxf(vec3_dot(view->forward, light->direction), -1.0f), 1.0f));
	return away < corner + AUREOLE_RAD;
}

static void put(float out[4], struct vec3 v)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

void sky_draw(const struct sky *sky, const struct view *view, const struct light_state *light, gfx_buffer frame_block)
{
	enum sky_kind kind = sun_or_stars(view, light) ? SKY_EVERY_PIXEL : SKY_GRID;
	float constants[3][4] = { 0 };
	put(constants[0], view->forward);
	put(constants[1], vec3_scale(view->right, view->tan_half_x));
	put(constants[2], vec3_scale(view->up, view->tan_half_y));
	struct gfx_draw draw = {
		.pipeline = sky->pipelines[kind],
		.count = kind == SKY_GRID ? GRID_VERTICES : 3,
		.blocks = { frame_block },
		.constants = &constants[0][0],
		.constant_count = 3,
	};
	gfx_depth_range(sky->gfx, 0.0f, 1.0f);
	gfx_draw(sky->gfx, &draw);
}
