/*
 * The steps for one stretch. Looks from all over the view cell, shared by both cells, say which distant pixels are ever
 * seen; then each cell is captured from its middle, and from where most is seen that no capture shows yet, until little
 * is left (cell_cover.h). Captures are no larger than what they have to show.
 *
 * What is kept of a cell:
 *   nothing   when no look sees a distant pixel in its half-space;
 *   geometry  when what it sees has fewer triangles than an impostor can have: below GEOMETRY_TRIANGLES, or below what
 *             the impostor came out with, and what the whole stretch sees, which is loaded and drawn then, has no more
 *             than GEOMETRY_WHOLE; or when no impostor within the bounds can be made;
 *   impostor  else. When its error is above tau, the bound on triangles or pages came first, and the cell says so.
 */
#include "tools/impostor/cell_bake.h"
#include "tools/impostor/blob_write.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "platform/base/log.h"
#include "tools/impostor/capture.h"
#include "tools/impostor/cell_cover.h"
#include "tools/impostor/cell_looks.h"
#include "tools/impostor/cell_views.h"
#include "tools/impostor/impostor.h"
#include "tools/impostor/wanted.h"

#define FOCAL_PX 869.0
#define TEXELS_PER_PX 1.0
#define CAPTURE_SCALE 1.25 /* pixels of a capture a texel */
#define TRIANGLES_MAX 3000
#define PAGES_MAX 16
#define LOOK_SCALE 0.5        /* of the screen's resolution */
#define WANTED_MARGIN_PX 13.0 /* these are pixels of the screen */
#define GEOMETRY_TRIANGLES 400
#define GEOMETRY_WHOLE 2000
#define RELAX_TRIES 3
#define CAPTURES_MAX 24
#define EYES_MAX 8
#define LEFT_MAX 16 /* points of an eye, 16 pixels of the screen each, that may stay uncovered all around */
#define FIRST_MARGIN_PX (2.0 * WANTED_MARGIN_PX)
#define MARGIN_PX 13.0 /* around what is left, for surfaces to go on under what hides them */
#define WANTED_RADIUS_PX 5.5

struct cell_baker {
	const struct pkg *pkg;
	struct cell_options options;
	struct capturer *capturer;
	struct cell_looks looks;
	cover_array points;
	struct impostor_capture captures[CAPTURES_MAX];
	size_t capture_count;
	byte_array raw;
	struct cell_times times;
};

struct cell_options cell_options_settled(const struct cell_options *options, const struct pkg *pkg)
{
	struct cell_options out = *options;
	if (!(out.tau_px > 0.0))
		out.tau_px = 1.0;
	if (!(out.focal_px > 0.0))
		out.focal_px = FOCAL_PX;
	if (!(out.texels_per_px > 0.0))
		out.texels_per_px = TEXELS_PER_PX;
	if (!out.triangles_max)
		out.triangles_max = TRIANGLES_MAX;
	if (!out.pages_max)
		out.pages_max = PAGES_MAX;
	if (!(out.far_m > 0.0)) {
		const struct pkg_meta *meta = pkg->meta;
		double sum = 0.0;
		for (int k = 0; k < 3; k++)
			sum += pow((meta->max_mm[k] - (double)meta->min_mm[k]) * 1e-3, 2.0);
		out.far_m = ceil(sqrt(sum) / 1000.0 + 1.0) * 1000.0;
	}
	return out;
}

struct cell_options cell_options_at_level(const struct cell_options *settled, unsigned level)
{
	struct cell_options out = *settled;
	out.triangles_max = out.triangles_max >> level ? out.triangles_max >> level : 1;
	out.pages_max = out.pages_max >> level ? out.pages_max >> level : 1;
	return out;
}

void baked_stretch_finish(struct baked_stretch *baked)
{
	ARRAY_FINISH(&baked->bytes);
}

struct cell_baker *cell_baker_new(const struct pkg *pkg)
{
	struct cell_baker *baker = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*baker));
	*baker = (struct cell_baker){ .pkg = pkg };
	return baker;
}

