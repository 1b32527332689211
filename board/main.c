/*
 * boulevard: this machine. The only file that knows every room: options, profile, memory, start, loop, shutdown. After
 * the first frame the loop neither allocates nor opens anything, except to write what was asked for (frames, stats).
 */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "board/city.h"
#include "board/controls.h"
#include "board/inputs.h"
#include "board/menu.h"
#include "board/options.h"
#include "board/panel.h"
#include "board/png_write.h"
#include "board/profile.h"
#include "board/reverse.h"
#include "board/settings.h"
#include "board/standby.h"
#include "board/stats.h"
#include "platform/base/clock.h"
#include "platform/base/heap.h"
#include "platform/base/log.h"
#include "platform/base/notify.h"
#include "platform/display/display.h"
#include "render/screen.h"

#define CPU_SHARE_MIN ((uint64_t)3 << 20)
#define CPU_SHARE_MAX ((uint64_t)96 << 20)
#define DRIVER_BYTES ((uint64_t)64 << 20) /* of the heap, beside what the budget counts */
#define MOVING_MPS 1.4
#define LOADING_STEP_NS (2 * NS_PER_MS)
#define WHILE_LOADING_NS (15 * NS_PER_MS) /* from one look at the inputs to the next */
#define NIGHT_AMBIENT 0.3

struct machine {
	struct options options;
	struct profile profile;
	uint8_t *memory; /* the CPU's part of the budget, one reservation */
	uint64_t memory_bytes;
	struct heap_piece heap; /* the driver's */
	struct arena boot;
	struct inputs inputs;
	struct controls controls;
	struct settings settings;
	struct standby standby;
	struct menu menu;
	struct display display;
	struct panel_pace pace;
	bool touched; /* somebody turned or pressed something since the last frame */
	struct screen screen;
	struct reverse reverse;
	struct city city;
	uint8_t *pixels; /* width * height * 4; NULL where a window shows the picture and nothing saves it */
	struct stats stats;
	struct notify notify; /* the service manager */
	bool simulated;       /* the clock follows the frames, not the wall */
	bool paused;
	bool quit;
	int64_t started_ns; /* of the process */
	int64_t origin_ns;  /* real time that is 0 on the frames' clock */
	int64_t began_ns;   /* of the frame being made, real time */
	int64_t looked_ns;  /* at the inputs while the map loads, real time */
	bool running;       /* the frames' clock is */
	bool loading;       /* within city_step() or the map's first picture */
	uint32_t last_half;
};

static struct machine machine;
static volatile sig_atomic_t stop_asked, stats_asked;

static void on_signal(int number)
{
	if (number == SIGUSR1)
		stats_asked = 1;
	else
		stop_asked = 1;
}

static void catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal };
	sigemptyset(&action.sa_mask);
	sigaction(SIGUSR1, &action, NULL);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to its writer, no more */
}

/* One reservation for everything of ours on the CPU: no more than half of the budget, of which the city gives
 * the GPU what is not needed; and room for the driver's. */
