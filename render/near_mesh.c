/* Uploads of geometry, materials, textures and the light map; emission of chunk draws. */
#include "render/near_mesh.h"

#include <errno.h>

#include "platform/base/log.h"
#include "render/camera.h"
#include "render/surfaces.h"

#define GAP_MIN_INDICES 192 /* 64 triangles: about what a draw costs, on a CPU as on a GPU */
#define CLOSE_M 200.0       /* around the eye: cameras keep out of walls there, what hides the route fades */
#define ROOM_TO_CUT 2048    /* draws left in the list, below which chunks are drawn whole */

static const struct gfx_attribute vertex_layout[] = {
	{ GFX_I32X3, offsetof(struct pkg_mesh_vertex, pos_mm) },
	{ GFX_I8X2_SNORM, offsetof(struct pkg_mesh_vertex, normal_oct) },
	{ GFX_U8X2, offsetof(struct pkg_mesh_vertex, ao) },
	{ GFX_U16X2, offsetof(struct pkg_mesh_vertex, uv) },
	{ GFX_U8X4_UNORM, offsetof(struct pkg_mesh_vertex, rgb) },
};
static_assert(offsetof(struct pkg_mesh_vertex, seed) == offsetof(struct pkg_mesh_vertex, rgb) + 3, "one attribute");
static_assert(offsetof(struct pkg_mesh_vertex, material) == offsetof(struct pkg_mesh_vertex, ao) + 1, "one attribute");

#define WALL "#define HAS_WALL 1\n"
#define GROUND "#define HAS_GROUND 1\n"
#define WATER "#define HAS_WATER 1\n"
#define FADE "#define FADE 1\n"
#define LIT "#define LIT 1\n"
#define STYLES(look)                                                                                                   \
	{                                                                                                                  \
		look, look FADE, look LIT, look FADE LIT                                                                       \
	}
static const char *const look_defines[LOOK_COUNT][MESH_STYLES] = {
	[LOOK_PLAIN] = STYLES(""),
	[LOOK_WALLS] = STYLES(WALL),
	[LOOK_GROUND] = STYLES(GROUND),
	[LOOK_WATER] = STYLES(WATER),
	[LOOK_ALL] = STYLES(WALL GROUND WATER),
};

static int make_program(struct near_mesh *mesh, enum city_look look, int style)
{
	struct gfx_program_desc desc = {
		.vertex = "city.vert",
		.fragment = "city.frag",
		.defines = look_defines[look][style],
		.textures = { "u_textures", "u_light_map" },
		.blocks = { "Frame", "Materials" },
	};
	return gfx_program_create(mesh->gfx, &desc, &mesh->programs[look][style]);
}

static int make_pipeline(struct near_mesh *mesh, enum city_look look, enum pkg_pass pass, int style)
{
	bool decal = pass == PKG_PASS_DECAL;
	struct gfx_pipeline_desc desc = {
		.program = mesh->programs[look][style],
		.stride = sizeof(struct pkg_mesh_vertex),
		.attribute_count = sizeof(vertex_layout) / sizeof(vertex_layout[0]),
		.index = GFX_INDEX_U16,
		.blend = decal || style & MESH_FADED ? GFX_BLEND : GFX_OPAQUE,
		.depth = decal ? GFX_DEPTH_TEST : GFX_DEPTH_TEST_WRITE,
		.cull_back = true,
		.offset_factor = decal ? -1.0f : 0.0f,
		.offset_units = decal ? -16.0f : 0.0f,
	};
	for (uint32_t i = 0; i < desc.attribute_count; i++)
		desc.attributes[i] = vertex_layout[i];
	return gfx_pipeline_create(mesh->gfx, &desc, &mesh->pipelines[look][pass][style]);
}

static int make_pipelines(struct near_mesh *mesh)
{
	int err = 0;
	for (int look = 0; look < LOOK_COUNT; look++) {
		for (int style = 0; style < MESH_STYLES && !err; style++) {
			err = make_program(mesh, (enum city_look)look, style);
			for (int pass = 0; pass < PKG_PASS_COUNT && !err; pass++)
				err = make_pipeline(mesh, (enum city_look)look, (enum pkg_pass)pass, style);
		}
	}
	return err;
}

