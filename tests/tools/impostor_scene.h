/* A city of a few rectangles for tests of the impostor's steps: captures by casting rays, and a picture of an impostor
 * by a rasteriser that is slow and plain. */
#ifndef BLVD_TESTS_TOOLS_IMPOSTOR_SCENE_H
#define BLVD_TESTS_TOOLS_IMPOSTOR_SCENE_H

#include "tools/impostor/impostor.h"

#define SCENE_QUADS 16

struct scene_quad {
	struct dvec3 corner, along, up; /* corner + s along + t up, s and t in 0 to 1 */
	uint8_t rgb[3];
	double pattern_m; /* 0: plain; else a soft pattern of this wavelength */
	uint8_t kind;
};
struct scene {
	struct scene_quad quads[SCENE_QUADS]; /* object is the index; normal is along x up */
	uint32_t count;
};

/* Looks from `eye` along `heading_rad` (0: +x), level; 90 degrees across. */
struct capture_view scene_view(struct dvec3 eye, double heading_rad, uint32_t width, uint32_t height);
void scene_capture(const struct scene *scene, const struct capture_view *view, struct capture_image *out);
/* The quad seen along the way from `eye` to `point`, or UINT32_MAX. */
uint32_t scene_first_hit(const struct scene *scene, struct dvec3 eye, struct dvec3 point);

/* Two triangles for each quad with an owned pixel; hidden parts of it are to be filled. */
void scene_mesh(const struct scene *scene, const struct impostor_capture *capture, const uint8_t *owner, uint8_t view,
	struct impostor_mesh *mesh);

/* Bilinear, projective, by nearest depth. RGBA, 0 where nothing is drawn. `pages` as in struct impostor. */
void scene_draw_impostor(
	const struct impostor *impostor, const uint8_t *pages, const struct capture_view *view, uint8_t *rgba);

#endif
