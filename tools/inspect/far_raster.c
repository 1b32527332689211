/* Triangle by triangle, pixel by pixel: shares of the corners on the screen over depth are shares in space, and so are
 * the texture coordinates over the depth in the capture's view. Triangles that reach behind the eye are left out. */
#include "tools/inspect/far_raster.h"

#include <math.h>
#include <string.h>

#include "tools/bake/etc2.h"
#include "tools/city/pool.h"

#define NEAREST_M 1.0
#define PAGE_TEXELS ((size_t)PKG_PAGE_PX * PKG_PAGE_PX)

void far_raster_finish(struct far_raster *raster)
{
	array_free(raster->alpha);
	array_free(raster->pixels);
	*raster = (struct far_raster){ 0 };
}

void far_raster_use(
	struct far_raster *raster, const struct impostor_view *impostor, const struct pkg_truth_texel *truth)
{
	static uint8_t texels[PKG_PAGE_PX * PKG_PAGE_PX][4];
	raster->impostor = impostor;
	raster->truth = truth;
	array_free(raster->alpha);
	raster->alpha = array_grow(NULL, &(size_t){ 0 }, impostor->head.page_count * PAGE_TEXELS + 1, 1);
	for (uint32_t page = 0; page < impostor->head.page_count; page++) {
		etc2_decode(texels, impostor->pages + (size_t)page * PKG_PAGE_BYTES, PKG_PAGE_PX, PKG_PAGE_PX);
		for (size_t i = 0; i < PAGE_TEXELS; i++)
			raster->alpha[page * PAGE_TEXELS + i] = texels[i][3];
	}
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

void far_raster_view(const struct far_raster *raster, struct dvec3 point, double out[3])
{
	struct dvec3 d = { point.x - raster->eye.x, point.y - raster->eye.y, point.z - raster->eye.z };
	out[0] = dot(d, raster->right);
	out[1] = dot(d, raster->up);
	out[2] = dot(d, raster->forward);
}

struct corner {
	struct dvec3 at;
	double x, y, depth; /* on the screen, y down */
	double u, v, capture_depth;
};

static bool load_corner(const struct far_raster *raster, uint32_t index, struct corner *out)
{
	const struct pkg_impostor_vertex *vertex = &raster->impostor->vertices[raster->impostor->indices[index]];
	const float *axis = raster->impostor->views[vertex->view_kind % PKG_IMPOSTOR_VIEWS_MAX].axis;
	double view[3];
	out->at = (struct dvec3){ vertex->pos_mm[0] * 1e-3, vertex->pos_mm[1] * 1e-3, vertex->pos_mm[2] * 1e-3 };
	far_raster_view(raster, out->at, view);
	out->depth = view[2];
	if (!(view[2] > NEAREST_M))
		return false;
	out->x = RASTER_WIDTH * 0.5 + RASTER_FOCAL_PX * view[0] / view[2];
	out->y = RASTER_HEIGHT * 0.5 - RASTER_FOCAL_PX * view[1] / view[2];
	out->u = vertex->uv[0] / 128.0;
	out->v = vertex->uv[1] / 128.0;
	out->capture_depth = axis[0] * out->at.x + axis[1] * out->at.y + axis[2] * out->at.z + axis[3];
	return true;
}

/* Where a texture coordinate is drawn: shares of the corners on the page, over the depth in the capture's view, are
 * shares in space. */
static struct dvec3 place_of(const struct corner corner[3], double u, double v)
{
	struct dvec3 place = { 0 };
	double sum = 0.0;
	for (int k = 0; k < 3; k++) {
		const struct corner *a = &corner[(k + 1) % 3], *b = &corner[(k + 2) % 3];
		double share = ((a->u - u) * (b->v - v) - (b->u - u) * (a->v - v)) / corner[k].capture_depth;
		place.x += share * corner[k].at.x;
		place.y += share * corner[k].at.y;
		place.z += share * corner[k].at.z;
		sum += share;
	}
	return (struct dvec3){ place.x / sum, place.y / sum, place.z / sum };
}

/* Finds the texel at shares of the corners in space. False: cut away. */
static bool find_texel(const struct far_raster *raster, const struct corner corner[3], uint32_t page,
	const double share[3], struct raster_pixel *out)
{
	double u = 0.0, v = 0.0, z = 0.0;
	for (int k = 0; k < 3; k++) {
		u += share[k] * corner[k].u * corner[k].capture_depth;
		v += share[k] * corner[k].v * corner[k].capture_depth;
		z += share[k] * corner[k].capture_depth;
	}
	u = floor(u / z);
	v = floor(v / z);
	if (!(u >= 0.0 && v >= 0.0 && u < PKG_PAGE_PX && v < PKG_PAGE_PX))
		return false;
	size_t i = page * PAGE_TEXELS + (size_t)v * PKG_PAGE_PX + (size_t)u;
	if (raster->alpha[i] < PKG_PAGE_CUT)
		return false;
	out->truth = &raster->truth[i];
	out->at = place_of(corner, u + 0.5, v + 0.5);
	out->corner = place_of(corner, u + 1.0, v + 1.0);
	return true;
}

static void draw_pixel(
	struct far_raster *raster, const struct corner corner[3], uint32_t page, int x, int y, double area)
{
	double share[3], sum = 0.0;
	for (int k = 0; k < 3; k++) {
		const struct corner *a = &corner[(k + 1) % 3], *b = &corner[(k + 2) % 3];
		double part = ((a->x - x - 0.5) * (b->y - y - 0.5) - (b->x - x - 0.5) * (a->y - y - 0.5)) / area;
		if (part < 0.0)
			return;
		share[k] = part / corner[k].depth;
		sum += share[k];
	}
	struct raster_pixel *pixel = &raster->pixels[(size_t)y * RASTER_WIDTH + (size_t)x];
	struct raster_pixel drawn = { .depth = 1.0 / sum };
	if (pixel->truth && pixel->depth <= drawn.depth)
		return;
	for (int k = 0; k < 3; k++)
		share[k] /= sum;
	if (find_texel(raster, corner, page, share, &drawn))
		*pixel = drawn;
}

static void draw_triangle(struct far_raster *raster, uint32_t first)
{
	struct corner c[3];
	for (uint32_t k = 0; k < 3; k++)
		if (!load_corner(raster, first + k, &c[k]))
			return;
	double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
	if (fabs(area) < 1e-9)
		return;
	int left = (int)fmax(fmin(fmin(c[0].x, c[1].x), c[2].x), 0.0);
	int right = (int)fmin(fmax(fmax(c[0].x, c[1].x), c[2].x), RASTER_WIDTH - 1);
	int top = (int)fmax(fmin(fmin(c[0].y, c[1].y), c[2].y), 0.0);
	int bottom = (int)fmin(fmax(fmax(c[0].y, c[1].y), c[2].y), RASTER_HEIGHT - 1);
	uint32_t page = raster->impostor->vertices[raster->impostor->indices[first]].page;
	for (int y = top; y <= bottom; y++)
		for (int x = left; x <= right; x++)
			draw_pixel(raster, c, page, x, y, area);
}

void far_raster_draw(struct far_raster *raster, struct dvec3 eye, double heading_rad)
{
	size_t count = (size_t)RASTER_WIDTH * RASTER_HEIGHT;
	if (!raster->pixels)
		raster->pixels = array_grow(NULL, &(size_t){ 0 }, count, sizeof(*raster->pixels));
	memset(raster->pixels, 0, count * sizeof(*raster->pixels));
	raster->eye = eye;
	raster->forward = (struct dvec3){ sin(heading_rad), cos(heading_rad), 0.0 };
	raster->right = (struct dvec3){ cos(heading_rad), -sin(heading_rad), 0.0 };
	raster->up = (struct dvec3){ 0.0, 0.0, 1.0 };
	for (uint32_t i = 0; i + 2 < raster->impostor->head.index_count; i += 3)
		draw_triangle(raster, i);
}
