#include "tools/read/tile_grid.h"

#include <stdlib.h>
#include <string.h>

#include "tools/city/box_index.h"

/* In units: a quarter of a metre at zoom 15. */
#define SNAP_UNITS 5.0
#define LABEL_UNITS 10.0

struct renaming {
	tile_place from, to;
};
typedef ARRAY(struct renaming) renaming_array;
typedef ARRAY(tile_place) place_array;

static int by_place(const void *a, const void *b)
{
	tile_place x = *(const tile_place *)a, y = *(const tile_place *)b;
	return x < y ? -1 : x > y;
}

static int by_from(const void *a, const void *b)
{
	return by_place(&((const struct renaming *)a)->from, &((const struct renaming *)b)->from);
}

static tile_place renamed(const renaming_array *renamings, tile_place place)
{
	for (int steps = 0; renamings->count && steps < 8; steps++) {
		struct renaming key = { place, 0 };
		const struct renaming *found = bsearch(&key, renamings->items, renamings->count, sizeof(key), by_from);
		if (!found)
			break;
		place = found->to;
	}
	return place;
}

static void apply(tile_line_array *lines, renaming_array *renamings)
{
	ARRAY_SORT(renamings, by_from);
	for (size_t i = 0; i < lines->count; i++) {
		struct tile_line *line = &lines->items[i];
		size_t kept = 0;
		for (size_t j = 0; j < line->count; j++) {
			tile_place place = renamed(renamings, line->places[j]);
			if (!kept || line->places[kept - 1] != place)
				line->places[kept++] = place;
		}
		line->count = kept;
	}
}

/* Ends on a tile's border, one coordinate swapped to the front so that those of one border sort together. */
static void snap_border(tile_line_array *lines, bool vertical)
{
	place_array ends = { 0 };
	renaming_array renamings = { 0 };
	for (size_t i = 0; i < lines->count; i++) {
		const struct tile_line *line = &lines->items[i];
		for (int k = 0; line->road && k < 2; k++) {
			tile_place end = line->places[k ? line->count - 1 : 0];
			int64_t across = vertical ? tile_east(end) : tile_south(end),
					along = vertical ? tile_south(end) : tile_east(end);
			if (across % TILE_UNITS == 0)
				ARRAY_PUSH(&ends, tile_place_of(across, along));
		}
	}
	ARRAY_SORT(&ends, by_place);
	for (size_t i = 1; i < ends.count; i++) {
		tile_place a = ends.items[i - 1], b = ends.items[i];
		if (a == b || tile_east(a) != tile_east(b) || tile_south(b) - tile_south(a) > (int64_t)SNAP_UNITS)
			continue;
		tile_place from = vertical ? b : tile_place_of(tile_south(b), tile_east(b));
		tile_place to = vertical ? a : tile_place_of(tile_south(a), tile_east(a));
		ARRAY_PUSH(&renamings, (struct renaming){ from, to });
	}
	apply(lines, &renamings);
	ARRAY_FINISH(&ends);
	ARRAY_FINISH(&renamings);
}

/* Tells how many lines pass each place. */
struct usage {
	place_array places; /* sorted, with repetitions */
};

static void count_usage(const tile_line_array *lines, struct usage *usage)
{
	*usage = (struct usage){ 0 };
	for (size_t i = 0; i < lines->count; i++)
		for (size_t j = 0; lines->items[i].road && j < lines->items[i].count; j++)
			ARRAY_PUSH(&usage->places, lines->items[i].places[j]);
	ARRAY_SORT(&usage->places, by_place);
}

static size_t uses(const struct usage *usage, tile_place place)
{
	const tile_place *items = usage->places.items;
	size_t low = 0, high = usage->places.count, count = 0;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (items[middle] < place)
			low = middle + 1;
		else
			high = middle;
	}
	while (low + count < usage->places.count && items[low + count] == place)
		count++;
	return count;
}