static void drop_captures(struct cell_baker *baker)
{
	for (size_t i = 0; i < baker->capture_count; i++) {
		capture_image_finish(&baker->captures[i].image);
		array_free(baker->captures[i].wanted);
		baker->captures[i] = (struct impostor_capture){ 0 };
	}
	baker->capture_count = 0;
}

void cell_baker_free(struct cell_baker *baker)
{
	if (!baker)
		return;
	drop_captures(baker);
	cell_looks_finish(&baker->looks);
	ARRAY_FINISH(&baker->points);
	ARRAY_FINISH(&baker->raw);
	if (baker->capturer)
		capturer_close(baker->capturer);
	array_free(baker);
}

const struct cell_times *cell_baker_times(const struct cell_baker *baker)
{
	return &baker->times;
}

/* Processor time of this process. */
static int64_t cpu_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void spend(double *on, int64_t *since)
{
	int64_t now = cpu_ns();
	*on += (double)(now - *since) * 1e-9;
	*since = now;
}

/* --- blobs --- */

static int store_set(struct cell_baker *baker, const struct triangle_set *set, byte_array *out, struct pkg_blob *blob)
{
	if (!set->triangles)
		return 0;
	baker->raw.count = 0;
	triangle_set_encode(set, baker->pkg, &baker->raw);
	return blob_append(out, &baker->raw, BLOB_SMALL, blob);
}

/* --- what is in front --- */

/* Triangles with a corner ahead of the cell's start. */
static void in_front(
	const struct pkg *pkg, const struct view_cell *cell, const struct triangle_set *set, struct triangle_set *out)
{
	struct dvec3 axis = cell_axis(cell);
	triangle_set_clear(out);
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		uint32_t size = triangle_set_object_size(&pkg->objects[item->object]);
		const uint64_t *from = set->words.items + item->first_word;
		uint64_t *to = triangle_set_add(out, pkg, item->object);
		for (uint32_t triangle = 0; triangle < size; triangle++) {
			int64_t mm[3][3];
			double ahead = -INFINITY;
			if (!(from[triangle / 64] >> (triangle % 64) & 1))
				continue;
			triangle_set_corners(pkg, item->object, triangle, mm);
			for (int k = 0; k < 3; k++)
				ahead = fmax(ahead, ((double)mm[k][0] * 1e-3 - cell->start.x) * axis.x +
										((double)mm[k][1] * 1e-3 - cell->start.y) * axis.y);
			if (ahead > -cell->overrun_m)
				to[triangle / 64] |= UINT64_C(1) << (triangle % 64);
		}
	}
	triangle_set_tidy(out, pkg);
}

/* What hides the distance in the looks. What is thin hides little and from few places: it is left out, so that nothing
 * is lost between two looks. */
static void keep_occluders(const struct pkg *pkg, const struct triangle_set *near_set, struct triangle_set *out)
{
	triangle_set_clear(out);
	for (size_t i = 0; i < near_set->items.count; i++) {
		const struct triangle_set_item *item = &near_set->items.items[i];
		const struct pkg_object *object = &pkg->objects[item->object];
		if (object->kind == PKG_OBJECT_TREE || object->kind == PKG_OBJECT_FURNITURE)
			continue;
		memcpy(triangle_set_add(out, pkg, item->object), &near_set->words.items[item->first_word],
			(triangle_set_object_size(object) + 63) / 64 * sizeof(uint64_t));
	}
	triangle_set_tidy(out, pkg);
}

/* --- captures --- */

static bool any(const uint8_t *bytes, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (bytes[i])
			return true;
	return false;
}

