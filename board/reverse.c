#include "board/reverse.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define AHEAD_FIRST_NS (20 * NS_PER_MS)
#define AHEAD_MAX_NS (120 * NS_PER_MS) /* a machine that takes longer shows late pictures, and counts them */

static struct camera_config camera_config_of(const struct profile_camera *from, const char *source)
{
	return (struct camera_config){
		.source = source,
		.width = from->width,
		.height = from->height,
		.fps = from->fps,
		.format = from->format,
		.lens = { .kind = from->lens,
			.fov_rad = fmin(from->fov_deg, from->lens == LENS_PINHOLE ? 170.0 : 220.0) * (BLVD_PI / 180.0),
			.k1 = from->k1,
			.k2 = from->k2 },
		.mount = { .height_m = from->height_m,
			.back_m = from->behind_axle_m,
			.right_m = from->offset_m,
			.pitch_rad = from->pitch_deg * (BLVD_PI / 180.0) },
	};
}

static int open_view(
	struct reverse *reverse, const struct camera_config *camera, const struct screen *screen, struct arena *arena)
{
	const struct profile *profile = reverse->profile;
	struct reverse_view_config config = {
		.width = camera->width,
		.height = camera->height,
		.guide = { .lens = camera->lens,
			.mount = camera->mount,
			.wheelbase_m = profile->wheelbase_m,
			.width_m = profile->width_m,
			.overhang_m = profile->rear_overhang_m,
			.mirror = profile->camera.mirror },
	};
	int status = reverse_view_init(&reverse->view, arena, screen, &config);
	if (status < 0)
		log_error("no reversing picture of %u x %u: %s", camera->width, camera->height, strerror(-status));
	return status;
}

int reverse_open(struct reverse *reverse, const struct options *options, const struct profile *profile,
	const struct screen *screen, bool simulated, struct arena *arena)
{
	*reverse = (struct reverse){ .profile = profile, .simulated = simulated };
	const char *device = options->camera ? options->camera : profile->camera.device;
	if (!device || !strcmp(device, "none"))
		return 0;
	bool sim = !strcmp(device, "sim") || !strncmp(device, "sim:", 4);
	if (simulated && !sim) {
		log_warn("a replay on a simulated clock has no live camera: %s is not used", device);
		return 0;
	}
	struct camera_config config = camera_config_of(&profile->camera, sim ? device + strcspn(device, ":") : device);
	config.source += sim && *config.source == ':';
	int status = camera_open(&reverse->camera, sim ? &camera_sim : &camera_v4l2, &config, arena);
	if (status == 0)
		status = open_view(reverse, &config, screen, arena);
	if (status < 0)
		reverse_close(reverse);
	reverse->images.gfx = screen->gfx;
	/* a CPU that draws gains nothing by it, and Mesa's crashes on buffers of some devices */
	reverse->images.wanted = profile->camera.zero_copy == PROFILE_ZERO_COPY_AUTO
								 ? !gfx_caps(screen->gfx)->software
								 : profile->camera.zero_copy == PROFILE_ZERO_COPY_YES;
	if (profile->camera.zero_copy == PROFILE_ZERO_COPY_YES && gfx_caps(screen->gfx)->software)
		log_warn("camera: zero_copy = yes gains nothing where a CPU draws");
	reverse->watch.look_for_repeats = profile->camera.repeats;
	reverse->ahead_ns = simulated ? 0 : AHEAD_FIRST_NS;
	return status;
}

void reverse_close(struct reverse *reverse)
{
	camera_images_finish(&reverse->images);
	camera_close(&reverse->camera);
	reverse_view_finish(&reverse->view);
	*reverse = (struct reverse){ 0 };
}

bool reverse_has_camera(const struct reverse *reverse)
{
	return reverse->camera.ops != NULL;
}

enum heard { HEARD_NOTHING, HEARD_REVERSE, HEARD_OTHER };

