/* Context creation and EGL's error words, shared by the displays that speak EGL themselves. */
#include "platform/display/egl.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/display.h"

/* Every caller gets the same EGLDisplay, and one eglTerminate() ends it for all of them: the last one does it. */
static pthread_mutex_t users_lock = PTHREAD_MUTEX_INITIALIZER;
static int users;

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

static EGLBoolean initialize(EGLDisplay display)
{
	pthread_mutex_lock(&users_lock);
	EGLBoolean done = eglInitialize(display, NULL, NULL);
	users += done ? 1 : 0;
	pthread_mutex_unlock(&users_lock);
	return done;
}

static void terminate(EGLDisplay display)
{
	pthread_mutex_lock(&users_lock);
	if (--users == 0)
		eglTerminate(display);
	pthread_mutex_unlock(&users_lock);
}

int egl_start_surfaceless(EGLDisplay display, EGLContext *context)
{
	if (!initialize(display))
		return fail("cannot start");
	if (!eglBindAPI(EGL_OPENGL_ES_API) || (*context = make_context(display)) == EGL_NO_CONTEXT) {
		int err = fail("no OpenGL ES 3.0 context");
		terminate(display);
		return err;
	}
	int err = egl_use(display, *context);
	if (err)
		egl_stop(display, *context);
	return err;
}

int egl_use(EGLDisplay display, EGLContext context)
{
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
		return fail("context without a surface");
	return 0;
}

void egl_stop(EGLDisplay display, EGLContext context)
{
	eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(display, context);
	terminate(display);
	eglReleaseThread();
}

void (*display_get_proc(const char *name))(void)
{
	return eglGetProcAddress(name);
}
