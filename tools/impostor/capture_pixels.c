/*
 * Disparity is worked out here in double and not on the GPU: on a plane 1/z is affine in the image, so it costs two
 * multiplications a pixel and has no error but its rounding to float.
 */
#include "tools/impostor/capture_pixels.h"

#include <math.h>
#include <string.h>

#define PINHOLE_SAME 1e-3f /* of a disparity: planes that agree so well at a pixel are one surface there */

static struct dvec3 cross(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct dvec3 minus(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static void corners_from_eye(const struct pkg *pkg, const struct capture_batch *batch, uint32_t triangle,
	const struct capture_view *view, struct dvec3 out[3])
{
	const struct pkg_object *object = &pkg->objects[batch->triangles.items[triangle].object];
	const int32_t *origin = pkg->chunks[object->chunk].origin_mm;
	for (int i = 0; i < 3; i++) {
		const int32_t *at = batch->vertices.items[(size_t)triangle * 3 + (size_t)i].pos_mm;
		out[i].x = (double)((int64_t)origin[0] + at[0]) * 1e-3 - view->eye.x;
		out[i].y = (double)((int64_t)origin[1] + at[1]) * 1e-3 - view->eye.y;
		out[i].z = (double)((int64_t)origin[2] + at[2]) * 1e-3 - view->eye.z;
	}
}

/* A point on the ray r of a pixel is on the plane n p = d where p = r d / (n r): disparity is n r / d. Rasterisation
 * snaps corners to a fraction of a pixel, which on a plane seen from its edge is a leap in disparity: the corners'
 * own are the limits. */
static void find_plane(const struct dvec3 corner[3], const struct capture_view *view, struct capture_plane *out)
{
	double nearest = 1.0 / view->far_m, farthest = 1.0 / view->near_m;
	double high = nearest, low = farthest;
	for (int i = 0; i < 3; i++) {
		double z = dot(corner[i], view->forward);
		double disparity = z > view->near_m ? 1.0 / z : farthest;
		high = disparity > high ? disparity : high;
		low = disparity < low ? disparity : low;
	}
	struct dvec3 normal = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
	double distance = dot(normal, corner[0]);
	double along = dot(normal, view->forward), right = dot(normal, view->right), up = dot(normal, view->up);
	out->low = (float)low;
	out->high = (float)high;
	out->per_x = right / (view->focal_px * distance);
	out->per_y = -up / (view->focal_px * distance);
	out->at_origin = along / distance - view->centre_x * out->per_x - view->centre_y * out->per_y;
	if (!isfinite(out->at_origin))
		*out = (struct capture_plane){ .at_origin = high, .low = out->low, .high = out->high };
}

static const struct capture_plane *plane_of(struct capture_planes *planes, const struct pkg *pkg,
	const struct capture_batch *batch, uint32_t triangle, const struct capture_view *view)
{
	struct capture_plane *plane = &planes->items.items[triangle];
	if (plane->drawing == planes->drawing)
		return plane;
	struct dvec3 corner[3];
	corners_from_eye(pkg, batch, triangle, view, corner);
	find_plane(corner, view, plane);
	plane->drawing = planes->drawing;
	return plane;
}

static void start_drawing(struct capture_planes *planes, size_t triangles)
{
	size_t had = planes->items.count;
	ARRAY_RESERVE(&planes->items, triangles + 1);
	if (triangles > had) {
		memset(planes->items.items + had, 0, (triangles - had) * sizeof(*planes->items.items));
		planes->items.count = triangles;
	}
	if (!++planes->drawing) {
		memset(planes->items.items, 0, planes->items.count * sizeof(*planes->items.items));
		planes->drawing = 1;
	}
}

static void fill_pixel(struct capture_pixel *out, const struct capture_triangle *triangle,
	const struct capture_plane *plane, double x, double y)
{
	float disparity = (float)(plane->at_origin + plane->per_x * x + plane->per_y * y);
	disparity = disparity < plane->low ? plane->low : disparity;
	*out = (struct capture_pixel){
		.object = triangle->object + 1,
		.disparity = disparity > plane->high ? plane->high : disparity,
		.normal_oct = { triangle->normal_oct[0], triangle->normal_oct[1] },
		.kind = triangle->kind,
		.seed = triangle->seed,
		.triangle = triangle->bit,
	};
}

struct pinholes {
	const struct pkg *pkg;
	const struct capture_batch *batch;
	struct capture_planes *planes;
	const struct capture_view *view;
};

static uint8_t kind_of(const struct pinholes *in, uint32_t seen)
{
	return in->batch->triangles.items[seen - 1].kind;
}

static float disparity_on(const struct capture_plane *plane, uint32_t x, uint32_t y)
{
	return (float)(plane->at_origin + plane->per_x * (x + 0.5) + plane->per_y * (y + 0.5));
}

static bool same_kind(const struct pinholes *in, uint32_t a, uint32_t b)
{
	return a && b ? kind_of(in, a) == kind_of(in, b) : a == b;
}

/* What is seen beside a pinhole: one pixel on, or two where it is two pixels long. */
static uint32_t beside(const struct pinholes *in, const uint32_t *at, ptrdiff_t step)
{
	return same_kind(in, at[step], *at) ? at[2 * step] : at[step];
}

/* What a pixel should show where all around it is one sheet of water and it shows something else, no nearer; or 0. */
static uint32_t behind_pinhole(const struct pinholes *in, const uint32_t *seen, uint32_t x, uint32_t y)
{
	const ptrdiff_t width = in->view->width;
	const uint32_t *at = seen + (ptrdiff_t)y * width + x;
	const uint32_t around[4] = { beside(in, at, -1), beside(in, at, 1), beside(in, at, -width), beside(in, at, width) };
	float low = INFINITY, high = 0, slope = 0;
	if (*at && kind_of(in, *at) == PKG_MATERIAL_WATER)
		return 0;
	for (int i = 0; i < 4; i++) {
		if (!around[i] || kind_of(in, around[i]) != PKG_MATERIAL_WATER)
			return 0;
		const struct capture_plane *plane = plane_of(in->planes, in->pkg, in->batch, around[i] - 1, in->view);
		low = fminf(low, disparity_on(plane, x, y));
		high = fmaxf(high, disparity_on(plane, x, y));
		slope = (float)(fabs(plane->per_x) + fabs(plane->per_y));
	}
	if (low < high * (1 - PINHOLE_SAME))
		return 0;
	/* what stands on the edge itself is as near as the surface a pixel on */
	float own = *at ? disparity_on(plane_of(in->planes, in->pkg, in->batch, *at - 1, in->view), x, y) : 0;
	return own <= high + slope ? around[0] : 0;
}

/* Where sheets of open water share an edge but not its vertices, a pixel here and there falls between them. An impostor
 * would make a spot of three pixels of what shows through. */
static void close_pinholes(const struct pinholes *in, uint32_t *seen, uint8_t *rgba)
{
	const uint32_t width = in->view->width;
	for (uint32_t y = 2; y + 2 < in->view->height; y++) {
		for (uint32_t x = 2; x + 2 < width; x++) {
			size_t at = (size_t)y * width + x;
			uint32_t shown = seen[at] == seen[at - 1] ? 0 : behind_pinhole(in, seen, x, y);
			if (!shown)
				continue;
			seen[at] = shown;
			if (rgba)
				memcpy(rgba + 4 * at, rgba + 4 * (at - 1), 4);
		}
	}
}

void capture_pixels_fill(const struct pkg *pkg, const struct capture_batch *batch, struct capture_planes *planes,
	uint32_t *seen, uint8_t *rgba, struct capture_image *out)
{
	const struct capture_view *view = &out->view;
	start_drawing(planes, batch->triangles.count);
	close_pinholes(&(struct pinholes){ pkg, batch, planes, view }, seen, rgba);
	for (uint32_t y = 0; y < view->height; y++) {
		const uint32_t *from = seen + (size_t)y * view->width;
		struct capture_pixel *to = out->pixels + (size_t)y * view->width;
		for (uint32_t x = 0; x < view->width; x++) {
			if (!from[x]) {
				to[x] = (struct capture_pixel){ 0 };
				continue;
			}
			uint32_t triangle = from[x] - 1;
			fill_pixel(&to[x], &batch->triangles.items[triangle], plane_of(planes, pkg, batch, triangle, view),
				(double)x + 0.5, (double)y + 0.5);
		}
	}
}

static bool on_ground(const struct capture_triangle *triangle)
{
	return triangle->kind == PKG_MATERIAL_GROUND || triangle->kind == PKG_MATERIAL_MARKING;
}

/* Markings are objects of their own, but one with the ground that they lie on. */
static bool alike(const struct capture_batch *batch, uint32_t a, uint32_t b)
{
	if (a == b || !a || !b)
		return a == b;
	const struct capture_triangle *s = &batch->triangles.items[a - 1], *t = &batch->triangles.items[b - 1];
	if (on_ground(s) && on_ground(t))
		return s->object == t->object || s->decal || t->decal;
	return s->object == t->object && s->kind == t->kind;
}

/* Nothing when there are no samples. */
static void mean_color(const uint8_t *const samples[], unsigned count, int components, uint8_t *out)
{
	for (int c = 0; c < components && count; c++) {
		unsigned sum = count / 2;
		for (unsigned i = 0; i < count; i++)
			sum += samples[i][c];
		out[c] = (uint8_t)(sum / count);
	}
}

static bool is_decal(const struct capture_batch *batch, uint32_t seen)
{
	return batch->triangles.items[seen - 1].decal;
}

void capture_pixels_color(const struct capture_batch *batch, const uint32_t *seen, const uint8_t *rgba,
	const uint32_t *fine_seen, const uint8_t *fine_rgba, struct capture_image *out)
{
	size_t width = out->view.width, height = out->view.height;
	for (size_t at = 0; at < width * height; at++) {
		size_t fine = at / width * width * 4 + at % width * 2;
		const size_t around[4] = { fine, fine + 1, fine + width * 2, fine + width * 2 + 1 };
		const uint8_t *samples[5] = { rgba + at * 4 }, *shares[5] = { rgba + at * 4 + 3 };
		memset(out->rgba + at * 4, 0, 4);
		if (!seen[at])
			continue;
		/* decals leave their wear in alpha */
		unsigned count = 1, share_count = !is_decal(batch, seen[at]);
		for (int i = 0; i < 4; i++) {
			if (!alike(batch, seen[at], fine_seen[around[i]]))
				continue;
			samples[count++] = fine_rgba + around[i] * 4;
			if (share_count && !is_decal(batch, fine_seen[around[i]]))
				shares[share_count++] = fine_rgba + around[i] * 4 + 3;
		}
		mean_color(samples, count, 3, out->rgba + at * 4);
		mean_color(shares, share_count, 1, out->rgba + at * 4 + 3);
	}
}
