#include "impostor_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct dvec3 add(struct dvec3 a, struct dvec3 b, double scale)
{
	return (struct dvec3){ a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct dvec3 cross(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

struct capture_view scene_view(struct dvec3 eye, double heading_rad, uint32_t width, uint32_t height)
{
	double c = cos(heading_rad), s = sin(heading_rad);
	return (struct capture_view){ .eye = eye,
		.right = { s, -c, 0 },
		.up = { 0, 0, 1 },
		.forward = { c, s, 0 },
		.focal_px = width / 2.0,
		.centre_x = width / 2.0,
		.centre_y = height / 2.0,
		.width = width,
		.height = height,
		.near_m = 1,
		.far_m = 5000 };
}

/* Share of the way along `ray` at which the quad is hit, and where in it; or INFINITY. */
static double hit(const struct scene_quad *quad, struct dvec3 eye, struct dvec3 ray, double at[2])
{
	struct dvec3 normal = cross(quad->along, quad->up);
	double speed = dot(normal, ray);
	if (fabs(speed) < 1e-12)
		return INFINITY;
	double t = dot(normal, add(quad->corner, eye, -1)) / speed;
	struct dvec3 in = add(add(eye, ray, t), quad->corner, -1);
	at[0] = dot(in, quad->along) / dot(quad->along, quad->along);
	at[1] = dot(in, quad->up) / dot(quad->up, quad->up);
	return t > 1e-6 && at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1 ? t : INFINITY;
}

static uint32_t nearest(const struct scene *scene, struct dvec3 eye, struct dvec3 ray, double *t, double at[2])
{
	uint32_t found = UINT32_MAX;
	*t = INFINITY;
	for (uint32_t i = 0; i < scene->count; i++) {
		double here[2], share = hit(&scene->quads[i], eye, ray, here);
		if (share >= *t)
			continue;
		*t = share;
		found = i;
		memcpy(at, here, sizeof(here));
	}
	return found;
}

uint32_t scene_first_hit(const struct scene *scene, struct dvec3 eye, struct dvec3 point)
{
	double t, at[2];
	return nearest(scene, eye, add(point, eye, -1), &t, at);
}

static void encode_normal(const struct scene_quad *quad, int8_t oct[2])
{
	struct dvec3 n = cross(quad->along, quad->up);
	double sum = fabs(n.x) + fabs(n.y) + fabs(n.z), x = n.x / sum, y = n.y / sum;
	if (n.z < 0) {
		double folded = copysign(1 - fabs(y), x);
		y = copysign(1 - fabs(x), y);
		x = folded;
	}
	oct[0] = (int8_t)lround(x * 127);
	oct[1] = (int8_t)lround(y * 127);
}

static void paint(const struct scene_quad *quad, const double at[2], uint8_t rgba[4])
{
	double wave = 0;
	if (quad->pattern_m > 0)
		wave = sin(2 * BLVD_PI * at[0] * sqrt(dot(quad->along, quad->along)) / quad->pattern_m) *
			   sin(2 * BLVD_PI * at[1] * sqrt(dot(quad->up, quad->up)) / quad->pattern_m);
	for (int k = 0; k < 3; k++)
		rgba[k] = (uint8_t)lround(fmin(fmax(quad->rgb[k] + 40 * wave, 0), 255));
	rgba[3] = (uint8_t)lround(60 + 60 * wave);
}

void scene_capture(const struct scene *scene, const struct capture_view *view, struct capture_image *out)
{
	size_t count = (size_t)view->width * view->height;
	*out = (struct capture_image){ *view, calloc(count, 4), calloc(count, sizeof(struct capture_pixel)) };
	for (uint32_t y = 0, i = 0; y < view->height; y++) {
		for (uint32_t x = 0; x < view->width; x++, i++) {
			double t, at[2];
			struct dvec3 ray = add(capture_point(view, x + 0.5, y + 0.5, 1), view->eye, -1);
			uint32_t found = nearest(scene, view->eye, ray, &t, at);
			if (found == UINT32_MAX)
				continue;
			const struct scene_quad *quad = &scene->quads[found];
			out->pixels[i] = (struct capture_pixel){
				.object = found + 1, .disparity = (float)(1 / t), .kind = quad->kind, .triangle = PKG_NONE
			};
			encode_normal(quad, out->pixels[i].normal_oct);
			paint(quad, at, out->rgba + 4 * (size_t)i);
		}
	}
}

static void add_texels(
	struct impostor_mesh *mesh, struct mesh_patch *patch, const struct capture_image *image, uint32_t object)
{
	patch->first_texel = (uint32_t)mesh->texels.count;
	for (uint32_t y = patch->min_y; y <= patch->max_y; y++) {
		for (uint32_t x = patch->min_x; x <= patch->max_x; x++) {
			bool is_shown = image->pixels[(size_t)y * image->view.width + x].object == object;
			ARRAY_PUSH(&mesh->texels, is_shown ? MESH_SHOW : MESH_FILL);
		}
	}
}

static void add_patch(const struct scene_quad *quad, const struct capture_image *image, uint8_t view, uint32_t object,
	struct impostor_mesh *mesh)
{
	static const uint32_t two[6] = { 0, 1, 2, 0, 2, 3 };
	struct mesh_patch patch = { .first_vertex = (uint32_t)mesh->vertices.count,
		.vertex_count = 4,
		.first_index = (uint32_t)mesh->indices.count,
		.index_count = 6,
		.kind = quad->kind,
		.view = view };
	double low[2] = { INFINITY, INFINITY }, high[2] = { 0, 0 };
	encode_normal(quad, patch.normal_oct);
	for (int i = 0; i < 4; i++) {
		struct dvec3 point = add(add(quad->corner, quad->along, i == 1 || i == 2), quad->up, i >= 2);
		double x, y, z;
		if (!capture_project(&image->view, point, &x, &y, &z))
			abort();
		low[0] = fmin(low[0], x);
		low[1] = fmin(low[1], y);
		high[0] = fmax(high[0], x);
		high[1] = fmax(high[1], y);
		patch.disparity_max = fmaxf(patch.disparity_max, (float)(1 / z));
		ARRAY_PUSH(&mesh->vertices, (struct mesh_vertex){ (float)x, (float)y, (float)(1 / z), { 0, 0 } });
	}
	for (int i = 0; i < 6; i++)
		ARRAY_PUSH(&mesh->indices, two[i]);
	patch.min_x = (uint16_t)fmin(fmax(floor(low[0]), 0), image->view.width - 1);
	patch.min_y = (uint16_t)fmin(fmax(floor(low[1]), 0), image->view.height - 1);
	patch.max_x = (uint16_t)fmin(fmax(ceil(high[0]), 0), image->view.width - 1);
	patch.max_y = (uint16_t)fmin(fmax(ceil(high[1]), 0), image->view.height - 1);
	add_texels(mesh, &patch, image, object);
	ARRAY_PUSH(&mesh->patches, patch);
}

void scene_mesh(const struct scene *scene, const struct impostor_capture *capture, const uint8_t *owner, uint8_t view,
	struct impostor_mesh *mesh)
{
	size_t count = (size_t)capture->image.view.width * capture->image.view.height;
	for (uint32_t q = 0; q < scene->count; q++) {
		bool any = false;
		for (size_t i = 0; i < count && !any; i++)
			any = owner[i] && capture->image.pixels[i].object == q + 1;
		if (any)
			add_patch(&scene->quads[q], &capture->image, view, q + 1, mesh);
	}
}

static void fetch(const uint8_t *page, double u, double v, double rgba[4])
{
	double x = u - 0.5, y = v - 0.5;
	memset(rgba, 0, 4 * sizeof(*rgba));
	for (int n = 0; n < 4; n++) {
		int column = (int)floor(x) + n % 2, row = (int)floor(y) + n / 2;
		double weight = (1 - fabs(x - column)) * (1 - fabs(y - row));
		column = column < 0 ? 0 : column > 255 ? 255 : column;
		row = row < 0 ? 0 : row > 255 ? 255 : row;
		for (int k = 0; k < 4; k++)
			rgba[k] += weight * page[4 * (row * 256 + column) + k];
	}
}

/* A corner in the picture: position, 1 / depth, and u z, v z, z of the capture. */
struct corner {
	double x, y, inverse, uvz[3];
};

static bool place(const struct impostor *impostor, const struct pkg_impostor_vertex *vertex,
	const struct capture_view *view, struct corner *out)
{
	const float *axis = impostor->views.items[vertex->view_kind % PKG_IMPOSTOR_VIEWS_MAX].axis;
	double z = axis[3], p[3], depth;
	for (int k = 0; k < 3; k++) {
		z += (double)axis[k] * vertex->pos_mm[k] * 1e-3;
		p[k] = (vertex->pos_mm[k] + (double)impostor->origin_mm[k]) * 1e-3;
	}
	if (!capture_project(view, (struct dvec3){ p[0], p[1], p[2] }, &out->x, &out->y, &depth))
		return false;
	out->inverse = 1 / depth;
	out->uvz[0] = vertex->uv[0] / 128.0 * z;
	out->uvz[1] = vertex->uv[1] / 128.0 * z;
	out->uvz[2] = z;
	return true;
}

static void draw_triangle(
	const struct corner c[3], const uint8_t *page, const struct capture_view *view, uint8_t *rgba, double *depths)
{
	double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
	for (uint32_t y = 0, i = 0; y < view->height && area != 0; y++) {
		for (uint32_t x = 0; x < view->width; x++, i++) {
			double px = x + 0.5, py = y + 0.5, share[3], inverse = 0, uvz[3] = { 0 }, colour[4];
			for (int k = 0; k < 3; k++) {
				const struct corner *a = &c[(k + 1) % 3], *b = &c[(k + 2) % 3];
				share[k] = ((a->x - px) * (b->y - py) - (b->x - px) * (a->y - py)) / area;
				inverse += share[k] * c[k].inverse;
				for (int n = 0; n < 3; n++)
					uvz[n] += share[k] * c[k].inverse * c[k].uvz[n];
			}
			if (share[0] < 0 || share[1] < 0 || share[2] < 0 || inverse <= depths[i])
				continue;
			fetch(page, uvz[0] / uvz[2], uvz[1] / uvz[2], colour);
			if (colour[3] < PKG_PAGE_CUT)
				continue;
			depths[i] = inverse;
			for (int k = 0; k < 4; k++)
				rgba[4 * (size_t)i + (size_t)k] = (uint8_t)lround(colour[k]);
		}
	}
}

void scene_draw_impostor(
	const struct impostor *impostor, const uint8_t *pages, const struct capture_view *view, uint8_t *rgba)
{
	size_t count = (size_t)view->width * view->height;
	double *depths = calloc(count, sizeof(*depths));
	memset(rgba, 0, 4 * count);
	for (size_t i = 0; i < impostor->indices.count; i += 3) {
		struct corner c[3];
		bool is_in_front = true;
		for (int k = 0; k < 3; k++)
			is_in_front &=
				place(impostor, &impostor->vertices.items[impostor->indices.items[i + (size_t)k]], view, &c[k]);
		const uint8_t *page =
			pages + (size_t)impostor->vertices.items[impostor->indices.items[i]].page * 4 * PKG_PAGE_PX * PKG_PAGE_PX;
		if (is_in_front)
			draw_triangle(c, page, view, rgba, depths);
	}
	free(depths);
}
