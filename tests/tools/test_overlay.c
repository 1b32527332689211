/* Read-outs and street labels over simulated drives, without GL: nothing overlaps, nothing flickers, nothing allocates.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "overlay_city.h"
#include "render/overlay.h"

static struct overlay_city city;
static bool ready;
static uint8_t *memory;
#define MEMORY_BYTES ((size_t)16 << 20)

static const int corners[][2] = { { 2, 1 }, { 2, 5 }, { 4, 5 }, { 4, 9 }, { 8, 9 }, { 8, 4 }, { 10, 4 }, { 10, 10 },
	{ 1, 10 }, { 1, 2 } };
static uint32_t route[128], route_count;

static int open_city(void **state)
{
	(void)state;
	memory = malloc(MEMORY_BYTES);
	ready = overlay_city_make(&city);
	route_count = overlay_city_route(&city, corners, sizeof(corners) / sizeof(corners[0]), route, 128);
	return 0;
}

static int close_city(void **state)
{
	(void)state;
	overlay_city_finish(&city);
	free(memory);
	return 0;
}

static void start(struct overlay *overlay, struct arena *arena)
{
	if (!ready) {
		printf("skipped: no fonts\n");
		skip();
	}
	arena_init(arena, "test", memory, MEMORY_BYTES);
	assert_int_equal(overlay_init(overlay, arena, NULL, &city.pkg, NULL), 0);
}

static bool overlaps(const struct box *a, const struct box *b)
{
	return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static void update(struct overlay *overlay, double driven_m, double speed_mps, enum camera_kind kind, uint32_t width,
	uint32_t height, int64_t time_ns)
{
	struct nav_view nav;
	struct view view;
	overlay_city_drive(&city, route, route_count, driven_m, speed_mps, &nav);
	overlay_city_view(&nav, kind, width, height, &view);
	struct overlay_input input = { .view = &view, .nav = &nav, .kind = kind, .time_ns = time_ns };
	overlay_update(overlay, &input);
}

/* Shown labels keep clear of each other, of the read-outs, and stand where they stood in the city. */
static void assert_labels_clear(const struct labels *labels, const struct overlay *overlay)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++) {
		const struct label *a = &labels->slots[i];
		if (!a->used || a->shown <= 0.0f)
			continue;
		assert_true(a->shown <= 1.0f && a->size_px >= 24.0f * overlay_scale(1280, 720));
		assert_true(a->box.x0 >= 0.0f && a->box.y0 >= 0.0f && a->box.x1 <= 1280.0f && a->box.y1 <= 720.0f);
		for (uint32_t k = 0; k < overlay->taken_count; k++)
			assert_false(overlaps(&a->box, &overlay->taken[k]));
		for (uint32_t k = i + 1; k < LABELS_MAX; k++) {
			const struct label *b = &labels->slots[k];
			if (b->used && b->shown > 0.0f)
				assert_false(overlaps(&a->box, &b->box));
		}
	}
}

/* Nothing pops up: from one frame to the next a label brightens by no more than the fade. Returns how many vanished
 * within a frame, because they ran into something. */
static uint32_t assert_no_popping(const struct labels *labels, float *shown, uint64_t *key, float step)
{
	uint32_t cuts = 0;
	for (uint32_t i = 0; i < LABELS_MAX; i++) {
		const struct label *label = &labels->slots[i];
		float now = label->used ? label->shown : 0.0f;
		if (label->used && key[i] == label->what.key)
			assert_true(now - shown[i] <= step + 1e-4f);
		else
			assert_true(now <= step + 1e-4f && shown[i] < 0.35f);
		cuts += shown[i] - now > 0.5f;
		shown[i] = now;
		key[i] = label->used ? label->what.key : 0;
	}
	return cuts;
}

