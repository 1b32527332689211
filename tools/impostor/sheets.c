/* Borders that are no jumps, longest first, join the sheets on their sides, unless that brings a jump inside. */
#include "tools/impostor/sheets.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define JOINED_SIDES 24 /* shorter borders are not joined */

struct tying {
	struct sheets *sheets;
	ARRAY(uint32_t) first, beside; /* ties by surface, compressed rows */
	ARRAY(uint32_t) next, last;    /* surfaces of a sheet as a list; last by sheet's first surface */
	ARRAY(uint32_t) sheet, size;
};

static bool can_join(const struct tie *tie)
{
	return tie->sides >= JOINED_SIDES && !tie->steps;
}

static struct tie *tie_of(const struct sheets *sheets, uint32_t a, uint32_t b)
{
	size_t low = 0, high = sheets->ties.count;
	while (low < high) {
		size_t middle = (low + high) / 2;
		const struct tie *tie = &sheets->ties.items[middle];
		if (tie->a < a || (tie->a == a && tie->b < b))
			low = middle + 1;
		else
			high = middle;
	}
	struct tie *tie = low < sheets->ties.count ? &sheets->ties.items[low] : NULL;
	return tie && tie->a == a && tie->b == b ? tie : NULL;
}

static void look_at_side(struct tying *tying, const struct surfaces *surfaces, const float *tolerance, double share,
	uint32_t pixel, uint32_t other, double x, double y)
{
	uint32_t a = surfaces->label[pixel], b = surfaces->label[other];
	if (!a || !b || a == b)
		return;
	const struct plane *plane_a = &surfaces->items.items[a - 1].plane, *plane_b = &surfaces->items.items[b - 1].plane;
	double step = plane_at(plane_a, x, y) - plane_at(plane_b, x, y);
	double allowed = (double)fminf(tolerance[pixel], tolerance[other]);
	if (fabs(step) <= share * allowed)
		return;
	struct tie *tie = tie_of(tying->sheets, (a < b ? a : b) - 1, (a < b ? b : a) - 1);
	tie->steps++;
}

static void find_ties(struct tying *tying, const struct surfaces *surfaces, const float *tolerance, double share)
{
	struct borders borders = { 0 };
	borders_find(&borders, surfaces->label, surfaces->width, surfaces->height);
	for (size_t i = 0; i < borders.items.count; i++)
		ARRAY_PUSH(&tying->sheets->ties, (struct tie){ borders.items.items[i].a - 1, borders.items.items[i].b - 1,
											 borders.items.items[i].sides, 0 });
	borders_finish(&borders);
	for (uint32_t y = 0, i = 0; y < surfaces->height; y++) {
		for (uint32_t x = 0; x < surfaces->width; x++, i++) {
			if (x)
				look_at_side(tying, surfaces, tolerance, share, i, i - 1, x, y + 0.5);
			if (y)
				look_at_side(tying, surfaces, tolerance, share, i, i - surfaces->width, x + 0.5, y);
		}
	}
}

static void list_by_surface(struct tying *tying, size_t surfaces)
{
	ARRAY_RESERVE(&tying->first, surfaces + 1);
	memset(tying->first.items, 0, (surfaces + 1) * sizeof(uint32_t));
	for (size_t i = 0; i < tying->sheets->ties.count; i++) {
		tying->first.items[tying->sheets->ties.items[i].a]++;
		tying->first.items[tying->sheets->ties.items[i].b]++;
	}
	for (size_t i = 1; i <= surfaces; i++)
		tying->first.items[i] += tying->first.items[i - 1];
	ARRAY_RESERVE(&tying->beside, 2 * tying->sheets->ties.count + 1);
	for (uint32_t i = (uint32_t)tying->sheets->ties.count; i-- > 0;) {
		tying->beside.items[--tying->first.items[tying->sheets->ties.items[i].a]] = i;
		tying->beside.items[--tying->first.items[tying->sheets->ties.items[i].b]] = i;
	}
}

/* Is there a surface of one sheet that cannot be joined to one beside it of the other? */
static bool jump_between(const struct tying *tying, uint32_t sheet, uint32_t other)
{
	for (uint32_t surface = sheet; surface != UINT32_MAX; surface = tying->next.items[surface]) {
		for (uint32_t k = tying->first.items[surface]; k < tying->first.items[surface + 1]; k++) {
			const struct tie *tie = &tying->sheets->ties.items[tying->beside.items[k]];
			uint32_t neighbour = tie->a == surface ? tie->b : tie->a;
			if (tying->sheet.items[neighbour] == other && !can_join(tie))
				return true;
		}
	}
	return false;
}

