/*
 * Colours of the clusters. A texel is the mean of the pixels under it that its patches show. What they do not show, but
 * filters and compressed blocks reach, is filled from the neighbours, ring by ring, so that neither another surface nor
 * the clear colour mixes in. A texel is there or cut away: what it covers of its place would move outlines by less than
 * half a texel more, and take a seventh of an impostor's bytes.
 */
#include <string.h>

#include "tools/impostor/atlas_part.h"

#define BORDER_PX 2 /* how far beyond its triangles a patch's pixels are looked for */
#define GLOSS_STEPS 16
#define WEIGHT_MIN 0.05 /* of a texel: with less of it covered by own pixels it is filled */

enum cover {
	COVER_UNKNOWN, /* no triangle reaches the pixel's centre: as its neighbours */
	COVER_CUT,
	COVER_SOLID,
};

/* Index of a capture's pixel in the part, or SIZE_MAX. */
static size_t place_in(const struct atlas_part *part, int32_t x, int32_t y)
{
	x -= part->left;
	y -= part->top;
	return x < 0 || y < 0 || x >= part->width || y >= part->height ? SIZE_MAX
																   : (size_t)y * (size_t)part->width + (size_t)x;
}

static const struct capture_pixel *pixel_at(const struct atlas_canvas *canvas, int32_t x, int32_t y)
{
	return &canvas->image->pixels[(size_t)y * canvas->image->view.width + (size_t)x];
}

static uint8_t mesh_texel(const struct impostor_mesh *mesh, const struct mesh_patch *patch, int32_t x, int32_t y)
{
	if (x < patch->min_x || y < patch->min_y || x > patch->max_x || y > patch->max_y)
		return MESH_FILL;
	size_t width = (size_t)patch->max_x - patch->min_x + 1;
	return mesh->texels.items[patch->first_texel + (size_t)(y - patch->min_y) * width + (size_t)(x - patch->min_x)];
}

static void cover_triangle(const struct atlas_canvas *canvas, struct atlas_part *part, const struct mesh_patch *patch,
	const struct mesh_vertex corners[3])
{
	int32_t rows[2], columns[2];
	atlas_rows(corners, rows);
	for (int32_t y = rows[0]; y <= rows[1]; y++) {
		atlas_columns(corners, y, columns);
		for (int32_t x = columns[0]; x <= columns[1]; x++) {
			size_t i = place_in(part, x, y);
			if (i == SIZE_MAX || part->cover[i] == COVER_SOLID)
				continue;
			part->cover[i] = mesh_texel(canvas->mesh, patch, x, y) == MESH_CUT ? COVER_CUT : COVER_SOLID;
		}
	}
}

/* Pixels that the piece's patch shows, a little beyond the piece's own. */
/* Is there something, and lit as the patch is? Water is dark before it mirrors the sky, and a patch of something else
 * mirrors none. */
static bool lights_as(const struct capture_pixel *pixel, const struct mesh_patch *patch)
{
	return pixel->object && (pixel->kind == PKG_MATERIAL_WATER) == (patch->kind == PKG_MATERIAL_WATER);
}

static bool own_shown(const struct atlas_canvas *canvas, struct atlas_part *part, const struct mesh_patch *patch,
	const struct atlas_piece *piece)
{
	int32_t low_x = (int32_t)floorf(piece->min_x) - BORDER_PX, high_x = (int32_t)ceilf(piece->max_x) + BORDER_PX;
	int32_t low_y = (int32_t)floorf(piece->min_y) - BORDER_PX, high_y = (int32_t)ceilf(piece->max_y) + BORDER_PX;
	bool any = false;
	for (int32_t y = low_y > patch->min_y ? low_y : patch->min_y; y <= high_y && y <= patch->max_y; y++) {
		for (int32_t x = low_x > patch->min_x ? low_x : patch->min_x; x <= high_x && x <= patch->max_x; x++) {
			size_t i = place_in(part, x, y);
			if (i == SIZE_MAX || mesh_texel(canvas->mesh, patch, x, y) != MESH_SHOW ||
				!lights_as(pixel_at(canvas, x, y), patch))
				continue;
			part->owned[i] = 1;
			any = true;
		}
	}
	return any;
}

