/* The KMS display on a made-up device: what it asks of the kernel, and how it takes surprises. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/display/kms.h"
#include "platform/display/kms_copy.h"

enum { CONNECTOR = 10, ENCODER = 20, CRTC = 30, PLANE = 40 };
enum { P_CONNECTOR_CRTC = 50, P_ACTIVE, P_MODE, P_FB, P_PLANE_CRTC, P_TYPE, P_ROTATION, P_GAMMA, P_GAMMA_SIZE };

/* The driver keeps what it allocated when it is unloaded; leaks of ours are looked for in other programs. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

/* The device: what it is, what it was asked, and how it answers next. */
static struct {
	bool atomic, connected, master_taken, rotates;
	bool never_master; /* not root, and opened while another program was the master: no asking helps */
	int kept_fd;       /* of the display under test; others look and go */
	bool shown_before; /* a boot splash in the first mode */
	int refused_modes; /* the first so many fail every test */
	int flip_error, modeset_error;
	int pipe[2]; /* events: a byte each */
	unsigned opens, closes, tests, modesets, seamless, flips, legacy_flips, fbs, dumbs, blobs;
	uint32_t last_fb;
	drmModeModeInfo asked[64]; /* by blob */
	drmModeModeInfo modes[3];
	void *user;
} device;

static const drmModeModeInfo hd = { .clock = 148500,
	.hdisplay = 1920,
	.htotal = 2200,
	.vdisplay = 1080,
	.vtotal = 1125,
	.type = DRM_MODE_TYPE_PREFERRED,
	.name = "1920x1080" };
static const drmModeModeInfo small60 = {
	.clock = 74250, .hdisplay = 1280, .htotal = 1650, .vdisplay = 720, .vtotal = 750, .name = "1280x720"
};
static const drmModeModeInfo small50 = {
	.clock = 74250, .hdisplay = 1280, .htotal = 1980, .vdisplay = 720, .vtotal = 750, .name = "1280x720"
};

static void reset_device(void)
{
	memset(&device, 0, sizeof(device));
	device.atomic = device.connected = true;
	device.modes[0] = hd;
	device.modes[1] = small60;
	device.modes[2] = small50;
}

static int fake_open(const char *path)
{
	(void)path;
	if (device.opens++ > device.closes)
		return dup(device.kept_fd);
	assert_int_equal(pipe(device.pipe), 0);
	device.kept_fd = device.pipe[0];
	return device.pipe[0];
}

static void fake_close(int fd)
{
	device.closes++;
	close(fd);
	if (fd == device.kept_fd)
		close(device.pipe[1]);
}

static int fake_client_cap(int fd, uint64_t capability, uint64_t value)
{
	(void)fd;
	(void)value;
	return capability == DRM_CLIENT_CAP_ATOMIC && !device.atomic ? -EOPNOTSUPP : 0;
}

static int fake_cap(int fd, uint64_t capability, uint64_t *value)
{
	(void)fd;
	*value = capability == DRM_CAP_DUMB_BUFFER;
	return 0;
}

static int fake_set_master(int fd)
{
	if (device.never_master && fd == device.kept_fd)
		return -EACCES;
	return device.master_taken ? -EBUSY : 0;
}

static int fake_drop_master(int fd)
{
	(void)fd;
	return 0;
}

static drmModeResPtr fake_resources(int fd)
{
	static uint32_t crtc = CRTC, connector = CONNECTOR;
	static drmModeRes all = { .count_crtcs = 1, .crtcs = &crtc, .count_connectors = 1, .connectors = &connector };
	(void)fd;
	return &all;
}