/* One face from an eye. The first eye shows whatever is wanted, the others only what is left. */
static int capture_face(
	struct cell_baker *baker, const struct view_cell *cell, struct dvec3 eye, enum cell_face face, bool first)
{
	double per_px = baker->options.texels_per_px * CAPTURE_SCALE, focal_px = baker->options.focal_px * per_px;
	struct capture_view view = cell_face_view(cell, eye, face, true, focal_px);
	int64_t since = cpu_ns();
	if (baker->capture_count == CAPTURES_MAX || !cover_crop(&baker->points, &baker->looks, first ? NULL : &eye,
													(first ? FIRST_MARGIN_PX : MARGIN_PX) * per_px, &view))
		return 0;
	view.near_m = 1.0;
	view.far_m = baker->options.far_m;
	struct impostor_capture *capture = &baker->captures[baker->capture_count];
	int err = capturer_draw(baker->capturer, &view, true, &capture->image);
	spend(&baker->times.capture, &since);
	if (err)
		return err;
	size_t pixels = (size_t)view.width * view.height;
	capture->wanted = array_grow(NULL, &(size_t){ 0 }, pixels, 1);
	if (first)
		impostor_wanted(baker->looks.images.items, baker->looks.count, &capture->image,
			(unsigned)lround(WANTED_MARGIN_PX * per_px), capture->wanted);
	else
		cover_wanted(
			&baker->points, &baker->looks, &capture->image, (int)lround(WANTED_RADIUS_PX * per_px), capture->wanted);
	baker->capture_count++;
	if (!any(capture->wanted, pixels)) {
		baker->capture_count--;
		capture_image_finish(&capture->image);
		array_free(capture->wanted);
		capture->wanted = NULL;
	}
	spend(&baker->times.wanted, &since);
	return 0;
}

/* All faces from an eye; then what they show is struck off. */
static int capture_eye(struct cell_baker *baker, const struct view_cell *cell, struct dvec3 eye, bool first)
{
	static const enum cell_face faces[] = { CELL_FRONT, CELL_LEFT, CELL_RIGHT };
	size_t before = baker->capture_count;
	for (size_t face = 0; face < 3; face++) {
		int err = capture_face(baker, cell, eye, faces[face], first);
		if (err)
			return err;
	}
	int64_t since = cpu_ns();
	for (size_t i = before; i < baker->capture_count; i++)
		cover_strike(&baker->points, &baker->captures[i].image, baker->captures[i].wanted);
	cover_strike_eye(&baker->points, &baker->looks, &eye);
	spend(&baker->times.wanted, &since);
	return 0;
}

/* The middle first, where the eye is never far; then wherever most is left to show. */
static int capture_all(struct cell_baker *baker, const struct view_cell *cell, const struct triangle_set *ahead)
{
	static const struct cell_pose middle = { .along = 0.5, .height = 0.6 };
	struct dvec3 eye = cell_eye(cell, &middle);
	capturer_use(baker->capturer, ahead);
	int err = capture_eye(baker, cell, eye, true);
	for (int i = 1; i < EYES_MAX && !err && cover_next(&baker->points, &baker->looks, LEFT_MAX, &eye); i++)
		err = capture_eye(baker, cell, eye, false);
	return err;
}

/* Depth of the nearest wanted pixel of the first eye. */
static uint32_t split_mm(const struct cell_baker *baker)
{
	double disparity = 0.0;
	for (size_t i = 0; i < baker->capture_count; i++) {
		const struct impostor_capture *capture = &baker->captures[i];
		size_t pixels = (size_t)capture->image.view.width * capture->image.view.height;
		if (!same_eye(&capture->image.view.eye, &baker->captures[0].image.view.eye))
			break;
		for (size_t k = 0; k < pixels; k++)
			if (capture->wanted[k])
				disparity = fmax(disparity, capture->image.pixels[k].disparity);
	}
	return disparity > 0.0 ? (uint32_t)fmin(rint(1e3 / disparity), UINT32_MAX) : 0;
}

/* --- one cell --- */

static int build(struct cell_baker *baker, const struct view_cell *cell, struct impostor *out)
{
	const struct cell_options *asked = &baker->options;
	struct impostor_options options = {
		.tau_px = asked->tau_px,
		.focal_px = asked->focal_px,
		.texels_per_px = asked->texels_per_px,
		.triangles_max = asked->triangles_max,
		.pages_max = asked->pages_max,
		.interior = asked->grid ? IMPOSTOR_GRID : IMPOSTOR_PLANES,
		.grid_px = 16,
		.truth = asked->truth,
	};
	int err = -E2BIG;
	for (int i = 0; i < RELAX_TRIES && err == -E2BIG; i++, options.tau_px *= 2.0)
		err = impostor_build(cell, baker->captures, baker->capture_count, &options, out);
	return err;
}

