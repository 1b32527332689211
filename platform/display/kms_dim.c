/*
 * Brightness: the panel's own light where the profile names it, else the device's gamma table or colour matrix, else
 * the picture is drawn darker.
 */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "platform/display/kms.h"

#define STEP (1.0f / 128.0f) /* smaller changes cannot be seen */

/* A name is that of a folder of the kernel's; a path is taken as it is. */
static void backlight_path(char path[256], const char *backlight, const char *file)
{
	snprintf(path, 256, "%s%s/%s", backlight[0] == '/' ? "" : "/sys/class/backlight/", backlight, file);
}

static unsigned read_number(const char *backlight, const char *file)
{
	char path[256], text[16] = "";
	backlight_path(path, backlight, file);
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return 0;
	ssize_t size = read(fd, text, sizeof(text) - 1);
	close(fd);
	return size > 0 ? (unsigned)strtoul(text, NULL, 10) : 0;
}

static bool open_backlight(struct kms_dim *dim, const char *backlight)
{
	char path[256];
	dim->backlight_max = read_number(backlight, "max_brightness");
	dim->backlight_found = read_number(backlight, "brightness");
	backlight_path(path, backlight, "brightness");
	dim->backlight_fd = dim->backlight_max ? open(path, O_WRONLY | O_CLOEXEC) : -1;
	if (dim->backlight_fd < 0)
		log_warn("%s: %s; dimming the picture instead", path, strerror(errno));
	return dim->backlight_fd >= 0;
}

static bool write_backlight(const struct kms_dim *dim, unsigned value)
{
	char text[16];
	int size = snprintf(text, sizeof(text), "%u\n", value);
	return pwrite(dim->backlight_fd, text, (size_t)size, 0) == size;
}

/* Dark is for standby; a panel that is only dimmed is never quite off, because that looks broken. */
static unsigned backlight_value(const struct kms_dim *dim, float level)
{
	unsigned value = (unsigned)lroundf(level * (float)dim->backlight_max);
	return value || level <= 0.0f ? value : 1;
}

void kms_dim_open(struct kms *kms)
{
	struct kms_dim *dim = &kms->dim;
	*dim = (struct kms_dim){ .way = KMS_DIM_DEVICE, .backlight_fd = -1, .wanted = 1.0f, .shown = 1.0f };
	if (kms->config->backlight && open_backlight(dim, kms->config->backlight)) {
		dim->way = KMS_DIM_BACKLIGHT;
		dim->shown = -1.0f; /* whoever was killed in standby left it dark */
	}
}

void kms_dim_close(struct kms *kms)
{
	struct kms_dim *dim = &kms->dim;
	kms_dim_rest(kms);
	if (dim->backlight_fd >= 0)
		close(dim->backlight_fd);
	dim->backlight_fd = -1;
	if (dim->blob)
		kms->drm->destroy_blob(kms->fd, dim->blob);
	dim->blob = 0;
}

static void apply(struct kms *kms)
{
	struct kms_dim *dim = &kms->dim;
	if (dim->way == KMS_DIM_BACKLIGHT && !write_backlight(dim, backlight_value(dim, dim->wanted))) {
		log_warn("the backlight cannot be set (%s); dimming the picture instead", strerror(errno));
		dim->way = KMS_DIM_DEVICE;
	}
	if (dim->way == KMS_DIM_DEVICE) {
		if (kms->state != KMS_ON)
			return; /* kms_dim_again() */
		int err = kms->commit->dim(kms, dim->wanted);
		if (err)
			err = kms_legacy.dim(kms, dim->wanted);
		if (err) {
			log_info("%s has no gamma table (%s): pictures are drawn darker", kms->device, strerror(-err));
			dim->way = KMS_DIM_DRAWN;
		}
	}
	dim->shown = dim->wanted;
}

void kms_dim_set(struct kms *kms, float level)
{
	struct kms_dim *dim = &kms->dim;
	bool end = level <= 0.0f || level >= 1.0f;
	dim->wanted = level;
	if (fabsf(level - dim->shown) >= STEP || (end && fabsf(level - dim->shown) > 0.0f))
		apply(kms);
}

void kms_dim_rest(struct kms *kms)
{
	struct kms_dim *dim = &kms->dim;
	float wanted = dim->wanted;
	if (dim->way == KMS_DIM_DEVICE && dim->shown < 1.0f)
		kms_dim_set(kms, 1.0f);
	dim->wanted = wanted;
	if (dim->way == KMS_DIM_BACKLIGHT && dim->backlight_fd >= 0 && dim->shown <= 0.0f) {
		write_backlight(dim, dim->backlight_found ? dim->backlight_found : dim->backlight_max);
		dim->shown = -1.0f; /* no longer what was wanted */
	}
}

void kms_dim_again(struct kms *kms)
{
	const struct kms_dim *dim = &kms->dim;
	bool forgotten = dim->way == KMS_DIM_DEVICE && (dim->wanted < 1.0f || dim->shown < 1.0f);
	if (forgotten || dim->shown < 0.0f)
		apply(kms);
}