/* Gear and contact: one that says reverse is enough. */
static enum heard listen(const struct reverse_input *input, int64_t *edge_ns)
{
	enum heard heard = HEARD_NOTHING;
	bool gear_good = input->state->state[VEHICLE_GEAR] == NAV_SIGNAL_GOOD;
	if (gear_good && input->state->gear != NAV_GEAR_UNKNOWN)
		heard = input->state->gear == NAV_GEAR_REVERSE ? HEARD_REVERSE : HEARD_OTHER;
	*edge_ns = input->vehicle->inputs[VEHICLE_GEAR].changed_ns + input->frames_to_clock_ns;
	if (!input->line->known)
		return heard;
	if (!input->line->on)
		return heard == HEARD_NOTHING ? HEARD_OTHER : heard;
	if (heard != HEARD_REVERSE || input->line->since_ns < *edge_ns)
		*edge_ns = input->line->since_ns;
	return HEARD_REVERSE;
}

static void engage(struct reverse *reverse, int64_t now_ns, int64_t edge_ns)
{
	reverse->engaged = true;
	reverse->waiting = true;
	reverse->edge_ns = edge_ns > now_ns ? now_ns : edge_ns;
	reverse->stats.reversed++;
}

/* Something said forward, or nothing says anything and the car shows it. */
static bool stays(struct reverse *reverse, const struct reverse_input *input, enum heard heard)
{
	if (heard == HEARD_OTHER)
		return input->now_ns - reverse->reverse_ns < REVERSE_HOLD_NS;
	if (!reverse->lost_ns)
		reverse->lost_ns = input->now_ns;
	bool forward = input->state->speed_usable && fabs(input->state->speed_mps) > REVERSE_FORWARD_MPS;
	return !forward && input->now_ns - reverse->lost_ns < REVERSE_LOST_NS;
}

static void update_engaged(struct reverse *reverse, const struct reverse_input *input)
{
	int64_t edge_ns;
	enum heard heard = listen(input, &edge_ns);
	if (heard != HEARD_NOTHING)
		reverse->lost_ns = 0;
	if (heard == HEARD_REVERSE) {
		if (!reverse->was_reverse && !reverse->engaged)
			engage(reverse, input->now_ns, edge_ns);
		reverse->reverse_ns = input->now_ns;
		reverse->was_reverse = true;
		return;
	}
	reverse->was_reverse = reverse->was_reverse && heard == HEARD_NOTHING;
	if (reverse->engaged && !stays(reverse, input, heard))
		reverse->engaged = reverse->was_reverse = false;
}

static void look_at_camera(struct reverse *reverse, int64_t now_ns)
{
	struct camera_frame frame;
	struct camera_status status;
	if (camera_latest(&reverse->camera, now_ns, &frame)) {
		reverse->has_frame = camera_watch_frame(&reverse->watch, &frame, now_ns);
		reverse->frame = frame;
		reverse->uploaded = false;
	}
	camera_status(&reverse->camera, &status);
	if (status.link == CAMERA_ABSENT || reverse->frame.session != status.sessions)
		reverse->has_frame = false; /* its memory is gone */
	enum watch_state state = camera_watch_state(&reverse->watch, status.link, now_ns, reverse->ahead_ns);
	if (state != reverse->watched) {
		reverse->stats.frozen += state == WATCH_FROZEN;
		reverse->stats.missing += state == WATCH_MISSING;
		if (state == WATCH_MISSING)
			log_warn("camera: no picture%s%s", status.trouble[0] ? ": " : "", status.trouble);
		else if (state == WATCH_FROZEN)
			log_warn("camera: frozen");
		else if (state == WATCH_LIVE)
			log_info("camera: live, %s", status.format);
	}
	reverse->state = reverse->watched = state;
}

/* The newest frame to the GPU: in place if that can be, else by a copy. False: it is larger than was agreed. */
static bool bring_frame(struct reverse *reverse)
{
	bool changed;
	gfx_texture texture = camera_images_of(&reverse->images, &reverse->camera, &reverse->frame, &changed);
	if (changed)
		reverse_view_forget(&reverse->view);
	if (!texture.id) {
		reverse->stats.copied++;
		return reverse_view_upload(&reverse->view, &reverse->frame);
	}
	reverse->stats.in_place++;
	reverse_view_use(&reverse->view, &reverse->frame, texture);
	return true;
}

/* The driver of the GPU makes a program's last form at its first use, which may take longer than a picture has: one
 * picture that nobody sees, as soon as the camera's format is known. */
static void warm_up(struct reverse *reverse)
{
	if (reverse->engaged || reverse->warmed || reverse->state != WATCH_LIVE || !reverse->has_frame)
		return;
	reverse->warmed = true;
	if (!bring_frame(reverse))
		return;
	reverse_view_draw(&reverse->view, &(struct reverse_view_state){ .angle_known = true, .note = " " });
}

