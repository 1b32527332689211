/* Pictures for drivers without atomic requests: one call sets mode and picture, another flips. Nothing can be tried
 * beforehand, and the plane turns nothing. */
#include <errno.h>

#include "platform/display/kms.h"

static int legacy_test(struct kms *kms, const drmModeModeInfo *mode, uint32_t fb, unsigned turn_deg)
{
	(void)kms;
	(void)mode;
	(void)fb;
	return turn_deg ? -EINVAL : -EOPNOTSUPP;
}

static int legacy_modeset(struct kms *kms, uint32_t fb)
{
	struct kms_output *output = &kms->output;
	return kms->drm->set_crtc(kms->fd, output->crtc, fb, 0, 0, &output->connector, 1, &output->mode);
}

static int legacy_flip(struct kms *kms, uint32_t fb)
{
	return kms->drm->page_flip(kms->fd, kms->output.crtc, fb, DRM_MODE_PAGE_FLIP_EVENT, kms);
}

#define GAMMA_MAX 4096

static int legacy_dim(struct kms *kms, float level)
{
	static uint16_t table[GAMMA_MAX];
	uint32_t size = kms->output.legacy_gamma_size;
	if (size < 2 || size > GAMMA_MAX)
		return -EOPNOTSUPP;
	for (uint32_t i = 0; i < size; i++)
		table[i] = (uint16_t)(level * 65535.0f * (float)i / (float)(size - 1) + 0.5f);
	return kms->drm->set_gamma(kms->fd, kms->output.crtc, size, table, table, table);
}

const struct kms_commit kms_legacy = {
	.name = "legacy",
	.test = legacy_test,
	.modeset = legacy_modeset,
	.flip = legacy_flip,
	.dim = legacy_dim,
};
