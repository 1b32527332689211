#include "block_city.h"

#include "platform/base/rng.h"

static double draw(uint64_t *state, double from, double to)
{
	*state = hash_u64(*state + 1);
	return from + (to - from) * (double)(*state >> 11) / 9007199254740992.0;
}

struct building *block_city_house(struct city *city, struct dvec2 at, struct dvec2 size, double height_m, double roof_m)
{
	struct building house = {
		.id = (int64_t)city->buildings.count + 1,
		.kind = BUILDING_APARTMENTS,
		.kind_given = true,
		.outline = PKG_NONE,
		.height_m = height_m,
		.roof_shape = roof_m > 0.0 ? ROOF_GABLED : ROOF_FLAT,
		.roof_height_m = roof_m,
		.roof_direction_deg = NAN,
		.face = PKG_NONE,
	};
	struct dvec2 *corners = POOL_ARRAY(&city->pool, struct dvec2, 4);
	corners[0] = at;
	corners[1] = (struct dvec2){ at.x + size.x, at.y };
	corners[2] = (struct dvec2){ at.x + size.x, at.y + size.y };
	corners[3] = (struct dvec2){ at.x, at.y + size.y };
	house.footprint.outer = (struct ring){ corners, 4 };
	ARRAY_PUSH(&city->buildings, house);
	return &city->buildings.items[city->buildings.count - 1];
}

/* Two rows, back to back over a yard; some houses touch, some stand apart, some are open below. */
static void fill_block(struct city *city, struct dvec2 corner, uint64_t *state)
{
	for (int row = 0; row < 2; row++) {
		double y = corner.y + (row ? 26.0 : 6.0), depth = draw(state, 9.0, 12.0);
		for (double x = corner.x + 6.0; x < corner.x + 34.0;) {
			double width = draw(state, 7.0, 14.0), height = draw(state, 3.0, 20.0);
			double roof = draw(state, 0.0, 1.0) < 0.5 ? draw(state, 1.0, 0.4 * height) : 0.0;
			width = fmin(width, corner.x + 42.0 - x);
			struct building *house =
				block_city_house(city, (struct dvec2){ x, y }, (struct dvec2){ width, depth }, height, roof);
			if (draw(state, 0.0, 1.0) < 0.1)
				house->kind = BUILDING_ROOF;
			else if (draw(state, 0.0, 1.0) < 0.1)
				house->min_height_m = height * 0.4;
			x += width + (draw(state, 0.0, 1.0) < 0.5 ? 0.0 : draw(state, 0.5, 5.0));
		}
	}
}

/* The ground in squares, so that most of them can be hidden. */
static void lay_ground(struct mesh_sink *sink)
{
	const double step = 8.0, side = BLOCK_CITY_BLOCKS * BLOCK_CITY_PITCH_M;
	for (double y = 0.0; y < side; y += step)
		for (double x = 0.0; x < side; x += step) {
			mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_GROUND, .face = PKG_NONE });
			uint32_t corner[4];
			for (int i = 0; i < 4; i++) {
				struct mesh_vertex vertex = {
					.at = { x + (i == 1 || i == 2) * step, y + (i > 1) * step, 0.0 }, .normal = { 0, 0, 1 }, .ao = 1.0f
				};
				corner[i] = mesh_add_vertex(sink, &vertex);
			}
			mesh_add_triangle(sink, PKG_PASS_OPAQUE, corner[0], corner[1], corner[2]);
			mesh_add_triangle(sink, PKG_PASS_OPAQUE, corner[0], corner[2], corner[3]);
			mesh_end(sink);
		}
}

static void start(struct block_city *made)
{
	*made = (struct block_city){ .city = { .name = "blocks" } };
	made->city.report = &made->report;
}

void block_city_build(struct block_city *made)
{
	made->city.report = &made->report;
	made->city.max = (struct dvec2){ 1.0, 1.0 };
	struct mesh_sink *sink = mesh_sink_new();
	lay_ground(sink);
	buildings_build(&made->city, NULL, sink);
	mesh_finish_chunks(sink, &made->mesh);
	mesh_sink_free(sink);
	occluders_build(&made->city, &made->occluders);
	struct pkg *pkg = &made->pkg;
	pkg->meta = &made->meta;
	pkg->chunks = made->mesh.chunks.items;
	pkg->chunk_count = (uint32_t)made->mesh.chunks.count;
	pkg->objects = made->mesh.objects.items;
	pkg->object_count = (uint32_t)made->mesh.objects.count;
	pkg->geometry = made->mesh.geometry.items;
	pkg->geometry_bytes = made->mesh.geometry.count;
	pkg->occluders = made->occluders.walls.items;
	pkg->occluder_count = (uint32_t)made->occluders.walls.count;
	for (int axis = 0; axis < 3; axis++) {
		made->meta.min_mm[axis] = -100000;
		made->meta.max_mm[axis] = 400000;
	}
}

void block_city_make(struct block_city *made, uint64_t seed)
{
	start(made);
	uint64_t state = seed;
	for (int row = 0; row < BLOCK_CITY_BLOCKS; row++)
		for (int column = 0; column < BLOCK_CITY_BLOCKS; column++)
			fill_block(&made->city, (struct dvec2){ column * BLOCK_CITY_PITCH_M, row * BLOCK_CITY_PITCH_M }, &state);
	block_city_build(made);
}

void block_city_finish(struct block_city *made)
{
	mesh_chunks_finish(&made->mesh);
	occluders_finish(&made->occluders);
	city_finish(&made->city);
}
