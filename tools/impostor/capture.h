/*
 * Renders sets of triangles from poses through our own GL, on a surfaceless context: unlit colour, disparity and what
 * is seen, a pixel each. One capturer belongs to one thread; there may be several. Each call makes the
 * capturer's context current and leaves it so.
 *
 * What a pixel is (object, triangle, normal, disparity) is that of its centre, exactly: disparity is worked out from
 * the triangle's corners in double, for the eye as given. Its colour is a mean over the pixel, of samples that show the
 * same object; it says nothing of what else the pixel holds.
 *
 * Colour is what light is multiplied with, in encoded colour as city.vert and city.frag do it. Let c be the colour and
 * a alpha, E the encoded light_on() the surface with an open sky (c has the ambient occlusion; that it dims the sun a
 * little more is lost), m the share that glass mirrors from here (mirroring()), M what it mirrors (mirrored()), and
 * (h, w) the air() between, all of prelude.glsl. Then a frame shows
 *     (c E + a m M) w + h
 * and a times the light of rooms on walls and shops. Everything else has an alpha too, for its gloss. Ground has the
 * light map's open sky in c; water is the body of it, without waves. Lamps' light is in none of them.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CAPTURE_H
#define BLVD_TOOLS_IMPOSTOR_CAPTURE_H

#include "assets/pkg.h"
#include "platform/base/vec.h"
#include "tools/impostor/triangle_set.h"

/* A pinhole camera that may look past its axis. Pixel (x, y) has its centre at (x + 0.5, y + 0.5), y down; its ray is
 * forward + right (px - centre_x) / focal_px + up (centre_y - py) / focal_px. Depth z is along `forward`. */
struct capture_view {
	struct dvec3 eye;                /* city frame, m */
	struct dvec3 right, up, forward; /* unit, right-handed: right x up = -forward */
	double focal_px;
	double centre_x, centre_y;
	uint32_t width, height;
	double near_m, far_m;
};

/* Position in pixels and depth of a point; false behind the eye. */
bool capture_project(const struct capture_view *view, struct dvec3 point, double *x, double *y, double *z);
/* The same view of a part of its pixels. */
struct capture_rect {
	uint32_t x, y, width, height;
};
struct capture_view capture_cut(const struct capture_view *view, const struct capture_rect *rect);
/* The pixels that the set's triangles can touch, in front of the near plane; false when there are none. For
 * capture_cut(): what a view costs goes by its pixels. */
bool capture_bounds(
	const struct pkg *pkg, const struct triangle_set *set, const struct capture_view *view, struct capture_rect *out);
/* The point seen at a pixel position, at disparity 1 / z. */
struct dvec3 capture_point(const struct capture_view *view, double x, double y, double disparity);

struct capture_pixel {
	uint32_t object;      /* + 1; 0: nothing, the rest is 0 then */
	float disparity;      /* 1 / z; linear, from the geometry and not from window depth */
	int8_t normal_oct[2]; /* the triangle's shading normal */
	uint8_t kind;         /* enum pkg_material_kind */
	uint8_t seed;
	uint32_t triangle; /* of the object: the bit's index, or PKG_NONE where it is not known */
};
static_assert(sizeof(struct capture_pixel) == 16, "as the GPU writes it");

/* Rows from the top. Owned. */
struct capture_image {
	struct capture_view view;
	uint8_t *rgba; /* NULL, or sRGB albedo x tint x ambient occlusion; alpha: share that mirrors. See above */
	struct capture_pixel *pixels;
};
void capture_image_finish(struct capture_image *image);

struct capturer;
/* Loads the package's geometry and textures. Returns 0, or -errno after logging one line. */
int capturer_open(struct capturer **out, const struct pkg *pkg);
void capturer_close(struct capturer *capturer);

/* What is to be drawn by following calls. `set` is not needed afterwards. Damaged chunks are left out. */
void capturer_use(struct capturer *capturer, const struct triangle_set *set);
/* Draws what is in use. `color` false leaves out->rgba NULL. Reuses what `out` has when the size fits. Decals are drawn
 * too. The depth buffer has 24 bits: choose the near plane no nearer than needed. Returns 0, -EINVAL (no pixels),
 * -E2BIG (twice the view's size, or the set, is more than GL can hold) or -ENOMEM; logs one line on failure. */
int capturer_draw(struct capturer *capturer, const struct capture_view *view, bool color, struct capture_image *out);

#endif