static void drive_labels(enum camera_kind kind, double speed_mps, int frames_per_s)
{
	static struct overlay overlay;
	struct arena arena;
	float shown[LABELS_MAX] = { 0 };
	uint64_t key[LABELS_MAX] = { 0 };
	start(&overlay, &arena);
	double length_m = 3600.0;
	int frames = (int)(length_m / speed_mps * frames_per_s);
	size_t used = arena.used, heap = mallinfo2().uordblks;
	uint64_t seen = 0;
	uint32_t cuts = 0;
	for (int i = 0; i < frames; i++) {
		int64_t now = INT64_C(1000000000) * i / frames_per_s;
		update(&overlay, speed_mps * i / frames_per_s, speed_mps, kind, 1280, 720, now);
		assert_labels_clear(&overlay.labels, &overlay);
		cuts += assert_no_popping(&overlay.labels, shown, key, 1.0f / 0.35f / (float)frames_per_s);
		for (uint32_t k = 0; k < LABELS_MAX; k++)
			seen += shown[k] > 0.5f;
	}
	const struct labels_stats *stats = &overlay.labels.stats;
	double km = length_m / 1000.0;
	printf("camera %d at %.0f m/s: %.1f labels in sight, %.1f appear a km, shortest life %.2f s, %u cut, %u dropped\n",
		(int)kind, speed_mps, (double)seen / frames, (double)stats->appeared / km,
		(double)stats->shortest_life_ns * 1e-9, cuts, (unsigned)stats->dropped);
	assert_int_equal(arena.used, used);
	assert_int_equal(mallinfo2().uordblks, heap);
	assert_int_equal(overlay.canvas.dropped, 0);
	assert_true(stats->appeared >= (uint64_t)(5.0 * km));
	assert_true(stats->appeared - stats->disappeared < LABELS_MAX);
	/* each junction gives one name at most twice: by itself, and again after giving way */
	assert_true((double)stats->appeared < (kind == CAMERA_HEADING_UP ? 70.0 : 40.0) * km);
	assert_true(stats->shortest_life_ns > INT64_C(400000000));
	assert_true(cuts <= 3 * km);
	overlay_finish(&overlay);
}

static void labels_are_calm_for_a_driver(void **state)
{
	(void)state;
	drive_labels(CAMERA_DRIVER, 12.0, 30);
	drive_labels(CAMERA_DRIVER, 22.0, 60);
}

static void labels_are_calm_behind_the_car(void **state)
{
	(void)state;
	drive_labels(CAMERA_CHASE, 12.0, 30);
}

static void labels_are_calm_from_above(void **state)
{
	(void)state;
	drive_labels(CAMERA_NORTH_UP, 12.0, 30);
	drive_labels(CAMERA_HEADING_UP, 12.0, 30);
}

static void a_label_keeps_its_place_in_the_city(void **state)
{
	(void)state;
	static struct overlay overlay;
	struct arena arena;
	start(&overlay, &arena);
	struct label before[LABELS_MAX] = { 0 };
	for (int i = 0; i < 3000; i++) {
		update(&overlay, 0.4 * i, 12.0, CAMERA_CHASE, 1280, 720, INT64_C(33333333) * i);
		for (uint32_t k = 0; k < LABELS_MAX; k++) {
			const struct label *now = &overlay.labels.slots[k];
			if (now->used && now->on && before[k].on && before[k].what.key == now->what.key)
				assert_memory_equal(now->what.at_mm, before[k].what.at_mm, sizeof(now->what.at_mm));
			before[k] = *now;
		}
	}
	overlay_finish(&overlay);
}

static void the_same_drive_gives_the_same_vertices(void **state)
{
	(void)state;
	static struct overlay overlay;
	struct arena arena;
	uint64_t sum[2] = { 0, 0 };
	for (int round = 0; round < 2; round++) {
		start(&overlay, &arena);
		for (int i = 0; i < 400; i++) {
			update(&overlay, 0.8 * i, 12.0, CAMERA_DRIVER, 1280, 720, INT64_C(66666666) * i);
			const uint8_t *bytes = (const uint8_t *)overlay.canvas.vertices;
			for (size_t k = 0; k < overlay.canvas.vertex_count * sizeof(struct canvas_vertex); k++)
				sum[round] = sum[round] * 31 + bytes[k];
		}
		overlay_finish(&overlay);
	}
	assert_int_equal(sum[0], sum[1]);
}