static int reserve_memory(struct machine *m)
{
	uint64_t budget = m->options.budget_bytes;
	m->memory_bytes = budget / 2;
	if (m->memory_bytes < CPU_SHARE_MIN)
		m->memory_bytes = CPU_SHARE_MIN;
	if (m->memory_bytes > CPU_SHARE_MAX)
		m->memory_bytes = CPU_SHARE_MAX;
	void *at = mmap(NULL, (size_t)m->memory_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (at == MAP_FAILED) {
		log_error("cannot reserve %llu MiB: %s", (unsigned long long)(m->memory_bytes >> 20), strerror(errno));
		return -ENOMEM;
	}
	m->memory = at;
	heap_prepare(&m->heap, (size_t)(budget + DRIVER_BYTES));
	arena_init(&m->boot, "boot", m->memory, (size_t)m->memory_bytes);
	return 0;
}

/* The profile is read before the budget is known: it says it. Its strings live in a small buffer of their own. */
static int load_profile(struct machine *m)
{
	static uint8_t text[256 << 10];
	static struct arena arena;
	arena_init(&arena, "profile", text, sizeof(text));
	int status = profile_load(&m->profile, m->options.profile, &arena);
	if (status < 0)
		return status;
	struct options *o = &m->options;
	if (!o->width) {
		o->width = m->profile.width;
		o->height = m->profile.height;
	}
	if (!o->fps)
		o->fps = m->profile.fps;
	if (!o->budget_bytes)
		o->budget_bytes = m->profile.budget_bytes;
	if (o->samples < 0)
		o->samples = (int)m->profile.samples;
	settings_init(&m->settings, &m->profile, o);
	menu_init(&m->menu, &m->settings);
	return 0;
}

static int open_display(struct machine *m)
{
	int status = panel_open(&m->display, &m->options, &m->profile);
	if (status < 0)
		return status;
	m->simulated = m->options.replay && m->display.surface == DISPLAY_SURFACE_NONE;
	panel_pace_init(&m->pace, &m->options, &m->profile);
	return 0;
}

/* What everything is drawn into, and where it is read back. */
static int open_screen(struct machine *m)
{
	const struct options *o = &m->options;
	struct screen_config config = {
		.width = o->width,
		.height = o->height,
		.samples = o->samples > 0 ? (uint32_t)o->samples : 1,
		.plain_first = !o->frames, /* the first picture soon; pictures that are kept have all samples */
		.get_proc = display_get_proc,
		.turns = m->display.turn_deg || m->pace.brightness_night < 1.0f || m->pace.brightness_day < 1.0f,
	};
	int status = screen_init(&m->screen, &m->boot, &config);
	bool read_back = m->display.surface != DISPLAY_SURFACE_WINDOW || o->frames;
	if (read_back)
		m->pixels = arena_alloc(&m->boot, (size_t)o->width * o->height * 4, 64);
	if (status == 0 && (m->pixels || !read_back))
		return 0;
	log_error("no picture of %u x %u pixels with a budget of %llu MiB: %s", o->width, o->height,
		(unsigned long long)(o->budget_bytes >> 20), strerror(status < 0 ? -status : ENOMEM));
	return -ENOMEM;
}

static int make_frames_folder(const char *path)
{
	if (mkdir(path, 0777) < 0 && errno != EEXIST) {
		int status = -errno;
		log_error("%s: %s", path, strerror(-status));
		return status;
	}
	return 0;
}

/* Lines and devices know the machine's own clock, a script that of the frames. */
static int64_t controls_time(const struct machine *m, int64_t frame_ns)
{
	return m->simulated ? frame_ns : clock_now_ns();
}

static void while_loading(void *context);

static void begin_map(struct machine *m)
{
	struct city_config config = {
		.options = &m->options,
		.profile = &m->profile,
		.screen = &m->screen,
		.inputs = &m->inputs,
		.arena = &m->boot,
		.simulated = m->simulated,
		.between = m->simulated || !reverse_has_camera(&m->reverse) ? NULL : while_loading,
		.context = m,
	};
	city_begin(&m->city, &config);
}

/* Whether to go on: the map is there, may still come, or there is a camera without it. */
static bool step_map(struct machine *m)
{
	enum city_state before = m->city.state;
	m->loading = true;
	city_step(&m->city);
	m->loading = false;
	if (m->city.state == CITY_READY && before != CITY_READY)
		stats_phase(&m->stats, "map", m->started_ns);
	return m->city.state != CITY_FAILED || reverse_has_camera(&m->reverse);
}

/* This machine first, the map beside or after it: returns an exit status. */
static int start(struct machine *m)
{
	if (load_profile(m) < 0)
		return EXIT_CODE_BAD_INPUT;
	if (reserve_memory(m) < 0)
		return EXIT_CODE_FAILED;
	if (m->options.frames && make_frames_folder(m->options.frames) < 0)
		return EXIT_CODE_FAILED;
	stats_phase(&m->stats, "profile", m->started_ns);
	if (open_display(m) < 0)
		return EXIT_CODE_FAILED;
	heap_large_pages(&m->heap, true); /* loading the driver has made the heap grow */
	if (open_screen(m) < 0)
		return EXIT_CODE_FAILED;
	stats_phase(&m->stats, "display", m->started_ns);
	int status = reverse_open(&m->reverse, &m->options, &m->profile, &m->screen, m->simulated, &m->boot);
	if (status < 0)
		return status == -EINVAL ? EXIT_CODE_BAD_INPUT : EXIT_CODE_FAILED;
	status = inputs_open(&m->inputs, &m->options, &m->profile, NULL, &m->boot);
	if (status < 0)
		return status == -ENOMEM || m->inputs.machine_fault ? EXIT_CODE_FAILED : EXIT_CODE_BAD_INPUT;
	status = controls_open(&m->controls, &m->options, &m->profile, m->simulated, controls_time(m, 0), &m->boot);
	if (status < 0)
		return status == -ENOMEM ? EXIT_CODE_FAILED : EXIT_CODE_BAD_INPUT;
	standby_open(&m->standby, &m->options, &m->profile);
	stats_phase(&m->stats, "inputs", m->started_ns);
	begin_map(m);
	if (m->simulated && !step_map(m))
		return m->city.exit_code;
	return EXIT_CODE_DONE;
}

static void gather_stats(struct machine *m)
{
	struct renderer_stats drawn = { .far_name = "none" };
	if (m->city.renderer)
		renderer_stats(m->city.renderer, &drawn);
	struct stats *s = &m->stats;
	s->renderer = gfx_caps(m->screen.gfx)->renderer;
	s->far_name = drawn.far_name;
	s->width = m->options.width;
	s->height = m->options.height;
	s->samples = gfx_target_samples(m->screen.gfx, m->screen.target);
	s->tau_px = m->options.tau_px;
	s->damaged_chunks = drawn.chunks_damaged;
	s->damaged_cells = drawn.far_damaged;
	s->budget_bytes = m->options.budget_bytes;
	s->cpu_high_water_bytes = m->boot.high_water;
	s->gpu_high_water_bytes = gfx_stats(m->screen.gfx)->bytes_high_water;
	s->allocations_after_start = m->boot.late;
	s->display = m->display.ops->name;
	memcpy(s->display_detail, m->display.detail, sizeof(s->display_detail));
	s->display_counts = m->display.counts;
	inputs_stats(&m->inputs, s);
	reverse_stats(&m->reverse, &s->camera);
	controls_stats(&m->controls, &s->controls);
	s->controls.view = camera_name(m->settings.view);
	s->controls.zoom = m->settings.zoom;
	s->controls.menu_open = m->menu.open;
}

static void write_stats(struct machine *m)
{
	if (!m->options.stats)
		return;
	gather_stats(m);
	int status = stats_write(&m->stats, m->options.stats);
	if (status < 0)
		log_error("%s: cannot write: %s", m->options.stats, strerror(-status));
}

static void act(struct machine *m, enum action action)
{
	if (!m->reverse.engaged && menu_act(&m->menu, action, m->controls.now_ns))
		return;
	if (action == ACTION_QUIT || action == ACTION_ESCAPE)
		m->quit = true;
	else if (action == ACTION_PAUSE)
		m->paused = m->options.replay && !m->paused;
	else
		settings_act(&m->settings, action);
}

static void handle_controls(struct machine *m, int64_t now_ns)
{
	controls_advance(&m->controls, controls_time(m, now_ns));
	for (enum action action; (action = controls_next(&m->controls)) != ACTION_NONE; m->touched = true)
		act(m, action);
	if (m->city.renderer)
		settings_apply(&m->settings, m->city.renderer);
}

static void handle_events(struct machine *m)
{
	struct display_event event;
	m->display.ops->pump(&m->display);
	while (display_poll(&m->display, &event)) {
		if (event.kind == DISPLAY_EVENT_CLOSE)
			m->quit = true;
		else if (event.kind == DISPLAY_EVENT_KEY)
			act(m, controls_action_of_key(event.key));
		m->touched = true;
	}
}

static void count_map_frame(struct machine *m, const struct nav_view *view)
{
	struct renderer_stats drawn;
	renderer_stats(m->city.renderer, &drawn);
	struct stats *s = &m->stats;
	histogram_add(&s->triangles, drawn.triangles);
	histogram_add(&s->far_triangles, drawn.far_triangles);
	histogram_add(&s->draws, drawn.draws);
	s->fallback_frames += drawn.far_fallback;
	s->late_cell_frames += drawn.far_late;
	if (drawn.far_error_px > s->far_error_px)
		s->far_error_px = drawn.far_error_px;
	s->off_street_frames += view->located && !view->on_street;
	if (drawn.far_entered) {
		s->cells_entered = drawn.far_entered;
	} else if (view->located && view->half != m->last_half) {
		s->cells_entered++;
		m->last_half = view->half;
	}
	if (!m->city.drawn) {
		stats_phase(s, "picture", m->started_ns);
		s->first_frame_ms = (double)(clock_now_ns() - m->started_ns) / 1e6;
		arena_seal(&m->boot);
		gfx_target_refine(m->screen.gfx, m->screen.target);
		heap_large_pages(&m->heap, false);
	}
	city_drawn(&m->city);
}

static void count_frame(struct machine *m)
{
	int64_t took_ns = clock_now_ns() - m->began_ns;
	histogram_add(&m->stats.frame_ns, (uint64_t)took_ns);
	m->stats.late_frames += took_ns > NS_PER_S / m->options.fps;
	m->stats.frames++;
}

static bool is_night(const struct machine *m)
{
	double ambient = m->inputs.state.ambient;
	return settings_night(&m->settings, &m->controls.state) ||
		   (m->settings.light == LIGHT_AUTO && ambient >= 0.0 && ambient < NIGHT_AMBIENT);
}

static void draw_map(struct machine *m, int64_t now_ns, const struct nav_view *view)
{
	struct overlay_driver driver = settings_driver(&m->settings, &m->controls.state);
	driver.menu = menu_step(&m->menu, fabs(view->speed_mps) > MOVING_MPS, m->controls.now_ns);
	driver.devices = controls_fault(&m->controls);
	struct renderer_time time = {
		.time_ns = now_ns,
		.wall_ns = inputs_wall_ns(&m->inputs, now_ns),
		.force_night = settings_night(&m->settings, &m->controls.state),
		.force_day = m->settings.light == LIGHT_DAY,
		.ambient = m->settings.light == LIGHT_DAY ? 1.0 : view->ambient,
		.driver = &driver,
	};
	m->loading = !m->city.drawn;
	renderer_draw(m->city.renderer, view, &time);
	m->loading = false;
}

/* What the screen shall show now, drawn: the reversing picture before everything. False: nothing new. */
static bool draw(struct machine *m, int64_t now_ns, const struct nav_view *view)
{
	bool failed = m->city.state == CITY_FAILED;
	struct reverse_input input = {
		.now_ns = controls_time(m, now_ns),
		.frames_to_clock_ns = m->origin_ns,
		.vehicle = &m->inputs.vehicle,
		.state = &m->inputs.state,
		.line = &m->controls.state.reverse,
		.night = is_night(m),
		.note = failed ? "NO MAP" : NULL,
	};
	m->began_ns = clock_now_ns();
	if (reverse_update(&m->reverse, &input)) {
		menu_close(&m->menu);
		reverse_draw(&m->reverse, &input);
		return true;
	}
	if (m->loading)
		return false;
	if (m->city.state == CITY_READY)
		draw_map(m, now_ns, view);
	else if (failed)
		reverse_view_notice(&m->reverse.view, "NO MAP", "THE CITY FILE IS MISSING OR DAMAGED", true, input.night);
	return m->city.state == CITY_READY || failed;
}

/* Shows what was drawn, and counts it. Returns 0 or -errno. */
static int show(struct machine *m, int64_t now_ns)
{
	panel_bring_out(&m->display, &m->screen, m->pixels);
	if (reverse_outdated(&m->reverse, controls_time(m, now_ns)))
		panel_bring_out(&m->display, &m->screen, m->pixels);
	count_frame(m);
	int status = panel_show(&m->display, &m->screen, m->pixels);
	reverse_shown(&m->reverse, controls_time(m, now_ns));
	return status;
}

static int save_frame(struct machine *m)
{
	uint64_t number = m->stats.frames - 1;
	if (!m->options.frames || number % m->options.every)
		return 0;
	char path[4096];
	if (snprintf(path, sizeof(path), "%s/frame-%06llu.png", m->options.frames, (unsigned long long)number) >=
		(int)sizeof(path))
		return -ENAMETOOLONG;
	if (m->display.surface == DISPLAY_SURFACE_WINDOW)
		screen_read_pixels(&m->screen, m->pixels);
	return png_write(path, m->pixels, m->options.width, m->options.height);
}

/* As bright as the light around the car wants it. */
static void set_brightness(struct machine *m, int64_t now_ns, bool dark)
{
	struct renderer_stats drawn = { 0 };
	if (m->city.renderer)
		renderer_stats(m->city.renderer, &drawn);
	struct panel_scene scene = { .now_ns = now_ns,
		.dark = dark,
		.night = is_night(m) ? 1.0 : drawn.night,
		.ambient = m->settings.light == LIGHT_AUTO ? m->inputs.state.ambient : -1.0 };
	m->menu.has_brightness = m->display.ops->set_brightness != NULL;
	display_set_brightness(&m->display, panel_level(&m->pace, &scene) * (float)m->settings.brightness / 100.0f);
}

/* Nothing to see: the ignition is off. */
static int draw_dark(struct machine *m)
{
	screen_draw_dark(&m->screen);
	panel_bring_out(&m->display, &m->screen, m->pixels);
	m->stats.frames++;
	int status = panel_show(&m->display, &m->screen, m->pixels);
	return status < 0 ? status : save_frame(m);
}

/* The frames' clock of the next frame; waits for it unless the clock is simulated. */
static int64_t next_time(struct machine *m, int64_t last_ns)
{
	int64_t period =
		NS_PER_S / power_fps(&m->standby.power, panel_fps(&m->pace, &(struct panel_scene){ .now_ns = last_ns,
																		.speed_mps = m->inputs.state.speed_mps,
																		.touched = m->touched }));
	m->touched = false;
	if (m->simulated)
		return (int64_t)m->stats.frames * NS_PER_S / m->options.fps;
	clock_sleep_until(m->origin_ns + last_ns + period);
	int64_t now = clock_now_ns() - m->origin_ns;
	if (m->paused) {
		m->origin_ns += now - last_ns;
		return last_ns;
	}
	return now;
}

static bool is_over(const struct machine *m)
{
	return m->quit || stop_asked || (m->options.limit && m->stats.frames >= m->options.limit) ||
		   (m->options.replay && inputs_ended(&m->inputs));
}

/* The frames' clock begins with the map, or at once when a camera does not wait for it. */
static bool start_clock(struct machine *m)
{
	if (!m->running && (m->city.state == CITY_READY || reverse_has_camera(&m->reverse))) {
		m->running = true;
		m->origin_ns = m->options.replay && !m->simulated ? clock_now_ns() : 0;
	}
	return m->running;
}

/* Called again and again while the map loads: listens, and draws if the car is put into reverse. Not while the
 * reversing picture itself is being drawn between two steps: it would be drawn into from within. */
static void while_loading(void *context)
{
	static struct nav_view view;
	struct machine *m = context;
	int64_t began_ns = m->began_ns, now_ns = clock_now_ns();
	if (!m->loading || now_ns - m->looked_ns < WHILE_LOADING_NS || !start_clock(m))
		return;
	m->looked_ns = now_ns;
	now_ns -= m->origin_ns;
	handle_events(m);
	controls_advance(&m->controls, controls_time(m, now_ns));
	inputs_advance(&m->inputs, now_ns, &view);
	if (!m->display.hidden && draw(m, now_ns, &view))
		show(m, now_ns);
	notify_alive(&m->notify, clock_now_ns());
	m->began_ns = began_ns;
}

static int step(struct machine *m, int64_t now_ns)
{
	static struct nav_view view;
	handle_controls(m, now_ns);
	inputs_advance(&m->inputs, now_ns, &view);
	m->menu.has_route = view.routed;
	settings_filter(&m->settings, m->inputs.destinations, &view);
	enum standby_order order = standby_advance(&m->standby, &m->inputs, &m->controls.state.ignition, now_ns);
	m->quit |= order == STANDBY_END;
	if (m->display.hidden)
		return 0;
	if (!m->simulated)
		set_brightness(m, now_ns, order != STANDBY_RUN);
	if (order != STANDBY_RUN)
		return draw_dark(m);
	if (!draw(m, now_ns, &view)) {
		clock_sleep_until(clock_now_ns() + LOADING_STEP_NS);
		return 0;
	}
	int status = show(m, now_ns);
	if (m->city.state == CITY_READY && !m->reverse.engaged)
		count_map_frame(m, &view);
	return status < 0 ? status : save_frame(m);
}

static int run(struct machine *m)
{
	int64_t now_ns = 0;
	m->last_half = PKG_NONE;
	while (!is_over(m)) {
		handle_events(m);
		if (!step_map(m))
			break;
		standby_begin(&m->standby, &m->options, &m->inputs);
		if (!start_clock(m)) { /* what was on the screen before stays */
			clock_sleep_until(clock_now_ns() + LOADING_STEP_NS);
			continue;
		}
		now_ns = next_time(m, now_ns);
		if (step(m, now_ns) < 0)
			return EXIT_CODE_FAILED;
		if (m->stats.frames || m->display.hidden) /* no panel is a state, not a failed start */
			notify_ready(&m->notify, NULL);
		notify_alive(&m->notify, clock_now_ns());
		if (stats_asked) {
			stats_asked = 0;
			write_stats(m);
		}
	}
	return m->city.exit_code;
}

static int finish(struct machine *m, int code)
{
	notify_close(&m->notify);
	if (m->screen.gfx && m->stats.frames)
		write_stats(m);
	standby_close(&m->standby, &m->inputs);
	int status = inputs_close(&m->inputs);
	if (status < 0 && code == EXIT_CODE_DONE) {
		log_error("%s: cannot write: %s", m->options.record, strerror(-status));
		code = EXIT_CODE_FAILED;
	}
	controls_close(&m->controls);
	city_finish(&m->city);
	reverse_close(&m->reverse);
	screen_finish(&m->screen);
	display_close(&m->display);
	if (m->memory)
		munmap(m->memory, (size_t)m->memory_bytes);
	return code;
}

#ifdef __SANITIZE_ADDRESS__
/* GL drivers hold memory to the end of the process; nothing of ours comes from the heap. */
const char *__asan_default_options(void); /* NOLINT: the sanitizer's name */
const char *__asan_default_options(void)  /* NOLINT */
{
	return "detect_leaks=0";
}
#endif

int main(int argc, char **argv)
{
	machine.started_ns = clock_now_ns();
	catch_signals();
	log_init("boulevard", LOG_INFO);
	options_parse(&machine.options, argc, argv);
	int status = notify_open(&machine.notify);
	if (status < 0)
		log_warn("NOTIFY_SOCKET: %s", strerror(-status));
	if (machine.options.verbose)
		log_init("boulevard", LOG_DEBUG);
	int code = start(&machine);
	if (code == EXIT_CODE_DONE)
		code = run(&machine);
	return finish(&machine, code);
}
