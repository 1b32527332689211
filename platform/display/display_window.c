/* A desktop window by GLFW 3.3, with the context made by EGL, so that it is the same OpenGL ES as everywhere else. */
#ifdef BLVD_HAVE_GLFW
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <errno.h>

#include "platform/base/log.h"
#include "platform/display/display.h"

static void on_error(int code, const char *text)
{
	log_error("window: %s (%d)", text, code);
}

static enum display_key key_of(int key)
{
	switch (key) {
	case GLFW_KEY_UP:
		return DISPLAY_KEY_UP;
	case GLFW_KEY_DOWN:
		return DISPLAY_KEY_DOWN;
	case GLFW_KEY_LEFT:
		return DISPLAY_KEY_LEFT;
	case GLFW_KEY_RIGHT:
		return DISPLAY_KEY_RIGHT;
	case GLFW_KEY_EQUAL:
	case GLFW_KEY_KP_ADD:
		return DISPLAY_KEY_ZOOM_IN;
	case GLFW_KEY_MINUS:
	case GLFW_KEY_KP_SUBTRACT:
		return DISPLAY_KEY_ZOOM_OUT;
	case GLFW_KEY_C:
		return DISPLAY_KEY_CAMERA;
	case GLFW_KEY_N:
		return DISPLAY_KEY_NIGHT;
	case GLFW_KEY_SPACE:
		return DISPLAY_KEY_PAUSE;
	case GLFW_KEY_ENTER:
	case GLFW_KEY_KP_ENTER:
		return DISPLAY_KEY_PUSH;
	case GLFW_KEY_BACKSPACE:
		return DISPLAY_KEY_BACK;
	case GLFW_KEY_ESCAPE:
		return DISPLAY_KEY_ESCAPE;
	case GLFW_KEY_Q:
		return DISPLAY_KEY_QUIT;
	default:
		return DISPLAY_KEY_NONE;
	}
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
	(void)scancode;
	(void)mods;
	struct display_event event = { .kind = DISPLAY_EVENT_KEY, .key = key_of(key) };
	if (action != GLFW_RELEASE && event.key != DISPLAY_KEY_NONE)
		display_push(glfwGetWindowUserPointer(window), &event);
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
	(void)x;
	struct display_event event = { .kind = DISPLAY_EVENT_KEY,
		.key = y > 0.0 ? DISPLAY_KEY_ZOOM_IN : DISPLAY_KEY_ZOOM_OUT };
	display_push(glfwGetWindowUserPointer(window), &event);
}

static void on_close(GLFWwindow *window)
{
	display_push(glfwGetWindowUserPointer(window), &(struct display_event){ .kind = DISPLAY_EVENT_CLOSE });
}

static void on_resize(GLFWwindow *window, int width, int height)
{
	struct display *display = glfwGetWindowUserPointer(window);
	if (width <= 0 || height <= 0)
		return; /* iconified */
	display->width = (uint32_t)width;
	display->height = (uint32_t)height;
	struct display_event event = { .kind = DISPLAY_EVENT_RESIZE, .width = display->width, .height = display->height };
	display_push(display, &event);
}

static void listen(GLFWwindow *window)
{
	glfwSetKeyCallback(window, on_key);
	glfwSetScrollCallback(window, on_scroll);
	glfwSetWindowCloseCallback(window, on_close);
	glfwSetFramebufferSizeCallback(window, on_resize);
}

static int window_open(struct display *display, const struct display_config *config)
{
	glfwSetErrorCallback(on_error);
	if (!glfwInit())
		return -ENODEV;
	glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
	glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 0);
	glfwWindowHint(GLFW_DEPTH_BITS, 0);
	glfwWindowHint(GLFW_STENCIL_BITS, 0);
	const char *title = config->title ? config->title : "Boulevard";
	GLFWwindow *window = glfwCreateWindow((int)config->width, (int)config->height, title, NULL, NULL);
	if (!window) {
		glfwTerminate();
		return -ENODEV;
	}
	display->native[0] = window;
	display->surface = DISPLAY_SURFACE_WINDOW;
	glfwSetWindowUserPointer(window, display);
	listen(window);
	glfwMakeContextCurrent(window);
	glfwSwapInterval(config->vsync ? 1 : 0);
	int width, height;
	glfwGetFramebufferSize(window, &width, &height);
	display->width = (uint32_t)width;
	display->height = (uint32_t)height;
	return 0;
}

static void window_close(struct display *display)
{
	glfwDestroyWindow(display->native[0]);
	glfwTerminate();
}

static int window_use(struct display *display)
{
	glfwMakeContextCurrent(display->native[0]);
	return 0;
}

static int window_present(struct display *display)
{
	glfwSwapBuffers(display->native[0]);
	return 0;
}

static void window_pump(struct display *display)
{
	(void)display;
	glfwPollEvents();
}

const struct display_ops display_window = {
	.name = "window",
	.open = window_open,
	.close = window_close,
	.use = window_use,
	.present = window_present,
	.pump = window_pump,
};
#endif
