#include "platform/display/egl_image.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <errno.h>
#include <stddef.h>
#include <string.h>

#include "platform/display/egl.h"

#define FORMATS_MAX 256

/* Mesa's software driver on a card (kms_swrast, 22.3 and 25.0) says yes to buffers of other devices, cannot map them,
 * because the kernel maps no imported buffer as a plain one, and crashes when they are drawn. */
static bool breaks_on_use(EGLDisplay display)
{
	PFNEGLGETDISPLAYDRIVERNAMEPROC name_of =
		(PFNEGLGETDISPLAYDRIVERNAMEPROC)eglGetProcAddress("eglGetDisplayDriverName");
	const char *name = egl_has(display, "EGL_MESA_query_driver") && name_of ? name_of(display) : NULL;
	return name && !strcmp(name, "kms_swrast");
}

bool egl_image_offered(uint32_t fourcc)
{
	EGLDisplay display = eglGetCurrentDisplay();
	if (display == EGL_NO_DISPLAY || !egl_has(display, "EGL_EXT_image_dma_buf_import") || breaks_on_use(display))
		return false;
	PFNEGLQUERYDMABUFFORMATSEXTPROC query =
		(PFNEGLQUERYDMABUFFORMATSEXTPROC)eglGetProcAddress("eglQueryDmaBufFormatsEXT");
	EGLint formats[FORMATS_MAX], count = 0;
	if (!egl_has(display, "EGL_EXT_image_dma_buf_import_modifiers") || !query)
		return true; /* it does not tell: the import will */
	if (!query(display, FORMATS_MAX, formats, &count))
		return false;
	for (EGLint i = 0; i < count; i++)
		if ((uint32_t)formats[i] == fourcc)
			return true;
	return false;
}

int egl_image_create(const struct egl_dmabuf *from, void **image)
{
	static const EGLint plane_words[2][3] = { { EGL_DMA_BUF_PLANE0_FD_EXT, EGL_DMA_BUF_PLANE0_OFFSET_EXT,
												  EGL_DMA_BUF_PLANE0_PITCH_EXT },
		{ EGL_DMA_BUF_PLANE1_FD_EXT, EGL_DMA_BUF_PLANE1_OFFSET_EXT, EGL_DMA_BUF_PLANE1_PITCH_EXT } };
	PFNEGLCREATEIMAGEKHRPROC create = (PFNEGLCREATEIMAGEKHRPROC)eglGetProcAddress("eglCreateImageKHR");
	EGLDisplay display = eglGetCurrentDisplay();
	EGLint words[32], count = 0;
	*image = NULL;
	if (!create || display == EGL_NO_DISPLAY || !egl_has(display, "EGL_EXT_image_dma_buf_import"))
		return -ENOTSUP;
	const EGLint head[] = { EGL_WIDTH, (EGLint)from->width, EGL_HEIGHT, (EGLint)from->height, EGL_LINUX_DRM_FOURCC_EXT,
		(EGLint)from->fourcc };
	for (; count < 6; count++)
		words[count] = head[count];
	for (uint32_t i = 0; i < from->planes && i < 2; i++) {
		const EGLint values[3] = { from->fd, (EGLint)from->offset[i], (EGLint)from->stride[i] };
		for (int k = 0; k < 3; k++) {
			words[count++] = plane_words[i][k];
			words[count++] = values[k];
		}
	}
	if (from->yuv) {
		words[count++] = EGL_YUV_COLOR_SPACE_HINT_EXT;
		words[count++] = from->bt709 ? EGL_ITU_REC709_EXT : EGL_ITU_REC601_EXT;
		words[count++] = EGL_SAMPLE_RANGE_HINT_EXT;
		words[count++] = from->full_range ? EGL_YUV_FULL_RANGE_EXT : EGL_YUV_NARROW_RANGE_EXT;
	}
	words[count] = EGL_NONE;
	*image = create(display, EGL_NO_CONTEXT, EGL_LINUX_DMA_BUF_EXT, NULL, words);
	return *image != EGL_NO_IMAGE_KHR ? 0 : -EINVAL;
}

void egl_image_destroy(void *image)
{
	PFNEGLDESTROYIMAGEKHRPROC destroy = (PFNEGLDESTROYIMAGEKHRPROC)eglGetProcAddress("eglDestroyImageKHR");
	if (image && destroy && eglGetCurrentDisplay() != EGL_NO_DISPLAY)
		destroy(eglGetCurrentDisplay(), image);
}
