/* Connector, CRTC and plane: found at start, and the panel asked again whenever it may have changed. */
#include <drm_fourcc.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/kms.h"

/* Reads the ids of an object's properties by name. */
struct named_property {
	const char *name;
	uint32_t *id;
	uint64_t *value; /* or NULL */
};

/* The bits of an enumeration's words "rotate-0"... as this driver numbers them. */
static uint64_t rotations_of(const drmModePropertyRes *property)
{
	static const char *const words[] = { "rotate-0", "rotate-90", "rotate-180", "rotate-270" };
	uint64_t bits = 0;
	for (int i = 0; i < property->count_enums; i++)
		for (unsigned k = 0; k < 4; k++)
			if (!strcmp(property->enums[i].name, words[k]) && property->enums[i].value == k)
				bits |= 1u << k; /* a bitmask's values are bit numbers: DRM_MODE_ROTATE_0 is bit 0 */
	return bits;
}

static void read_properties(
	const struct kms *kms, uint32_t object, uint32_t type, const struct named_property *wanted, uint64_t *rotations)
{
	const struct kms_drm *drm = kms->drm;
	drmModeObjectPropertiesPtr all = drm->properties(kms->fd, object, type);
	for (uint32_t i = 0; all && i < all->count_props; i++) {
		drmModePropertyPtr property = drm->property(kms->fd, all->props[i]);
		if (!property)
			continue;
		for (const struct named_property *want = wanted; want->name; want++) {
			if (strcmp(property->name, want->name) != 0)
				continue;
			*want->id = property->prop_id;
			if (want->value)
				*want->value = all->prop_values[i];
		}
		if (rotations && !strcmp(property->name, "rotation"))
			*rotations = rotations_of(property);
		drm->free_property(property);
	}
	if (all)
		drm->free_properties(all);
}

static void read_all_properties(const struct kms *kms, struct kms_output *out)
{
	struct kms_connector_properties *connector = &out->connector_properties;
	struct kms_crtc_properties *crtc = &out->crtc_properties;
	struct kms_plane_properties *plane = &out->plane_properties;
	const struct named_property of_connector[] = { { "CRTC_ID", &connector->crtc_id, NULL }, { 0 } };
	const struct named_property of_crtc[] = { { "ACTIVE", &crtc->active, NULL }, { "MODE_ID", &crtc->mode_id, NULL },
		{ "GAMMA_LUT", &crtc->gamma_lut, NULL }, { "GAMMA_LUT_SIZE", &crtc->gamma_lut_size, &crtc->gamma_size },
		{ "CTM", &crtc->ctm, NULL }, { 0 } };
	const struct named_property of_plane[] = { { "FB_ID", &plane->fb_id, NULL }, { "CRTC_ID", &plane->crtc_id, NULL },
		{ "SRC_X", &plane->src_x, NULL }, { "SRC_Y", &plane->src_y, NULL }, { "SRC_W", &plane->src_w, NULL },
		{ "SRC_H", &plane->src_h, NULL }, { "CRTC_X", &plane->crtc_x, NULL }, { "CRTC_Y", &plane->crtc_y, NULL },
		{ "CRTC_W", &plane->crtc_w, NULL }, { "CRTC_H", &plane->crtc_h, NULL }, { "rotation", &plane->rotation, NULL },
		{ 0 } };
	read_properties(kms, out->connector, DRM_MODE_OBJECT_CONNECTOR, of_connector, NULL);
	read_properties(kms, out->crtc, DRM_MODE_OBJECT_CRTC, of_crtc, NULL);
	if (out->plane)
		read_properties(kms, out->plane, DRM_MODE_OBJECT_PLANE, of_plane, &plane->rotations);
}

static void connector_name(const drmModeConnector *connector, char *out, size_t size)
{
	const char *type = drmModeGetConnectorTypeName(connector->connector_type);
	snprintf(out, size, "%s-%u", type ? type : "Unknown", connector->connector_type_id);
}

/* The connector by name, else the first that is connected, else the first. */
static uint32_t find_connector(const struct kms *kms, const drmModeRes *resources)
{
	const char *wanted = kms->config->connector;
	uint32_t first = 0, connected = 0;
	for (int i = 0; i < resources->count_connectors; i++) {
		drmModeConnectorPtr connector = kms->drm->connector(kms->fd, resources->connectors[i]);
		if (!connector)
			continue;
		char name[32];
		connector_name(connector, name, sizeof(name));
		bool fits = wanted ? !strcmp(name, wanted) : connector->connector_type != DRM_MODE_CONNECTOR_WRITEBACK;
		if (fits && !first)
			first = connector->connector_id;
		if (fits && !connected && connector->connection == DRM_MODE_CONNECTED)
			connected = connector->connector_id;
		kms->drm->free_connector(connector);
	}
	return connected ? connected : first;
}

/* The CRTC that the connector has now, which shows whatever was there before us; 0 none. */
static uint32_t present_crtc(const struct kms *kms, const drmModeConnector *connector)
{
	drmModeEncoderPtr encoder = connector->encoder_id ? kms->drm->encoder(kms->fd, connector->encoder_id) : NULL;
	uint32_t crtc = encoder ? encoder->crtc_id : 0;
	if (encoder)
		kms->drm->free_encoder(encoder);
	return crtc;
}

