/* Rings from the outermost inwards: without depths of its own, what is nearer must come later. */
#include "render/backdrop.h"

#include <math.h>

#define SEGMENTS 32
#define VERTICES (RINGS * SEGMENTS)
#define INDICES ((RINGS - 1) * SEGMENTS * 6)
#define UNDER_M 1.5f /* below the eye, at least right around it */

static const float radius_m[] = { 12000.0f, 5000.0f, 2500.0f, 1400.0f, 800.0f, 450.0f, 240.0f, 120.0f, 50.0f, 15.0f,
	0.5f };
#define RINGS ((int)(sizeof(radius_m) / sizeof(radius_m[0])))

static int make_buffers(struct backdrop *backdrop)
{
	static uint16_t indices[INDICES];
	uint32_t count = 0;
	for (int ring = 0; ring + 1 < RINGS; ring++) {
		for (int i = 0; i < SEGMENTS; i++) {
			uint16_t a = (uint16_t)(ring * SEGMENTS + i), b = (uint16_t)(ring * SEGMENTS + (i + 1) % SEGMENTS);
			const uint16_t quad[6] = { a, b, (uint16_t)(a + SEGMENTS), (uint16_t)(a + SEGMENTS), b,
				(uint16_t)(b + SEGMENTS) };
			for (int k = 0; k < 6; k++)
				indices[count++] = quad[k];
		}
	}
	struct gfx_buffer_desc index_desc = { .kind = GFX_BUFFER_INDEX, .bytes = sizeof(indices), .data = indices };
	struct gfx_buffer_desc vertex_desc = {
		.kind = GFX_BUFFER_VERTEX, .usage = GFX_STREAM, .bytes = VERTICES * (uint32_t)sizeof(struct vec3)
	};
	int err = gfx_buffer_create(backdrop->gfx, &index_desc, &backdrop->indices);
	return err ? err : gfx_buffer_create(backdrop->gfx, &vertex_desc, &backdrop->vertices);
}

int backdrop_init(struct backdrop *backdrop, struct gfx *gfx, const struct pkg *pkg)
{
	*backdrop = (struct backdrop){ .gfx = gfx, .pkg = pkg };
	struct gfx_program_desc program = { .vertex = "backdrop.vert", .fragment = "backdrop.frag", .blocks = { "Frame" } };
	int err = gfx_program_create(gfx, &program, &backdrop->program);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = { .program = backdrop->program,
		.stride = sizeof(struct vec3),
		.attribute_count = 1,
		.attributes = { { GFX_F32X3, 0 } },
		.index = GFX_INDEX_U16,
		.depth = GFX_DEPTH_TEST };
	err = gfx_pipeline_create(gfx, &pipeline, &backdrop->pipeline);
	return err ? err : make_buffers(backdrop);
}

void backdrop_finish(struct backdrop *backdrop)
{
	if (!backdrop->gfx)
		return;
	gfx_buffer_destroy(backdrop->gfx, backdrop->vertices);
	gfx_buffer_destroy(backdrop->gfx, backdrop->indices);
	gfx_pipeline_destroy(backdrop->gfx, backdrop->pipeline);
	gfx_program_destroy(backdrop->gfx, backdrop->program);
	*backdrop = (struct backdrop){ 0 };
}

static float height_m(const struct backdrop *backdrop, const struct view *view, float east_m, float north_m)
{
	int64_t east = view->eye_mm[0] + (int64_t)(east_m * 1000.0f),
			north = view->eye_mm[1] + (int64_t)(north_m * 1000.0f);
	return (float)((double)(pkg_ground_mm(backdrop->pkg, east, north) - view->eye_mm[2]) * 1e-3);
}

void backdrop_update(const struct backdrop *backdrop, const struct view *view)
{
	struct vec3 vertices[VERTICES];
	/* in a tunnel the land is overhead: a floor does */
	bool under = height_m(backdrop, view, 0.0f, 0.0f) > 0.0f;
	for (int ring = 0; ring < RINGS; ring++) {
		for (int i = 0; i < SEGMENTS; i++) {
			float angle = (float)i * (float)(2.0 * 3.14159265358979323846 / SEGMENTS);
			float x = radius_m[ring] * cosf(angle), y = radius_m[ring] * sinf(angle);
			float z = under ? -UNDER_M : height_m(backdrop, view, x, y);
			vertices[ring * SEGMENTS + i] = (struct vec3){ x, y, radius_m[ring] < 100.0f ? fminf(z, -UNDER_M) : z };
		}
	}
	gfx_buffer_write(backdrop->gfx, backdrop->vertices, 0, vertices, sizeof(vertices));
}

void backdrop_draw(const struct backdrop *backdrop, const struct view *view, gfx_buffer frame_block)
{
	struct gfx_draw draw = {
		.pipeline = backdrop->pipeline,
		.vertices = backdrop->vertices,
		.indices = backdrop->indices,
		.count = INDICES,
		.blocks = { frame_block },
		.constants = view->slice[VIEW_FAR].clip_from_eye.m,
		.constant_count = 4,
	};
	gfx_depth_range(backdrop->gfx, 0.0f, 1.0f);
	gfx_draw(backdrop->gfx, &draw);
}
