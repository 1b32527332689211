/*
 * A camera that is not there: sim_scene.h's picture, a frame every 1/fps of the clock that is handed in, so a replay
 * gives the same frames. Its script is words separated by commas:
 *
 *     640x480  fps=15  yuyv uyvy nv12 rgbx bgrx       what it offers; its own size, at most that of the config
 *     KIND@START+SECONDS                              a fault, from START seconds after the first look at it
 *     control=PATH                                    a pipe (mkfifo): a line "KIND SECONDS" is a fault from now on
 *
 *     frozen   frames go on, with new numbers and times, but the picture is that of START
 *     stalled  no more frames, the device is there
 *     missing  unplugged, and plugged in again
 *     late     every frame comes 300 ms after its capture
 *     torn     every frame is cut short
 *     size     every frame has another size than was agreed
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/camera/camera.h"
#include "platform/camera/sim_scene.h"

#define FAULTS_MAX 16
#define LATE_NS (300 * NS_PER_MS)
#define OPENING_NS (100 * NS_PER_MS) /* from plugged in to the first frame */

enum fault_kind { FAULT_FROZEN, FAULT_STALLED, FAULT_MISSING, FAULT_LATE, FAULT_TORN, FAULT_SIZE, FAULT_COUNT };
static const char *const fault_names[FAULT_COUNT] = { "frozen", "stalled", "missing", "late", "torn", "size" };

struct fault {
	enum fault_kind kind;
	int64_t from_ns, until_ns;
};

struct sim {
	struct camera_config config;
	struct fault faults[FAULTS_MAX];
	uint32_t fault_count;
	struct camera_frame layout;
	uint8_t *scene, *memory; /* without and with the number */
	int64_t period_ns;
	bool started;
	int64_t start_ns;   /* the first look */
	int64_t plugged_ns; /* since the start: when this session began */
	int64_t looked;     /* number of the last frame that was looked at; -1 none */
	int control;        /* pipe; -1 none */
	char line[64];      /* of it, so far */
	size_t length;
	struct camera_status status;
};

static bool parse_fault(struct sim *sim, const char *word)
{
	for (int kind = 0; kind < FAULT_COUNT; kind++) {
		size_t length = strlen(fault_names[kind]);
		double from, seconds;
		char extra;
		if (strncmp(word, fault_names[kind], length) != 0 || word[length] != '@')
			continue;
		if (sscanf(word + length + 1, "%lf+%lf%c", &from, &seconds, &extra) != 2 || !(from >= 0.0 && from < 1e6) ||
			!(seconds > 0.0 && seconds < 1e6) || sim->fault_count == FAULTS_MAX)
			return false;
		sim->faults[sim->fault_count++] =
			(struct fault){ (enum fault_kind)kind, (int64_t)(from * 1e9), (int64_t)((from + seconds) * 1e9) };
		return true;
	}
	return false;
}

/* Both ends are held, so that it never ends. */
static bool open_control(struct sim *sim, const char *path)
{
	sim->control = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	return sim->control >= 0;
}

/* "KIND SECONDS" */
static void take_order(struct sim *sim, const char *line, int64_t at_ns)
{
	char word[16], extra;
	double seconds;
	int kind = 0;
	bool whole = sscanf(line, "%15s %lf %c", word, &seconds, &extra) == 2 && seconds > 0.0 && seconds < 1e6;
	while (whole && kind < FAULT_COUNT && strcmp(word, fault_names[kind]) != 0)
		kind++;
	if (!whole || kind == FAULT_COUNT) {
		log_warn("simulated camera: '%s' is no fault and seconds", line);
		return;
	}
	uint32_t place = 0; /* of one that is over, or a new one */
	while (place < sim->fault_count && sim->faults[place].until_ns > at_ns)
		place++;
	if (place == FAULTS_MAX)
		return;
	sim->fault_count += place == sim->fault_count;
	sim->faults[place] = (struct fault){ (enum fault_kind)kind, at_ns, at_ns + (int64_t)(seconds * 1e9) };
}

static void take_orders(struct sim *sim, int64_t at_ns)
{
	char c;
	while (sim->control >= 0 && read(sim->control, &c, 1) == 1) {
		if (c != '\n' && sim->length + 1 < sizeof(sim->line)) {
			sim->line[sim->length++] = c;
		} else if (c == '\n') {
			sim->line[sim->length] = 0;
			sim->length = 0;
			take_order(sim, sim->line, at_ns);
		}
	}
}

static bool parse_word(struct sim *sim, const char *word)
{
	struct camera_config *config = &sim->config;
	uint32_t width, height, fps;
	char extra;
	enum camera_format format = camera_format_by_name(word);
	if (sscanf(word, "%ux%u%c", &width, &height, &extra) == 2) {
		bool fits = width >= 16 && height >= 16 && width <= config->width && height <= config->height;
		config->width = width & ~1u;
		config->height = height & ~1u;
		return fits;
	}
	if (sscanf(word, "fps=%u%c", &fps, &extra) == 1) {
		config->fps = fps;
		return fps >= 1 && fps <= 240;
	}
	if (format != CAMERA_FORMAT_COUNT && camera_format_bytes(format, 2, 2) && format != CAMERA_PLANES) {
		config->format = format;
		return true;
	}
	if (!strncmp(word, "control=", 8))
		return open_control(sim, word + 8);
	return parse_fault(sim, word);
}

static int parse_script(struct sim *sim, const char *script)
{
	char word[128];
	while (script && *script) {
		size_t length = strcspn(script, ",");
		snprintf(word, sizeof(word), "%.*s", (int)length, script);
		if (length >= sizeof(word) || (length && !parse_word(sim, word))) {
			log_error(
				"simulated camera: '%s' is no size up to %u x %u, no fps=N, no format, no pipe, no FAULT@START+SECONDS",
				word, sim->config.width, sim->config.height);
			return -EINVAL;
		}
		script += length + (script[length] == ',');
	}
	return 0;
}

