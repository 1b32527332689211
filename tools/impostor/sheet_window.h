/*
 * The part of a capture that a sheet is meshed in: the sheet's pixels, spread to where its triangles are to reach.
 *
 * First under whatever is nearer and down to where the near ground will be (guard_px), so that parallax uncovers a
 * continuation and no hole; some pixels (seam_px) over the surfaces that it is tied to; then gaps are closed that are
 * narrower than twice close_px; at last a ring (ring_px) on all sides, for the texture's filter.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SHEET_WINDOW_H
#define BLVD_TOOLS_IMPOSTOR_SHEET_WINDOW_H

#include "tools/impostor/displacement.h"
#include "tools/impostor/foliage_light.h"
#include "tools/impostor/impostor.h"
#include "tools/impostor/sheets.h"

struct sheet_options {
	double per_px; /* pixels of the capture in one of the screen */
	uint32_t guard_px, close_px;
	uint32_t ring_px, seam_px;
	uint32_t reach_px; /* how far outlines may grow beyond what is spread */
	double price_px2;  /* area that a triangle is worth */
	double inner_px;   /* by how much borders between surfaces may be off */
	uint32_t grid_px;  /* not 0: vertices have the capture's disparities, and there is one every so many pixels */
	uint8_t view;
};
/* What all sheets of a capture share. */
struct sheet_source {
	const struct capture_image *image;
	const struct surfaces *surfaces;
	const struct sheets *sheets;
	float *tolerance; /* of disparity for tau_px: at owned pixels, and 0 where not asked for yet */
	struct displacement *displacement;
	double tau_px;
	const struct foliage_light *foliage;
	const uint8_t *open_below; /* not 0: nothing here and in all pixels below */
	struct sheet_options options;
};

static inline const struct surface *sheet_surface(const struct sheet_source *source, uint32_t label)
{
	return &source->surfaces->items.items[label - 1];
}

/* What a surface has at a pixel that is not its own, going by disparity. */
enum mesh_texel sheet_texel(const struct sheet_source *source, const struct surface *surface, uint32_t x, uint32_t y);

/* Scratch, kept from sheet to sheet; zeroed to start with. */
struct sheet_window {
	int32_t x, y; /* of the first pixel in the image; may be negative */
	uint32_t width, height;
	ARRAY(uint32_t) label; /* surface + 1 */
	ARRAY(uint8_t) seam;   /* not 0: spread over a surface that is tied to the sheet */
	ARRAY(uint32_t) front, next_front, lent;
};

void sheet_window_open(struct sheet_window *window, const struct sheet_source *source, uint32_t sheet);
void sheet_window_finish(struct sheet_window *window);

/* The label at a pixel of the image; 0 outside of the window. */
static inline uint32_t sheet_window_label(const struct sheet_window *window, int64_t x, int64_t y)
{
	x -= window->x;
	y -= window->y;
	if (x < 0 || y < 0 || x >= window->width || y >= window->height)
		return 0;
	return window->label.items[(size_t)y * window->width + (size_t)x];
}

#endif
