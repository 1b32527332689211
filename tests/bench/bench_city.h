/*
 * What the benchmark draws, in plain arrays, and boulevard's own renderer to compare with; C under a C++ program.
 */
#ifndef BLVD_TESTS_BENCH_CITY_H
#define BLVD_TESTS_BENCH_CITY_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct bench_options {
	const char *package;
	double east_m, north_m, heading_deg; /* the car's; the eye is the driver's */
	uint32_t width, height, samples;
};

/* A chunk of the package as floats. Arrays belong to the package and stay until bench_close(). */
struct bench_chunk {
	double origin_m[3]; /* city frame */
	uint32_t vertices;
	float *positions;     /* x, y, z, metres from the origin */
	float *normals;       /* x, y, z */
	float *uvs;           /* u, v, texture layer */
	uint8_t *colors;      /* linear tint times ambient occlusion, alpha 255 */
	uint16_t *indices[2]; /* opaque, decal */
	uint32_t index_count[2];
};

struct bench_textures {
	uint32_t width, height, layers, levels;
	const uint8_t *texels; /* RGBA8, level by level, in each all layers */
};

struct bench_eye {
	double at_m[3], forward[3], up[3], fov_y_deg, near_m, far_m;
	float to_sun[3];
};

struct bench_city;

/* NULL after a line on stderr. Also starts boulevard's renderer, which leaves no context current. */
struct bench_city *bench_open(const struct bench_options *options);
void bench_close(struct bench_city *city);

uint32_t bench_chunk_count(const struct bench_city *city);
bool bench_chunk_make(struct bench_city *city, uint32_t index, struct bench_chunk *out); /* false: no memory */
void bench_chunk_free(struct bench_chunk *chunk);
bool bench_texture_view(const struct bench_city *city, struct bench_textures *out); /* false: not RGBA8 */
void bench_eye_view(const struct bench_city *city, struct bench_eye *out);

/* One frame of boulevard, drawn and read back. Returns the CPU time of all threads. */
int64_t bench_boulevard_frame(struct bench_city *city);
uint32_t bench_boulevard_triangles(const struct bench_city *city);
const uint8_t *bench_boulevard_pixels(const struct bench_city *city);

int64_t bench_cpu_ns(void); /* of the process so far */
bool bench_write_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height); /* top row first */

#ifdef __cplusplus
}
#endif

#endif
