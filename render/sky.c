#include "render/sky.h"

#include <math.h>

#define GRID_VERTICES (16 * 16 * 6) /* of sky.vert */
#define AUREOLE_RAD 0.34f           /* beyond, the sun adds less than 1/512 to the sky */
#define STARS_SEEN 0.01f            /* of sky.frag */

static int make(struct sky *sky, enum sky_kind kind)
{
	static const char *const defines[] = { [SKY_GRID] = "#define GRID 1\n", [SKY_SUN] = "#define SUN 1\n" };
	struct gfx_program_desc program = {
		.vertex = "sky.vert",
		.fragment = "sky.frag",
		.defines = defines[kind],
		.blocks = { "Frame" },
	};
	int err = gfx_program_create(sky->gfx, &program, &sky->programs[kind]);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = {
		.program = sky->programs[kind],
		.primitive = kind == SKY_SUN ? GFX_TRIANGLE_STRIP : GFX_TRIANGLES,
		.depth = GFX_DEPTH_TEST,
	};
	return gfx_pipeline_create(sky->gfx, &pipeline, &sky->pipelines[kind]);
}

int sky_init(struct sky *sky, struct gfx *gfx)
{
	*sky = (struct sky){ .gfx = gfx };
	int err = 0;
	for (int kind = 0; kind < SKY_KIND_COUNT && !err; kind++)
		err = make(sky, (enum sky_kind)kind);
	return err;
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

/* Can a pixel of this view show the sun or its aureole? */
static bool sun_in_view(const struct view *view, const struct light_state *light)
{
	float corner = atanf(hypotf(view->tan_half_x, view->tan_half_y));
	float away = acosf(fminf(fmaxf(vec3_dot(view->forward, light->direction), -1.0f), 1.0f));
	return away < corner + AUREOLE_RAD * 1.4142136f;
}

static void put(float out[4], struct vec3 v, float w)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
	out[3] = w;
}

static void draw(const struct sky *sky, enum sky_kind kind, const struct view *view, gfx_buffer frame_block)
{
	static const uint32_t counts[] = { [SKY_EVERY_PIXEL] = 3, [SKY_GRID] = GRID_VERTICES, [SKY_SUN] = 4 };
	float constants[3][4];
	put(constants[0], view->forward, tanf(AUREOLE_RAD));
	put(constants[1], vec3_scale(view->right, view->tan_half_x), 0.0f);
	put(constants[2], vec3_scale(view->up, view->tan_half_y), 0.0f);
	struct gfx_draw draw = {
		.pipeline = sky->pipelines[kind],
		.count = counts[kind],
		.blocks = { frame_block },
		.constants = &constants[0][0],
		.constant_count = 3,
	};
	gfx_draw(sky->gfx, &draw);
}

void sky_draw(const struct sky *sky, const struct view *view, const struct light_state *light, gfx_buffer frame_block)
{
	gfx_depth_range(sky->gfx, 0.0f, 1.0f);
	bool stars = light->stars > STARS_SEEN;
	draw(sky, stars ? SKY_EVERY_PIXEL : SKY_GRID, view, frame_block);
	if (!stars && sun_in_view(view, light))
		draw(sky, SKY_SUN, view, frame_block);
}
