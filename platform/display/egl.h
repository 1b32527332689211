/* An OpenGL ES 3.0 context by EGL, for displays that make their own. */
#ifndef BLVD_PLATFORM_DISPLAY_EGL_H
#define BLVD_PLATFORM_DISPLAY_EGL_H

#include <EGL/egl.h>

/* The word for an EGL error code: "EGL_BAD_MATCH". */
const char *egl_error_text(EGLint error);

/* Does the display have this extension? EGL_NO_DISPLAY asks for client extensions. */
int egl_has(EGLDisplay display, const char *extension);

/* Initialises `display`, makes a surfaceless ES 3.0 context and makes it current. Returns 0 or -EIO; logs one line. */
int egl_start_surfaceless(EGLDisplay display, EGLContext *context);
/* Makes a context current in this thread. Returns 0 or -EIO; logs one line. */
int egl_use(EGLDisplay display, EGLContext context);
void egl_stop(EGLDisplay display, EGLContext context);

#endif
