/*
 * Pictures for devices that no GPU draws for: drawn without a surface, read back, and copied into two buffers in plain
 * memory, turned and darkened on the way. The copy of 1280 x 720 takes about a millisecond.
 */
#include <drm_fourcc.h>
#include <errno.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/egl.h"
#include "platform/display/kms.h"

static int dumb_open(struct kms *kms)
{
	uint64_t able = 0;
	if (kms->drm->get_cap(kms->fd, DRM_CAP_DUMB_BUFFER, &able) || !able)
		return -EOPNOTSUPP;
	struct kms_dumb_state *dumb = &kms->dumb;
	*dumb = (struct kms_dumb_state){ 0 };
	struct display hidden = { 0 };
	int err = display_surfaceless.open(&hidden, kms->config);
	dumb->egl = hidden.native[0];
	dumb->context = hidden.native[1];
	return err;
}

static void drop_buffers(struct kms *kms)
{
	struct kms_dumb_state *dumb = &kms->dumb;
	for (int i = 0; i < KMS_DUMB_BUFFERS; i++) {
		if (dumb->fbs[i])
			kms->drm->remove_fb(kms->fd, dumb->fbs[i]);
		kms->drm->destroy_dumb(kms->fd, &dumb->buffers[i]);
		dumb->fbs[i] = 0;
		dumb->busy[i] = false;
	}
}

static void dumb_close(struct kms *kms)
{
	drop_buffers(kms);
	if (kms->dumb.context)
		egl_stop(kms->dumb.egl, kms->dumb.context);
	kms->dumb = (struct kms_dumb_state){ 0 };
}

static int dumb_use(struct kms *kms)
{
	return egl_use(kms->dumb.egl, kms->dumb.context);
}

static int dumb_resize(struct kms *kms)
{
	struct kms_dumb_state *dumb = &kms->dumb;
	uint32_t width, height;
	drop_buffers(kms);
	kms_size(kms, &width, &height);
	for (int i = 0; i < KMS_DUMB_BUFFERS; i++) {
		struct kms_dumb_buffer *buffer = &dumb->buffers[i];
		int err = kms->drm->create_dumb(kms->fd, width, height, buffer);
		if (!err)
			err = kms->drm->add_fb(
				kms->fd, width, height, buffer->handle, buffer->pitch, DRM_FORMAT_MOD_INVALID, &dumb->fbs[i]);
		if (err) {
			drop_buffers(kms);
			return err;
		}
	}
	return 0;
}

struct kms_dumb_buffer *kms_dumb_free(struct kms *kms)
{
	struct kms_dumb_state *dumb = &kms->dumb;
	for (uint32_t i = 0; i < KMS_DUMB_BUFFERS; i++) {
		if (dumb->busy[i] || !dumb->fbs[i])
			continue;
		dumb->drawn = i;
		return &dumb->buffers[i];
	}
	return NULL;
}

static int dumb_take(struct kms *kms, struct kms_frame *out)
{
	struct kms_dumb_state *dumb = &kms->dumb;
	if (!dumb->fbs[dumb->drawn] || dumb->busy[dumb->drawn])
		return -EBUSY;
	dumb->busy[dumb->drawn] = true;
	*out = (struct kms_frame){ .fb = dumb->fbs[dumb->drawn], .owner = &dumb->busy[dumb->drawn] };
	return 0;
}

static void dumb_give_back(struct kms *kms, const struct kms_frame *frame)
{
	(void)kms;
	*(bool *)frame->owner = false;
}

const struct kms_buffers kms_dumb = {
	.name = "plain buffers",
	.surface = DISPLAY_SURFACE_PIXELS,
	.open = dumb_open,
	.close = dumb_close,
	.use = dumb_use,
	.resize = dumb_resize,
	.take = dumb_take,
	.give_back = dumb_give_back,
};
