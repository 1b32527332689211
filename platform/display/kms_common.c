/*
 * The KMS display as a whole. At start the device is looked at but not touched: whatever a boot splash shows stays
 * until the first picture of ours is drawn, and only that one sets the mode. From then on pictures flip, and every
 * surprise (panel gone, terminal switched, master lost, a flip without an answer) leads back to that same first step.
 */
#include <drm_fourcc.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/display/kms.h"

#define FLIP_MAX_NS NS_PER_S /* the slowest flip that is waited for */
#define RETRY_NS (NS_PER_S / 2)
#define CARDS_MAX 16

/* --- pictures ------------------------------------------------------------------------------------------------------
 */

static void give_back(struct kms *kms, struct kms_frame *frame)
{
	if (frame->fb)
		kms->buffers->give_back(kms, frame);
	*frame = (struct kms_frame){ 0 };
}

static void now_on_screen(struct kms *kms, const struct kms_frame *frame)
{
	give_back(kms, &kms->on_screen);
	kms->on_screen = *frame;
	kms->counts.flips++;
}

static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc, void *user)
{
	(void)fd;
	(void)sequence;
	(void)seconds;
	(void)microseconds;
	(void)crtc;
	struct kms *kms = user;
	if (!kms->pending.fb)
		return; /* given up before */
	now_on_screen(kms, &kms->pending);
	kms->pending = (struct kms_frame){ 0 };
}

/* Takes the events that are there within `timeout_ms`; false when there were none. */
static bool take_events(struct kms *kms, int timeout_ms)
{
	drmEventContext context = { .version = 3, .page_flip_handler2 = on_flip };
	struct pollfd wait = { .fd = kms->fd, .events = POLLIN };
	if (poll(&wait, 1, timeout_ms) <= 0 || !(wait.revents & POLLIN))
		return false;
	return kms->drm->handle_event(kms->fd, &context) == 0;
}

void kms_wait(struct kms *kms)
{
	while (kms->pending.fb) {
		int64_t left = kms->flip_asked_ns + FLIP_MAX_NS - clock_now_ns();
		if (take_events(kms, left > 0 ? (int)(left / NS_PER_MS) + 1 : 0)) /* it may be there since long */
			continue;
		if (left > 0 && clock_now_ns() < kms->flip_asked_ns + FLIP_MAX_NS)
			continue; /* a signal */
		log_warn("%s: no answer to a flip; setting the mode again", kms->output.name);
		give_back(kms, &kms->pending);
		kms->counts.missed++;
		if (kms->state == KMS_ON)
			kms->state = KMS_FRESH;
	}
}

/* Nothing of ours is shown any more, as far as we know. */
static void forget_pictures(struct kms *kms)
{
	give_back(kms, &kms->pending);
	give_back(kms, &kms->on_screen);
}

/* --- modes ---------------------------------------------------------------------------------------------------------
 */

static void turned_size(const drmModeModeInfo *mode, unsigned turn_deg, uint32_t *width, uint32_t *height)
{
	bool across = turn_deg % 180 != 0;
	*width = across ? mode->vdisplay : mode->hdisplay;
	*height = across ? mode->hdisplay : mode->vdisplay;
}

/* Asks the device about a mode with a buffer that nobody sees. */
static int test_mode(struct kms *kms, const drmModeModeInfo *mode, unsigned turn_deg)
{
	struct kms_dumb_buffer buffer;
	uint32_t width, height, fb = 0;
	turned_size(mode, turn_deg, &width, &height);
	if (kms->drm->create_dumb(kms->fd, width, height, &buffer))
		return -EOPNOTSUPP;
	int err = -EOPNOTSUPP;
	if (!kms->drm->add_fb(kms->fd, width, height, buffer.handle, buffer.pitch, DRM_FORMAT_MOD_INVALID, &fb)) {
		err = kms->commit->test(kms, mode, fb, turn_deg);
		kms->drm->remove_fb(kms->fd, fb);
	}
	kms->drm->destroy_dumb(kms->fd, &buffer);
	return err;
}

