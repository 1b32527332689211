#include "platform/display/kms_mode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool kms_mode_parse(const char *text, struct kms_mode_wish *out)
{
	struct kms_mode_wish wish = { 0 };
	double refresh = 0.0;
	int size_end = 0, end = 0;
	if (strspn(text, "0123456789") == 0 || text[strspn(text, "0123456789x")] == '-')
		return false; /* what sscanf would take for a number */
	if (sscanf(text, "%5ux%5u%n", &wish.width, &wish.height, &size_end) != 2 || !wish.width || !wish.height)
		return false;
	if (text[size_end]) {
		if (sscanf(text + size_end, "@%lf%n", &refresh, &end) != 1 || text[size_end + end] || !(refresh >= 1.0) ||
			!(refresh <= 1000.0))
			return false;
		wish.refresh_mhz = (uint32_t)lround(refresh * 1000.0);
	}
	*out = wish;
	return true;
}

uint32_t kms_mode_refresh_mhz(const drmModeModeInfo *mode)
{
	uint64_t pixels = (uint64_t)mode->htotal * mode->vtotal;
	if (!pixels || !mode->clock)
		return mode->vrefresh * 1000u;
	uint64_t mhz = ((uint64_t)mode->clock * 1000000u + pixels / 2) / pixels;
	if (mode->flags & DRM_MODE_FLAG_INTERLACE)
		mhz *= 2;
	if (mode->flags & DRM_MODE_FLAG_DBLSCAN)
		mhz /= 2;
	return (uint32_t)mhz;
}

bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b)
{
	return a->clock == b->clock && a->hdisplay == b->hdisplay && a->vdisplay == b->vdisplay && a->htotal == b->htotal &&
		   a->vtotal == b->vtotal && a->hsync_start == b->hsync_start && a->vsync_start == b->vsync_start &&
		   a->flags == b->flags;
}

void kms_mode_text(const drmModeModeInfo *mode, char *out, size_t size)
{
	double hz = kms_mode_refresh_mhz(mode) / 1000.0;
	bool whole = fabs(hz - round(hz)) < 0.005;
	snprintf(out, size, whole ? "%ux%u@%.0f" : "%ux%u@%.2f", mode->hdisplay, mode->vdisplay, hz);
}

/* Higher is tried earlier. The parts do not overlap: what stands first decides. */
static uint64_t score(const drmModeModeInfo *mode, const struct kms_mode_wish *wish, const drmModeModeInfo *current)
{
	uint32_t mhz = kms_mode_refresh_mhz(mode);
	uint64_t rank = (uint64_t)mode->hdisplay * mode->vdisplay; /* below 2^32 */
	bool sized = wish->width == mode->hdisplay && wish->height == mode->vdisplay;
	if (sized && wish->refresh_mhz) {
		uint32_t off = mhz > wish->refresh_mhz ? mhz - wish->refresh_mhz : wish->refresh_mhz - mhz;
		rank = UINT32_MAX - off;
	}
	if (current && kms_mode_same(mode, current))
		rank += UINT64_C(1) << 33;
	if (mode->type & DRM_MODE_TYPE_PREFERRED)
		rank += UINT64_C(1) << 34;
	if (sized && wish->refresh_mhz) /* the rate decides, not who else likes it */
		rank &= UINT32_MAX;
	if (sized)
		rank += UINT64_C(1) << 35;
	if (!(mode->flags & DRM_MODE_FLAG_INTERLACE))
		rank += UINT64_C(1) << 36;
	return rank;
}

uint32_t kms_mode_order(const drmModeModeInfo *modes, int count, const struct kms_mode_wish *wish,
	const drmModeModeInfo *current, uint8_t order[KMS_MODES_MAX])
{
	uint64_t scores[KMS_MODES_MAX] = { 0 };
	uint32_t kept = 0;
	for (int i = 0; i < count && i < KMS_MODES_MAX; i++) {
		uint64_t mine = score(&modes[i], wish, current);
		uint32_t at = kept++;
		for (; at > 0 && scores[at - 1] < mine; at--) {
			scores[at] = scores[at - 1];
			order[at] = order[at - 1];
		}
		scores[at] = mine;
		order[at] = (uint8_t)i;
	}
	return kept;
}