/* Pools of the whole city, else of what is wanted at once, else of what is left in proportion to that. */
static int make_pools(
	struct near_mesh *mesh, struct arena *arena, uint64_t left_bytes, const struct resident_need *need)
{
	const uint64_t vertex_bytes = sizeof(struct pkg_mesh_vertex), limit = UINT32_MAX;
	uint64_t vertices, indices;
	residency_totals(mesh->pkg, &vertices, &indices);
	uint64_t wanted = vertices * vertex_bytes + indices * 2;
	if (wanted > left_bytes && need) {
		vertices = need->vertices;
		indices = need->indices;
		wanted = need->geometry;
	}
	if (wanted > left_bytes && wanted) {
		double share = (double)left_bytes / (double)wanted;
		vertices = (uint64_t)((double)vertices * share);
		indices = (uint64_t)((double)indices * share);
		log_info("%.0f MiB of geometry are wanted, there is room for %.0f MiB at a time", (double)wanted / 1048576.0,
			(double)left_bytes / 1048576.0);
	}
	if (vertices > limit / vertex_bytes)
		vertices = limit / vertex_bytes;
	if (indices > limit / 2)
		indices = limit / 2;
	struct gfx_buffer_desc vertex_pool = { .kind = GFX_BUFFER_VERTEX, .bytes = (uint32_t)(vertices * vertex_bytes) };
	struct gfx_buffer_desc index_pool = { .kind = GFX_BUFFER_INDEX, .bytes = (uint32_t)(indices * 2) };
	vertex_pool.bytes = vertex_pool.bytes ? vertex_pool.bytes : (uint32_t)vertex_bytes;
	index_pool.bytes = index_pool.bytes ? index_pool.bytes : 2;
	int err = gfx_buffer_create(mesh->gfx, &vertex_pool, &mesh->vertices);
	if (!err)
		err = gfx_buffer_create(mesh->gfx, &index_pool, &mesh->indices);
	if (!err)
		err = residency_init(&mesh->residency, arena, mesh->pkg, (uint32_t)vertices, (uint32_t)indices);
	return err;
}

/* Room for one run per object and pass, and one per pass for chunks whose objects do not add up. */
static uint32_t runs_of(const struct pkg_chunk *chunk)
{
	return (chunk->object_count + 1) * PKG_PASS_COUNT;
}

uint64_t near_mesh_arena_bytes(const struct pkg *pkg)
{
	uint64_t runs = 0;
	for (uint32_t i = 0; i < pkg->chunk_count; i++)
		runs += runs_of(&pkg->chunks[i]);
	return runs * sizeof(struct mesh_run) + (uint64_t)pkg->chunk_count * (2 * sizeof(uint32_t) + sizeof(uint8_t)) +
		   residency_arena_bytes(pkg);
}

static int make_runs(struct near_mesh *mesh, struct arena *arena)
{
	uint32_t chunks = mesh->pkg->chunk_count, sum = 0;
	mesh->first_run = ARENA_ARRAY(arena, uint32_t, chunks);
	mesh->run_count = ARENA_ARRAY(arena, uint32_t, chunks);
	mesh->textured = ARENA_ARRAY(arena, uint8_t, chunks);
	if (!mesh->first_run || !mesh->run_count || !mesh->textured)
		return -ENOMEM;
	for (uint32_t i = 0; i < chunks; i++) {
		mesh->first_run[i] = sum;
		sum += runs_of(&mesh->pkg->chunks[i]);
	}
	mesh->runs = ARENA_ARRAY(arena, struct mesh_run, sum);
	return mesh->runs ? 0 : -ENOMEM;
}

int near_mesh_init(struct near_mesh *mesh, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	uint64_t budget_bytes, const struct resident_need *need)
{
	double reach_m = need ? need->reach_m : 0.0;
	*mesh = (struct near_mesh){ .gfx = gfx, .pkg = pkg, .close_m = reach_m > CLOSE_M ? reach_m : CLOSE_M };
	int err = make_pipelines(mesh);
	if (!err)
		err = surfaces_make(gfx, pkg, &mesh->materials, &mesh->textures);
	if (!err)
		err = light_tiles_make(gfx, pkg, &mesh->light, &mesh->light_map);
	if (!err)
		err = make_runs(mesh, arena);
	if (err)
		return err;
	uint64_t used = gfx_stats(gfx)->bytes;
	if (used >= budget_bytes) {
		log_error("memory budget of %.0f MiB for the GPU: %.0f MiB are needed before any geometry",
			(double)budget_bytes / 1048576.0, (double)used / 1048576.0);
		return -ENOMEM;
	}
	return make_pools(mesh, arena, budget_bytes - used, need);
}

