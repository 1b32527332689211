#include "render/screen.h"

int screen_init(struct screen *screen, struct arena *arena, const struct screen_config *config)
{
	*screen = (struct screen){ .width = config->width, .height = config->height };
	struct gfx_config gfx_config = { .get_proc = config->get_proc };
	int status = gfx_init(&screen->gfx, arena, config->gfx ? config->gfx : &gfx_gles3, &gfx_config);
	if (status < 0)
		return status;
	struct gfx_target_desc target = { .width = config->width, .height = config->height, .samples = config->samples };
	status = gfx_target_create(screen->gfx, &target, &screen->target);
	if (status < 0)
		screen_finish(screen);
	return status;
}

void screen_finish(struct screen *screen)
{
	gfx_finish(screen->gfx);
	*screen = (struct screen){ 0 };
}

void screen_present(const struct screen *screen, uint32_t width, uint32_t height)
{
	gfx_present(screen->gfx, screen->target, width, height);
}

void screen_read_pixels(const struct screen *screen, uint8_t *out)
{
	gfx_read_rgba8(screen->gfx, screen->target, out);
}