bool reverse_update(struct reverse *reverse, const struct reverse_input *input)
{
	if (!reverse_has_camera(reverse))
		return false;
	reverse->drawn_for_ns = input->now_ns;
	update_engaged(reverse, input);
	look_at_camera(reverse, input->now_ns);
	warm_up(reverse);
	return reverse->engaged;
}

static void draw_words(struct reverse *reverse)
{
	static const char *const titles[] = {
		[WATCH_STARTING] = "CAMERA STARTS",
		[WATCH_LIVE] = "NO CAMERA PICTURE", /* live, but not to be drawn: larger than was agreed */
		[WATCH_FROZEN] = "CAMERA FROZEN",
		[WATCH_MISSING] = "NO CAMERA PICTURE",
	};
	reverse_view_notice(
		&reverse->view, titles[reverse->state], "LOOK BEHIND YOU", reverse->state != WATCH_STARTING, reverse->night);
}

void reverse_draw(struct reverse *reverse, const struct reverse_input *input)
{
	const struct vehicle_state *state = input->state;
	reverse->night = input->night;
	reverse->live = reverse->state == WATCH_LIVE && reverse->has_frame;
	if (reverse->live && !reverse->uploaded)
		reverse->live = reverse->uploaded = bring_frame(reverse);
	if (!reverse->live) {
		draw_words(reverse);
		return;
	}
	const struct profile *profile = reverse->profile;
	struct reverse_view_state shown = {
		.night = input->night,
		.angle_known = state->state[VEHICLE_STEERING] == NAV_SIGNAL_GOOD && profile->wheelbase_m > 0.0,
		.angle_rad = (state->value[VEHICLE_STEERING] - profile->steering_centre_deg * (BLVD_PI / 180.0)) /
					 profile->steering_ratio,
		.note = input->note,
	};
	if (!shown.angle_known && !shown.note && state->state[VEHICLE_STEERING] != NAV_SIGNAL_ABSENT)
		shown.note = "STEERING ANGLE UNKNOWN";
	reverse_view_draw(&reverse->view, &shown);
}

bool reverse_outdated(struct reverse *reverse, int64_t now_ns)
{
	if (!reverse->engaged || !reverse->live || now_ns - reverse->frame.time_ns <= WATCH_AGE_NS)
		return false;
	reverse->live = false;
	reverse->state = reverse->waiting ? WATCH_STARTING : WATCH_FROZEN;
	if (reverse->stats.withdrawn++ == 0)
		log_warn("camera: a picture was too old when it was drawn; words are shown where that happens");
	draw_words(reverse);
	return true;
}

void reverse_shown(struct reverse *reverse, int64_t now_ns)
{
	if (!reverse_has_camera(reverse))
		return;
	int64_t took_ns = now_ns - reverse->drawn_for_ns;
	if (!reverse->simulated) {
		reverse->ahead_ns = took_ns > reverse->ahead_ns ? took_ns : reverse->ahead_ns - reverse->ahead_ns / 16;
		reverse->ahead_ns = reverse->ahead_ns > AHEAD_MAX_NS ? AHEAD_MAX_NS : reverse->ahead_ns;
	}
	if (!reverse->live || !reverse->engaged)
		return;
	int64_t age_ns = now_ns - reverse->frame.time_ns;
	reverse->stats.shown++;
	reverse->stats.too_old += age_ns > WATCH_AGE_NS;
	histogram_add(&reverse->stats.age_ns, age_ns > 0 ? (uint64_t)age_ns : 0);
	if (!reverse->waiting)
		return;
	reverse->waiting = false;
	histogram_add(&reverse->stats.edge_ns, (uint64_t)(now_ns - reverse->edge_ns));
}

void reverse_stats(const struct reverse *reverse, struct camera_stats *out)
{
	struct camera_status status;
	camera_status(&reverse->camera, &status);
	*out = reverse->stats;
	out->configured = reverse_has_camera(reverse);
	out->frames = status.frames;
	out->bad = status.bad + reverse->watch.backwards;
	out->skipped = status.skipped;
	out->sessions = status.sessions;
	out->decode_ns_max = status.decode_ns_max;
	memcpy(out->format, status.format, sizeof(out->format));
}
