#include "tools/inspect/far_poses.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "assets/cells.h"
#include "assets/impostor_fold.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/city/pool.h"
#include "tools/impostor/view_cell.h"
#include "tools/inspect/far_raster.h"

#define READER_BYTES ((size_t)256 << 10)
#define HEADING_RAD (BLVD_PI / 4.0)
#define NEAREST_M 1.0

struct check {
	struct rng rng;
	struct far_raster raster;
	ARRAY(float) px;
	struct far_poses_result *out;
};

/* An eye of the view cell, metres from the cell's origin. */
static struct dvec3 random_eye(struct check *check, const struct view_cell *box, const struct pkg_cell *cell)
{
	double x = box->end.x - box->start.x, y = box->end.y - box->start.y, length = fmax(hypot(x, y), 1e-9);
	double along = rng_range(&check->rng, -box->overrun_m, length + box->overrun_m);
	double aside = rng_range(&check->rng, -box->half_width_m, box->half_width_m);
	double share = fmin(fmax(along / length, 0.0), 1.0);
	double height = rng_range(&check->rng, box->eye_min_m, box->eye_max_m);
	return (struct dvec3){
		box->start.x + (x * along + y * aside) / length - cell->origin_mm[0] * 1e-3,
		box->start.y + (y * along - x * aside) / length - cell->origin_mm[1] * 1e-3,
		box->start.z + share * (box->end.z - box->start.z) + height - cell->origin_mm[2] * 1e-3,
	};
}

/* Between two points on the screen, of which the raster has half of the resolution. False: behind the eye. */
static bool apart(const struct far_raster *raster, struct dvec3 p, struct dvec3 q, double *px)
{
	double a[3], b[3];
	far_raster_view(raster, p, a);
	far_raster_view(raster, q, b);
	*px = 2.0 * RASTER_FOCAL_PX * hypot(a[0] / a[2] - b[0] / b[2], a[1] / a[2] - b[1] / b[2]);
	return a[2] > NEAREST_M && b[2] > NEAREST_M;
}

static void check_render(struct check *check, const struct pkg_cell *cell)
{
	for (size_t i = 0; i < (size_t)RASTER_WIDTH * RASTER_HEIGHT; i++) {
		const struct raster_pixel *pixel = &check->raster.pixels[i];
		double px, texel_px;
		if (!pixel->truth)
			continue;
		bool made_up = !pixel->truth->object || pixel->truth->object & PKG_TRUTH_MADE_UP;
		check->out->made_up += made_up;
		struct dvec3 shown = { pixel->truth->pos_m[0], pixel->truth->pos_m[1], pixel->truth->pos_m[2] };
		if (made_up || !apart(&check->raster, pixel->at, shown, &px) ||
			!apart(&check->raster, pixel->at, pixel->corner, &texel_px))
			continue;
		ARRAY_PUSH(&check->px, (float)px);
		check->out->over_tau += px > cell->tau_px;
		check->out->over_error += px > fmax(cell->error_px, cell->tau_px) + texel_px;
	}
}

static void check_cell(struct check *check, const struct pkg *pkg, uint32_t index, const struct impostor_view *impostor,
	const struct pkg_truth_texel *truth, unsigned poses)
{
	const struct pkg_cell *cell = &pkg->cells[index];
	struct view_cell box = view_cell_of(&pkg->stretches[index / 2]);
	box = index & 1 ? view_cell_turned(&box) : box;
	double heading = atan2(box.end.x - box.start.x, box.end.y - box.start.y);
	far_raster_use(&check->raster, impostor, truth);
	for (unsigned pose = 0; pose < poses; pose++) {
		struct dvec3 eye = random_eye(check, &box, cell);
		far_raster_draw(&check->raster, eye, heading + rng_range(&check->rng, -HEADING_RAD, HEADING_RAD));
		check_render(check, cell);
	}
	check->out->cells++;
}

static int read_and_check(
	struct check *check, struct blob_reader *reader, const struct pkg *pkg, uint32_t index, unsigned poses)
{
	struct pool pool = { 0 };
	const struct pkg_cell *cell = &pkg->cells[index];
	struct impostor_view impostor;
	void *raw = pool_alloc(&pool, cell->impostor.raw_bytes), *truth = pool_alloc(&pool, cell->truth.raw_bytes);
	void *scratch = pool_alloc(&pool, impostor_fold_bytes(cell->vertex_count, cell->index_count));
	int err = blob_read(reader, pkg, &cell->impostor, raw);
	if (!err)
		err = blob_read(reader, pkg, &cell->truth, truth);
	if (!err)
		err = impostor_view_open(&impostor, cell, raw, cell->impostor.raw_bytes, scratch);
	if (err)
		log_error("cell %u is damaged", index);
	else
		check_cell(check, pkg, index, &impostor, truth, poses);
	pool_finish(&pool);
	return err;
}

static int compare(const void *left, const void *right)
{
	float a = *(const float *)left, b = *(const float *)right;
	return (a > b) - (a < b);
}

static void sum_up(struct check *check)
{
	struct far_poses_result *out = check->out;
	size_t count = check->px.count;
	ARRAY_SORT(&check->px, compare);
	out->pixels = count;
	if (!count)
		return;
	double last = (double)(count - 1);
	out->p50_px = (double)check->px.items[count / 2];
	out->p99_px = (double)check->px.items[(size_t)(last * 0.99)];
	out->p999_px = (double)check->px.items[(size_t)(last * 0.999)];
	out->max_px = (double)check->px.items[count - 1];
}

int far_poses_check(const struct pkg *pkg, unsigned poses, struct far_poses_result *out)
{
	struct pool pool = { 0 };
	struct arena arena;
	struct blob_reader *reader;
	struct check check = { .rng = rng_seed(1), .out = out };
	*out = (struct far_poses_result){ 0 };
	arena_init(&arena, "blobs", pool_alloc(&pool, READER_BYTES), READER_BYTES);
	int err = blob_reader_init(&reader, &arena);
	for (uint32_t i = 0; i < 2 * pkg->stretch_count && !err; i++)
		if (pkg->cells[i].impostor.stored_bytes && pkg->cells[i].truth.stored_bytes)
			err = read_and_check(&check, reader, pkg, i, poses);
	sum_up(&check);
	far_raster_finish(&check.raster);
	ARRAY_FINISH(&check.px);
	pool_finish(&pool);
	return err ? err : out->cells ? 0 : -ENODATA;
}
