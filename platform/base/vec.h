/*
 * Small vectors and matrices, header only. float for what goes to the GPU (camera-relative), double for
 * the bake. Matrices are column major, as GLSL expects: m[col * 4 + row].
 */
#ifndef BLVD_PLATFORM_BASE_VEC_H
#define BLVD_PLATFORM_BASE_VEC_H

#include <math.h>
#include <string.h>

#define BLVD_PI 3.14159265358979323846

struct vec2 {
	float x, y;
};
struct vec3 {
	float x, y, z;
};
struct vec4 {
	float x, y, z, w;
};
struct dvec2 {
	double x, y;
};
struct dvec3 {
	double x, y, z;
};
struct mat4 {
	float m[16];
};

static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
	return (struct vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}
static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
	return (struct vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}
static inline struct vec3 vec3_scale(struct vec3 a, float s)
{
	return (struct vec3){ a.x * s, a.y * s, a.z * s };
}
static inline float vec3_dot(struct vec3 a, struct vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
	return (struct vec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
/* The zero vector stays zero. */
static inline struct vec3 vec3_normalize(struct vec3 a)
{
	float length = sqrtf(vec3_dot(a, a));
	return length > 0.0f ? vec3_scale(a, 1.0f / length) : a;
}

static inline struct dvec2 dvec2_add(struct dvec2 a, struct dvec2 b)
{
	return (struct dvec2){ a.x + b.x, a.y + b.y };
}
static inline struct dvec2 dvec2_sub(struct dvec2 a, struct dvec2 b)
{
	return (struct dvec2){ a.x - b.x, a.y - b.y };
}
static inline struct dvec2 dvec2_scale(struct dvec2 a, double s)
{
	return (struct dvec2){ a.x * s, a.y * s };
}
static inline double dvec2_dot(struct dvec2 a, struct dvec2 b)
{
	return a.x * b.x + a.y * b.y;
}
/* z of the cross product: positive when b is to the left of a. */
static inline double dvec2_cross(struct dvec2 a, struct dvec2 b)
{
	return a.x * b.y - a.y * b.x;
}
static inline double dvec2_length(struct dvec2 a)
{
	return hypot(a.x, a.y);
}

static inline struct mat4 mat4_identity(void)
{
	return (struct mat4){ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
}

/* a * b: b is applied first. */
static inline struct mat4 mat4_mul(const struct mat4 *a, const struct mat4 *b)
{
	struct mat4 out;
	for (int col = 0; col < 4; col++) {
		for (int row = 0; row < 4; row++) {
			float sum = 0.0f;
			for (int k = 0; k < 4; k++)
				sum += a->m[k * 4 + row] * b->m[col * 4 + k];
			out.m[col * 4 + row] = sum;
		}
	}
	return out;
}

static inline struct vec4 mat4_apply(const struct mat4 *a, struct vec4 v)
{
	const float *m = a->m;
	return (struct vec4){
		m[0] * v.x + m[4] * v.y + m[8] * v.z + m[12] * v.w,
		m[1] * v.x + m[5] * v.y + m[9] * v.z + m[13] * v.w,
		m[2] * v.x + m[6] * v.y + m[10] * v.z + m[14] * v.w,
		m[3] * v.x + m[7] * v.y + m[11] * v.z + m[15] * v.w,
	};
}

#endif