struct segment {
	uint32_t line, index; /* from place `index` to `index + 1` */
};
typedef ARRAY(struct segment) segment_array;

static void index_segments(
	const tile_line_array *lines, segment_array *segments, bounds_array *boxes, struct box_index *index)
{
	for (size_t i = 0; i < lines->count; i++) {
		const struct tile_line *line = &lines->items[i];
		for (size_t j = 0; line->road && j + 1 < line->count; j++) {
			struct dvec2 a = tile_point(line->places[j]), b = tile_point(line->places[j + 1]);
			ARRAY_PUSH(segments, (struct segment){ (uint32_t)i, (uint32_t)j });
			ARRAY_PUSH(
				boxes, (struct bounds){ { fmin(a.x, b.x), fmin(a.y, b.y) }, { fmax(a.x, b.x), fmax(a.y, b.y) } });
		}
	}
	box_index_build(index, boxes->items, boxes->count, 200.0);
}

static double distance(struct dvec2 at, struct dvec2 a, struct dvec2 b, double *t)
{
	struct dvec2 along = dvec2_sub(b, a), to = dvec2_sub(at, a);
	double squared = dvec2_dot(along, along);
	*t = squared > 0.0 ? fmin(fmax(dvec2_dot(along, to) / squared, 0.0), 1.0) : 0.0;
	return dvec2_length(dvec2_sub(to, dvec2_scale(along, *t)));
}

struct insertion {
	uint32_t line, index;
	double t;
	tile_place place;
};
typedef ARRAY(struct insertion) insertion_array;

static int by_line(const void *a, const void *b)
{
	const struct insertion *x = a, *y = b;
	if (x->line != y->line)
		return x->line < y->line ? -1 : 1;
	if (x->index != y->index)
		return x->index < y->index ? -1 : 1;
	return x->t < y->t ? -1 : x->t > y->t;
}

/* An end that no other line passes, but one passes close by: it ends there. */
static void find_junctions(const tile_line_array *lines, insertion_array *out)
{
	segment_array segments = { 0 };
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	struct usage usage;
	count_usage(lines, &usage);
	index_segments(lines, &segments, &boxes, &index);
	for (size_t i = 0; i < lines->count; i++) {
		const struct tile_line *line = &lines->items[i];
		for (int k = 0; line->road && k < 2; k++) {
			tile_place end = line->places[k ? line->count - 1 : 0];
			struct dvec2 at = tile_point(end);
			double best = SNAP_UNITS;
			struct insertion insertion = { 0 };
			if (uses(&usage, end) > 1)
				continue;
			box_index_find(&index, bounds_grown((struct bounds){ at, at }, SNAP_UNITS), &near);
			for (size_t n = 0; segments.items && n < near.count; n++) {
				struct segment segment = segments.items[near.items[n]];
				const struct tile_line *other = &lines->items[segment.line];
				double t, away;
				if (segment.line == i || other->level != line->level)
					continue;
				away = distance(
					at, tile_point(other->places[segment.index]), tile_point(other->places[segment.index + 1]), &t);
				if (away < best) {
					best = away;
					insertion = (struct insertion){ segment.line, segment.index, t, end };
				}
			}
			if (best < SNAP_UNITS)
				ARRAY_PUSH(out, insertion);
		}
	}
	ARRAY_SORT(out, by_line);
	box_index_finish(&index);
	ARRAY_FINISH(&usage.places);
	ARRAY_FINISH(&segments);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&near);
}

static void insert_junctions(tile_line_array *lines, struct pool *pool)
{
	insertion_array found = { 0 };
	find_junctions(lines, &found);
	for (size_t i = 0; i < found.count;) {
		struct tile_line *line = &lines->items[found.items[i].line];
		size_t last = i, count = 0;
		while (last < found.count && found.items[last].line == found.items[i].line)
			last++;
		tile_place *places = POOL_ARRAY(pool, tile_place, line->count + last - i);
		for (size_t j = 0; j < line->count; j++) {
			places[count++] = line->places[j];
			while (i < last && found.items[i].index == j)
				places[count++] = found.items[i++].place;
		}
		i = last;
		line->places = places;
		line->count = count;
	}
	ARRAY_FINISH(&found);
}

