/*
 * Which pieces are copied together: those that meet along a border that is no jump share the texels there, and neither
 * needs a gutter. Pieces that lie over one another are kept apart, for a pixel has one colour.
 */
#include "tools/impostor/atlas_layout.h"

#define TEXELS_MAX (PKG_PAGE_PX - 2 * ATLAS_GUTTER)
#define SCALE_RATIO_MAX 1.3 /* of pieces in one cluster: the coarser ones get more than they need */
#define FILL_MIN 0.3        /* of a cluster's rectangle: shapes with large gaps are hard to place */
#define CONFLICT_PX 2       /* so many pixels' centres may lie in two pieces of a cluster: rounding */
/* Borders are the same when they are equal to so many parts of a pixel, and of their disparity. */
#define LATTICE 64.0
#define DISPARITY_SLACK 1e-3

struct corner_at {
	uint64_t place; /* view, x, y */
	float disparity;
	uint32_t piece;
};

struct contact {
	uint32_t a, b;  /* pieces, a < b */
	uint32_t count; /* of corners, or pixels */
};

struct extent {
	double min_x, min_y, max_x, max_y, texels, scale; /* texels: area at each piece's own scale */
	uint8_t view;
};

typedef ARRAY(struct contact) contact_list;

static int by_place(const void *left, const void *right)
{
	const struct corner_at *a = left, *b = right;
	if (a->place != b->place)
		return a->place < b->place ? -1 : 1;
	return (a->piece > b->piece) - (a->piece < b->piece);
}

static int by_pieces(const void *left, const void *right)
{
	const struct contact *a = left, *b = right;
	if (a->a != b->a)
		return a->a < b->a ? -1 : 1;
	return (a->b > b->b) - (a->b < b->b);
}

static int most_first(const void *left, const void *right)
{
	const struct contact *a = left, *b = right;
	if (a->count != b->count)
		return a->count > b->count ? -1 : 1;
	return by_pieces(a, b);
}

static uint64_t place_of(const struct mesh_vertex *corner, uint8_t view)
{
	uint32_t x = (uint32_t)(int32_t)lround((double)corner->x * LATTICE);
	uint32_t y = (uint32_t)(int32_t)lround((double)corner->y * LATTICE);
	return (uint64_t)view << 56 | (uint64_t)(x & 0xfffffff) << 28 | (y & 0xfffffff);
}

/* Pairs of pieces with a corner in common, once for each such corner. */
static void meet(const struct corner_at *at, size_t count, contact_list *contacts)
{
	for (size_t i = 0; i < count; i++) {
		for (size_t k = i + 1; k < count; k++) {
			float off = fabsf(at[i].disparity - at[k].disparity);
			if (at[i].piece != at[k].piece && off <= (float)DISPARITY_SLACK * at[i].disparity)
				ARRAY_PUSH(contacts, (struct contact){ at[i].piece, at[k].piece, 1 });
		}
	}
}

/* Sorted, each pair once. */
static void count_pairs(contact_list *pairs)
{
	size_t kept = 0;
	ARRAY_SORT(pairs, by_pieces);
	for (size_t i = 0; i < pairs->count; i++) {
		if (kept && !by_pieces(&pairs->items[kept - 1], &pairs->items[i]))
			pairs->items[kept - 1].count += pairs->items[i].count;
		else
			pairs->items[kept++] = pairs->items[i];
	}
	pairs->count = kept;
}

static void find_contacts(const struct atlas_layout *layout, const struct impostor_mesh *mesh, contact_list *contacts)
{
	ARRAY(struct corner_at) at = { 0 };
	for (uint32_t p = 0; p < layout->pieces.count; p++) {
		const struct atlas_piece *piece = &layout->pieces.items[p];
		const struct mesh_vertex *corners = &layout->corners.items[piece->first_corner];
		for (uint32_t i = 0; i < piece->corner_count; i++)
			ARRAY_PUSH(&at, (struct corner_at){ place_of(&corners[i], mesh->patches.items[piece->patch].view),
								corners[i].disparity, p });
	}
	ARRAY_SORT(&at, by_place);
	size_t kept = 0; /* a piece once at a place */
	for (size_t i = 0; i < at.count; i++)
		if (!kept || by_place(&at.items[kept - 1], &at.items[i]))
			at.items[kept++] = at.items[i];
	for (size_t first = 0, end; first < kept; first = end) {
		for (end = first + 1; end < kept && at.items[end].place == at.items[first].place; end++)
			;
		meet(&at.items[first], end - first, contacts);
	}
	ARRAY_FINISH(&at);
	count_pairs(contacts);
	ARRAY_SORT(contacts, most_first);
}

/* Neighbouring pixels mostly tell of the same pair. */
static void add_pair(contact_list *pairs, uint32_t a, uint32_t b)
{
	struct contact *last = pairs->count ? &pairs->items[pairs->count - 1] : NULL;
	if (last && last->a == a && last->b == b)
		last->count++;
	else
		ARRAY_PUSH(pairs, (struct contact){ a, b, 1 });
}