static void unite(struct tying *tying, uint32_t a, uint32_t b)
{
	if (tying->size.items[a] < tying->size.items[b]) {
		uint32_t swap = a;
		a = b;
		b = swap;
	}
	if (jump_between(tying, b, a))
		return;
	for (uint32_t surface = b; surface != UINT32_MAX; surface = tying->next.items[surface])
		tying->sheet.items[surface] = a;
	tying->next.items[tying->last.items[a]] = b;
	tying->last.items[a] = tying->last.items[b];
	tying->size.items[a] += tying->size.items[b];
}

static int longest_first(const void *left, const void *right)
{
	const struct tie *a = left, *b = right;
	if (a->sides != b->sides)
		return a->sides > b->sides ? -1 : 1;
	if (a->a != b->a)
		return a->a < b->a ? -1 : 1;
	return (a->b > b->b) - (a->b < b->b);
}

static void write_out(struct sheets *sheets, const struct tying *tying)
{
	size_t surfaces = tying->sheet.count;
	sheets->sheet_of.count = sheets->first.count = sheets->members.count = 0;
	ARRAY_RESERVE(&sheets->sheet_of, surfaces + 1);
	sheets->sheet_of.count = surfaces;
	struct pool pool = { 0 };
	uint32_t *number = POOL_ARRAY(&pool, uint32_t, surfaces + 1);
	uint32_t known = 0;
	for (size_t i = 0; i < surfaces; i++) {
		uint32_t sheet = tying->sheet.items[i];
		if (!number[sheet])
			number[sheet] = ++known;
		sheets->sheet_of.items[i] = number[sheet] - 1;
	}
	ARRAY_RESERVE(&sheets->first, known + 1);
	memset(sheets->first.items, 0, (known + 1) * sizeof(uint32_t));
	sheets->first.count = known + 1;
	for (size_t i = 0; i < surfaces; i++)
		sheets->first.items[sheets->sheet_of.items[i]]++;
	for (uint32_t i = 1; i <= known; i++)
		sheets->first.items[i] += sheets->first.items[i - 1];
	ARRAY_RESERVE(&sheets->members, surfaces + 1);
	sheets->members.count = surfaces;
	for (uint32_t i = (uint32_t)surfaces; i-- > 0;)
		sheets->members.items[--sheets->first.items[sheets->sheet_of.items[i]]] = i;
	pool_finish(&pool);
}

void sheets_find(struct sheets *sheets, const struct surfaces *surfaces, const float *tolerance, double share)
{
	struct tying tying = { .sheets = sheets };
	sheets->ties.count = 0;
	for (uint32_t i = 0; i < surfaces->items.count; i++) {
		ARRAY_PUSH(&tying.sheet, i);
		ARRAY_PUSH(&tying.last, i);
		ARRAY_PUSH(&tying.next, UINT32_MAX);
		ARRAY_PUSH(&tying.size, 1);
	}
	find_ties(&tying, surfaces, tolerance, share);
	list_by_surface(&tying, surfaces->items.count);
	ARRAY(struct tie) order = { 0 };
	for (size_t i = 0; i < sheets->ties.count; i++)
		if (can_join(&sheets->ties.items[i]))
			ARRAY_PUSH(&order, sheets->ties.items[i]);
	ARRAY_SORT(&order, longest_first);
	for (size_t i = 0; i < order.count; i++) {
		uint32_t a = tying.sheet.items[order.items[i].a], b = tying.sheet.items[order.items[i].b];
		if (a != b)
			unite(&tying, a, b);
	}
	write_out(sheets, &tying);
	ARRAY_FINISH(&order);
	ARRAY_FINISH(&tying.first);
	ARRAY_FINISH(&tying.beside);
	ARRAY_FINISH(&tying.next);
	ARRAY_FINISH(&tying.last);
	ARRAY_FINISH(&tying.sheet);
	ARRAY_FINISH(&tying.size);
}

void sheets_finish(struct sheets *sheets)
{
	ARRAY_FINISH(&sheets->ties);
	ARRAY_FINISH(&sheets->sheet_of);
	ARRAY_FINISH(&sheets->first);
	ARRAY_FINISH(&sheets->members);
}
