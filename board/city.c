#include "board/city.h"

#include <errno.h>
#include <string.h>

#include "board/menu.h"
#include "platform/base/log.h"
#include "platform/display/display.h"

static void open_job(void *context, uint32_t job)
{
	struct city *city = context;
	(void)job;
	city->open_status = pkg_open(&city->pkg, city->config.options->package, &city->fault);
}

static void fail(struct city *city, int exit_code)
{
	city->state = CITY_FAILED;
	city->exit_code = exit_code;
}

void city_begin(struct city *city, const struct city_config *config)
{
	*city = (struct city){ .config = *config };
	/* without a thread, for want of memory or of need, it is opened in the first step */
	if (!config->simulated && worker_init(&city->worker, "package", open_job, city) == 0)
		worker_give(&city->worker, 0);
}

static int choose_view(struct city *city)
{
	const char *name = city->config.options->camera_view;
	int kind = name ? camera_from_name(name) : 0;
	if (kind < 0) {
		log_error("no camera called '%s': driver, chase, heading-up, north-up", name);
		return -EINVAL;
	}
	if (name)
		renderer_camera(city->renderer)->kind = (enum camera_kind)kind;
	return 0;
}

static int open_renderer(struct city *city)
{
	const struct options *o = city->config.options;
	uint32_t word_count;
	const char *const *words = menu_words(&word_count);
	struct renderer_config config = {
		.width = o->width,
		.height = o->height,
		.samples = o->samples > 0 ? (uint32_t)o->samples : 1,
		.far_name = o->far_name ? o->far_name : "auto",
		.tau_px = o->tau_px,
		.budget_bytes = o->budget_bytes,
		.deterministic = city->config.simulated,
		.screen = city->config.screen,
		.overlay = true,
		.overlay_config = {
			.menu_words = words,
			.menu_word_count = word_count,
			.zone_given = true,
			.utc_offset_minutes = (int32_t)city->pkg.meta->utc_offset_minutes,
		},
	};
	int status = renderer_init(&city->renderer, city->config.arena, &config, &city->pkg);
	if (status == -ENOMEM)
		log_error("the budget of %llu MiB is too small for %s at %u x %u", (unsigned long long)(o->budget_bytes >> 20),
			o->package, o->width, o->height);
	return status < 0 ? status : choose_view(city);
}

static void load(struct city *city)
{
	const struct city_config *config = &city->config;
	city->state = CITY_LOADING;
	gfx_set_between(config->screen->gfx, config->between, config->context);
	int status = inputs_map(config->inputs, config->options, config->profile, &city->pkg, config->arena);
	if (status == 0)
		status = open_renderer(city);
	if (status == 0) {
		city->state = CITY_READY;
		return;
	}
	gfx_set_between(config->screen->gfx, NULL, NULL);
	fail(city, status == -EFBIG ? EXIT_CODE_BAD_INPUT : status == -EINVAL ? EXIT_CODE_USAGE : EXIT_CODE_FAILED);
}

void city_step(struct city *city)
{
	uint32_t job;
	if (city->state != CITY_OPENING)
		return;
	if (!city->worker.started)
		open_job(city, 0);
	else if (!worker_take(&city->worker, false, &job))
		return;
	worker_finish(&city->worker);
	if (city->open_status == 0) {
		load(city);
		return;
	}
	log_error(
		"%s: byte %llu: %s", city->config.options->package, (unsigned long long)city->fault.offset, city->fault.text);
	fail(city, EXIT_CODE_BAD_INPUT);
}

void city_drawn(struct city *city)
{
	if (city->drawn)
		return;
	city->drawn = true;
	gfx_set_between(city->config.screen->gfx, NULL, NULL);
}

void city_finish(struct city *city)
{
	worker_finish(&city->worker);
	renderer_finish(city->renderer);
	if (city->config.inputs)
		city->config.inputs->nav.pkg = NULL;
	pkg_close(&city->pkg);
	*city = (struct city){ 0 };
}