static void spoil(struct nav_view *nav, int variant)
{
	static const uint32_t long_names[] = { 5, 6, 13, 14 };
	if (variant & 1) {
		nav->next.street = nav->street = city.name[long_names[variant / 2 % 4]];
		nav->after_next = nav->next;
		nav->after_next.distance_m += 50.0;
	}
	if (variant & 2)
		nav->signal[NAV_SIGNAL_YAW_RATE] = NAV_SIGNAL_IMPLAUSIBLE;
	if (variant & 4)
		nav->routed = false;
	if (variant & 8)
		nav->off_route = true;
	if (variant & 16)
		nav->located = false;
	if (variant & 32)
		nav->speed_mps = 123.0;
}

/* Every read-out inside of the screen, none over another, in all states and on all screens. */
static void readouts_never_overlap(void **state)
{
	(void)state;
	static struct overlay overlay;
	struct arena arena;
	static const uint32_t sizes[][2] = { { 1280, 720 }, { 1920, 720 }, { 480, 272 }, { 720, 1280 }, { 800, 480 },
		{ 1920, 1080 }, { 320, 240 }, { 640, 200 }, { 3840, 2160 }, { 1, 1 } };
	for (size_t size = 0; size < sizeof(sizes) / sizeof(sizes[0]); size++) {
		start(&overlay, &arena);
		for (int variant = 0; variant < 128; variant++) {
			struct nav_view nav;
			struct view view;
			overlay_city_drive(&city, route, route_count, 250.0, 12.0, &nav);
			spoil(&nav, variant);
			overlay_city_view(&nav, CAMERA_CHASE, sizes[size][0], sizes[size][1], &view);
			struct overlay_input input = { .view = &view, .nav = &nav, .kind = CAMERA_CHASE, .time_ns = variant };
			input.map_damaged = (variant & 64) != 0;
			overlay_update(&overlay, &input);
			float width = (float)sizes[size][0], height = (float)sizes[size][1];
			if (width < 480.0f || height < 272.0f)
				continue; /* it must only not fail */
			assert_true(overlay.taken_count >= 3);
			for (uint32_t i = 0; i < overlay.taken_count; i++) {
				const struct box *box = &overlay.taken[i];
				assert_true(box->x0 >= 0.0f && box->y0 >= 0.0f && box->x1 <= width && box->y1 <= height);
				for (uint32_t k = i + 1; k < overlay.taken_count; k++)
					assert_false(overlaps(box, &overlay.taken[k]));
			}
		}
		overlay_finish(&overlay);
	}
}

static void text_stays_in_its_bounds(void **state)
{
	(void)state;
	struct canvas canvas;
	struct text_font font;
	struct arena arena;
	if (!ready)
		skip();
	arena_init(&arena, "test", memory, MEMORY_BYTES);
	assert_int_equal(canvas_init(&canvas, &arena, NULL, &city.pkg, 0), 0);
	text_font_init(&font, &city.pkg);
	for (uint32_t i = 0; i < OVERLAY_NAMES; i++) {
		struct text_line line = text_line_string(&font, city.name[i]);
		assert_non_null(line.shaped);
		for (float limit = 0.0f; limit < 400.0f; limit += 37.0f) {
			for (int align = TEXT_LEFT; align <= TEXT_RIGHT; align++) {
				struct text_style style = { .size_px = 32.0f, .fill = { 1, 1, 1, 1 }, .halo_px = 3.0f };
				style.max_width_px = limit;
				style.align = (enum text_align)align;
				canvas_begin(&canvas, 1000, 1000);
				float width = text_draw(&canvas, &font, &line, 500.0f, 500.0f, &style);
				struct box box = text_box(&font, &line, 500.0f, 500.0f, &style);
				assert_true(limit == 0.0f || width <= limit + 0.1f);
				/* quads reach beyond the letters by the distance field's spread */
				float room = 32.0f * 8.0f / 48.0f + 4.0f;
				for (uint32_t k = 0; k < canvas.vertex_count; k++) {
					const struct canvas_vertex *at = &canvas.vertices[k];
					if (limit == 0.0f || limit > 60.0f)
						assert_true(at->x >= box.x0 - room && at->x <= box.x1 + room);
					assert_true(at->y >= box.y0 - room && at->y <= box.y1 + room);
				}
			}
		}
	}
	struct text_line unknown = text_line_utf8("\xFF\xC3 \xE4\xB8\xAD"), empty = text_line_string(&font, 0);
	struct text_style style = { .size_px = 24.0f, .fill = { 1, 1, 1, 1 } };
	assert_true(text_draw(&canvas, &font, &unknown, 0.0f, 0.0f, &style) >= 0.0f);
	assert_true(text_line_empty(&empty));
}