static int store_impostor(
	struct cell_baker *baker, const struct impostor *impostor, struct pkg_cell *cell, byte_array *bytes)
{
	cell->kind = PKG_CELL_IMPOSTOR;
	cell->reason = impostor->error_px > baker->options.tau_px ? PKG_REASON_TAU_RELAXED : PKG_REASON_IMPOSTOR_CHEAPER;
	cell->page_count = (uint16_t)impostor->page_count;
	cell->vertex_count = (uint32_t)impostor->vertices.count;
	cell->index_count = (uint32_t)impostor->indices.count;
	cell->error_px = (float)impostor->error_px;
	cell->over_share = (float)impostor->over_share;
	memcpy(cell->origin_mm, impostor->origin_mm, sizeof(cell->origin_mm));
	baker->raw.count = 0;
	impostor_encode(impostor, &baker->raw);
	int err = blob_append(bytes, &baker->raw, BLOB_SMALL, &cell->impostor);
	if (err || !impostor->truth || !impostor->page_count)
		return err;
	baker->raw.count = 0;
	impostor_encode_truth(impostor, &baker->raw);
	return blob_append(bytes, &baker->raw, BLOB_QUICK, &cell->truth);
}

static void keep_geometry(struct pkg_cell *cell, enum pkg_cell_reason reason)
{
	cell->kind = PKG_CELL_GEOMETRY;
	cell->reason = (uint8_t)reason;
}

/* `ahead`: the far set in front. Its looks have been taken. `whole`: triangles that geometry would draw. */
static int make_impostor(struct cell_baker *baker, const struct view_cell *view, const struct triangle_set *ahead,
	uint64_t whole, struct pkg_cell *cell, byte_array *bytes)
{
	struct impostor impostor = { 0 };
	int err = capture_all(baker, view, ahead);
	int64_t since = cpu_ns();
	if (!err && baker->capture_count) {
		cell->split_mm = split_mm(baker);
		err = build(baker, view, &impostor);
	}
	spend(&baker->times.build, &since);
	if (err == -E2BIG) {
		keep_geometry(cell, PKG_REASON_ERROR_TOO_LARGE);
		err = 0;
	} else if (!err && impostor.indices.count / 3 >= cell->seen_triangles && whole <= GEOMETRY_WHOLE) {
		keep_geometry(cell, PKG_REASON_FEWER_TRIANGLES);
	} else if (!err && impostor.indices.count) {
		err = store_impostor(baker, &impostor, cell, bytes);
	}
	spend(&baker->times.store, &since);
	impostor_finish(&impostor);
	drop_captures(baker);
	return err;
}

static int bake_cell(struct cell_baker *baker, const struct view_cell *view, const struct triangle_set *seen,
	const struct triangle_set *far_set, struct pkg_cell *cell, byte_array *bytes)
{
	struct triangle_set ahead = { 0 };
	*cell = (struct pkg_cell){
		.kind = PKG_CELL_NOTHING, .reason = PKG_REASON_NONE_IN_VIEW, .tau_px = (float)baker->options.tau_px
	};
	in_front(baker->pkg, view, seen, &ahead);
	cell->seen_triangles = ahead.triangles;
	int err = 0;
	bool few = ahead.triangles <= GEOMETRY_TRIANGLES && seen->triangles <= GEOMETRY_WHOLE;
	if (ahead.triangles && (!baker->options.impostor || few)) {
		keep_geometry(cell, PKG_REASON_FEWER_TRIANGLES);
	} else if (ahead.triangles) {
		in_front(baker->pkg, view, far_set, &ahead);
		cover_points(&baker->looks, baker->pkg, &ahead, cell_axis(view), &baker->points);
		if (baker->points.count)
			err = make_impostor(baker, view, &ahead, seen->triangles, cell, bytes);
	}
	triangle_set_finish(&ahead);
	return err;
}

