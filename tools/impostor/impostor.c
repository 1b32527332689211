/* The steps in their order. */
#include <errno.h>

#include "tools/impostor/impostor.h"

/* Pixels at the border of what is owned, or of an object: where triangles go. */
static size_t outline_of(const struct capture_image *image, const uint8_t *owner)
{
	uint32_t width = image->view.width, height = image->view.height;
	size_t sum = 0;
	for (uint32_t y = 0, i = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++, i++) {
			if (!owner[i])
				continue;
			bool goes_right = x + 1 < width && owner[i + 1] && image->pixels[i + 1].object == image->pixels[i].object;
			bool goes_down =
				y + 1 < height && owner[i + width] && image->pixels[i + width].object == image->pixels[i].object;
			sum += goes_right && goes_down ? 0 : 1;
		}
	}
	return sum;
}

/* The triangles that are left are shared by outline; what a capture does not need the next ones get. */
static void make_mesh(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor_mesh *mesh)
{
	struct pool pool = { 0 };
	uint8_t **owners = POOL_ARRAY(&pool, uint8_t *, count);
	size_t *outlines = POOL_ARRAY(&pool, size_t, count), outline = 0;
	for (size_t i = 0; i < count; i++) {
		const struct capture_image *image = &captures[i].image;
		owners[i] = POOL_ARRAY(&pool, uint8_t, (size_t)image->view.width * image->view.height);
		impostor_fuse(cell, captures, i, options, owners[i]);
		outlines[i] = outline_of(image, owners[i]);
		outline += outlines[i];
	}
	for (size_t i = 0; i < count; outline -= outlines[i++]) {
		struct impostor_options share = *options;
		size_t used = mesh->indices.count / 3;
		if (!outlines[i])
			continue;
		if (options->triangles_max) {
			size_t left = options->triangles_max > used ? options->triangles_max - used : 0;
			share.triangles_max = (uint32_t)(used + left * outlines[i] / outline);
		}
		impostor_mesh_add(mesh, cell, &captures[i], owners[i], (uint8_t)i, &share);
	}
	pool_finish(&pool);
}

int impostor_build(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out)
{
	if (count > PKG_IMPOSTOR_VIEWS_MAX) {
		*out = (struct impostor){ 0 };
		return -E2BIG;
	}
	struct impostor_mesh mesh = { 0 };
	make_mesh(cell, captures, count, options, &mesh);
	int result = impostor_atlas(&mesh, cell, captures, count, options, out);
	impostor_mesh_finish(&mesh);
	return result;
}
