#include "tools/inspect/far_pictures.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "assets/cells.h"
#include "assets/impostor_fold.h"
#include "platform/base/log.h"
#include "tools/bake/etc2.h"
#include "tools/city/pool.h"
#include "tools/impostor/cell_views.h"
#include "tools/inspect/far_table.h"
#include "tools/measure/image.h"

#define WIRE_WIDTH 1920
#define WIRE_FOCAL_PX 869.0
#define PAGES_ACROSS 4
#define READER_BYTES ((size_t)256 << 10)

static struct image image_new(struct pool *pool, uint32_t width, uint32_t height)
{
	return (struct image){ .width = width, .height = height, .rgb = POOL_ARRAY(pool, uint8_t, 3 * width * height) };
}

static int write_picture(const struct image *image, const char *folder, const char *name, uint32_t stretch)
{
	char path[PATH_MAX];
	if (snprintf(path, sizeof(path), "%s/%s-%u.png", folder, name, stretch) >= (int)sizeof(path))
		return -ENAMETOOLONG;
	return image_write_png(image, path);
}

/* What is cut away is magenta. */
static void draw_page(struct image *image, const uint8_t *blocks, uint32_t x0, uint32_t y0)
{
	static uint8_t texels[PKG_PAGE_PX * PKG_PAGE_PX][4];
	static const uint8_t magenta[3] = { 255, 0, 255 };
	etc2_decode(texels, blocks, PKG_PAGE_PX, PKG_PAGE_PX);
	for (uint32_t y = 0; y < PKG_PAGE_PX; y++)
		for (uint32_t x = 0; x < PKG_PAGE_PX; x++) {
			const uint8_t *from = texels[y * PKG_PAGE_PX + x];
			memcpy(image->rgb + 3 * ((size_t)(y0 + y) * image->width + x0 + x), from[3] < PKG_PAGE_CUT ? magenta : from,
				3);
		}
}

static struct image draw_pages(struct pool *pool, const struct impostor_view *impostor)
{
	uint32_t pages = impostor->head.page_count, across = pages < PAGES_ACROSS ? pages : PAGES_ACROSS;
	uint32_t down = (pages + across - 1) / across;
	struct image image = image_new(pool, across * PKG_PAGE_PX, down * PKG_PAGE_PX);
	for (uint32_t i = 0; i < pages; i++)
		draw_page(
			&image, impostor->pages + (size_t)i * PKG_PAGE_BYTES, i % across * PKG_PAGE_PX, i / across * PKG_PAGE_PX);
	return image;
}

static void draw_line(struct image *image, struct dvec2 a, struct dvec2 b, const uint8_t rgb[3])
{
	double steps = fmin(fmax(fmax(fabs(b.x - a.x), fabs(b.y - a.y)), 1.0), 1e4);
	for (double i = 0; i <= steps; i++) {
		double x = a.x + (b.x - a.x) * i / steps, y = a.y + (b.y - a.y) * i / steps;
		if (x >= 0.0 && y >= 0.0 && x < image->width && y < image->height)
			memcpy(image->rgb + 3 * ((size_t)y * image->width + (size_t)x), rgb, 3);
	}
}

/* Edges in the colour of the triangle's capture. */
static struct image draw_wire(struct pool *pool, const struct pkg_stretch *stretch, const struct pkg_cell *cell,
	bool turned, const struct impostor_view *impostor)
{
	struct view_cell box = view_cell_of(stretch);
	box = turned ? view_cell_turned(&box) : box;
	struct cell_pose pose = { .behind = true, .height = 0.6 };
	struct capture_view view = cell_face_view(&box, cell_eye(&box, &pose), CELL_FRONT, false, WIRE_FOCAL_PX);
	struct image image = image_new(pool, WIRE_WIDTH, view.height);
	memset(image.rgb, 24, (size_t)3 * image.width * image.height);
	view.centre_x += (WIRE_WIDTH - (double)view.width) * 0.5;
	for (uint32_t i = 0; i + 2 < impostor->head.index_count; i += 3) {
		struct dvec2 at[3] = { 0 };
		double z = 1.0;
		const struct pkg_impostor_vertex *vertex = &impostor->vertices[impostor->indices[i]];
		for (int k = 0; k < 3 && z > 0.5; k++) {
			vertex = &impostor->vertices[impostor->indices[i + (uint32_t)k]];
			struct dvec3 point = { (vertex->pos_mm[0] + (double)cell->origin_mm[0]) * 1e-3,
				(vertex->pos_mm[1] + (double)cell->origin_mm[1]) * 1e-3,
				(vertex->pos_mm[2] + (double)cell->origin_mm[2]) * 1e-3 };
			if (!capture_project(&view, point, &at[k].x, &at[k].y, &z))
				z = 0.0;
		}
		if (z <= 0.5)
			continue;
		uint8_t shade = (uint8_t)(vertex->view_kind % 32);
		const uint8_t rgb[3] = { (uint8_t)(90 + shade * 61 % 160), (uint8_t)(230 - shade * 37 % 160),
			(uint8_t)(120 + shade * 97 % 130) };
		for (int k = 0; k < 3; k++)
			draw_line(&image, at[k], at[(k + 1) % 3], rgb);
	}
	return image;
}

static int draw_cell(
	struct pool *pool, struct blob_reader *reader, const struct pkg *pkg, uint32_t index, uint32_t half, const char *to)
{
	const struct pkg_cell *cell = &pkg->cells[far_cell_of(index, half)];
	struct impostor_view impostor;
	if (cell->kind != PKG_CELL_IMPOSTOR)
		return 0;
	void *raw = pool_alloc(pool, cell->impostor.raw_bytes);
	void *scratch = pool_alloc(pool, impostor_fold_bytes(cell->vertex_count, cell->index_count));
	int err = blob_read(reader, pkg, &cell->impostor, raw);
	if (!err)
		err = impostor_view_open(&impostor, cell, raw, cell->impostor.raw_bytes, scratch);
	if (err) {
		log_error("cell %u: its impostor is damaged", far_cell_of(index, half));
		return err;
	}
	struct image wire = draw_wire(pool, &pkg->stretches[index], cell, half & 1, &impostor);
	struct image pages = draw_pages(pool, &impostor);
	err = write_picture(&wire, to, "wire", index);
	return err ? err : write_picture(&pages, to, "pages", index);
}

int far_pictures(const struct pkg *pkg, uint32_t half, const char *folder)
{
	struct pool pool = { 0 };
	struct arena arena;
	struct blob_reader *reader;
	if (!pkg->stretches)
		return 0;
	arena_init(&arena, "blobs", pool_alloc(&pool, READER_BYTES), READER_BYTES);
	int err = blob_reader_init(&reader, &arena);
	for (uint32_t i = pkg->first_stretch[half / 2]; i < pkg->first_stretch[half / 2 + 1] && !err; i++)
		err = draw_cell(&pool, reader, pkg, i, half, folder);
	pool_finish(&pool);
	return err;
}
