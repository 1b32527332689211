/* libdrm behind struct kms_drm, and the three things that it is asked in the kernel's own words: an atomic request
 * without its allocations, buffers in plain memory, and frame buffers with whatever the driver understands. */
#include "platform/display/kms_drm.h"

#include <assert.h>
#include <drm_fourcc.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

void kms_request_add(struct kms_request *request, uint32_t object, uint32_t property, uint64_t value)
{
	if (!property)
		return;
	if (!request->object_count || request->objects[request->object_count - 1] != object) {
		assert(request->object_count < KMS_REQUEST_OBJECTS);
		request->objects[request->object_count] = object;
		request->counts[request->object_count++] = 0;
	}
	assert(request->count < KMS_REQUEST_VALUES);
	request->counts[request->object_count - 1]++;
	request->properties[request->count] = property;
	request->values[request->count++] = value;
}

static int device_open(const char *path)
{
	int fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
	return fd < 0 ? -errno : fd;
}

static void device_close(int fd)
{
	close(fd);
}

static int set_master(int fd)
{
	return drmSetMaster(fd) ? -errno : 0;
}

static int drop_master(int fd)
{
	return drmDropMaster(fd) ? -errno : 0;
}

static int add_fb(
	int fd, uint32_t width, uint32_t height, uint32_t handle, uint32_t pitch, uint64_t modifier, uint32_t *id)
{
	const uint32_t handles[4] = { handle }, pitches[4] = { pitch }, offsets[4] = { 0 };
	const uint64_t modifiers[4] = { modifier };
	int err = -EINVAL;
	if (modifier != DRM_FORMAT_MOD_INVALID)
		err = drmModeAddFB2WithModifiers(
			fd, width, height, DRM_FORMAT_XRGB8888, handles, pitches, offsets, modifiers, id, DRM_MODE_FB_MODIFIERS);
	if (err)
		err = drmModeAddFB2(fd, width, height, DRM_FORMAT_XRGB8888, handles, pitches, offsets, id, 0);
	if (err)
		err = drmModeAddFB(fd, width, height, 24, 32, pitch, handle, id);
	return err;
}

static int remove_fb(int fd, uint32_t id)
{
	return drmModeRmFB(fd, id);
}

static void destroy_dumb(int fd, struct kms_dumb_buffer *buffer)
{
	if (buffer->pixels)
		munmap(buffer->pixels, buffer->size);
	struct drm_mode_destroy_dumb destroy = { .handle = buffer->handle };
	if (buffer->handle)
		drmIoctl(fd, DRM_IOCTL_MODE_DESTROY_DUMB, &destroy);
	*buffer = (struct kms_dumb_buffer){ 0 };
}

static int create_dumb(int fd, uint32_t width, uint32_t height, struct kms_dumb_buffer *out)
{
	struct drm_mode_create_dumb create = { .width = width, .height = height, .bpp = 32 };
	*out = (struct kms_dumb_buffer){ .width = width, .height = height };
	if (drmIoctl(fd, DRM_IOCTL_MODE_CREATE_DUMB, &create))
		return -errno;
	out->handle = create.handle;
	out->pitch = create.pitch;
	out->size = create.size;
	struct drm_mode_map_dumb map = { .handle = create.handle };
	void *pixels = MAP_FAILED;
	if (!drmIoctl(fd, DRM_IOCTL_MODE_MAP_DUMB, &map))
		pixels = mmap(NULL, create.size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, (off_t)map.offset);
	if (pixels != MAP_FAILED) {
		out->pixels = pixels;
		return 0;
	}
	int err = -errno;
	destroy_dumb(fd, out);
	return err;
}

static int atomic(int fd, const struct kms_request *request, uint32_t flags, void *user)
{
	struct drm_mode_atomic commit = {
		.flags = flags,
		.count_objs = request->object_count,
		.objs_ptr = (uintptr_t)request->objects,
		.count_props_ptr = (uintptr_t)request->counts,
		.props_ptr = (uintptr_t)request->properties,
		.prop_values_ptr = (uintptr_t)request->values,
		.user_data = (uintptr_t)user,
	};
	return drmIoctl(fd, DRM_IOCTL_MODE_ATOMIC, &commit) ? -errno : 0;
}

const struct kms_drm kms_drm_libdrm = {
	.open = device_open,
	.close = device_close,
	.set_client_cap = drmSetClientCap,
	.get_cap = drmGetCap,
	.set_master = set_master,
	.drop_master = drop_master,
	.resources = drmModeGetResources,
	.free_resources = drmModeFreeResources,
	.connector = drmModeGetConnector,
	.free_connector = drmModeFreeConnector,
	.encoder = drmModeGetEncoder,
	.free_encoder = drmModeFreeEncoder,
	.crtc = drmModeGetCrtc,
	.free_crtc = drmModeFreeCrtc,
	.planes = drmModeGetPlaneResources,
	.free_planes = drmModeFreePlaneResources,
	.plane = drmModeGetPlane,
	.free_plane = drmModeFreePlane,
	.properties = drmModeObjectGetProperties,
	.free_properties = drmModeFreeObjectProperties,
	.property = drmModeGetProperty,
	.free_property = drmModeFreeProperty,
	.create_blob = drmModeCreatePropertyBlob,
	.destroy_blob = drmModeDestroyPropertyBlob,
	.add_fb = add_fb,
	.remove_fb = remove_fb,
	.create_dumb = create_dumb,
	.destroy_dumb = destroy_dumb,
	.atomic = atomic,
	.set_crtc = drmModeSetCrtc,
	.page_flip = drmModePageFlip,
	.set_gamma = drmModeCrtcSetGamma,
	.handle_event = drmHandleEvent,
};