/* The first candidate that the device accepts becomes the mode. False when it accepts none. */
static bool try_modes(struct kms *kms)
{
	struct kms_output *output = &kms->output;
	drmModeModeInfo first = output->mode;
	for (uint32_t i = 0; i < output->candidate_count; i++) {
		int err = test_mode(kms, &output->candidates[i], 0);
		if (err == -EOPNOTSUPP || err == -EACCES || err == -EPERM)
			return true; /* not to be had now: the first candidate, unasked */
		if (err)
			continue;
		output->mode = output->candidates[i];
		output->shown_before = output->shown_before && kms_mode_same(&first, &output->mode);
		if (i)
			log_info("%s: %u mode(s) refused", output->name, i);
		return true;
	}
	return false;
}

static void choose_way(struct kms *kms)
{
	kms->plane_turn_deg = 0;
	if (!try_modes(kms) && kms->commit == &kms_atomic) {
		log_info("%s: no mode works with atomic requests; without them", kms->output.name);
		kms->commit = &kms_legacy;
	}
	unsigned turn = kms->config->rotation_deg;
	if (turn && !test_mode(kms, &kms->output.mode, turn))
		kms->plane_turn_deg = turn;
}

void kms_size(const struct kms *kms, uint32_t *width, uint32_t *height)
{
	turned_size(&kms->output.mode, kms->plane_turn_deg, width, height);
}

unsigned kms_turn_left(const struct kms *kms)
{
	return kms->config->rotation_deg - kms->plane_turn_deg;
}

/* A panel is there: chooses its mode and makes buffers of its size. */
static void panel_came(struct kms *kms)
{
	choose_way(kms);
	forget_pictures(kms);
	int err = kms->buffers ? kms->buffers->resize(kms) : 0;
	if (err)
		log_error("%s: no buffers: %s", kms->output.name, strerror(-err));
	kms->state = kms->is_master ? KMS_FRESH : KMS_AWAY;
	kms->retry_ns = 0;
}

static void panel_went(struct kms *kms)
{
	log_warn("%s: nothing is connected; waiting", kms->output.name);
	kms->state = KMS_NO_PANEL;
	forget_pictures(kms);
}

static void ask_panel(struct kms *kms)
{
	struct kms_output *output = &kms->output;
	bool was = output->connected;
	drmModeModeInfo mode = output->mode;
	kms_output_ask(kms, output);
	if (output->connected != was)
		kms->counts.hotplugs++;
	if (was && !output->connected) {
		panel_went(kms);
	} else if (output->connected && (!was || !kms_mode_same(&mode, &output->candidates[0]))) {
		if (!was)
			log_info("%s: connected", output->name);
		panel_came(kms);
	}
}

/* --- whose screen it is --------------------------------------------------------------------------------------------
 */

/* A picture that stands would be taken for a live one, the reversing camera's above all, and nobody may come who draws
 * over it. */
static void go_dark(struct kms *kms)
{
	struct kms_dark *dark = &kms->dark;
	uint32_t width, height;
	if (kms->state != KMS_ON)
		return;
	kms_size(kms, &width, &height);
	int err = kms->drm->create_dumb(kms->fd, width, height, &dark->buffer);
	if (!err)
		err = kms->drm->add_fb(
			kms->fd, width, height, dark->buffer.handle, dark->buffer.pitch, DRM_FORMAT_MOD_INVALID, &dark->fb);
	if (!err)
		err = kms->commit->modeset(kms, dark->fb);
	if (err)
		log_warn("%s: the last picture stands: %s", kms->output.name, strerror(-err));
}

static void end_dark(struct kms *kms)
{
	if (kms->dark.fb)
		kms->drm->remove_fb(kms->fd, kms->dark.fb);
	kms->drm->destroy_dumb(kms->fd, &kms->dark.buffer);
	kms->dark = (struct kms_dark){ 0 };
}

/* Who was never its master and is not root gets the screen by opening the device, in no other way. */
static bool is_shut_out(const struct kms *kms)
{
	int fd = kms->drm->open(kms->device);
	if (fd < 0)
		return false;
	bool is_free = !kms->drm->set_master(fd);
	kms->drm->close(fd);
	return is_free;
}

static void lose_screen(struct kms *kms)
{
	if (kms->state == KMS_FRESH || kms->state == KMS_ON)
		kms->state = KMS_AWAY;
	kms->is_master = false;
	kms->counts.switches++;
	kms->retry_ns = clock_now_ns() + RETRY_NS;
}

