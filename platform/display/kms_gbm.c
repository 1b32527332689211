/*
 * Pictures drawn by the GPU into buffers of GBM, which the panel shows without a copy. Frame buffer ids are made once
 * for each of the surface's few buffers.
 */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <drm_fourcc.h>
#include <errno.h>
#include <gbm.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/egl.h"
#include "platform/display/kms.h"

static int fail(const char *what)
{
	log_debug("EGL on GBM: %s: %s", what, egl_error_text(eglGetError()));
	return -EIO;
}

/* The config whose pixels are XRGB8888. */
static EGLConfig find_config(EGLDisplay egl)
{
	static const EGLint wanted[] = { EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, EGL_WINDOW_BIT,
		EGL_RED_SIZE, 8, EGL_GREEN_SIZE, 8, EGL_BLUE_SIZE, 8, EGL_NONE };
	EGLConfig configs[64];
	EGLint count = 0, visual;
	if (!eglChooseConfig(egl, wanted, configs, 64, &count))
		return NULL;
	for (EGLint i = 0; i < count; i++)
		if (eglGetConfigAttrib(egl, configs[i], EGL_NATIVE_VISUAL_ID, &visual) && visual == GBM_FORMAT_XRGB8888)
			return configs[i];
	return NULL;
}

/* Drawn by the CPU, into memory that is slow to read: plain buffers are three times as fast. */
static bool drawn_by_cpu(EGLDisplay egl)
{
	if (!egl_has(egl, "EGL_MESA_query_driver"))
		return false;
	PFNEGLGETDISPLAYDRIVERNAMEPROC name_of =
		(PFNEGLGETDISPLAYDRIVERNAMEPROC)eglGetProcAddress("eglGetDisplayDriverName");
	const char *name = name_of ? name_of(egl) : NULL;
	return name && strstr(name, "swrast");
}

static int start_egl(struct kms_gbm_state *gbm)
{
	static const EGLint version[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE };
	gbm->egl = eglGetPlatformDisplay(EGL_PLATFORM_GBM_KHR, gbm->device, NULL);
	if (gbm->egl == EGL_NO_DISPLAY || !eglInitialize(gbm->egl, NULL, NULL)) {
		gbm->egl = NULL;
		return fail("cannot start");
	}
	gbm->config = find_config(gbm->egl);
	if (!gbm->config || !eglBindAPI(EGL_OPENGL_ES_API))
		return fail("no XRGB8888 to draw OpenGL ES 3 into");
	gbm->context = eglCreateContext(gbm->egl, gbm->config, EGL_NO_CONTEXT, version);
	if (!gbm->context)
		return fail("no OpenGL ES 3.0 context");
	return 0;
}

static int gbm_use(struct kms *kms)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	EGLSurface surface = gbm->window ? gbm->window : EGL_NO_SURFACE;
	return eglMakeCurrent(gbm->egl, surface, surface, gbm->context) ? 0 : fail("context");
}

static int gbm_open(struct kms *kms)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	*gbm = (struct kms_gbm_state){ 0 };
	gbm->device = gbm_create_device(kms->fd);
	if (!gbm->device)
		return -ENODEV;
	int err = start_egl(gbm);
	if (!err && kms->config->buffers == DISPLAY_BUFFERS_AUTO && drawn_by_cpu(gbm->egl))
		return -EOPNOTSUPP;
	return err ? err : gbm_use(kms);
}

static void drop_surface(struct kms *kms)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	for (int i = 0; i < KMS_GBM_BUFFERS; i++)
		if (gbm->buffers[i].bo)
			kms->drm->remove_fb(kms->fd, gbm->buffers[i].fb);
	for (int i = 0; i < KMS_GBM_BUFFERS; i++)
		gbm->buffers[i] = (struct kms_gbm_buffer){ 0 };
	if (gbm->window) {
		eglMakeCurrent(gbm->egl, EGL_NO_SURFACE, EGL_NO_SURFACE, gbm->context);
		eglDestroySurface(gbm->egl, gbm->window);
	}
	if (gbm->surface)
		gbm_surface_destroy(gbm->surface);
	gbm->window = gbm->surface = NULL;
}

static void gbm_close(struct kms *kms)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	if (gbm->egl) {
		drop_surface(kms);
		eglMakeCurrent(gbm->egl, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
		if (gbm->context)
			eglDestroyContext(gbm->egl, gbm->context);
		eglTerminate(gbm->egl);
		eglReleaseThread();
	}
	if (gbm->device)
		gbm_device_destroy(gbm->device);
	*gbm = (struct kms_gbm_state){ 0 };
}

static int gbm_resize(struct kms *kms)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	uint32_t width, height;
	drop_surface(kms);
	kms_size(kms, &width, &height);
	const uint32_t shown = GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING;
	gbm->surface = gbm_surface_create(gbm->device, width, height, GBM_FORMAT_XRGB8888, shown);
	if (!gbm->surface) /* some want to be told that only plain rows can be shown */
		gbm->surface = gbm_surface_create(gbm->device, width, height, GBM_FORMAT_XRGB8888, shown | GBM_BO_USE_LINEAR);
	if (!gbm->surface)
		return -errno;
	gbm->window = eglCreatePlatformWindowSurface(gbm->egl, gbm->config, gbm->surface, NULL);
	if (!gbm->window)
		return fail("no surface");
	return gbm_use(kms);
}

/* The entry of a buffer, made when it is met first; NULL when it cannot be shown. */
static struct kms_gbm_buffer *find_buffer(struct kms *kms, struct gbm_bo *bo)
{
	struct kms_gbm_buffer *entry = gbm_bo_get_user_data(bo);
	for (int i = 0; i < KMS_GBM_BUFFERS && !entry; i++) {
		struct kms_gbm_buffer *free_one = &kms->gbm.buffers[i];
		if (free_one->bo)
			continue;
		int err = kms->drm->add_fb(kms->fd, gbm_bo_get_width(bo), gbm_bo_get_height(bo), gbm_bo_get_handle(bo).u32,
			gbm_bo_get_stride(bo), gbm_bo_get_modifier(bo), &free_one->fb);
		if (err)
			return NULL;
		free_one->bo = bo;
		gbm_bo_set_user_data(bo, free_one, NULL);
		entry = free_one;
	}
	return entry;
}

static int gbm_take(struct kms *kms, struct kms_frame *out)
{
	struct kms_gbm_state *gbm = &kms->gbm;
	if (!gbm->window)
		return -ENODEV;
	if (!eglSwapBuffers(gbm->egl, gbm->window))
		return fail("cannot finish a picture");
	struct gbm_bo *bo = gbm_surface_lock_front_buffer(gbm->surface);
	if (!bo)
		return -EIO;
	const struct kms_gbm_buffer *buffer = find_buffer(kms, bo);
	if (!buffer) {
		gbm_surface_release_buffer(gbm->surface, bo);
		return -EIO;
	}
	*out = (struct kms_frame){ .fb = buffer->fb, .owner = bo };
	return 0;
}

static void gbm_give_back(struct kms *kms, const struct kms_frame *frame)
{
	gbm_surface_release_buffer(kms->gbm.surface, frame->owner);
}

const struct kms_buffers kms_gbm = {
	.name = "GBM",
	.surface = DISPLAY_SURFACE_WINDOW,
	.open = gbm_open,
	.close = gbm_close,
	.use = gbm_use,
	.resize = gbm_resize,
	.take = gbm_take,
	.give_back = gbm_give_back,
};