static void a_name_breaks_at_a_blank(void **state)
{
	(void)state;
	struct text_font font;
	float end, start_em;
	if (!ready)
		skip();
	text_font_init(&font, &city.pkg);
	struct text_line line = text_line_string(&font, city.name[6]); /* Avenue de la Gare-des-Eaux-Vives */
	float width = text_width_em(&font, &line);
	assert_true(text_break(&font, &line, 0.6f * width, &end, &start_em));
	assert_true(end > 0.2f * width && end < 0.6f * width && start_em > end && start_em < width);
	assert_false(text_break(&font, &line, 0.1f * width, &end, &start_em));
	line = text_line_string(&font, city.name[14]); /* two words, read from the right */
	width = text_width_em(&font, &line);
	assert_true(line.right_to_left);
	assert_true(text_break(&font, &line, 0.8f * width, &end, &start_em));
	assert_true(width - start_em <= 0.8f * width);
}

static void a_package_without_font_draws_no_text(void **state)
{
	(void)state;
	static struct overlay overlay;
	struct arena arena;
	struct nav_view nav;
	struct view view;
	struct pkg bare = city.pkg;
	bare.font = NULL;
	arena_init(&arena, "test", memory, MEMORY_BYTES);
	assert_int_equal(overlay_init(&overlay, &arena, NULL, &bare, NULL), 0);
	overlay_city_drive(&city, route, route_count, 250.0, 12.0, &nav);
	overlay_city_view(&nav, CAMERA_DRIVER, 1280, 720, &view);
	struct overlay_input input = { .view = &view, .nav = &nav, .kind = CAMERA_DRIVER };
	overlay_update(&overlay, &input);
	for (uint32_t i = 0; i < overlay.canvas.vertex_count; i++)
		assert_true(overlay.canvas.vertices[i].range_px == 0.0f);
	overlay_finish(&overlay);
}

static void a_full_canvas_drops_and_counts(void **state)
{
	(void)state;
	struct canvas canvas;
	struct arena arena;
	arena_init(&arena, "test", memory, MEMORY_BYTES);
	assert_int_equal(canvas_init(&canvas, &arena, NULL, &city.pkg, 100), 0);
	canvas_begin(&canvas, 100, 100);
	for (int i = 0; i < 50; i++)
		canvas_disc(&canvas, (struct vec2){ 50.0f, 50.0f }, 20.0f, (struct rgba){ 1, 1, 1, 1 });
	assert_true(canvas.dropped > 0 && canvas.vertex_count <= 100 && canvas.index_count <= 300);
	for (uint32_t i = 0; i < canvas.index_count; i++)
		assert_true(canvas.indices[i] < canvas.vertex_count);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(readouts_never_overlap),
		cmocka_unit_test(labels_are_calm_for_a_driver),
		cmocka_unit_test(labels_are_calm_behind_the_car),
		cmocka_unit_test(labels_are_calm_from_above),
		cmocka_unit_test(a_label_keeps_its_place_in_the_city),
		cmocka_unit_test(the_same_drive_gives_the_same_vertices),
		cmocka_unit_test(text_stays_in_its_bounds),
		cmocka_unit_test(a_name_breaks_at_a_blank),
		cmocka_unit_test(a_package_without_font_draws_no_text),
		cmocka_unit_test(a_full_canvas_drops_and_counts),
	};
	return cmocka_run_group_tests(tests, open_city, close_city);
}