static void regain_screen(struct kms *kms)
{
	int err = kms->drm->set_master(kms->fd);
	if (err) {
		kms->shut_out = (err == -EACCES || err == -EPERM) && is_shut_out(kms);
		return;
	}
	log_info("%s: the screen is ours", kms->device);
	kms->is_master = true;
	forget_pictures(kms);
	kms_output_ask(kms, &kms->output);
	if (kms->output.connected)
		panel_came(kms);
	else
		kms->state = KMS_NO_PANEL;
}

static void follow_terminal(struct kms *kms)
{
	switch (kms_vt_poll(&kms->vt)) {
	case KMS_VT_LEAVING:
		log_info("another terminal: the screen is let go");
		kms_wait(kms);
		kms_dim_rest(kms);
		go_dark(kms);
		lose_screen(kms);
		kms->drm->drop_master(kms->fd);
		kms_vt_leave(&kms->vt);
		break;
	case KMS_VT_ENTERED:
		regain_screen(kms);
		break;
	case KMS_VT_SAME:
		break;
	}
}

void kms_pump(struct kms *kms, int64_t now_ns)
{
	while (take_events(kms, 0))
		;
	follow_terminal(kms);
	if (!kms->is_master && !kms->vt.away && now_ns >= kms->retry_ns) {
		kms->retry_ns = now_ns + RETRY_NS;
		regain_screen(kms);
	}
	if (kms_hotplug_poll(&kms->hotplug, now_ns))
		ask_panel(kms);
}

bool kms_visible(const struct kms *kms)
{
	return kms->state == KMS_ON || (kms->state == KMS_FRESH && clock_now_ns() >= kms->retry_ns);
}

/* --- showing -------------------------------------------------------------------------------------------------------
 */

static void set_mode(struct kms *kms, struct kms_frame *frame)
{
	int err = kms->commit->modeset(kms, frame->fb);
	if (err == -EACCES || err == -EPERM) {
		lose_screen(kms);
	} else if (err) {
		log_error("%s: cannot set the mode: %s", kms->output.name, strerror(-err));
		kms->retry_ns = clock_now_ns() + RETRY_NS;
	}
	if (err) {
		give_back(kms, frame);
		kms->counts.missed++;
		return;
	}
	char mode[32];
	kms_mode_text(&kms->output.mode, mode, sizeof(mode));
	log_info("%s: %s on %s, %s, %s", kms->device, mode, kms->output.name, kms->commit->name, kms->buffers->name);
	kms->state = KMS_ON;
	kms->counts.modesets++;
	now_on_screen(kms, frame);
	end_dark(kms);
	kms->output.shown_before = true;
	kms_dim_again(kms);
}

static void flip(struct kms *kms, struct kms_frame *frame)
{
	int err = kms->commit->flip(kms, frame->fb);
	if (!err) {
		kms->pending = *frame;
		kms->flip_asked_ns = clock_now_ns();
	} else if (err == -EACCES || err == -EPERM) {
		log_warn("%s: somebody else has the screen", kms->device);
		lose_screen(kms);
		give_back(kms, frame);
		kms->counts.missed++;
	} else if (err == -EBUSY) {
		give_back(kms, frame);
		kms->counts.missed++;
	} else {
		log_warn("%s: cannot flip (%s); setting the mode again", kms->output.name, strerror(-err));
		set_mode(kms, frame);
	}
}

int kms_show(struct kms *kms)
{
	struct kms_frame frame;
	if (!kms_visible(kms)) {
		kms->counts.missed++;
		return 0;
	}
	int err = kms->buffers->take(kms, &frame);
	if (err)
		return err;
	kms_wait(kms);
	if (kms->state == KMS_ON)
		flip(kms, &frame);
	else
		set_mode(kms, &frame);
	return 0;
}

/* --- start and end -------------------------------------------------------------------------------------------------
 */

/* Opens one device; its output is found, too. */
static int open_card(struct kms *kms, const char *path)
{
	int fd = kms->drm->open(path);
	if (fd < 0)
		return fd;
	kms->fd = fd;
	snprintf(kms->device, sizeof(kms->device), "%s", path);
	bool planes = !kms->drm->set_client_cap(fd, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1);
	bool atomic = planes && !kms->drm->set_client_cap(fd, DRM_CLIENT_CAP_ATOMIC, 1);
	int err = kms_output_find(kms, &kms->output);
	if (err) {
		kms->drm->close(fd);
		kms->fd = -1;
		return err;
	}
	kms->commit = atomic && kms->output.plane && kms->output.crtc_properties.mode_id ? &kms_atomic : &kms_legacy;
	return 0;
}

