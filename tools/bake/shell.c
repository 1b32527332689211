#include "tools/bake/shell.h"

#include <math.h>

void shell_clear(struct shell *shell)
{
	shell->vertices.count = shell->indices.count = 0;
}

void shell_finish(struct shell *shell)
{
	ARRAY_FINISH(&shell->vertices);
	ARRAY_FINISH(&shell->indices);
}

void shell_brush(struct shell *shell, int material, const uint8_t rgb[3])
{
	shell->material = (uint8_t)material;
	for (int i = 0; i < 3; i++)
		shell->rgb[i] = rgb[i];
}

uint32_t shell_vertex(struct shell *shell, const struct shell_point *point, struct vec3 normal)
{
	struct mesh_vertex vertex = { .at = point->at,
		.normal = normal,
		.u = point->u,
		.v = point->v,
		.ao = fminf(fmaxf(point->ao, 0.0f), 1.0f),
		.material = shell->material,
		.rgb = { shell->rgb[0], shell->rgb[1], shell->rgb[2] },
		.seed = shell->seed };
	ARRAY_PUSH(&shell->vertices, vertex);
	return (uint32_t)shell->vertices.count - 1;
}

void shell_triangle(struct shell *shell, uint32_t a, uint32_t b, uint32_t c)
{
	ARRAY_PUSH(&shell->indices, a);
	ARRAY_PUSH(&shell->indices, b);
	ARRAY_PUSH(&shell->indices, c);
}

static struct dvec3 newell(const struct shell_point *points, size_t count)
{
	struct dvec3 sum = { 0.0, 0.0, 0.0 }, o = points[0].at;
	for (size_t i = 0, j = count - 1; i < count; j = i++) {
		struct dvec3 a = { points[j].at.x - o.x, points[j].at.y - o.y, points[j].at.z - o.z };
		struct dvec3 b = { points[i].at.x - o.x, points[i].at.y - o.y, points[i].at.z - o.z };
		sum.x += a.y * b.z - a.z * b.y;
		sum.y += a.z * b.x - a.x * b.z;
		sum.z += a.x * b.y - a.y * b.x;
	}
	return sum;
}

void shell_face(struct shell *shell, const struct shell_point *points, size_t count)
{
	struct dvec3 sum = newell(points, count);
	double length = sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
	if (!(length > 1e-7))
		return;
	struct vec3 normal = { (float)(sum.x / length), (float)(sum.y / length), (float)(sum.z / length) };
	uint32_t first = shell_vertex(shell, &points[0], normal), last = 0;
	for (size_t i = 1; i < count; i++) {
		uint32_t at = shell_vertex(shell, &points[i], normal);
		if (i >= 2)
			shell_triangle(shell, first, last, at);
		last = at;
	}
}

static struct shell_point box_point(const struct shell_box *box, double l, double w, double z, double u, double v)
{
	struct dvec2 across = { -box->along.y, box->along.x };
	return (struct shell_point){ { box->centre.x + box->along.x * l + across.x * w,
									 box->centre.y + box->along.y * l + across.y * w, z },
		(float)(u / box->tile_m), (float)(v / box->tile_m), box->ao };
}

static void box_lid(struct shell *shell, const struct shell_box *box, double z, bool up)
{
	double l = box->length / 2.0, w = box->width / 2.0;
	double corner[4][2] = { { -l, -w }, { l, -w }, { l, w }, { -l, w } };
	struct shell_point points[4];
	for (int i = 0; i < 4; i++) {
		const double *c = corner[up ? i : 3 - i];
		points[i] = box_point(box, c[0], c[1], z, c[0] + l, c[1] + w);
	}
	shell_face(shell, points, 4);
}

void shell_box(struct shell *shell, const struct shell_box *box)
{
	double l = box->length / 2.0, w = box->width / 2.0, height = box->to - box->from;
	double corner[4][2] = { { -l, -w }, { l, -w }, { l, w }, { -l, w } };
	for (int i = 0; i < 4; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % 4];
		double side = i % 2 ? box->width : box->length;
		struct shell_point points[4] = {
			box_point(box, a[0], a[1], box->from, 0.0, 0.0),
			box_point(box, b[0], b[1], box->from, side, 0.0),
			box_point(box, b[0], b[1], box->to, side, height),
			box_point(box, a[0], a[1], box->to, 0.0, height),
		};
		shell_face(shell, points, 4);
	}
	box_lid(shell, box, box->to, true);
	if (box->bottom)
		box_lid(shell, box, box->from, false);
}

void shell_emit(const struct shell *shell, const struct mesh_object *object, struct mesh_sink *sink)
{
	if (shell->indices.count == 0)
		return;
	mesh_begin(sink, object);
	for (size_t i = 0; i < shell->vertices.count; i++)
		mesh_add_vertex(sink, &shell->vertices.items[i]);
	for (size_t i = 0; i + 2 < shell->indices.count; i += 3)
		mesh_add_triangle(
			sink, PKG_PASS_OPAQUE, shell->indices.items[i], shell->indices.items[i + 1], shell->indices.items[i + 2]);
	mesh_end(sink);
}
