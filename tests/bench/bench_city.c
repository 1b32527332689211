/* The package as arrays, the driver's eye, and boulevard's frames, each with its own context only while it draws. */
#include "tests/bench/bench_city.h"

#include <EGL/egl.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "assets/pkg.h"
#include "board/png_write.h"
#include "platform/base/clock.h"
#include "platform/display/display.h"
#include "render/frame.h"

#define ARENA_BYTES ((size_t)64 << 20)
#define FOV_DEG 45.0

struct bench_city {
	struct bench_options options;
	struct pkg pkg;
	struct display display;
	struct arena arena;
	void *memory;
	struct renderer *renderer;
	struct nav_view nav;
	struct renderer_time time;
	EGLDisplay egl_display;
	EGLContext egl_context;
	uint8_t *pixels;
};

static void place_car(struct bench_city *city)
{
	const struct bench_options *o = &city->options;
	int64_t east = llrint(o->east_m * 1e3), north = llrint(o->north_m * 1e3);
	city->time = (struct renderer_time){ .time_ns = NS_PER_S, .ambient = -1.0 };
	city->nav = (struct nav_view){ .located = true,
		.time_ns = NS_PER_S,
		.heading_bam = bam_from_rad(o->heading_deg * (BLVD_PI / 180.0)),
		.half = PKG_NONE,
		.pos_mm = { east, north, pkg_ground_mm(&city->pkg, east, north) + 1400 } };
}

static bool start_renderer(struct bench_city *city)
{
	const struct bench_options *o = &city->options;
	struct display_config display = { .width = o->width, .height = o->height };
	if (display_open(&city->display, &display_surfaceless, &display))
		return false;
	struct renderer_config config = {
		.width = o->width, .height = o->height, .samples = o->samples, .fov_deg = FOV_DEG, .get_proc = display_get_proc
	};
	arena_init(&city->arena, "bench", city->memory, ARENA_BYTES);
	if (renderer_init(&city->renderer, &city->arena, &config, &city->pkg))
		return false;
	renderer_camera(city->renderer)->kind = CAMERA_DRIVER;
	city->egl_display = eglGetCurrentDisplay();
	city->egl_context = eglGetCurrentContext();
	bench_boulevard_frame(city); /* compiles, uploads */
	return true;
}

struct bench_city *bench_open(const struct bench_options *options)
{
	struct bench_city *city = calloc(1, sizeof(*city));
	if (!city)
		return NULL;
	city->options = *options;
	city->memory = malloc(ARENA_BYTES);
	city->pixels = malloc((size_t)options->width * options->height * 4);
	struct pkg_fault fault = { 0 };
	int err = pkg_open(&city->pkg, options->package, &fault);
	if (err)
		fprintf(stderr, "%s: %s\n", options->package, err == -EBADMSG ? fault.text : strerror(-err));
	if (err || !city->memory || !city->pixels)
		goto fail;
	place_car(city);
	if (start_renderer(city))
		return city;
fail:
	free(city->pixels);
	free(city->memory);
	free(city);
	return NULL;
}

void bench_close(struct bench_city *city)
{
	eglMakeCurrent(city->egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, city->egl_context);
	renderer_finish(city->renderer);
	display_close(&city->display);
	pkg_close(&city->pkg);
	free(city->pixels);
	free(city->memory);
	free(city);
}

uint32_t bench_chunk_count(const struct bench_city *city)
{
	return city->pkg.chunk_count;
}

static float sign_of(float x)
{
	return x < 0.0f ? -1.0f : 1.0f;
}

static void unpack_normal(const int8_t oct[2], float out[3])
{
	float x = (float)oct[0] / 127.0f, y = (float)oct[1] / 127.0f, z = 1.0f - fabsf(x) - fabsf(y);
	float fold_x = z < 0.0f ? (1.0f - fabsf(y)) * sign_of(x) : x,
		  fold_y = z < 0.0f ? (1.0f - fabsf(x)) * sign_of(y) : y;
	float length = sqrtf(fold_x * fold_x + fold_y * fold_y + z * z);
	out[0] = fold_x / length;
	out[1] = fold_y / length;
	out[2] = z / length;
}

static uint8_t linear_tint(uint8_t srgb, uint8_t ao)
{
	return (uint8_t)lrint(pow(srgb / 255.0, 2.2) * ao);
}