static int sim_open(struct camera_device *camera, const struct camera_config *config, struct arena *arena)
{
	struct sim *sim = ARENA_ARRAY(arena, struct sim, 1);
	if (!sim)
		return -ENOMEM;
	sim->config = *config;
	sim->control = -1;
	sim->config.format = CAMERA_FORMAT_ANY;
	int status = parse_script(sim, config->source);
	if (status < 0) {
		if (sim->control >= 0)
			close(sim->control);
		return status;
	}
	struct camera_config *own = &sim->config;
	if (own->format == CAMERA_FORMAT_ANY)
		own->format =
			config->format == CAMERA_FORMAT_ANY || config->format == CAMERA_MJPEG ? CAMERA_YUYV : config->format;
	size_t bytes = (size_t)camera_format_bytes(own->format, own->width, own->height);
	sim->scene = arena_alloc(arena, bytes, 64);
	sim->memory = arena_alloc(arena, bytes, 64);
	if (!sim->scene || !sim->memory)
		return -ENOMEM;
	sim->layout = (struct camera_frame){
		.format = own->format, .width = own->width, .height = own->height, .buffer = UINT32_MAX
	};
	uint32_t stride = own->format == CAMERA_NV12 ? own->width : (uint32_t)(bytes / own->height);
	camera_frame_layout(&sim->layout, sim->memory, stride);
	sim_scene_draw(own, &sim->layout, sim->scene);
	memcpy(sim->memory, sim->scene, bytes);
	sim->period_ns = NS_PER_S / own->fps;
	sim->looked = -1;
	snprintf(sim->status.format, sizeof(sim->status.format), "%s %ux%u %u/s", camera_format_name(own->format),
		own->width, own->height, own->fps);
	log_info("camera: simulated, %s", sim->status.format);
	camera->impl = sim;
	return 0;
}

static void sim_close(struct camera_device *camera)
{
	struct sim *sim = camera->impl;
	if (sim->control >= 0)
		close(sim->control);
	sim->control = -1;
}

static const struct fault *fault_at(const struct sim *sim, enum fault_kind kind, int64_t at_ns)
{
	for (uint32_t i = 0; i < sim->fault_count; i++)
		if (sim->faults[i].kind == kind && at_ns >= sim->faults[i].from_ns && at_ns < sim->faults[i].until_ns)
			return &sim->faults[i];
	return NULL;
}

/* Whether it is plugged in, which begins a session. */
static bool is_there(struct sim *sim, int64_t at_ns)
{
	const struct fault *missing = fault_at(sim, FAULT_MISSING, at_ns);
	if (missing) {
		sim->status.link = CAMERA_ABSENT;
		snprintf(sim->status.trouble, sizeof(sim->status.trouble), "unplugged");
		sim->plugged_ns = missing->until_ns;
		return false;
	}
	if (sim->status.link == CAMERA_ABSENT) {
		sim->status.link = CAMERA_OPENING;
		sim->status.trouble[0] = 0;
		sim->status.sessions++;
	}
	return true;
}

/* The newest frame that has arrived by then, -1 none. */
static int64_t newest(const struct sim *sim, int64_t at_ns)
{
	for (int64_t number = at_ns / sim->period_ns; number >= 0; number--) {
		int64_t taken_ns = number * sim->period_ns;
		if (taken_ns < sim->plugged_ns + (sim->plugged_ns ? OPENING_NS : 0) || taken_ns + NS_PER_S < at_ns)
			return -1;
		if (fault_at(sim, FAULT_STALLED, taken_ns) || fault_at(sim, FAULT_MISSING, taken_ns))
			continue;
		if (!fault_at(sim, FAULT_LATE, taken_ns) || taken_ns + LATE_NS <= at_ns)
			return number;
	}
	return -1;
}

static bool sim_latest(struct camera_device *camera, int64_t now_ns, struct camera_frame *out)
{
	struct sim *sim = camera->impl;
	if (!sim->started) {
		sim->started = true;
		sim->start_ns = now_ns;
	}
	int64_t at_ns = now_ns - sim->start_ns;
	take_orders(sim, at_ns);
	int64_t number = is_there(sim, at_ns) ? newest(sim, at_ns) : -1;
	if (number < 0 || number == sim->looked)
		return false;
	sim->looked = number;
	int64_t taken_ns = number * sim->period_ns;
	if (fault_at(sim, FAULT_TORN, taken_ns) || fault_at(sim, FAULT_SIZE, taken_ns)) {
		sim->status.bad++;
		return false;
	}
	sim->status.frames++;
	sim->status.link = CAMERA_STREAMING;
	const struct fault *frozen = fault_at(sim, FAULT_FROZEN, taken_ns);
	int64_t shown = frozen ? frozen->from_ns / sim->period_ns : number;
	memcpy(sim->memory, sim->scene,
		(size_t)camera_format_bytes(sim->config.format, sim->config.width, sim->config.height));
	sim_scene_number(&sim->layout, sim->memory, (uint32_t)shown);
	*out = sim->layout;
	out->time_ns = sim->start_ns + taken_ns;
	out->sequence = (uint32_t)number;
	out->session = sim->status.sessions;
	out->digest = camera_digest(out);
	return true;
}

static void sim_status(const struct camera_device *camera, struct camera_status *out)
{
	const struct sim *sim = camera->impl;
	*out = sim->status;
}

const struct camera_ops camera_sim = {
	.name = "sim",
	.open = sim_open,
	.close = sim_close,
	.latest = sim_latest,
	.status = sim_status,
};