/* Cuts roads where they meet others, so that each piece has one name. */
static void split(tile_line_array *lines)
{
	tile_line_array pieces = { 0 };
	struct usage usage;
	count_usage(lines, &usage);
	for (size_t i = 0; i < lines->count; i++) {
		struct tile_line line = lines->items[i];
		size_t start = 0;
		for (size_t j = 1; j < line.count; j++) {
			if (j + 1 < line.count && !(line.road && uses(&usage, line.places[j]) > 1))
				continue;
			struct tile_line piece = line;
			piece.places = line.places + start;
			piece.count = j - start + 1;
			ARRAY_PUSH(&pieces, piece);
			start = j;
		}
	}
	ARRAY_FINISH(&usage.places);
	ARRAY_FINISH(lines);
	lines->items = pieces.items;
	lines->count = pieces.count;
	lines->capacity = pieces.capacity;
}

/* The label that runs along most of the piece. Votes go to the longest one met first among equals. */
static const char *name_of(
	const struct tile_line *line, const tile_name_array *names, const struct box_index *index, index_array *near)
{
	const char *best = NULL;
	double best_votes = 0.0;
	for (size_t j = 0; j + 1 < line->count; j++) {
		struct dvec2 a = tile_point(line->places[j]), b = tile_point(line->places[j + 1]);
		struct dvec2 along = dvec2_sub(b, a), middle = dvec2_scale(dvec2_add(a, b), 0.5);
		double length = dvec2_length(along), closest = LABEL_UNITS;
		const char *name = NULL;
		box_index_find(index, bounds_grown((struct bounds){ middle, middle }, LABEL_UNITS), near);
		for (size_t k = 0; k < near->count; k++) {
			const struct tile_name *label = &names->items[near->items[k]];
			struct dvec2 way = dvec2_sub(label->b, label->a);
			double t, away = distance(middle, label->a, label->b, &t);
			bool parallel = fabs(dvec2_cross(way, along)) < 0.25 * length * dvec2_length(way);
			if (parallel && away < closest) {
				closest = away;
				name = label->name;
			}
		}
		if (name && (best == name || length > best_votes)) {
			best_votes = best == name ? best_votes + length : length;
			best = name;
		}
	}
	return best;
}

static void add_name(struct tile_line *line, const char *name, struct osm_store *store)
{
	struct osm_tag *tags = POOL_ARRAY(&store->pool, struct osm_tag, line->tags.count + 1);
	memcpy(tags, line->tags.items, line->tags.count * sizeof(*tags));
	tags[line->tags.count] = (struct osm_tag){ osm_store_text(store, "name", 0), name };
	line->tags = (struct osm_tags){ tags, line->tags.count + 1 };
}

static void name_lines(tile_line_array *lines, const tile_name_array *names, struct osm_store *store)
{
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	for (size_t i = 0; i < names->count; i++) {
		struct dvec2 a = names->items[i].a, b = names->items[i].b;
		ARRAY_PUSH(&boxes, (struct bounds){ { fmin(a.x, b.x), fmin(a.y, b.y) }, { fmax(a.x, b.x), fmax(a.y, b.y) } });
	}
	box_index_build(&index, boxes.items, boxes.count, 200.0);
	for (size_t i = 0; i < lines->count; i++) {
		const char *name = lines->items[i].road ? name_of(&lines->items[i], names, &index, &near) : NULL;
		if (name)
			add_name(&lines->items[i], name, store);
	}
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&near);
}

void tile_lines_connect(tile_line_array *lines, const tile_name_array *names, struct osm_store *store)
{
	snap_border(lines, true);
	snap_border(lines, false);
	insert_junctions(lines, &store->pool);
	split(lines);
	name_lines(lines, names, store);
}
