/*
 * Pictures by atomic requests: everything that belongs to one change goes to the device at once, and can be tried
 * before. Flips do not wait; the kernel's event says when they are done.
 */
#include <errno.h>

#include "platform/base/log.h"
#include "platform/display/kms.h"

static uint64_t rotation_bit(unsigned turn_deg)
{
	/* the property turns counter-clockwise */
	static const uint64_t bits[] = { DRM_MODE_ROTATE_0, DRM_MODE_ROTATE_270, DRM_MODE_ROTATE_180, DRM_MODE_ROTATE_90 };
	return bits[turn_deg / 90 % 4];
}

static void add_plane(const struct kms_output *output, const drmModeModeInfo *mode, uint32_t fb, unsigned turn_deg,
	struct kms_request *request)
{
	const struct kms_plane_properties *plane = &output->plane_properties;
	bool across = turn_deg % 180 != 0;
	uint64_t width = across ? mode->vdisplay : mode->hdisplay, height = across ? mode->hdisplay : mode->vdisplay;
	kms_request_add(request, output->plane, plane->fb_id, fb);
	kms_request_add(request, output->plane, plane->crtc_id, output->crtc);
	kms_request_add(request, output->plane, plane->src_x, 0);
	kms_request_add(request, output->plane, plane->src_y, 0);
	kms_request_add(request, output->plane, plane->src_w, width << 16);
	kms_request_add(request, output->plane, plane->src_h, height << 16);
	kms_request_add(request, output->plane, plane->crtc_x, 0);
	kms_request_add(request, output->plane, plane->crtc_y, 0);
	kms_request_add(request, output->plane, plane->crtc_w, mode->hdisplay);
	kms_request_add(request, output->plane, plane->crtc_h, mode->vdisplay);
	kms_request_add(request, output->plane, plane->rotation, rotation_bit(turn_deg));
}

static void full_request(const struct kms_output *output, const drmModeModeInfo *mode, uint32_t mode_blob, uint32_t fb,
	unsigned turn_deg, struct kms_request *request)
{
	*request = (struct kms_request){ 0 };
	kms_request_add(request, output->connector, output->connector_properties.crtc_id, output->crtc);
	kms_request_add(request, output->crtc, output->crtc_properties.mode_id, mode_blob);
	kms_request_add(request, output->crtc, output->crtc_properties.active, 1);
	add_plane(output, mode, fb, turn_deg, request);
}

static int atomic_test(struct kms *kms, const drmModeModeInfo *mode, uint32_t fb, unsigned turn_deg)
{
	const struct kms_plane_properties *plane = &kms->output.plane_properties;
	if (turn_deg && (!plane->rotation || !(plane->rotations & rotation_bit(turn_deg))))
		return -EINVAL;
	uint32_t blob = 0;
	int err = kms->drm->create_blob(kms->fd, mode, sizeof(*mode), &blob);
	if (err)
		return err;
	struct kms_request request;
	full_request(&kms->output, mode, blob, fb, turn_deg, &request);
	err = kms->drm->atomic(kms->fd, &request, DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET, NULL);
	kms->drm->destroy_blob(kms->fd, blob);
	return err;
}

/* A request that needs no change of mode leaves no black in between: it is tried first where somebody's picture is on
 * the panel in the same mode. */
static int atomic_modeset(struct kms *kms, uint32_t fb)
{
	if (kms->mode_blob)
		kms->drm->destroy_blob(kms->fd, kms->mode_blob);
	kms->mode_blob = 0;
	const drmModeModeInfo *mode = &kms->output.mode;
	int err = kms->drm->create_blob(kms->fd, mode, sizeof(*mode), &kms->mode_blob);
	if (err)
		return err;
	struct kms_request request;
	full_request(&kms->output, mode, kms->mode_blob, fb, kms->plane_turn_deg, &request);
	if (kms->output.shown_before && !kms->drm->atomic(kms->fd, &request, 0, NULL)) {
		log_debug("%s: taken over without a change of mode", kms->output.name);
		return 0;
	}
	return kms->drm->atomic(kms->fd, &request, DRM_MODE_ATOMIC_ALLOW_MODESET, NULL);
}

static int atomic_flip(struct kms *kms, uint32_t fb)
{
	struct kms_request request = { 0 };
	kms_request_add(&request, kms->output.plane, kms->output.plane_properties.fb_id, fb);
	return kms->drm->atomic(kms->fd, &request, DRM_MODE_ATOMIC_NONBLOCK | DRM_MODE_PAGE_FLIP_EVENT, kms);
}

#define GAMMA_MAX 4096

static int gamma_blob(struct kms *kms, float level, uint32_t *blob)
{
	static struct drm_color_lut table[GAMMA_MAX];
	uint64_t size = kms->output.crtc_properties.gamma_size;
	if (size < 2 || size > GAMMA_MAX)
		return -EOPNOTSUPP;
	for (uint64_t i = 0; i < size; i++) {
		uint16_t value = (uint16_t)(level * 65535.0f * (float)i / (float)(size - 1) + 0.5f);
		table[i] = (struct drm_color_lut){ .red = value, .green = value, .blue = value };
	}
	return kms->drm->create_blob(kms->fd, table, size * sizeof(table[0]), blob);
}

static int matrix_blob(struct kms *kms, float level, uint32_t *blob)
{
	struct drm_color_ctm matrix = { 0 };
	for (int i = 0; i < 9; i += 4)
		matrix.matrix[i] = (uint64_t)((double)level * 4294967296.0); /* 31.32 with a sign bit */
	return kms->drm->create_blob(kms->fd, &matrix, sizeof(matrix), blob);
}

static int atomic_dim(struct kms *kms, float level)
{
	const struct kms_crtc_properties *crtc = &kms->output.crtc_properties;
	uint32_t property = crtc->gamma_lut && crtc->gamma_size ? crtc->gamma_lut : crtc->ctm, blob = 0;
	if (!property)
		return -EOPNOTSUPP;
	int err = property == crtc->gamma_lut ? gamma_blob(kms, level, &blob) : matrix_blob(kms, level, &blob);
	if (err)
		return err;
	struct kms_request request = { 0 };
	kms_request_add(&request, kms->output.crtc, property, blob);
	err = kms->drm->atomic(kms->fd, &request, 0, NULL);
	uint32_t old = err ? blob : kms->dim.blob;
	if (!err)
		kms->dim.blob = blob;
	if (old)
		kms->drm->destroy_blob(kms->fd, old);
	return err;
}

const struct kms_commit kms_atomic = {
	.name = "atomic",
	.test = atomic_test,
	.modeset = atomic_modeset,
	.flip = atomic_flip,
	.dim = atomic_dim,
};