/* A sliver that shows no pixel takes the one nearest to its plane, around its middle. */
static void own_something(const struct atlas_canvas *canvas, struct atlas_part *part)
{
	const struct atlas_piece *piece = &canvas->layout->pieces.items[part->cluster->first_piece];
	const struct mesh_vertex *c = &canvas->layout->corners.items[piece->first_corner];
	float disparity = (c[0].disparity + c[1].disparity + c[2].disparity) / 3, least = INFINITY;
	int32_t x = (int32_t)floorf((c[0].x + c[1].x + c[2].x) / 3), y = (int32_t)floorf((c[0].y + c[1].y + c[2].y) / 3);
	size_t best = 0;
	for (int32_t row = y - BORDER_PX; row <= y + BORDER_PX; row++) {
		for (int32_t column = x - BORDER_PX; column <= x + BORDER_PX; column++) {
			size_t i = place_in(part, column, row);
			if (i == SIZE_MAX || !pixel_at(canvas, column, row)->object)
				continue;
			float off = fabsf(pixel_at(canvas, column, row)->disparity - disparity);
			best = off < least ? i : best;
			least = off < least ? off : least;
		}
	}
	if (least < INFINITY)
		part->owned[best] = 1;
}

static void find_owned(const struct atlas_canvas *canvas, struct atlas_part *part)
{
	bool any = false;
	for (uint32_t p = 0; p < part->cluster->piece_count; p++) {
		const struct atlas_piece *piece = &canvas->layout->pieces.items[part->cluster->first_piece + p];
		const struct mesh_patch *patch = &canvas->mesh->patches.items[piece->patch];
		any |= own_shown(canvas, part, patch, piece);
		for (uint32_t i = 0; i < piece->corner_count; i += 3)
			cover_triangle(canvas, part, patch, &canvas->layout->corners.items[piece->first_corner + i]);
	}
	if (!any)
		own_something(canvas, part);
	for (size_t i = 0; i < (size_t)part->width * (size_t)part->height; i++)
		if (part->owned[i] && part->cover[i] == COVER_UNKNOWN)
			part->cover[i] = COVER_SOLID;
}

/* What a texel covers of the part, px; x and y. */
struct box {
	double low[2], high[2];
	int32_t first[2], last[2];
};

static struct box box_of(const struct atlas_part *part, uint32_t column, uint32_t row)
{
	const struct atlas_cluster *cluster = part->cluster;
	const int32_t start[2] = { cluster->left - part->left, cluster->top - part->top };
	const int32_t size[2] = { part->width, part->height };
	const uint32_t at[2] = { column, row };
	struct box box;
	for (int k = 0; k < 2; k++) {
		box.low[k] = start[k] + ((double)at[k] - ATLAS_GUTTER) / cluster->scale;
		box.high[k] = start[k] + ((double)at[k] + 1 - ATLAS_GUTTER) / cluster->scale;
		box.first[k] = (int32_t)fmax(floor(box.low[k]), 0);
		box.last[k] = (int32_t)fmin(ceil(box.high[k]), size[k]) - 1;
	}
	return box;
}

static double overlap(const struct box *box, int axis, int32_t at)
{
	return fmin(at + 1, box->high[axis]) - fmax(at, box->low[axis]);
}

/* The place at the mean position and disparity of those of the texel's pixels that show the same object as the largest
 * share of one pixel: on a plane that is exact. */
static struct pkg_truth_texel find_truth(
	const struct atlas_canvas *canvas, const struct atlas_part *part, const struct box *box)
{
	struct pkg_truth_texel truth = { 0 };
	double most = 0, sum[3] = { 0 }, weights = 0;
	for (int pass = 0; pass < 2; pass++) {
		for (int32_t y = box->first[1]; y <= box->last[1]; y++) {
			for (int32_t x = box->first[0]; x <= box->last[0]; x++) {
				const struct capture_pixel *pixel = pixel_at(canvas, part->left + x, part->top + y);
				double weight = overlap(box, 0, x) * overlap(box, 1, y);
				if (!part->owned[(size_t)y * (size_t)part->width + (size_t)x] ||
					(pass ? pixel->object != truth.object : weight <= most))
					continue;
				if (!pass) {
					most = weight;
					truth.object = pixel->object;
					continue;
				}
				sum[0] += weight * (part->left + x + 0.5);
				sum[1] += weight * (part->top + y + 0.5);
				sum[2] += weight * (double)pixel->disparity;
				weights += weight;
			}
		}
	}
	atlas_place(canvas, sum[0] / weights, sum[1] / weights, sum[2] / weights, &truth);
	return truth;
}