static drmModeConnectorPtr fake_connector(int fd, uint32_t id)
{
	static uint32_t encoder = ENCODER;
	static drmModeConnector it;
	(void)fd;
	it = (drmModeConnector){ .connector_id = id,
		.encoder_id = device.shown_before ? ENCODER : 0,
		.connector_type = DRM_MODE_CONNECTOR_HDMIA,
		.connector_type_id = 1,
		.connection = device.connected ? DRM_MODE_CONNECTED : DRM_MODE_DISCONNECTED,
		.count_modes = device.connected ? 3 : 0,
		.modes = device.modes,
		.count_encoders = 1,
		.encoders = &encoder };
	return &it;
}

static drmModeEncoderPtr fake_encoder(int fd, uint32_t id)
{
	static drmModeEncoder it;
	(void)fd;
	it = (drmModeEncoder){ .encoder_id = id, .crtc_id = device.shown_before ? CRTC : 0, .possible_crtcs = 1 };
	return &it;
}

static drmModeCrtcPtr fake_crtc(int fd, uint32_t id)
{
	static drmModeCrtc it;
	(void)fd;
	it = (drmModeCrtc){
		.crtc_id = id, .mode_valid = device.shown_before, .buffer_id = device.shown_before ? 7 : 0, .mode = hd
	};
	return &it;
}

static drmModePlaneResPtr fake_planes(int fd)
{
	static uint32_t plane = PLANE;
	static drmModePlaneRes all = { .count_planes = 1, .planes = &plane };
	(void)fd;
	return &all;
}

static drmModePlanePtr fake_plane(int fd, uint32_t id)
{
	static drmModePlane it;
	(void)fd;
	it = (drmModePlane){ .plane_id = id, .possible_crtcs = 1 };
	return &it;
}

static drmModeObjectPropertiesPtr fake_properties(int fd, uint32_t id, uint32_t type)
{
	static uint32_t of_connector[] = { P_CONNECTOR_CRTC }, of_crtc[] = { P_ACTIVE, P_MODE, P_GAMMA, P_GAMMA_SIZE };
	static uint32_t of_plane[] = { P_FB, P_PLANE_CRTC, P_TYPE, P_ROTATION };
	static uint64_t values[] = { 0, 0, DRM_PLANE_TYPE_PRIMARY, 256 };
	static drmModeObjectProperties all;
	(void)fd;
	(void)type;
	uint32_t *list = id == CONNECTOR ? of_connector : id == CRTC ? of_crtc : of_plane;
	all = (drmModeObjectProperties){ .count_props = id == CONNECTOR ? 1 : 4, .props = list, .prop_values = values };
	return &all;
}

static drmModePropertyPtr fake_property(int fd, uint32_t id)
{
	static const char *const names[] = { "CRTC_ID", "ACTIVE", "MODE_ID", "FB_ID", "CRTC_ID", "type", "rotation",
		"GAMMA_LUT", "GAMMA_LUT_SIZE" };
	static struct drm_mode_property_enum turns[] = { { 0, "rotate-0" }, { 1, "rotate-90" }, { 2, "rotate-180" },
		{ 3, "rotate-270" } };
	static drmModePropertyRes it;
	(void)fd;
	it = (drmModePropertyRes){ .prop_id = id };
	snprintf(it.name, sizeof(it.name), "%s", names[id - P_CONNECTOR_CRTC]);
	if (id == P_ROTATION) {
		it.count_enums = device.rotates ? 4 : 1;
		it.enums = turns;
	}
	return &it;
}

static int fake_create_blob(int fd, const void *data, size_t size, uint32_t *id)
{
	(void)fd;
	*id = ++device.blobs;
	if (size == sizeof(drmModeModeInfo))
		memcpy(&device.asked[*id % 64], data, size);
	return 0;
}

static int fake_destroy_blob(int fd, uint32_t id)
{
	(void)fd;
	(void)id;
	return 0;
}

static int fake_add_fb(
	int fd, uint32_t width, uint32_t height, uint32_t handle, uint32_t pitch, uint64_t modifier, uint32_t *id)
{
	(void)fd;
	(void)modifier;
	assert_true(handle && pitch >= width * 4 && height);
	static uint32_t last;
	*id = ++last;
	device.fbs++;
	return 0;
}