void near_mesh_finish(struct near_mesh *mesh)
{
	if (!mesh->gfx)
		return;
	for (int look = 0; look < LOOK_COUNT; look++) {
		for (int style = 0; style < MESH_STYLES; style++) {
			for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
				gfx_pipeline_destroy(mesh->gfx, mesh->pipelines[look][pass][style]);
			gfx_program_destroy(mesh->gfx, mesh->programs[look][style]);
		}
	}
	gfx_texture_destroy(mesh->gfx, mesh->light_map);
	gfx_texture_destroy(mesh->gfx, mesh->textures);
	gfx_buffer_destroy(mesh->gfx, mesh->materials);
	gfx_buffer_destroy(mesh->gfx, mesh->indices);
	gfx_buffer_destroy(mesh->gfx, mesh->vertices);
	*mesh = (struct near_mesh){ 0 };
}

uint8_t near_mesh_look_of(uint32_t kinds)
{
	const uint32_t walls = 1u << PKG_MATERIAL_WALL | 1u << PKG_MATERIAL_SHOP, water = 1u << PKG_MATERIAL_WATER;
	const uint32_t ground = 1u << PKG_MATERIAL_GROUND | 1u << PKG_MATERIAL_MARKING | 1u << PKG_MATERIAL_LAMP;
	int families = ((kinds & walls) != 0) + ((kinds & ground) != 0) + ((kinds & water) != 0);
	if (families > 1)
		return LOOK_ALL;
	return kinds & walls ? LOOK_WALLS : kinds & ground ? LOOK_GROUND : kinds & water ? LOOK_WATER : LOOK_PLAIN;
}

static uint8_t look_of_range(const struct near_mesh *mesh, uint32_t id, uint32_t first, uint32_t count)
{
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[id];
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(mesh->pkg, chunk);
	const uint16_t *indices = pkg_chunk_indices(mesh->pkg, chunk) + first;
	uint32_t kinds = 0;
	for (uint32_t i = 0; i < count; i++)
		kinds |= 1u << mesh->pkg->materials[vertices[indices[i]].material].kind;
	return near_mesh_look_of(kinds);
}

static void add_run(struct near_mesh *mesh, uint32_t id, const struct mesh_run *run)
{
	struct mesh_run *runs = mesh->runs + mesh->first_run[id];
	uint32_t *count = &mesh->run_count[id];
	struct mesh_run *last = *count ? &runs[*count - 1] : NULL;
	if (!run->count)
		return;
	if (last && last->look == run->look && last->pass == run->pass && last->first + last->count == run->first)
		last->count += run->count;
	else
		runs[(*count)++] = *run;
}

/* Objects of a chunk follow one another in each pass; neighbours that are shaded alike become one run. */
static void find_runs(struct near_mesh *mesh, uint32_t id)
{
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[id];
	uint32_t first = 0;
	mesh->run_count[id] = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		uint32_t before = mesh->run_count[id], at = first, end = first + chunk->index_count[pass];
		for (uint32_t i = 0; i < chunk->object_count; i++) {
			const struct pkg_object *object = &mesh->pkg->objects[chunk->first_object + i];
			struct mesh_run run = {
				.first = object->first_index[pass], .count = object->index_count[pass], .pass = (uint8_t)pass
			};
			if (!run.count || run.first != at)
				continue;
			run.look = look_of_range(mesh, id, run.first, run.count);
			add_run(mesh, id, &run);
			at += run.count;
		}
		if (at != end) { /* triangles of no object: one run for all */
			mesh->run_count[id] = before;
			struct mesh_run all = { .first = first, .count = end - first, .look = LOOK_ALL, .pass = (uint8_t)pass };
			add_run(mesh, id, &all);
		}
		first = end;
	}
}

static void need_layers(struct near_mesh *mesh, const struct pkg_mesh_vertex *vertices, uint32_t count)
{
	uint32_t wanted[256 / 32] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		wanted[vertices[i].material / 32] |= 1u << vertices[i].material % 32;
	surfaces_load(mesh->gfx, mesh->pkg, mesh->textures, &mesh->layers, wanted);
}

