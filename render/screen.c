#include "render/screen.h"

#include <errno.h>
#include <math.h>

#include "platform/base/geo.h"
#include "platform/base/log.h"

static int make_turn(struct screen *screen)
{
	struct gfx_program_desc program = {
		.vertex = "window.vert",
		.fragment = "window.frag",
		.defines = "#define NO_FRAME_BLOCK 1\n",
		.textures = { "u_picture" },
	};
	int status = gfx_program_create(screen->gfx, &program, &screen->turn_program);
	if (status < 0)
		return status;
	struct gfx_pipeline_desc pipeline = { .program = screen->turn_program, .primitive = GFX_TRIANGLE_STRIP };
	return gfx_pipeline_create(screen->gfx, &pipeline, &screen->turn_pipeline);
}

int screen_init(struct screen *screen, struct arena *arena, const struct screen_config *config)
{
	*screen = (struct screen){ .width = config->width, .height = config->height };
	struct gfx_config gfx_config = { .get_proc = config->get_proc };
	int status = gfx_init(&screen->gfx, arena, config->gfx ? config->gfx : &gfx_gles3, &gfx_config);
	if (status < 0)
		return status;
	uint32_t most_px = gfx_caps(screen->gfx)->max_texture_px;
	if (config->width > most_px || config->height > most_px) {
		log_error(
			"a picture of %u x %u: this GPU draws %u pixels a side at most", config->width, config->height, most_px);
		screen_finish(screen);
		return -ENOTSUP;
	}
	struct gfx_target_desc target = { .width = config->width,
		.height = config->height,
		.samples = config->samples,
		.depth_16 = config->depth_16,
		.plain_first = config->plain_first };
	status = gfx_target_create(screen->gfx, &target, &screen->target);
	if (status == 0 && config->turns)
		status = make_turn(screen);
	if (status < 0)
		screen_finish(screen);
	return status;
}

void screen_finish(struct screen *screen)
{
	gfx_finish(screen->gfx);
	*screen = (struct screen){ 0 };
}

void screen_draw_dark(struct screen *screen)
{
	const struct gfx_clear clear = { .color = true, .depth = true, .rgba = { 0.0f, 0.0f, 0.0f, 1.0f } };
	gfx_frame_begin(screen->gfx);
	gfx_pass_begin(screen->gfx, screen->target, &clear);
	gfx_pass_end(screen->gfx);
}

static void draw_turned(const struct screen *screen, const struct screen_turn *turn)
{
	double angle = turn->turn_deg * (BLVD_PI / 180.0);
	const float constants[4] = { (float)round(cos(angle)), (float)round(sin(angle)), turn->dim, 0.0f };
	bool across = turn->turn_deg % 180 != 0;
	struct gfx_draw draw = { .pipeline = screen->turn_pipeline,
		.count = 4,
		.textures = { gfx_target_texture(screen->gfx, screen->target) },
		.constants = constants,
		.constant_count = 1 };
	gfx_window_begin(screen->gfx, across ? turn->height : turn->width, across ? turn->width : turn->height);
	gfx_draw(screen->gfx, &draw);
	gfx_window_end(screen->gfx);
}

void screen_present(const struct screen *screen, const struct screen_turn *turn)
{
	if (screen->turn_pipeline.id && (turn->turn_deg || turn->dim < 1.0f))
		draw_turned(screen, turn);
	else
		gfx_present(screen->gfx, screen->target, turn->width, turn->height);
}

void screen_read_pixels(const struct screen *screen, uint8_t *out)
{
	gfx_read_rgba8(screen->gfx, screen->target, out);
}