static uint32_t possible_crtcs(const struct kms *kms, const drmModeConnector *connector)
{
	uint32_t possible = 0;
	for (int i = 0; i < connector->count_encoders; i++) {
		drmModeEncoderPtr encoder = kms->drm->encoder(kms->fd, connector->encoders[i]);
		if (!encoder)
			continue;
		possible |= encoder->possible_crtcs;
		kms->drm->free_encoder(encoder);
	}
	return possible;
}

static int find_crtc(
	const struct kms *kms, const drmModeRes *resources, const drmModeConnector *connector, struct kms_output *out)
{
	uint32_t present = present_crtc(kms, connector), possible = possible_crtcs(kms, connector);
	out->crtc_index = -1;
	for (int i = 0; i < resources->count_crtcs && i < 32; i++) {
		bool mine = resources->crtcs[i] == present;
		if (!mine && (out->crtc_index >= 0 || !(possible >> i & 1)))
			continue;
		out->crtc = resources->crtcs[i];
		out->crtc_index = i;
	}
	return out->crtc_index < 0 ? -ENODEV : 0;
}

static bool plane_is_primary(const struct kms *kms, uint32_t plane)
{
	uint32_t id = 0;
	uint64_t type = 0;
	const struct named_property wanted[] = { { "type", &id, &type }, { 0 } };
	read_properties(kms, plane, DRM_MODE_OBJECT_PLANE, wanted, NULL);
	return id && type == DRM_PLANE_TYPE_PRIMARY;
}

static uint32_t find_plane(const struct kms *kms, int crtc_index)
{
	drmModePlaneResPtr planes = kms->drm->planes(kms->fd);
	uint32_t found = 0;
	for (uint32_t i = 0; planes && i < planes->count_planes && !found; i++) {
		drmModePlanePtr plane = kms->drm->plane(kms->fd, planes->planes[i]);
		if (!plane)
			continue;
		if (plane->possible_crtcs >> crtc_index & 1 && plane_is_primary(kms, plane->plane_id))
			found = plane->plane_id;
		kms->drm->free_plane(plane);
	}
	if (planes)
		kms->drm->free_planes(planes);
	return found;
}

static void choose_mode(const struct kms *kms, const drmModeConnector *connector, struct kms_output *out)
{
	drmModeCrtcPtr crtc = kms->drm->crtc(kms->fd, out->crtc);
	bool lit = crtc && crtc->mode_valid && crtc->buffer_id && present_crtc(kms, connector) == out->crtc;
	uint8_t order[KMS_MODES_MAX];
	out->candidate_count =
		kms_mode_order(connector->modes, connector->count_modes, &kms->wish, lit ? &crtc->mode : NULL, order);
	for (uint32_t i = 0; i < out->candidate_count; i++)
		out->candidates[i] = connector->modes[order[i]];
	out->mode = out->candidate_count ? out->candidates[0] : (drmModeModeInfo){ 0 };
	out->shown_before = lit && out->candidate_count && kms_mode_same(&crtc->mode, &out->mode);
	out->legacy_gamma_size = crtc && crtc->gamma_size > 0 ? (uint32_t)crtc->gamma_size : 0;
	if (crtc)
		kms->drm->free_crtc(crtc);
	const struct kms_mode_wish *wish = &kms->wish;
	if (wish->width && out->candidate_count &&
		(out->mode.hdisplay != wish->width || out->mode.vdisplay != wish->height))
		log_warn("%s: no mode of %ux%u; using %ux%u", out->name, wish->width, wish->height, out->mode.hdisplay,
			out->mode.vdisplay);
}

void kms_output_ask(struct kms *kms, struct kms_output *output)
{
	drmModeConnectorPtr connector = kms->drm->connector(kms->fd, output->connector);
	output->connected = connector && connector->connection == DRM_MODE_CONNECTED && connector->count_modes > 0;
	if (output->connected)
		choose_mode(kms, connector, output);
	if (connector)
		kms->drm->free_connector(connector);
}

static int find_path(struct kms *kms, const drmModeRes *resources, struct kms_output *out)
{
	drmModeConnectorPtr connector = kms->drm->connector(kms->fd, out->connector);
	if (!connector)
		return -ENODEV;
	connector_name(connector, out->name, sizeof(out->name));
	int err = find_crtc(kms, resources, connector, out);
	kms->drm->free_connector(connector);
	if (err)
		return err;
	out->plane = find_plane(kms, out->crtc_index);
	read_all_properties(kms, out);
	kms_output_ask(kms, out);
	return 0;
}

int kms_output_find(struct kms *kms, struct kms_output *out)
{
	*out = (struct kms_output){ 0 };
	drmModeResPtr resources = kms->drm->resources(kms->fd);
	if (!resources)
		return -ENODEV;
	out->connector = find_connector(kms, resources);
	int err = out->connector ? find_path(kms, resources, out) : -ENODEV;
	kms->drm->free_resources(resources);
	return err;
}