static void unpack_vertex(const struct pkg *pkg, const struct pkg_mesh_vertex *from, struct bench_chunk *to, uint32_t i)
{
	unpack_normal(from->normal_oct, to->normals + i * 3);
	for (int k = 0; k < 3; k++) {
		to->positions[i * 3 + (uint32_t)k] = (float)from->pos_mm[k] * 0.001f;
		to->colors[i * 4 + (uint32_t)k] = linear_tint(from->rgb[k], from->ao);
	}
	to->colors[i * 4 + 3] = 255;
	to->uvs[i * 3] = (float)from->uv[0] / 256.0f;
	to->uvs[i * 3 + 1] = (float)from->uv[1] / 256.0f;
	to->uvs[i * 3 + 2] = pkg->materials[from->material].layer;
}

bool bench_chunk_make(struct bench_city *city, uint32_t index, struct bench_chunk *out)
{
	const struct pkg_chunk *chunk = &city->pkg.chunks[index];
	size_t n = chunk->vertex_count;
	*out = (struct bench_chunk){ .vertices = chunk->vertex_count,
		.positions = malloc(n * 3 * sizeof(float)),
		.normals = malloc(n * 3 * sizeof(float)),
		.uvs = malloc(n * 3 * sizeof(float)),
		.colors = malloc(n * 4) };
	if (!out->positions || !out->normals || !out->uvs || !out->colors) {
		bench_chunk_free(out);
		return false;
	}
	for (int k = 0; k < 3; k++)
		out->origin_m[k] = chunk->origin_mm[k] * 0.001;
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(&city->pkg, chunk);
	for (uint32_t i = 0; i < n; i++)
		unpack_vertex(&city->pkg, &vertices[i], out, i);
	const uint16_t *indices = pkg_chunk_indices(&city->pkg, chunk);
	for (int pass = 0; pass < 2; pass++) {
		out->indices[pass] = (uint16_t *)(uintptr_t)indices;
		out->index_count[pass] = chunk->index_count[pass];
		indices += chunk->index_count[pass];
	}
	return true;
}

void bench_chunk_free(struct bench_chunk *chunk)
{
	free(chunk->positions);
	free(chunk->normals);
	free(chunk->uvs);
	free(chunk->colors);
	*chunk = (struct bench_chunk){ 0 };
}

bool bench_texture_view(const struct bench_city *city, struct bench_textures *out)
{
	const struct pkg_texture_array *array = city->pkg.textures;
	if (!array || array->format != PKG_TEXTURE_RGBA8)
		return false;
	*out =
		(struct bench_textures){ array->width, array->height, array->layers, array->levels, city->pkg.texture_bytes };
	return true;
}

void bench_eye_view(const struct bench_city *city, struct bench_eye *out)
{
	const struct camera_pose *pose = &renderer_camera(city->renderer)->pose;
	double h = pose->heading_rad, p = pose->pitch_rad;
	*out = (struct bench_eye){
		.forward = { sin(h) * cos(p), cos(h) * cos(p), sin(p) },
		.up = { -sin(h) * sin(p), -cos(h) * sin(p), cos(p) },
		.fov_y_deg = pose->fov_rad * (180.0 / BLVD_PI),
		.near_m = 0.35,
		.far_m = 6000.0,
		.to_sun = { 0.66f, -0.36f, 0.66f },
	};
	for (int k = 0; k < 3; k++)
		out->at_m[k] = (double)pose->eye_mm[k] * 0.001;
}

int64_t bench_boulevard_frame(struct bench_city *city)
{
	eglMakeCurrent(city->egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, city->egl_context);
	int64_t start = clock_cpu_ns();
	renderer_draw(city->renderer, &city->nav, &city->time);
	renderer_read_pixels(city->renderer, city->pixels);
	int64_t spent = clock_cpu_ns() - start;
	eglMakeCurrent(city->egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	return spent;
}

uint32_t bench_boulevard_triangles(const struct bench_city *city)
{
	struct renderer_stats stats;
	renderer_stats(city->renderer, &stats);
	return stats.triangles;
}

const uint8_t *bench_boulevard_pixels(const struct bench_city *city)
{
	return city->pixels;
}

int64_t bench_cpu_ns(void)
{
	return clock_cpu_ns();
}

bool bench_write_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	return !png_write(path, rgba, width, height);
}
