/*
 * Walks the set's ranges; objects of a range that are seen, one after another, become one draw. A gap of unseen ones is
 * drawn along when another draw would cost more. Cost: a box test for each object of the chunks in view.
 */
#include "render/cell_emit.h"

#include <float.h>

#include "render/camera.h"

#define GAP_MIN_INDICES 192 /* 64 triangles: about what a draw costs, on a CPU as on a GPU */

/* A draw in the making, in one slice. */
struct piece {
	uint32_t first, end; /* nothing when equal */
	float nearest_m;
};

struct emitter {
	const struct draw_set *set;
	const struct near_mesh *mesh;
	const struct fade *fade;
	const struct view *view;
	struct draw_list *list;
	struct cell_emitted *out;
	struct draw_item item;
	struct piece pieces[VIEW_SLICE_COUNT];
};

static void flush(struct emitter *emitter, int slice)
{
	struct piece *piece = &emitter->pieces[slice];
	emitter->item.slice = (uint8_t)slice;
	emitter->item.first = piece->first;
	emitter->item.count = piece->end - piece->first;
	emitter->item.opacity = 255;
	draw_list_add(emitter->list, &emitter->item, piece->nearest_m);
	*piece = (struct piece){ 0, 0, FLT_MAX };
}

static void extend(struct emitter *emitter, int slice, const struct cell_part *part, float nearest_m)
{
	struct piece *piece = &emitter->pieces[slice];
	if (piece->end > piece->first && part->first - piece->end >= GAP_MIN_INDICES)
		flush(emitter, slice);
	if (piece->end == piece->first)
		piece->first = part->first;
	piece->end = part->first + part->count;
	piece->nearest_m = nearest_m < piece->nearest_m ? nearest_m : piece->nearest_m;
}

static const struct fade_entry *fading(const struct fade *fade, uint32_t object)
{
	for (uint32_t i = 0; fade && i < fade->count; i++)
		if (fade->entries[i].object == object)
			return &fade->entries[i];
	return NULL;
}

static void emit_faded(struct emitter *emitter, int slice, const struct cell_part *part, float opacity, float nearest_m)
{
	flush(emitter, slice);
	emitter->item.first = part->first;
	emitter->item.count = part->count;
	emitter->item.opacity = (uint8_t)(opacity * 254.0f);
	draw_list_add(emitter->list, &emitter->item, nearest_m);
}

static void emit_part(struct emitter *emitter, const struct cell_part *part)
{
	const struct pkg_object *object = &emitter->mesh->pkg->objects[part->object];
	struct vec3 min, max;
	float nearest, farthest;
	view_box(emitter->view, object->min_mm, object->max_mm, &min, &max);
	if (!view_sees_box(emitter->view, min, max))
		return;
	view_box_depth(emitter->view, min, max, &nearest, &farthest);
	const struct fade_entry *entry = fading(emitter->fade, part->object);
	for (int slice = 0; slice < VIEW_SLICE_COUNT; slice++) {
		if (nearest > emitter->view->slice[slice].far_m || farthest < emitter->view->slice[slice].near_m)
			continue;
		if (entry)
			emit_faded(emitter, slice, part, entry->opacity, nearest);
		else
			extend(emitter, slice, part, nearest);
	}
	emitter->out->triangles += part->count / 3;
}

static bool chunk_in_view(const struct emitter *emitter, uint32_t id)
{
	const struct pkg_chunk *chunk = &emitter->mesh->pkg->chunks[id];
	struct vec3 min, max;
	view_box(emitter->view, chunk->min_mm, chunk->max_mm, &min, &max);
	return view_sees_box(emitter->view, min, max);
}

static void emit_range(struct emitter *emitter, uint32_t index)
{
	const struct cell_set *cells = emitter->set->cells;
	const struct cell_range *range = &cells->ranges[index];
	emitter->item = (struct draw_item){
		.set = emitter->set, .range = index, .chunk = range->chunk, .pass = range->pass, .look = range->look
	};
	for (uint32_t i = 0; i < range->part_count; i++)
		emit_part(emitter, &cells->parts[range->first_part + i]);
	for (int slice = 0; slice < VIEW_SLICE_COUNT; slice++)
		flush(emitter, slice);
}

struct cell_emitted cell_emit(const struct draw_set *set, const struct near_mesh *mesh, const struct fade *fade,
	const struct view *view, struct draw_list *list)
{
	struct cell_emitted out = { 0 };
	struct emitter emitter = { .set = set, .mesh = mesh, .fade = fade, .view = view, .list = list, .out = &out };
	for (int slice = 0; slice < VIEW_SLICE_COUNT; slice++)
		emitter.pieces[slice].nearest_m = FLT_MAX;
	const struct cell_set *cells = set->cells;
	uint32_t chunk = PKG_NONE;
	bool seen = false;
	for (uint32_t i = 0; i < cells->range_count; i++) {
		if (cells->ranges[i].chunk != chunk) {
			chunk = cells->ranges[i].chunk;
			seen = chunk_in_view(&emitter, chunk);
			if (seen && !set->vertices.id && !near_mesh_has(mesh, chunk)) {
				seen = false;
				out.missing++;
			}
		}
		if (seen)
			emit_range(&emitter, i);
	}
	return out;
}
