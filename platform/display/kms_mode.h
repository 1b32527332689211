/* Which of a panel's modes to use. Pure: no device. */
#ifndef BLVD_PLATFORM_DISPLAY_KMS_MODE_H
#define BLVD_PLATFORM_DISPLAY_KMS_MODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <xf86drmMode.h>

#define KMS_MODES_MAX 64

struct kms_mode_wish {
	uint32_t width, height; /* 0: none */
	uint32_t refresh_mhz;   /* 0: any */
};

/* "1280x720", "1280x720@60", "1920x1080@59.94". False when it is none of these. */
bool kms_mode_parse(const char *text, struct kms_mode_wish *out);

/* Thousandths of a hertz, from the timings. */
uint32_t kms_mode_refresh_mhz(const drmModeModeInfo *mode);

/* Fills `order` with indices of `modes`, the one to try first first: as wished (the size, then the nearest refresh
 * rate), preferred by the panel, set by whoever was there before (`current`, NULL none), then the largest. Interlaced
 * ones come last. Returns how many, at most KMS_MODES_MAX. */
uint32_t kms_mode_order(const drmModeModeInfo *modes, int count, const struct kms_mode_wish *wish,
	const drmModeModeInfo *current, uint8_t order[KMS_MODES_MAX]);

bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b);

/* "1280x720@60" */
void kms_mode_text(const drmModeModeInfo *mode, char *out, size_t size);

#endif