/* Pairs of pieces that lie over one another, by the pixels: what one shows the other hides. */
static void find_conflicts(const struct atlas_layout *layout, const struct impostor_mesh *mesh,
	const struct impostor_capture *captures, contact_list *conflicts)
{
	struct pool pool = { 0 };
	uint32_t *owner = NULL;
	int view_now = -1;
	for (uint32_t p = 0; p < layout->pieces.count; p++) {
		const struct atlas_piece *piece = &layout->pieces.items[p];
		uint8_t view = mesh->patches.items[piece->patch].view;
		int32_t width = (int32_t)captures[view].image.view.width, height = (int32_t)captures[view].image.view.height;
		if (view != view_now) {
			pool_finish(&pool);
			owner = POOL_ARRAY(&pool, uint32_t, (size_t)width * (size_t)height);
			view_now = view;
		}
		for (uint32_t i = 0; i < piece->corner_count; i += 3) {
			const struct mesh_vertex *corners = &layout->corners.items[piece->first_corner + i];
			int32_t rows[2], columns[2];
			atlas_rows(corners, rows);
			for (int32_t y = rows[0] > 0 ? rows[0] : 0; y <= rows[1] && y < height; y++) {
				atlas_columns(corners, y, columns);
				for (int32_t x = columns[0] > 0 ? columns[0] : 0; x <= columns[1] && x < width; x++) {
					uint32_t *here = &owner[(size_t)y * (size_t)width + (size_t)x];
					if (*here && *here != p + 1)
						add_pair(conflicts, *here - 1, p);
					*here = *here ? *here : p + 1;
				}
			}
		}
	}
	pool_finish(&pool);
	count_pairs(conflicts);
}

static uint32_t root_of(uint32_t *parent, uint32_t piece)
{
	while (parent[piece] != piece)
		piece = parent[piece] = parent[parent[piece]];
	return piece;
}

static bool is_in_conflict(const contact_list *conflicts, uint32_t *parent, uint32_t a, uint32_t b)
{
	for (size_t i = 0; i < conflicts->count; i++) {
		uint32_t p = root_of(parent, conflicts->items[i].a), q = root_of(parent, conflicts->items[i].b);
		if (conflicts->items[i].count > CONFLICT_PX && ((p == a && q == b) || (p == b && q == a)))
			return true;
	}
	return false;
}

static bool may_join(const struct extent *a, const struct extent *b, struct extent *joined)
{
	*joined = (struct extent){ fmin(a->min_x, b->min_x), fmin(a->min_y, b->min_y), fmax(a->max_x, b->max_x),
		fmax(a->max_y, b->max_y), a->texels + b->texels, fmax(a->scale, b->scale), a->view };
	double width = (ceil(joined->max_x) - floor(joined->min_x)) * joined->scale;
	double height = (ceil(joined->max_y) - floor(joined->min_y)) * joined->scale;
	return width <= TEXELS_MAX && height <= TEXELS_MAX && joined->texels >= FILL_MIN * width * height &&
		   joined->scale <= SCALE_RATIO_MAX * fmin(a->scale, b->scale);
}

void atlas_join(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct impostor_capture *captures)
{
	size_t count = layout->pieces.count;
	struct pool pool = { 0 };
	uint32_t *parent = POOL_ARRAY(&pool, uint32_t, count);
	struct extent *extents = POOL_ARRAY(&pool, struct extent, count);
	for (uint32_t i = 0; i < count; i++) {
		const struct atlas_piece *piece = &layout->pieces.items[i];
		parent[i] = i;
		extents[i] = (struct extent){ piece->min_x, piece->min_y, piece->max_x, piece->max_y,
			piece->area * piece->scale * piece->scale, piece->scale, mesh->patches.items[piece->patch].view };
	}
	contact_list contacts = { 0 }, conflicts = { 0 };
	find_conflicts(layout, mesh, captures, &conflicts);
	find_contacts(layout, mesh, &contacts);
	for (size_t i = 0; i < contacts.count; i++) {
		uint32_t a = root_of(parent, contacts.items[i].a), b = root_of(parent, contacts.items[i].b);
		struct extent joined;
		if (a == b || contacts.items[i].count < 2 || !may_join(&extents[a], &extents[b], &joined) ||
			is_in_conflict(&conflicts, parent, a, b))
			continue;
		parent[a > b ? a : b] = a > b ? b : a;
		extents[a > b ? b : a] = joined;
	}
	for (uint32_t i = 0; i < count; i++)
		layout->pieces.items[i].cluster = root_of(parent, i);
	ARRAY_FINISH(&contacts);
	ARRAY_FINISH(&conflicts);
	pool_finish(&pool);
}
