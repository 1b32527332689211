/* Context creation and EGL's error words, shared by the displays that speak EGL themselves. */
#include "platform/display/egl.h"

#include <errno.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/display.h"

const char *egl_error_text(EGLint error)
{
	static const char *const words[] = { "EGL_SUCCESS", "EGL_NOT_INITIALIZED", "EGL_BAD_ACCESS", "EGL_BAD_ALLOC",
		"EGL_BAD_ATTRIBUTE", "EGL_BAD_CONFIG", "EGL_BAD_CONTEXT", "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY",
		"EGL_BAD_MATCH", "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW", "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",
		"EGL_CONTEXT_LOST" };
	EGLint index = error - EGL_SUCCESS;
	return index >= 0 && index < (EGLint)(sizeof(words) / sizeof(words[0])) ? words[index] : "unknown EGL error";
}

int egl_has(EGLDisplay display, const char *extension)
{
	const char *at = eglQueryString(display, EGL_EXTENSIONS);
	size_t length = strlen(extension);
	while (at && (at = strstr(at, extension))) {
		if (at[length] == ' ' || at[length] == '\0')
			return 1;
		at += length;
	}
	return 0;
}

static int fail(const char *what)
{
	log_error("EGL: %s: %s", what, egl_error_text(eglGetError()));
	return -EIO;
}

static EGLContext make_context(EGLDisplay display)
{
	static const EGLint wanted[] = { EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT,
		EGL_NONE };
	static const EGLint version[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE };
	EGLConfig config = NULL;
	EGLint count = 0;
	if (!eglChooseConfig(display, wanted, &config, 1, &count) || !count)
		config = NULL; /* EGL_NO_CONFIG_KHR: fine where there is EGL_KHR_no_config_context */
	return eglCreateContext(display, config, EGL_NO_CONTEXT, version);
}

int egl_start_surfaceless(EGLDisplay display, EGLContext *context)
{
	EGLint major, minor;
	if (!eglInitialize(display, &major, &minor))
		return fail("cannot start");
	if (!eglBindAPI(EGL_OPENGL_ES_API) || (*context = make_context(display)) == EGL_NO_CONTEXT) {
		int err = fail("no OpenGL ES 3.0 context");
		eglTerminate(display);
		return err;
	}
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, *context)) {
		int err = fail("context without a surface");
		egl_stop(display, *context);
		return err;
	}
	return 0;
}

void egl_stop(EGLDisplay display, EGLContext context)
{
	eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(display, context);
	eglTerminate(display);
	eglReleaseThread();
}

void (*display_get_proc(const char *name))(void)
{
	return eglGetProcAddress(name);
}
