#include "platform/camera/jpeg_planes.h"

#include <errno.h>

#ifdef BLVD_HAVE_TURBOJPEG
#include <turbojpeg.h>

/* Room for rows that are padded to whole blocks. */
static uint32_t padded(uint32_t size)
{
	return (size + 31) & ~31u;
}

uint64_t jpeg_planes_bytes(uint32_t width, uint32_t height)
{
	return (uint64_t)padded(width) * padded(height) * 3;
}

int jpeg_planes_init(struct jpeg_planes *jpeg, uint32_t width, uint32_t height, struct arena *arena)
{
	*jpeg = (struct jpeg_planes){ .width = width, .height = height };
	jpeg->apart = arena_alloc(arena, (size_t)padded(width) * padded(height) * 2, 64);
	jpeg->decoder = jpeg->apart ? tjInitDecompress() : NULL;
	return jpeg->decoder ? 0 : -ENOMEM;
}

void jpeg_planes_finish(struct jpeg_planes *jpeg)
{
	if (jpeg->decoder)
		tjDestroy(jpeg->decoder);
	*jpeg = (struct jpeg_planes){ 0 };
}

static void join(const uint8_t *u, const uint8_t *v, size_t count, uint8_t *out)
{
	for (size_t i = 0; i < count; i++) {
		out[2 * i] = u[i];
		out[2 * i + 1] = v[i];
	}
}

/* A grey picture has neutral colours of one place. */
static void describe(struct camera_frame *out, uint8_t *memory, uint32_t width, uint32_t height, int sampling)
{
	bool grey = sampling == TJSAMP_GRAY;
	*out = (struct camera_frame){ .format = CAMERA_PLANES,
		.width = width,
		.height = height,
		.chroma_width = grey ? 1 : (uint32_t)tjPlaneWidth(1, (int)width, sampling),
		.chroma_height = grey ? 1 : (uint32_t)tjPlaneHeight(1, (int)height, sampling),
		.matrix = CAMERA_BT601,
		.full_range = true,
		.buffer = UINT32_MAX };
	out->plane[0] = memory;
	out->stride[0] = width;
	out->plane[1] = memory + (size_t)padded(width) * padded(height);
	out->stride[1] = 2 * out->chroma_width;
}

int jpeg_planes_decode(
	struct jpeg_planes *jpeg, const uint8_t *data, size_t size, uint8_t *memory, struct camera_frame *out)
{
	int width = 0, height = 0, sampling = -1, space = -1; /* not always written, whatever is returned */
	if (tjDecompressHeader3(jpeg->decoder, data, size, &width, &height, &sampling, &space) || width <= 0 ||
		height <= 0 || sampling < 0)
		return -EBADMSG;
	if ((uint32_t)width > jpeg->width || (uint32_t)height > jpeg->height)
		return -EFBIG;
	describe(out, memory, (uint32_t)width, (uint32_t)height, sampling);
	size_t chroma = (size_t)out->chroma_width * out->chroma_height;
	uint8_t *planes[3] = { memory, jpeg->apart, jpeg->apart + chroma };
	int strides[3] = { width, (int)out->chroma_width, (int)out->chroma_width };
	uint8_t *pairs = memory + (out->plane[1] - out->plane[0]);
	/* a warning is a picture that is cut short or damaged: half a picture is none */
	if (tjDecompressToYUVPlanes(jpeg->decoder, data, size, planes, width, strides, height, TJFLAG_STOPONWARNING))
		return -EBADMSG;
	if (sampling == TJSAMP_GRAY) {
		pairs[0] = pairs[1] = 128;
		return 0;
	}
	join(planes[1], planes[2], chroma, pairs);
	return 0;
}

#else

uint64_t jpeg_planes_bytes(uint32_t width, uint32_t height)
{
	(void)width;
	(void)height;
	return 0;
}

int jpeg_planes_init(struct jpeg_planes *jpeg, uint32_t width, uint32_t height, struct arena *arena)
{
	(void)width;
	(void)height;
	(void)arena;
	*jpeg = (struct jpeg_planes){ 0 };
	return -ENOTSUP;
}

void jpeg_planes_finish(struct jpeg_planes *jpeg)
{
	(void)jpeg;
}

int jpeg_planes_decode(
	struct jpeg_planes *jpeg, const uint8_t *data, size_t size, uint8_t *memory, struct camera_frame *out)
{
	(void)jpeg;
	(void)data;
	(void)size;
	(void)memory;
	(void)out;
	return -ENOTSUP;
}
#endif