static void close_card(struct kms *kms)
{
	if (kms->fd >= 0)
		kms->drm->close(kms->fd);
	kms->fd = -1;
}

/* The first card with something connected, else the first with a connector at all. */
static int find_card(struct kms *kms)
{
	int first = -1, err = -ENODEV;
	char path[64];
	for (int i = 0; i <= CARDS_MAX; i++) {
		int card = i < CARDS_MAX ? i : first;
		if (card < 0)
			break;
		snprintf(path, sizeof(path), "/dev/dri/card%d", card);
		int status = open_card(kms, path);
		if (status) {
			err = status == -ENOENT ? err : status;
			continue;
		}
		if (kms->output.connected || i == CARDS_MAX)
			return 0;
		first = first < 0 ? card : first;
		close_card(kms);
	}
	return err;
}

static int open_buffers(struct kms *kms)
{
	static const struct kms_buffers *const ways[] = { &kms_gbm, &kms_dumb };
	enum display_buffers wanted = kms->config->buffers;
	int err = -ENODEV;
	for (int i = 0; i < 2; i++) {
		if ((wanted == DISPLAY_BUFFERS_GBM && i) || (wanted == DISPLAY_BUFFERS_DUMB && !i))
			continue;
		kms->buffers = ways[i];
		err = kms->buffers->open(kms);
		if (!err && kms->output.connected)
			err = kms->buffers->resize(kms);
		if (!err)
			return 0;
		log_info("%s: no %s: %s", kms->device, ways[i]->name, strerror(-err));
		kms->buffers->close(kms);
		kms->buffers = NULL;
	}
	return err;
}

/* Not from behind another terminal: opening a device that nobody has made us its master. */
static void take_screen(struct kms *kms)
{
	if (kms->vt.away) {
		log_info("another terminal is in front; waiting for ours");
		kms->drm->drop_master(kms->fd);
		return;
	}
	kms->is_master = !kms->drm->set_master(kms->fd);
	if (!kms->is_master)
		log_warn("%s: another program has the screen; waiting for it", kms->device);
}

int kms_open(struct kms *kms, const struct kms_drm *drm, const struct display_config *config)
{
	*kms = (struct kms){ .drm = drm, .config = config, .fd = -1 };
	kms->vt.fd = kms->hotplug.fd = kms->dim.backlight_fd = -1;
	if (config->mode && !kms_mode_parse(config->mode, &kms->wish)) {
		log_error("display mode '%s' is not WIDTHxHEIGHT or WIDTHxHEIGHT@HZ", config->mode);
		return -EINVAL;
	}
	int err = config->device ? open_card(kms, config->device) : find_card(kms);
	if (err) {
		log_error("%s: no panel to be had: %s", config->device ? config->device : "/dev/dri/card*", strerror(-err));
		return -ENODEV;
	}
	kms_vt_open(&kms->vt, config->vt);
	take_screen(kms);
	kms_hotplug_open(&kms->hotplug);
	if (kms->output.connected)
		choose_way(kms);
	else
		log_warn("%s: nothing is connected; waiting", kms->output.name);
	err = open_buffers(kms);
	if (err) {
		kms_close(kms);
		return -ENODEV;
	}
	kms_dim_open(kms);
	kms->state = !kms->output.connected ? KMS_NO_PANEL : kms->is_master ? KMS_FRESH : KMS_AWAY;
	return 0;
}

void kms_close(struct kms *kms)
{
	if (kms->buffers) {
		kms_wait(kms);
		forget_pictures(kms);
		kms->buffers->close(kms);
	}
	kms_dim_close(kms);
	end_dark(kms);
	if (kms->mode_blob)
		kms->drm->destroy_blob(kms->fd, kms->mode_blob);
	kms_vt_close(&kms->vt);
	kms_hotplug_close(&kms->hotplug);
	close_card(kms);
	*kms = (struct kms){ .fd = -1 };
}

void kms_brightness(struct kms *kms, float level)
{
	kms_dim_set(kms, level);
}