static void sample(const struct atlas_canvas *canvas, struct atlas_part *part, uint32_t column, uint32_t row)
{
	struct box box = box_of(part, column, row);
	size_t texel = (size_t)row * part->columns + column;
	double sum[4] = { 0 }, weights = 0, solid = 0, known = 0;
	for (int32_t y = box.first[1]; y <= box.last[1]; y++) {
		for (int32_t x = box.first[0]; x <= box.last[0]; x++) {
			size_t i = (size_t)y * (size_t)part->width + (size_t)x;
			double weight = overlap(&box, 0, x) * overlap(&box, 1, y);
			known += part->cover[i] != COVER_UNKNOWN ? weight : 0;
			solid += part->cover[i] == COVER_SOLID ? weight : 0;
			if (!part->owned[i])
				continue;
			const uint8_t *rgba = canvas->image->rgba +
								  4 * ((size_t)(part->top + y) * canvas->image->view.width + (size_t)(part->left + x));
			for (int k = 0; k < 4; k++)
				sum[k] += weight * rgba[k] * (k < 3 ? rgba[k] : 1);
			weights += weight;
		}
	}
	double least = WEIGHT_MIN / (part->cluster->scale * part->cluster->scale);
	part->colour[texel][4] = known > least ? (float)(solid * 2 >= known) : -1.0f;
	if (weights <= least)
		return;
	for (int k = 0; k < 4; k++)
		part->colour[texel][k] = (float)(sum[k] / weights);
	if (part->truth)
		part->truth[texel] = find_truth(canvas, part, &box);
	part->filled[texel] = 1;
}

/* The mean of the neighbours that were filled in earlier turns. */
static bool fill_texel(struct atlas_part *part, uint32_t column, uint32_t row, uint8_t turn)
{
	size_t texel = (size_t)row * part->columns + column;
	float sum[5] = { 0 }, weights = 0;
	for (uint32_t n = 0; n < 9; n++) {
		uint32_t x = column + n % 3 - 1, y = row + n / 3 - 1;
		size_t i = (size_t)y * part->columns + x;
		if (x >= part->columns || y >= part->rows || !part->filled[i] || part->filled[i] >= turn)
			continue;
		float weight = n % 2 ? 2 : 1; /* side by side, or corner to corner */
		for (int k = 0; k < 5; k++)
			sum[k] += weight * part->colour[i][k];
		weights += weight;
		if (part->truth) {
			part->truth[texel] = part->truth[i];
			part->truth[texel].object |= PKG_TRUTH_MADE_UP;
		}
	}
	if (weights <= 0)
		return false;
	for (int k = 0; k < 4; k++)
		part->colour[texel][k] = sum[k] / weights;
	if (part->colour[texel][4] < 0)
		part->colour[texel][4] = sum[4] / weights < 0.5f ? 0 : 1;
	part->filled[texel] = turn;
	return true;
}

static void fill_gaps(struct atlas_part *part)
{
	bool any = true;
	for (unsigned turn = 2; any; turn++) {
		any = false;
		for (uint32_t row = 0; row < part->rows; row++)
			for (uint32_t column = 0; column < part->columns; column++)
				if (!part->filled[(size_t)row * part->columns + column])
					any |= fill_texel(part, column, row, (uint8_t)(turn < UINT8_MAX ? turn : UINT8_MAX));
	}
}

/* Does anything solid show in a block, or so near that a filter takes colours from it? */
static bool is_visible(const struct atlas_part *part, uint32_t block_x, uint32_t block_y)
{
	uint32_t first_x = block_x ? 4 * block_x - 1 : 0, first_y = block_y ? 4 * block_y - 1 : 0;
	for (uint32_t y = first_y; y < 4 * block_y + 5 && y < part->rows; y++)
		for (uint32_t x = first_x; x < 4 * block_x + 5 && x < part->columns; x++)
			if (part->colour[(size_t)y * part->columns + x][4] > 0)
				return true;
	return false;
}

/* The share that mirrors, one for a block: as a pattern of its own it would take as many bytes as the colours, and what
 * is far shows it as a tone at most. */
static float gloss_of(const struct atlas_part *part, uint32_t block_x, uint32_t block_y)
{
	float sum = 0, solid = 0;
	for (uint32_t row = 4 * block_y; row < 4 * block_y + 4; row++) {
		for (uint32_t column = 4 * block_x; column < 4 * block_x + 4; column++) {
			const float *colour = part->colour[(size_t)row * part->columns + column];
			float weight = fmaxf(colour[4], 1e-3f);
			sum += weight * colour[3] / 255;
			solid += weight;
		}
	}
	return roundf(sum / solid * GLOSS_STEPS) / GLOSS_STEPS;
}