void near_mesh_need(struct near_mesh *mesh, const struct pkg_mesh_vertex *vertices, uint32_t count)
{
	need_layers(mesh, vertices, count);
	mesh->light_far = true;
}

void near_mesh_load_textures(struct near_mesh *mesh)
{
	mesh->textures_complete =
		mesh->textures_complete || (!surfaces_load_next(mesh->gfx, mesh->pkg, mesh->textures, &mesh->layers) &&
									   !light_tiles_load_next(mesh->gfx, mesh->pkg, mesh->light_map, &mesh->light));
}

static void upload(void *context, uint32_t id, const struct residency_chunk *place)
{
	struct near_mesh *mesh = context;
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[id];
	const uint32_t vertex_bytes = sizeof(struct pkg_mesh_vertex);
	find_runs(mesh, id);
	gfx_buffer_write(mesh->gfx, mesh->vertices, place->first_vertex * vertex_bytes,
		pkg_chunk_vertices(mesh->pkg, chunk), chunk->vertex_count * vertex_bytes);
	gfx_buffer_write(
		mesh->gfx, mesh->indices, place->first_index * 2, pkg_chunk_indices(mesh->pkg, chunk), place->index_count * 2);
}

void near_mesh_load(struct near_mesh *mesh, const int64_t eye_mm[3], double far_m, uint64_t slice_bytes)
{
	residency_update(&mesh->residency, eye_mm, (int64_t)(far_m * 1000.0), slice_bytes, upload, mesh);
}

bool near_mesh_has(const struct near_mesh *mesh, uint32_t chunk)
{
	return mesh->residency.chunks[chunk].state == RESIDENCY_PRESENT;
}

static void load_seen(struct near_mesh *mesh, uint32_t id, bool seen, bool close)
{
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[id];
	if (mesh->residency.whole && (seen || close))
		residency_load_now(&mesh->residency, id, upload, mesh);
	if (!seen || mesh->textured[id] || !near_mesh_has(mesh, id))
		return;
	mesh->textured[id] = 1;
	need_layers(mesh, pkg_chunk_vertices(mesh->pkg, chunk), chunk->vertex_count);
	light_tiles_load_box(mesh->gfx, mesh->pkg, mesh->light_map, &mesh->light, chunk->min_mm, chunk->max_mm);
}

/* What chunks do not tell of lies somewhere between the lowest and the highest of the city. */
static void load_light_seen(struct near_mesh *mesh, const struct view *view)
{
	const struct pkg_meta *meta = mesh->pkg->meta;
	for (uint32_t tile = 0; tile < mesh->light.columns * mesh->light.rows; tile++) {
		int32_t min_mm[3] = { 0, 0, meta->min_mm[2] }, max_mm[3] = { 0, 0, meta->max_mm[2] };
		struct vec3 min, max;
		light_tiles_bounds(&mesh->light, mesh->pkg, tile, min_mm, max_mm);
		view_box(view, min_mm, max_mm, &min, &max);
		if (view_sees_box(view, min, max))
			light_tiles_load(mesh->gfx, mesh->pkg, mesh->light_map, &mesh->light, tile);
	}
}

void near_mesh_load_seen(struct near_mesh *mesh, const struct view *view, double far_m)
{
	if (mesh->textures_complete && (!mesh->residency.whole || residency_complete(&mesh->residency)))
		return;
	for (uint32_t i = 0; i < mesh->pkg->chunk_count; i++) {
		struct vec3 min, max;
		if (mesh->textured[i] && mesh->residency.chunks[i].state != RESIDENCY_ABSENT)
			continue;
		view_box(view, mesh->pkg->chunks[i].min_mm, mesh->pkg->chunks[i].max_mm, &min, &max);
		double away_m = view_box_distance_m(min, max);
		load_seen(mesh, i, away_m <= far_m && view_sees_box(view, min, max), away_m <= mesh->close_m);
	}
	if (mesh->light_far)
		load_light_seen(mesh, view);
}

static void emit_piece(struct draw_list *list, struct draw_item *item, uint32_t first, uint32_t end, float depth_m)
{
	item->first = first;
	item->count = end - first;
	draw_list_add(list, item, depth_m);
}