static int fake_remove_fb(int fd, uint32_t id)
{
	(void)fd;
	(void)id;
	device.fbs--;
	return 0;
}

static int fake_create_dumb(int fd, uint32_t width, uint32_t height, struct kms_dumb_buffer *out)
{
	(void)fd;
	*out = (struct kms_dumb_buffer){ .handle = 1, .pitch = width * 4, .width = width, .height = height };
	out->pixels = calloc(height, out->pitch);
	device.dumbs++;
	return 0;
}

static void fake_destroy_dumb(int fd, struct kms_dumb_buffer *buffer)
{
	(void)fd;
	if (!buffer->handle)
		return;
	free(buffer->pixels);
	device.dumbs--;
	*buffer = (struct kms_dumb_buffer){ 0 };
}

static uint64_t value_of(const struct kms_request *request, uint32_t property)
{
	for (uint32_t i = 0; i < request->count; i++)
		if (request->properties[i] == property)
			return request->values[i];
	return 0;
}

static int test_mode(const drmModeModeInfo *mode)
{
	device.tests++;
	for (int i = 0; i < device.refused_modes; i++)
		if (kms_mode_same(mode, &device.modes[i]))
			return -EINVAL;
	return 0;
}

static int fake_atomic(int fd, const struct kms_request *request, uint32_t flags, void *user)
{
	(void)fd;
	if (flags & DRM_MODE_ATOMIC_TEST_ONLY)
		return test_mode(&device.asked[value_of(request, P_MODE) % 64]);
	if (!value_of(request, P_FB))
		return 0; /* a gamma table */
	device.last_fb = (uint32_t)value_of(request, P_FB);
	device.user = user;
	if (flags & DRM_MODE_PAGE_FLIP_EVENT) {
		device.flips += !device.flip_error;
		return device.flip_error;
	}
	if (!(flags & DRM_MODE_ATOMIC_ALLOW_MODESET)) {
		device.seamless++;
		return 0;
	}
	device.modesets += !device.modeset_error;
	return device.modeset_error;
}

static int fake_set_crtc(int fd, uint32_t crtc, uint32_t fb, uint32_t x, uint32_t y, uint32_t *connectors, int count,
	drmModeModeInfoPtr mode)
{
	(void)fd;
	assert_int_equal(crtc, CRTC);
	assert_true(fb && !x && !y && connectors[0] == CONNECTOR && count == 1 && mode->hdisplay);
	device.modesets++;
	return 0;
}

static int fake_page_flip(int fd, uint32_t crtc, uint32_t fb, uint32_t flags, void *user)
{
	(void)fd;
	(void)crtc;
	(void)fb;
	assert_int_equal(flags, DRM_MODE_PAGE_FLIP_EVENT);
	device.user = user;
	device.legacy_flips++;
	return device.flip_error;
}

static int fake_gamma(int fd, uint32_t crtc, uint32_t size, uint16_t *red, uint16_t *green, uint16_t *blue)
{
	(void)fd;
	(void)crtc;
	(void)size;
	(void)red;
	(void)green;
	(void)blue;
	return -EINVAL;
}

static int fake_event(int fd, drmEventContextPtr context)
{
	char byte;
	assert_int_equal(read(fd, &byte, 1), 1);
	context->page_flip_handler2(fd, 0, 0, 0, CRTC, device.user);
	return 0;
}

static void blank(void)
{
	assert_int_equal(write(device.pipe[1], "f", 1), 1);
}