static void write_texel(const float colour[5], float gloss, uint8_t rgba[4])
{
	for (int k = 0; k < 3; k++)
		rgba[k] = (uint8_t)lroundf(sqrtf(colour[k]));
	float solid = PKG_PAGE_SOLID + gloss * (255 - PKG_PAGE_SOLID);
	rgba[3] = (uint8_t)lroundf(solid * fmaxf(colour[4], 0));
}

static void write_block(
	const struct atlas_canvas *canvas, const struct atlas_part *part, uint32_t block_x, uint32_t block_y)
{
	const struct pack_shape *shape = part->shape;
	float gloss = gloss_of(part, block_x, block_y);
	for (uint32_t row = 4 * block_y; row < 4 * block_y + 4; row++) {
		for (uint32_t column = 4 * block_x; column < 4 * block_x + 4; column++) {
			size_t from = (size_t)row * part->columns + column;
			size_t to = ((size_t)shape->page * PKG_PAGE_PX + 4 * shape->y + row) * PKG_PAGE_PX + 4 * shape->x + column;
			write_texel(part->colour[from], gloss, canvas->out->pages + 4 * to);
			if (part->truth && part->colour[from][4] >= 0.5f)
				canvas->out->truth[to] = part->truth[from];
		}
	}
}

/* The part of the capture that the texels cover, and a border. */
static void frame(const struct capture_view *view, struct atlas_part *part)
{
	const struct atlas_cluster *cluster = part->cluster;
	int32_t border = BORDER_PX + (int32_t)ceil(ATLAS_GUTTER / cluster->scale);
	int32_t right = cluster->left + border + (int32_t)ceil(part->columns / cluster->scale);
	int32_t bottom = cluster->top + border + (int32_t)ceil(part->rows / cluster->scale);
	part->left = cluster->left > border ? cluster->left - border : 0;
	part->top = cluster->top > border ? cluster->top - border : 0;
	part->width = (right < (int32_t)view->width ? right : (int32_t)view->width) - part->left;
	part->height = (bottom < (int32_t)view->height ? bottom : (int32_t)view->height) - part->top;
}

static void paint_cluster(const struct atlas_canvas *canvas, uint32_t index)
{
	const struct pack_shape *shape = &canvas->layout->shapes.items[index];
	struct atlas_part part = { .cluster = &canvas->layout->clusters.items[index],
		.shape = shape,
		.columns = 4 * shape->width,
		.rows = 4 * shape->height };
	frame(&canvas->image->view, &part);
	if (part.width <= 0 || part.height <= 0)
		return;
	struct pool pool = { 0 };
	size_t texels = (size_t)part.columns * part.rows, pixels = (size_t)part.width * (size_t)part.height;
	part.owned = POOL_ARRAY(&pool, uint8_t, pixels);
	part.cover = POOL_ARRAY(&pool, uint8_t, pixels);
	part.colour = pool_alloc(&pool, texels * sizeof(*part.colour));
	part.filled = POOL_ARRAY(&pool, uint8_t, texels);
	part.truth = canvas->out->truth ? POOL_ARRAY(&pool, struct pkg_truth_texel, texels) : NULL;
	find_owned(canvas, &part);
	for (uint32_t row = 0; row < part.rows; row++)
		for (uint32_t column = 0; column < part.columns; column++)
			sample(canvas, &part, column, row);
	fill_gaps(&part);
	if (part.truth)
		atlas_place_made_up(canvas, &part);
	for (uint32_t y = 0; y < shape->height; y++)
		for (uint32_t x = 0; x < shape->width; x++)
			if ((shape->rows[y] >> x & 1) && is_visible(&part, x, y))
				write_block(canvas, &part, x, y);
	pool_finish(&pool);
}

void atlas_paint(const struct atlas_layout *layout, const struct impostor_mesh *mesh,
	const struct impostor_capture *captures, struct impostor *out)
{
	struct atlas_canvas canvas = { .layout = layout,
		.mesh = mesh,
		.origin = { out->origin_mm[0] * 1e-3, out->origin_mm[1] * 1e-3, out->origin_mm[2] * 1e-3 },
		.out = out };
	for (uint32_t i = 0; i < layout->clusters.count; i++) {
		canvas.image = &captures[layout->clusters.items[i].view].image;
		paint_cluster(&canvas, i);
	}
}
