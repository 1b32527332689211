/* Puts the parts together; decides day or night, sizes, and how much of the route is drawn. */
#include "render/overlay.h"

#include <errno.h>
#include <math.h>

#define LIGHT_CHANGE_S 0.8f

float overlay_scale(uint32_t width, uint32_t height)
{
	float w = (float)width, h = (float)height;
	float scale = fminf(fminf(w, h) / 720.0f, fmaxf(w, h) / 1100.0f);
	return fmaxf(scale, 0.58f);
}

int overlay_init(struct overlay *overlay, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	const struct overlay_config *config)
{
	*overlay = (struct overlay){ .pkg = pkg, .gfx = gfx };
	if (config)
		overlay->config = *config;
	if (overlay->config.units == UNITS_AUTO)
		overlay->config.units = wording_units_of(pkg->meta);
	overlay->memory.shown_speed = -1;
	text_font_init(&overlay->font, pkg);
	int status = canvas_init(&overlay->canvas, arena, gfx, pkg, overlay->config.vertices);
	if (status < 0)
		return status;
	status = ribbon_init(&overlay->ribbon, arena, gfx, overlay->config.ribbon_points);
	if (status == 0)
		status = labels_init(&overlay->labels, arena, pkg, &overlay->font);
	if (status == 0)
		status = menu_words_init(
			&overlay->menu_words, arena, &overlay->font, overlay->config.menu_words, overlay->config.menu_word_count);
	if (status < 0)
		overlay_finish(overlay);
	return status;
}

void overlay_finish(struct overlay *overlay)
{
	ribbon_finish(&overlay->ribbon);
	canvas_finish(&overlay->canvas);
	*overlay = (struct overlay){ 0 };
}

/* Day and night have a gap between them, so that dusk does not flicker; the change itself is gradual. */
static void follow_light(struct overlay *overlay, const struct overlay_input *input)
{
	bool chosen = input->driver && input->driver->light_chosen;
	double light = input->nav->ambient >= 0.0 && !chosen ? input->nav->ambient : (double)input->daylight;
	if (!overlay->started || input->time_ns < overlay->time_ns) {
		overlay->by_day = light > 0.4;
		overlay->day = overlay->by_day ? 1.0f : 0.0f;
		overlay->time_ns = input->time_ns;
		overlay->started = true;
	}
	overlay->by_day = overlay->by_day ? light > 0.3 : light > 0.45;
	float step = (float)((double)(input->time_ns - overlay->time_ns) * 1e-9) / LIGHT_CHANGE_S;
	overlay->time_ns = input->time_ns;
	overlay->day = overlay->by_day ? fminf(overlay->day + step, 1.0f) : fmaxf(overlay->day - step, 0.0f);
	palette_mix(&overlay->palette, overlay->day);
}

static struct ribbon_look look_of(enum camera_kind kind, float scale)
{
	bool above = kind == CAMERA_HEADING_UP || kind == CAMERA_NORTH_UP;
	struct ribbon_look look = {
		.start_m = kind == CAMERA_CHASE ? 2.5f : 5.0f,
		.start_fade_m = kind == CAMERA_CHASE ? 7.0f : 12.0f,
		.end_m = 900.0f,
		.end_fade_m = 350.0f,
		.hidden_alpha = 0.22f,
		.arrow = true,
	};
	if (above)
		look = (struct ribbon_look){
			.start_m = -1.0f,
			.start_fade_m = 1.0f,
			.end_m = 1e6f,
			.end_fade_m = 60.0f,
			.hidden_alpha = 0.5f,
			.least_px = 11.0f * scale,
		};
	return look;
}

static const char *message_of(const struct overlay *overlay, const struct overlay_input *input)
{
	if (input->message && *input->message)
		return input->message;
	if (input->map_damaged)
		return "Map damaged: parts are missing";
	if (!overlay->pkg->graph.edge_count)
		return "No street graph in this map";
	return NULL;
}

static float picture_heading(const struct view *view)
{
	/* straight down, the picture's up tells; else where it looks */
	float level = hypotf(view->forward.x, view->forward.y);
	const struct vec3 *ahead = level > 0.3f ? &view->forward : &view->up;
	return atan2f(ahead->x, ahead->y);
}

static enum wording_units units_of(const struct overlay *overlay, const struct overlay_driver *driver)
{
	if (!driver || driver->units == UNITS_AUTO)
		return overlay->config.units;
	bool yards = driver->units == UNITS_MILES_FEET && wording_units_of(overlay->pkg->meta) == UNITS_MILES_YARDS;
	return yards ? UNITS_MILES_YARDS : driver->units;
}

static void draw_hud(struct overlay *overlay, const struct overlay_input *input)
{
	const struct overlay_driver *driver = input->driver;
	float scale = overlay_scale(input->view->width, input->view->height);
	struct hud hud = {
		.canvas = &overlay->canvas,
		.font = &overlay->font,
		.palette = &overlay->palette,
		.pkg = overlay->pkg,
		.nav = input->nav,
		.memory = &overlay->memory,
		.units = units_of(overlay, driver),
		.devices = driver ? driver->devices : NULL,
		.zone_minutes = overlay->config.utc_offset_minutes,
		.zone_known = overlay->config.zone_given,
		.scale = scale,
		.width = (float)input->view->width,
		.height = (float)input->view->height,
		.margin = 24.0f * scale,
	};
	const char *message = message_of(overlay, input);
	hud.compact = hud.height < 560.0f * scale && message;
	hud_credit(&hud);
	hud_next(&hud);
	hud_compass(&hud, picture_heading(input->view));
	hud_speed(&hud);
	hud_menu(&hud, &overlay->menu_words, driver ? driver->menu : NULL);
	hud_trip(&hud);
	if (!hud.compact)
		hud_status(&hud);
	hud_street(&hud);
	hud_message(&hud, message);
	memcpy(overlay->taken, hud.taken, sizeof(overlay->taken));
	overlay->taken_count = hud.taken_count;
}

void overlay_update(struct overlay *overlay, const struct overlay_input *input)
{
	overlay->view = *input->view;
	overlay->look = look_of(input->kind, overlay_scale(input->view->width, input->view->height));
	follow_light(overlay, input);
	ribbon_update(&overlay->ribbon, overlay->pkg, input->nav, &overlay->palette);
	canvas_begin(&overlay->canvas, input->view->width, input->view->height);
	draw_hud(overlay, input);
	struct labels_input labels = {
		.view = input->view,
		.nav = input->nav,
		.kind = input->kind,
		.now_ns = input->time_ns,
		.scale = overlay_scale(input->view->width, input->view->height),
		.taken = overlay->taken,
		.taken_count = overlay->taken_count,
	};
	labels_update(&overlay->labels, &labels);
	if (!input->driver || !input->driver->no_names)
		labels_draw(&overlay->labels, &overlay->canvas, &overlay->palette);
	canvas_upload(&overlay->canvas);
}

void overlay_draw_world(const struct overlay *overlay, enum view_slice_id slice)
{
	ribbon_draw(&overlay->ribbon, &overlay->view, slice, &overlay->look);
}

void overlay_draw_hidden(const struct overlay *overlay, enum view_slice_id slice)
{
	ribbon_draw_hidden(&overlay->ribbon, &overlay->view, slice, &overlay->look);
}

void overlay_draw_screen(const struct overlay *overlay)
{
	canvas_draw(&overlay->canvas);
}
