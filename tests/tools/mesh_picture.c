/* Painter's algorithm over patches, then lines. */
#include "tests/tools/mesh_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/impostor/triangle_rows.h"
#include "tools/measure/image.h"

struct canvas {
	struct image image;
	float *disparity;
	int x, y, zoom; /* first pixel of the capture */
};

static void put(struct canvas *canvas, int64_t x, int64_t y, const uint8_t rgb[3])
{
	if (x < 0 || y < 0 || x >= canvas->image.width || y >= canvas->image.height)
		return;
	memcpy(canvas->image.rgb + 3 * ((size_t)y * canvas->image.width + (size_t)x), rgb, 3);
}

static void fill(struct canvas *canvas, const struct impostor_mesh *mesh, const struct mesh_patch *patch,
	const struct mesh_vertex *corner[3], const uint8_t rgb[3])
{
	double x[3], y[3];
	for (int i = 0; i < 3; i++) {
		x[i] = ((double)corner[i]->x - canvas->x) * canvas->zoom;
		y[i] = ((double)corner[i]->y - canvas->y) * canvas->zoom;
	}
	float mean = (corner[0]->disparity + corner[1]->disparity + corner[2]->disparity) / 3;
	struct pixel_run rows = triangle_rows(y, (int32_t)canvas->image.height);
	for (int32_t row = rows.from; row < rows.to; row++) {
		struct pixel_run run = triangle_run(x, y, row, (int32_t)canvas->image.width);
		for (int32_t column = run.from; column < run.to; column++) {
			uint32_t px = (uint32_t)(column / canvas->zoom + canvas->x),
					 py = (uint32_t)(row / canvas->zoom + canvas->y);
			uint8_t texel =
				mesh->texels.items[patch->first_texel + (py - patch->min_y) * (patch->max_x - patch->min_x + 1u) + px -
								   patch->min_x];
			float *depth = &canvas->disparity[(size_t)row * canvas->image.width + (size_t)column];
			if (texel == MESH_CUT || mean < *depth)
				continue;
			*depth = mean;
			uint8_t dark[3] = { rgb[0] / 2, rgb[1] / 2, rgb[2] / 2 };
			put(canvas, column, row, texel == MESH_FILL ? dark : rgb);
		}
	}
}

static void line(struct canvas *canvas, const struct mesh_vertex *a, const struct mesh_vertex *b)
{
	static const uint8_t black[3] = { 0, 0, 0 };
	double dx = (double)(b->x - a->x) * canvas->zoom, dy = (double)(b->y - a->y) * canvas->zoom;
	int steps = (int)ceil(fmax(fabs(dx), fabs(dy))) + 1;
	for (int i = 0; i <= steps; i++)
		put(canvas, lround(((double)a->x - canvas->x) * canvas->zoom + dx * i / steps - 0.5),
			lround(((double)a->y - canvas->y) * canvas->zoom + dy * i / steps - 0.5), black);
}

void mesh_picture(const char *path, const struct impostor_mesh *mesh, const struct capture_image *image, int zoom)
{
	int min_x = (int)image->view.width, min_y = (int)image->view.height, max_x = 0, max_y = 0;
	for (size_t i = 0; i < mesh->patches.count; i++) {
		const struct mesh_patch *patch = &mesh->patches.items[i];
		min_x = patch->min_x < min_x ? patch->min_x : min_x;
		min_y = patch->min_y < min_y ? patch->min_y : min_y;
		max_x = patch->max_x > max_x ? patch->max_x : max_x;
		max_y = patch->max_y > max_y ? patch->max_y : max_y;
	}
	if (max_x < min_x)
		return;
	struct canvas canvas = { .x = min_x, .y = min_y, .zoom = zoom };
	canvas.image.width = (uint32_t)((max_x - min_x + 1) * zoom);
	canvas.image.height = (uint32_t)((max_y - min_y + 1) * zoom);
	size_t count = (size_t)canvas.image.width * canvas.image.height;
	canvas.image.rgb = malloc(count * 3);
	canvas.disparity = calloc(count, sizeof(float));
	for (size_t i = 0; i < count; i++) {
		size_t row = i / canvas.image.width / (size_t)zoom + (size_t)min_y;
		size_t pixel = row * image->view.width + i % canvas.image.width / (size_t)zoom + (size_t)min_x;
		memset(canvas.image.rgb + 3 * i, image->pixels[pixel].object ? 120 : 235, 3);
	}
	for (int wires = 0; wires < 2; wires++) {
		for (size_t i = 0; i < mesh->patches.count; i++) {
			const struct mesh_patch *patch = &mesh->patches.items[i];
			uint64_t hash = hash_u64(i + 1);
			uint8_t rgb[3] = { (uint8_t)(110 + hash % 146), (uint8_t)(110 + (hash >> 8) % 146),
				(uint8_t)(110 + (hash >> 16) % 146) };
			for (uint32_t k = 0; k < patch->index_count; k += 3) {
				const struct mesh_vertex *corner[3];
				for (uint32_t c = 0; c < 3; c++)
					corner[c] =
						&mesh->vertices.items[patch->first_vertex + mesh->indices.items[patch->first_index + k + c]];
				if (!wires)
					fill(&canvas, mesh, patch, corner, rgb);
				for (int c = 0; wires && c < 3; c++)
					line(&canvas, corner[c], corner[(c + 1) % 3]);
			}
		}
	}
	image_write_png(&canvas.image, path);
	free(canvas.image.rgb);
	free(canvas.disparity);
}