static void free_nothing_resources(drmModeResPtr it)
{
	(void)it;
}
static void free_nothing_connector(drmModeConnectorPtr it)
{
	(void)it;
}
static void free_nothing_encoder(drmModeEncoderPtr it)
{
	(void)it;
}
static void free_nothing_crtc(drmModeCrtcPtr it)
{
	(void)it;
}
static void free_nothing_planes(drmModePlaneResPtr it)
{
	(void)it;
}
static void free_nothing_plane(drmModePlanePtr it)
{
	(void)it;
}
static void free_nothing_properties(drmModeObjectPropertiesPtr it)
{
	(void)it;
}
static void free_nothing_property(drmModePropertyPtr it)
{
	(void)it;
}

static const struct kms_drm fake = { fake_open, fake_close, fake_client_cap, fake_cap, fake_set_master,
	fake_drop_master, fake_resources, free_nothing_resources, fake_connector, free_nothing_connector, fake_encoder,
	free_nothing_encoder, fake_crtc, free_nothing_crtc, fake_planes, free_nothing_planes, fake_plane,
	free_nothing_plane, fake_properties, free_nothing_properties, fake_property, free_nothing_property,
	fake_create_blob, fake_destroy_blob, fake_add_fb, fake_remove_fb, fake_create_dumb, fake_destroy_dumb, fake_atomic,
	fake_set_crtc, fake_page_flip, fake_gamma, fake_event };

static struct display_config config;
static struct kms kms;

/* False where there is no EGL to draw with. */
static bool start(void)
{
	config.device = "/dev/made-up";
	config.vt = "none";
	config.buffers = DISPLAY_BUFFERS_DUMB;
	return kms_open(&kms, &fake, &config) == 0;
}

static void stop(void)
{
	kms_close(&kms);
	assert_int_equal(device.opens, device.closes);
	assert_int_equal(device.fbs, 0);
	assert_int_equal(device.dumbs, 0);
	config = (struct display_config){ 0 };
}

static bool draw(void)
{
	return kms_dumb_free(&kms) && kms_show(&kms) == 0;
}

static void the_screen_is_left_alone_until_the_first_picture(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	kms_pump(&kms, clock_now_ns());
	assert_int_equal(device.modesets + device.seamless + device.flips, 0);
	assert_true(draw());
	assert_int_equal(device.modesets, 1);
	assert_int_equal(device.flips, 0);
	assert_true(draw());
	assert_int_equal(device.flips, 1);
	assert_int_equal(kms.counts.flips, 1); /* the second is on its way */
	assert_null(kms_dumb_free(&kms));
	blank();
	kms_wait(&kms);
	assert_int_equal(kms.counts.flips, 2);
	assert_non_null(kms_dumb_free(&kms));
	stop();
}

static void a_boot_splash_in_the_same_mode_is_taken_over_without_black(void **state)
{
	(void)state;
	reset_device();
	device.shown_before = true;
	if (!start())
		skip();
	assert_true(draw());
	assert_int_equal(device.seamless, 1);
	assert_int_equal(device.modesets, 0);
	stop();
	reset_device();
	device.shown_before = true;
	config.mode = "1280x720@50";
	assert_true(start());
	assert_true(draw());
	assert_int_equal(device.seamless, 0);
	assert_int_equal(device.modesets, 1);
	stop();
}

static void a_refused_mode_gives_way_to_the_next(void **state)
{
	(void)state;
	reset_device();
	device.refused_modes = 1;
	if (!start())
		skip();
	assert_true(device.tests >= 2);
	assert_int_equal(kms.output.mode.hdisplay, 1280);
	assert_ptr_equal(kms.commit, &kms_atomic);
	stop();
	reset_device();
	device.refused_modes = 3;
	assert_true(start());
	assert_ptr_equal(kms.commit, &kms_legacy);
	stop();
}

static void without_atomic_requests_the_old_calls_do(void **state)
{
	(void)state;
	reset_device();
	device.atomic = false;
	if (!start())
		skip();
	assert_true(draw());
	assert_int_equal(device.modesets, 1);
	assert_true(draw());
	assert_int_equal(device.legacy_flips, 1);
	blank();
	kms_wait(&kms);
	assert_int_equal(kms.counts.flips, 2);
	stop();
}

