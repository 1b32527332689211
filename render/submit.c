#include "render/submit.h"

#include <string.h>

#include "render/surfaces.h"

/* u_draw of city.vert. */
struct city_constants {
	float origin_mm[3], opacity;
	struct mat4 clip_from_mm;
	float light_map[4];
};
static_assert(sizeof(struct city_constants) == 6 * 4 * sizeof(float), "u_draw[6]");

static struct mat4 from_mm(const struct mat4 *from_m)
{
	struct mat4 out = *from_m;
	for (int i = 0; i < 12; i++)
		out.m[i] *= 0.001f;
	return out;
}

static void set_origin(struct city_constants *constants, const struct view *view, const struct pkg_chunk *chunk)
{
	for (int axis = 0; axis < 3; axis++)
		constants->origin_mm[axis] = (float)(chunk->origin_mm[axis] - view->eye_mm[axis]);
}

void submit_geometry(struct gfx_draw *draw, const struct near_mesh *mesh, const struct draw_item *item)
{
	const struct residency_chunk *place = &mesh->residency.chunks[item->chunk];
	const struct draw_set *set = item->set;
	bool own = set && set->vertices.id;
	uint32_t vertex = own ? set->first_vertex + set->cells->ranges[item->range].first_vertex : place->first_vertex;
	draw->vertices = own ? set->vertices : mesh->vertices;
	draw->vertex_offset = vertex * (uint32_t)sizeof(struct pkg_mesh_vertex);
	draw->indices = set ? set->indices : mesh->indices;
	draw->first = (set ? set->first_index : place->first_index) + item->first;
	draw->count = item->count;
}

struct range {
	uint32_t first, end;
	bool invisible; /* writes depth alone */
};

static void submit(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block, struct range range)
{
	struct city_constants constants = { 0 };
	surfaces_light_map_frame(mesh->pkg, view->eye_mm, constants.light_map);
	struct gfx_draw draw = {
		.textures = { mesh->textures, mesh->light_map },
		.blocks = { frame_block, mesh->materials },
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	int slice = -1;
	for (uint32_t i = range.first; i < range.end; i++) {
		const struct draw_item *item = &list->items[i];
		if (item->slice != slice) {
			slice = item->slice;
			gfx_depth_range(gfx, view->slice[slice].depth_near, view->slice[slice].depth_far);
			constants.clip_from_mm = from_mm(&view->slice[slice].clip_from_eye);
		}
		set_origin(&constants, view, &mesh->pkg->chunks[item->chunk]);
		constants.opacity = range.invisible ? 0.0f : item->opacity * (1.0f / 255.0f);
		int style = (item->opacity < 255 ? MESH_FADED : 0) | (mesh->lit ? MESH_LIT : 0);
		draw.pipeline = mesh->pipelines[item->look][item->pass][style];
		submit_geometry(&draw, mesh, item);
		gfx_draw(gfx, &draw);
	}
}

void submit_solid(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block)
{
	submit(gfx, mesh, view, list, frame_block, (struct range){ 0, list->solid_count, false });
}

void submit_faded(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block)
{
	submit(gfx, mesh, view, list, frame_block, (struct range){ list->solid_count, list->count, true });
	submit(gfx, mesh, view, list, frame_block, (struct range){ list->solid_count, list->count, false });
}
