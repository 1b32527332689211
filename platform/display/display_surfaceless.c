/*
 * No screen at all: EGL on Mesa's surfaceless platform (llvmpipe on a machine without GPU), or on the first EGL device
 * where the driver is not Mesa's. Frames are read back by whoever wants them.
 */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <errno.h>
#include <stddef.h>

#include "platform/base/log.h"
#include "platform/display/display.h"
#include "platform/display/egl.h"

static EGLDisplay first_device(void)
{
	PFNEGLQUERYDEVICESEXTPROC query = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
	EGLDeviceEXT device;
	EGLint count = 0;
	if (!query || !query(1, &device, &count) || !count)
		return EGL_NO_DISPLAY;
	return eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, NULL);
}

static EGLDisplay find_display(void)
{
	EGLDisplay display = EGL_NO_DISPLAY;
	if (egl_has(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
		display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
	if (display == EGL_NO_DISPLAY && egl_has(EGL_NO_DISPLAY, "EGL_EXT_platform_device"))
		display = first_device();
	return display;
}

static int surfaceless_open(struct display *display, const struct display_config *config)
{
	(void)config;
	EGLDisplay egl = find_display();
	if (egl == EGL_NO_DISPLAY) {
		log_error("EGL: neither a surfaceless nor a device platform here");
		return -ENODEV;
	}
	EGLContext context;
	int err = egl_start_surfaceless(egl, &context);
	if (err)
		return err;
	display->native[0] = egl;
	display->native[1] = context;
	return 0;
}

static void surfaceless_close(struct display *display)
{
	egl_stop(display->native[0], display->native[1]);
}

static int surfaceless_use(struct display *display)
{
	return egl_use(display->native[0], display->native[1]);
}

static int surfaceless_present(struct display *display)
{
	(void)display;
	return 0;
}

static void surfaceless_pump(struct display *display)
{
	(void)display;
}

const struct display_ops display_surfaceless = {
	.name = "headless",
	.open = surfaceless_open,
	.close = surfaceless_close,
	.use = surfaceless_use,
	.present = surfaceless_present,
	.pump = surfaceless_pump,
};
