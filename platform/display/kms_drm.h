/*
 * What the KMS display asks of a DRM device. Two implementations: libdrm (kms_drm.c) and the tests' made-up device. The
 * members that are libdrm's own functions keep their contracts; what they return is given back to the matching free_
 * member.
 */
#ifndef BLVD_PLATFORM_DISPLAY_KMS_DRM_H
#define BLVD_PLATFORM_DISPLAY_KMS_DRM_H

#include <stddef.h>
#include <stdint.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

/* Values to set at once. Those of one object stand together. */
#define KMS_REQUEST_OBJECTS 4
#define KMS_REQUEST_VALUES 32
struct kms_request {
	uint32_t objects[KMS_REQUEST_OBJECTS], counts[KMS_REQUEST_OBJECTS];
	uint32_t object_count, count;
	uint32_t properties[KMS_REQUEST_VALUES];
	uint64_t values[KMS_REQUEST_VALUES];
};

/* A buffer in plain memory that the device can show: XRGB8888. */
struct kms_dumb_buffer {
	uint32_t handle, pitch, width, height;
	uint64_t size;
	uint8_t *pixels; /* write only, may be slow to read */
};

/* All mandatory. Numbers below zero are -errno. */
struct kms_drm {
	int (*open)(const char *path); /* an fd, or -errno */
	void (*close)(int fd);
	int (*set_client_cap)(int fd, uint64_t capability, uint64_t value);
	int (*get_cap)(int fd, uint64_t capability, uint64_t *value);
	int (*set_master)(int fd);
	int (*drop_master)(int fd);

	drmModeResPtr (*resources)(int fd);
	void (*free_resources)(drmModeResPtr resources);
	drmModeConnectorPtr (*connector)(int fd, uint32_t id); /* asks the panel: may take a while */
	void (*free_connector)(drmModeConnectorPtr connector);
	drmModeEncoderPtr (*encoder)(int fd, uint32_t id);
	void (*free_encoder)(drmModeEncoderPtr encoder);
	drmModeCrtcPtr (*crtc)(int fd, uint32_t id);
	void (*free_crtc)(drmModeCrtcPtr crtc);
	drmModePlaneResPtr (*planes)(int fd);
	void (*free_planes)(drmModePlaneResPtr planes);
	drmModePlanePtr (*plane)(int fd, uint32_t id);
	void (*free_plane)(drmModePlanePtr plane);
	drmModeObjectPropertiesPtr (*properties)(int fd, uint32_t id, uint32_t type);
	void (*free_properties)(drmModeObjectPropertiesPtr properties);
	drmModePropertyPtr (*property)(int fd, uint32_t id);
	void (*free_property)(drmModePropertyPtr property);

	int (*create_blob)(int fd, const void *data, size_t size, uint32_t *id);
	int (*destroy_blob)(int fd, uint32_t id);
	/* XRGB8888; `modifier` DRM_FORMAT_MOD_INVALID: not said. */
	int (*add_fb)(
		int fd, uint32_t width, uint32_t height, uint32_t handle, uint32_t pitch, uint64_t modifier, uint32_t *id);
	int (*remove_fb)(int fd, uint32_t id);
	int (*create_dumb)(int fd, uint32_t width, uint32_t height, struct kms_dumb_buffer *out);
	void (*destroy_dumb)(int fd, struct kms_dumb_buffer *buffer);

	int (*atomic)(int fd, const struct kms_request *request, uint32_t flags, void *user);
	int (*set_crtc)(int fd, uint32_t crtc, uint32_t fb, uint32_t x, uint32_t y, uint32_t *connectors, int count,
		drmModeModeInfoPtr mode);
	int (*page_flip)(int fd, uint32_t crtc, uint32_t fb, uint32_t flags, void *user);
	int (*set_gamma)(int fd, uint32_t crtc, uint32_t size, uint16_t *red, uint16_t *green, uint16_t *blue);
	int (*handle_event)(int fd, drmEventContextPtr context); /* reads what poll() announced */
};

extern const struct kms_drm kms_drm_libdrm;

/* Appends a value; `property` 0 (the object has no such one) is passed over. */
void kms_request_add(struct kms_request *request, uint32_t object, uint32_t property, uint64_t value);

#endif