/* --- the stretch --- */

static int look(
	struct cell_baker *baker, const struct view_cell *view, const struct visible_sets *sets, struct triangle_set *seen)
{
	struct triangle_set occluders = { 0 };
	int err = baker->capturer ? 0 : capturer_open(&baker->capturer, baker->pkg);
	if (err)
		return err;
	int64_t since = cpu_ns();
	keep_occluders(baker->pkg, &sets->near_set, &occluders);
	err = cell_looks_draw(&baker->looks, baker->capturer, baker->pkg, view, &sets->far_set, &occluders,
		baker->options.focal_px * LOOK_SCALE, baker->options.far_m);
	if (!err)
		cell_looks_seen(&baker->looks, baker->pkg, &sets->far_set, seen);
	triangle_set_finish(&occluders);
	spend(&baker->times.look, &since);
	if (err)
		log_error("cannot draw a view cell: %s", strerror(-err));
	return err;
}

static int bake_cells(struct cell_baker *baker, const struct view_cell *view, const struct visible_sets *sets,
	const struct triangle_set *seen, struct baked_stretch *out)
{
	/* The cells' blobs come after the visible set's, which is only stored if one of them wants it. */
	byte_array blobs[2] = { 0 };
	int err = 0;
	for (int way = 0; way < 2 && !err; way++) {
		struct view_cell turned = way ? view_cell_turned(view) : *view;
		err = bake_cell(baker, &turned, seen, &sets->far_set, &out->cells[way], &blobs[way]);
	}
	bool geometry = out->cells[0].kind == PKG_CELL_GEOMETRY || out->cells[1].kind == PKG_CELL_GEOMETRY;
	if (!err && (geometry || baker->options.pvs))
		err = store_set(baker, seen, &out->bytes, &out->stretch.pvs);
	for (int way = 0; way < 2 && !err; way++) {
		size_t at = (out->bytes.count + PKG_BLOB_ALIGN - 1) / PKG_BLOB_ALIGN * PKG_BLOB_ALIGN;
		if (!blobs[way].count)
			continue;
		ARRAY_RESERVE(&out->bytes, at + blobs[way].count);
		memset(out->bytes.items + out->bytes.count, 0, at - out->bytes.count);
		memcpy(out->bytes.items + at, blobs[way].items, blobs[way].count);
		out->bytes.count = at + blobs[way].count;
		struct pkg_blob *moved[] = { &out->cells[way].impostor, &out->cells[way].truth };
		for (int i = 0; i < 2; i++)
			moved[i]->offset += moved[i]->stored_bytes ? at : 0;
	}
	ARRAY_FINISH(&blobs[0]);
	ARRAY_FINISH(&blobs[1]);
	return err;
}

int cell_baker_run(struct cell_baker *baker, const struct cell_options *options, const struct pkg_stretch *stretch,
	const struct visible_sets *sets, uint64_t hash, struct baked_stretch *out)
{
	struct view_cell view = view_cell_of(stretch);
	struct triangle_set seen = { 0 };
	baker->options = *options;
	out->bytes.count = 0;
	out->stretch = *stretch;
	out->stretch.local_triangles = sets->near_set.triangles;
	out->stretch.near_triangles = sets->near_candidates;
	out->stretch.input_hash = hash;
	for (int way = 0; way < 2; way++)
		out->cells[way] = (struct pkg_cell){ .tau_px = (float)baker->options.tau_px };
	int err = store_set(baker, &sets->near_set, &out->bytes, &out->stretch.local);
	if (!err && sets->far_set.triangles)
		err = look(baker, &view, sets, &seen);
	out->stretch.pvs_triangles = seen.triangles;
	if (!err && seen.triangles)
		err = bake_cells(baker, &view, sets, &seen, out);
	triangle_set_finish(&seen);
	return err;
}