/* The fading object of the chunk that begins first within [at, end) of the pass, or NULL. */
static const struct fade_entry *next_fading(
	const struct near_mesh *mesh, const struct fade *fade, uint32_t chunk, int pass, uint32_t at, uint32_t end)
{
	const struct fade_entry *best = NULL;
	uint32_t best_first = end;
	for (uint32_t i = 0; fade && i < fade->count; i++) {
		const struct pkg_object *object = &mesh->pkg->objects[fade->entries[i].object];
		if (object->chunk != chunk || !object->index_count[pass])
			continue;
		if (object->first_index[pass] >= at && object->first_index[pass] < best_first) {
			best = &fade->entries[i];
			best_first = object->first_index[pass];
		}
	}
	return best;
}

/* Draws [at, end) of a run; what fades in it becomes draws of its own. */
static void emit_range(const struct near_mesh *mesh, const struct fade *fade, struct draw_list *list,
	struct draw_item item, uint32_t at, uint32_t end, float depth_m)
{
	while (at < end) {
		const struct fade_entry *entry = next_fading(mesh, fade, item.chunk, item.pass, at, end);
		const struct pkg_object *object = entry ? &mesh->pkg->objects[entry->object] : NULL;
		uint32_t stop = object ? object->first_index[item.pass] : end;
		item.opacity = 255;
		emit_piece(list, &item, at, stop, depth_m);
		at = stop;
		if (object) {
			at += object->index_count[item.pass];
			item.opacity = (uint8_t)(entry->opacity * 254.0f);
			emit_piece(list, &item, stop, at, depth_m);
		}
	}
}

static bool object_seen(const struct view *view, const struct pkg_object *object, int slice)
{
	struct vec3 min, max;
	float nearest, farthest;
	view_box(view, object->min_mm, object->max_mm, &min, &max);
	if (!view_sees_box(view, min, max))
		return false;
	view_box_depth(view, min, max, &nearest, &farthest);
	return nearest <= view->slice[slice].far_m && farthest >= view->slice[slice].near_m;
}

/* A stretch of unseen objects is left out when that saves more than another draw costs. Indices of no object stay. */
static void emit_seen(const struct near_mesh *mesh, const struct fade *fade, struct draw_list *list,
	const struct view *view, const struct draw_item *item, uint32_t first, uint32_t end, float depth_m)
{
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[item->chunk];
	uint32_t at = first, gap = first, gap_end = first;
	for (uint32_t i = 0; i <= chunk->object_count; i++) {
		const struct pkg_object *object = NULL;
		if (i < chunk->object_count) {
			object = &mesh->pkg->objects[chunk->first_object + i];
			uint32_t from = object->first_index[item->pass], count = object->index_count[item->pass];
			bool inside = count && from >= gap_end && from + count <= end;
			if (!inside || object_seen(view, object, item->slice))
				continue;
			if (from == gap_end) {
				gap_end += count;
				continue;
			}
		}
		if (gap_end - gap >= GAP_MIN_INDICES) {
			emit_range(mesh, fade, list, *item, at, gap, depth_m);
			at = gap_end;
		}
		if (object) {
			gap = object->first_index[item->pass];
			gap_end = gap + object->index_count[item->pass];
		}
	}
	emit_range(mesh, fade, list, *item, at, end, depth_m);
}

void near_mesh_emit(const struct near_mesh *mesh, const struct fade *fade, struct draw_list *list,
	const struct view *view, uint32_t chunk, enum view_slice_id slice, float depth_m)
{
	const struct mesh_run *runs = mesh->runs + mesh->first_run[chunk];
	bool room = list->count + ROOM_TO_CUT < list->capacity;
	for (uint32_t i = 0; i < mesh->run_count[chunk]; i++) {
		struct draw_item item = { .chunk = chunk, .slice = (uint8_t)slice, .pass = runs[i].pass, .look = runs[i].look };
		uint32_t first = runs[i].first, end = first + runs[i].count;
		if (view && room && runs[i].count >= GAP_MIN_INDICES)
			emit_seen(mesh, fade, list, view, &item, first, end, depth_m);
		else
			emit_range(mesh, fade, list, item, first, end, depth_m);
	}
}