static void a_panel_that_goes_and_comes_back_gets_a_modeset(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	assert_true(draw());
	kms_hotplug_close(&kms.hotplug); /* asked now and then instead */
	int64_t now = clock_now_ns();
	kms_pump(&kms, now);
	device.connected = false;
	kms_pump(&kms, now + 3 * NS_PER_S);
	assert_false(kms_visible(&kms));
	assert_int_equal(kms_show(&kms), 0);
	device.connected = true;
	kms_pump(&kms, now + 6 * NS_PER_S);
	assert_true(kms_visible(&kms));
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 2);
	assert_int_equal(kms.counts.hotplugs, 2);
	stop();
}

static void another_size_of_panel_gets_buffers_of_its_size(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	assert_true(draw());
	kms_hotplug_close(&kms.hotplug);
	int64_t now = clock_now_ns();
	kms_pump(&kms, now);
	device.modes[0] = small60;
	device.modes[0].type = DRM_MODE_TYPE_PREFERRED;
	kms_pump(&kms, now + 3 * NS_PER_S);
	struct kms_dumb_buffer *buffer = kms_dumb_free(&kms);
	assert_non_null(buffer);
	assert_int_equal(buffer->width, 1280);
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 2);
	stop();
}

static void a_screen_taken_away_comes_back_with_a_modeset(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	assert_true(draw());
	device.flip_error = -EACCES;
	device.master_taken = true;
	assert_true(draw());
	assert_false(kms_visible(&kms));
	int64_t now = clock_now_ns();
	kms_pump(&kms, now + NS_PER_S);
	assert_false(kms_visible(&kms));
	device.flip_error = 0;
	device.master_taken = false;
	kms_pump(&kms, now + 3 * NS_PER_S);
	assert_true(kms_visible(&kms));
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 2);
	assert_int_equal(kms.counts.switches, 1);
	stop();
}

static void a_free_screen_that_is_refused_to_this_opening_is_told(void **state)
{
	(void)state;
	reset_device();
	device.master_taken = device.never_master = true;
	if (!start())
		skip();
	assert_false(kms_visible(&kms));
	int64_t now = clock_now_ns();
	kms_pump(&kms, now + NS_PER_S);
	assert_false(kms.shut_out);
	device.master_taken = false; /* the other program ends */
	kms_pump(&kms, now + 3 * NS_PER_S);
	assert_true(kms.shut_out);
	assert_false(kms_visible(&kms));
	stop();
}

static void a_failing_flip_is_followed_by_a_modeset(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	assert_true(draw());
	device.flip_error = -EINVAL;
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 2);
	assert_true(kms_visible(&kms));
	stop();
}

static void an_answer_that_came_while_a_picture_took_long_counts(void **state)
{
	(void)state;
	reset_device();
	if (!start())
		skip();
	assert_true(draw());
	assert_true(draw());
	blank();
	kms.flip_asked_ns -= 3 * NS_PER_S;
	kms_wait(&kms);
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 1);
	assert_int_equal(device.flips, 2);
	kms.flip_asked_ns -= 3 * NS_PER_S; /* and none comes */
	kms_wait(&kms);
	assert_true(draw());
	assert_int_equal(kms.counts.modesets, 2);
	stop();
}

static void a_plane_that_can_turns_the_picture_else_whoever_draws(void **state)
{
	(void)state;
	reset_device();
	device.rotates = true;
	config.rotation_deg = 90;
	if (!start())
		skip();
	uint32_t width, height;
	kms_size(&kms, &width, &height);
	assert_int_equal(width, 1080);
	assert_int_equal(kms_turn_left(&kms), 0);
	stop();
	reset_device();
	config.rotation_deg = 90;
	assert_true(start());
	kms_size(&kms, &width, &height);
	assert_int_equal(width, 1920);
	assert_int_equal(kms_turn_left(&kms), 90);
	stop();
}

static void modes_are_read_and_ordered(void **state)
{
	(void)state;
	struct kms_mode_wish wish;
	assert_true(kms_mode_parse("1280x720@59.94", &wish));
	assert_int_equal(wish.refresh_mhz, 59940);
	static const char *const wrong[] = { "", "1280", "1280x", "x720", "1280x720@", "1280x720@0", "1280x720 ", "0x720",
		"1280x720@60Hz", "1280x720@nan", "1280x720@1e9", "-1280x720" };
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		assert_false(kms_mode_parse(wrong[i], &wish));
	const drmModeModeInfo modes[] = { small60, hd, small50 };
	uint8_t order[KMS_MODES_MAX];
	const struct {
		const char *wish;
		const drmModeModeInfo *current;
		uint8_t first, second;
	} cases[] = { { NULL, NULL, 1, 0 }, { NULL, &small50, 1, 2 }, { "1280x720", NULL, 0, 2 },
		{ "1280x720@50", NULL, 2, 0 }, { "1280x720@51", &small60, 2, 0 }, { "640x480", NULL, 1, 0 } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		wish = (struct kms_mode_wish){ 0 };
		assert_true(!cases[i].wish || kms_mode_parse(cases[i].wish, &wish));
		assert_int_equal(kms_mode_order(modes, 3, &wish, cases[i].current, order), 3);
		assert_int_equal(order[0], cases[i].first);
		assert_int_equal(order[1], cases[i].second);
	}
}

static void a_copied_picture_is_turned_clockwise(void **state)
{
	(void)state;
	/* A B C over D E F, red only */
	const uint8_t picture[] = { 'A', 0, 0, 0, 'B', 0, 0, 0, 'C', 0, 0, 0, 'D', 0, 0, 0, 'E', 0, 0, 0, 'F', 0, 0, 0 };
	const struct kms_picture from = { .rgba = picture, .width = 3, .height = 2 };
	const struct {
		unsigned turn, width, height;
		const char *rows;
	} cases[] = { { 0, 3, 2, "ABCDEF" }, { 90, 2, 3, "DAEBFC" }, { 180, 3, 2, "FEDCBA" }, { 270, 2, 3, "CFBEAD" },
		{ 0, 6, 2, "AABBCCDDEEFF" } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		uint8_t to[12 * 4 + 16] = { 0 };
		kms_copy(&from, to, cases[i].width * 4, cases[i].width, cases[i].height, cases[i].turn, 1.0f);
		for (size_t px = 0; px < strlen(cases[i].rows); px++)
			assert_int_equal(to[px * 4 + 2], cases[i].rows[px]);
	}
	uint8_t dim[24];
	kms_copy(&from, dim, 12, 3, 2, 0, 0.5f);
	assert_int_equal(dim[2], ('A' + 1) / 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_screen_is_left_alone_until_the_first_picture),
		cmocka_unit_test(a_boot_splash_in_the_same_mode_is_taken_over_without_black),
		cmocka_unit_test(a_refused_mode_gives_way_to_the_next),
		cmocka_unit_test(without_atomic_requests_the_old_calls_do),
		cmocka_unit_test(a_panel_that_goes_and_comes_back_gets_a_modeset),
		cmocka_unit_test(another_size_of_panel_gets_buffers_of_its_size),
		cmocka_unit_test(a_screen_taken_away_comes_back_with_a_modeset),
		cmocka_unit_test(a_free_screen_that_is_refused_to_this_opening_is_told),
		cmocka_unit_test(a_failing_flip_is_followed_by_a_modeset),
		cmocka_unit_test(an_answer_that_came_while_a_picture_took_long_counts),
		cmocka_unit_test(a_plane_that_can_turns_the_picture_else_whoever_draws),
		cmocka_unit_test(modes_are_read_and_ordered),
		cmocka_unit_test(a_copied_picture_is_turned_clockwise),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
