/* Placing: at most 32 labels against each other and the taken boxes, a few microseconds. */
#include "render/labels.h"

#include <math.h>

#include "platform/base/clock.h"

#define REFRESH_NS (200 * NS_PER_MS)
#define FADE_S 0.35f
#define DEBOUNCE_NS (250 * NS_PER_MS) /* free for so long before it appears */
#define REST_NS (900 * NS_PER_MS)     /* stays away for so long after it went */
#define NEAR_M 14.0f                  /* gone when it is this near */
#define FAR_M 330.0f
#define APPROACH_S 4.0f /* how far ahead its way is clear; more than LIFE_S since approaches quicken */
#define TURNING_RPS 0.12f
#define LIFE_S 1.6f         /* not shown when the car passes it sooner */
#define CLEAR_ON_PX 26.0f   /* at 720: free space around it to appear */
#define CLEAR_OFF_PX 7.0f   /* less: it goes */
#define CLEAR_FULL_PX 12.0f /* less: it is already fainter, so that it is gone before it touches */

int labels_init(struct labels *labels, struct arena *arena, const struct pkg *pkg, const struct text_font *font)
{
	*labels = (struct labels){ .pkg = pkg, .font = font };
	labels->stats.shortest_life_ns = INT64_MAX;
	return label_grid_init(labels, arena);
}

static struct label *find_slot(struct labels *labels, uint64_t key)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		if (labels->slots[i].used && labels->slots[i].what.key == key)
			return &labels->slots[i];
	return NULL;
}

static struct label *free_slot(struct labels *labels)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		if (!labels->slots[i].used)
			return &labels->slots[i];
	/* one that is wanted no more and not seen may go at once */
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		if (!labels->slots[i].wanted && labels->slots[i].alpha <= 0.0f)
			return &labels->slots[i];
	return NULL;
}

/* A living label keeps its place; rank and order follow the candidate. */
static void take_candidates(struct labels *labels, int64_t now_ns)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		labels->slots[i].wanted = false;
	for (uint32_t i = 0; i < labels->candidate_count; i++) {
		struct label *slot = find_slot(labels, labels->candidates[i].key);
		if (slot) {
			slot->wanted = true;
			slot->what.rank = labels->candidates[i].rank;
			slot->what.order = labels->candidates[i].order;
		}
	}
	for (uint32_t i = 0; i < labels->candidate_count; i++) {
		if (find_slot(labels, labels->candidates[i].key))
			continue;
		struct label *slot = free_slot(labels);
		if (!slot) {
			labels->stats.dropped += labels->candidate_count - i;
			return;
		}
		*slot = (struct label){ .used = true, .wanted = true, .what = labels->candidates[i] };
		slot->eligible_since_ns = now_ns;
		slot->off_since_ns = now_ns - REST_NS;
	}
}

static bool project(const struct view *view, const int32_t at_mm[3], struct vec2 *out, float *depth)
{
	int64_t at[3] = { at_mm[0], at_mm[1], at_mm[2] };
	struct vec3 eye = view_relative(view, at);
	*depth = vec3_dot(eye, view->forward);
	if (*depth < 0.5f)
		return false;
	out->x = (float)view->width / 2.0f + vec3_dot(eye, view->right) / *depth * view->focal_px;
	out->y = (float)view->height / 2.0f - vec3_dot(eye, view->up) / *depth * view->focal_px;
	return true;
}

/* Reads from left to right; turns over only well past the vertical, so that it does not flip to and fro. */
static float angle_along(struct label *label, struct vec2 at, struct vec2 towards)
{
	float angle = atan2f(towards.y - at.y, towards.x - at.x);
	if (label->flipped)
		angle += (float)BLVD_PI;
	angle = remainderf(angle, 2.0f * (float)BLVD_PI);
	float limit = (float)BLVD_PI / 2.0f + (label->on ? 0.25f : 0.0f);
	if (fabsf(angle) > limit) {
		label->flipped = !label->flipped;
		angle = remainderf(angle + (float)BLVD_PI, 2.0f * (float)BLVD_PI);
	}
	return angle;
}

static struct box turned_box(const struct label *label, float half_width, float half_height)
{
	float c = fabsf(cosf(label->angle_rad)), s = fabsf(sinf(label->angle_rad));
	float x = half_width * c + half_height * s, y = half_width * s + half_height * c;
	return (struct box){ label->x - x, label->y - y, label->x + x, label->y + y };
}

/* On the screen: place, angle, box. False behind the eye. */
static bool place(struct labels *labels, struct label *label, const struct labels_input *input)
{
	struct vec2 at, towards;
	float towards_depth;
	if (!project(input->view, label->what.at_mm, &at, &label->depth_m))
		return false;
	label->x = at.x;
	label->y = at.y;
	label->angle_rad = 0.0f;
	if (label->what.along && project(input->view, label->what.towards_mm, &towards, &towards_depth))
		label->angle_rad = angle_along(label, at, towards);
	label->size_px = (label->what.along ? 24.0f : 26.0f + 4.0f * label->strength) * input->scale;
	struct text_line line = text_line_string(labels->font, label->what.string);
	float half_width = text_width_em(labels->font, &line) * label->size_px / 2.0f + 4.0f * input->scale;
	label->box = turned_box(label, half_width, 0.68f * label->size_px);
	return half_width > 4.0f * input->scale;
}

/* Free pixels between two boxes; negative when they overlap. */
static float gap(const struct box *a, const struct box *b)
{
	float x = fmaxf(a->x0 - b->x1, b->x0 - a->x1), y = fmaxf(a->y0 - b->y1, b->y0 - a->y1);
	return fmaxf(x, y);
}

static float clearance(const struct label *label, const struct labels_input *input, const struct label *const *placed,
	uint32_t placed_count)
{
	const struct box *box = &label->box;
	float width = (float)input->view->width, height = (float)input->view->height;
	float least = fminf(fminf(box->x0, box->y0), fminf(width - box->x1, height - box->y1));
	for (uint32_t i = 0; i < input->taken_count; i++)
		least = fminf(least, gap(box, &input->taken[i]));
	for (uint32_t i = 0; i < placed_count; i++)
		least = fminf(least, gap(box, &placed[i]->box));
	return least;
}

static bool in_reach(const struct label *label, const struct labels_input *input)
{
	if (label->what.along)
		return true;
	float speed = fmaxf((float)input->nav->speed_mps, 0.0f);
	if (label->on)
		return label->depth_m > NEAR_M + FADE_S * speed && label->depth_m < FAR_M + 30.0f;
	return label->depth_m > NEAR_M + 8.0f + LIFE_S * speed && label->depth_m < FAR_M;
}

static void switch_on(struct labels *labels, struct label *label, int64_t now_ns)
{
	label->on = true;
	label->on_since_ns = now_ns;
	labels->stats.appeared++;
}

static void switch_off(struct labels *labels, struct label *label, int64_t now_ns)
{
	label->on = false;
	label->off_since_ns = label->eligible_since_ns = now_ns;
	labels->stats.disappeared++;
	int64_t life = now_ns - label->on_since_ns;
	if (life < labels->stats.shortest_life_ns)
		labels->stats.shortest_life_ns = life;
}

static bool name_is_on(const struct labels *labels, const struct label *label, const struct label *const *placed,
	uint32_t placed_count, float scale)
{
	(void)labels;
	for (uint32_t i = 0; i < placed_count; i++) {
		const struct label *other = placed[i];
		if (other->what.string != label->what.string)
			continue;
		if (!label->what.along || hypotf(other->x - label->x, other->y - label->y) < 420.0f * scale)
			return true;
	}
	return false;
}

/* A label that is about to run into something goes while there is still time to fade. */
static void follow_room(struct label *label, float room, float seconds)
{
	/* a jump is a neighbour that came or went, not an approach */
	float closing = seconds > 0.0f ? fmaxf((label->room_px - room) / seconds, 0.0f) : 1e9f;
	if (closing < 1500.0f)
		label->closing_pps += (closing - label->closing_pps) * fminf(seconds / 0.1f, 1.0f);
	label->room_px = room;
}

static void decide(struct labels *labels, struct label *label, const struct labels_input *input,
	const struct label *const *placed, uint32_t placed_count, float step)
{
	bool seen = place(labels, label, input);
	float room = seen ? clearance(label, input, placed, placed_count) / input->scale : -1.0f;
	bool keep = seen && label->wanted && !label->evicted && in_reach(label, input);
	follow_room(label, room, step * FADE_S);
	/* not in its first second and a half: a name that only flashes is worse than one that is cut */
	bool fresh = input->now_ns - label->on_since_ns < (int64_t)(LIFE_S * 1e9f);
	float soon = fresh ? 0.0f : label->closing_pps * 1.6f * FADE_S;
	if (label->on) {
		if (!keep || room - soon < CLEAR_OFF_PX)
			switch_off(labels, label, input->now_ns);
	} else {
		bool lasts = room - label->closing_pps * APPROACH_S >= CLEAR_OFF_PX;
		bool free = keep && !labels->turning && room >= CLEAR_ON_PX && lasts &&
					!name_is_on(labels, label, placed, placed_count, input->scale);
		if (!free)
			label->eligible_since_ns = input->now_ns;
		else if (input->now_ns - label->eligible_since_ns >= DEBOUNCE_NS &&
				 input->now_ns - label->off_since_ns >= REST_NS)
			switch_on(labels, label, input->now_ns);
	}
	float allowed = fminf(fmaxf(room / CLEAR_FULL_PX, 0.0f), 1.0f);
	/* gone at once when it must, back only gradually */
	label->shown = seen ? fminf(label->alpha * allowed, label->shown + step) : 0.0f;
}

static bool goes_first(const struct label *a, const struct label *b)
{
	bool a_seen = a->on || a->alpha > 0.0f, b_seen = b->on || b->alpha > 0.0f;
	if (a_seen != b_seen)
		return a_seen;
	if (a->what.rank != b->what.rank)
		return a->what.rank > b->what.rank;
	return a->what.order != b->what.order ? a->what.order < b->what.order : a->what.key < b->what.key;
}

static uint32_t sort_slots(struct labels *labels, struct label **order)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < LABELS_MAX; i++) {
		if (!labels->slots[i].used)
			continue;
		uint32_t at = count++;
		for (; at > 0 && goes_first(&labels->slots[i], order[at - 1]); at--)
			order[at] = order[at - 1];
		order[at] = &labels->slots[i];
	}
	return count;
}

/* The next manoeuvre's street comes on as soon as what stands in its place has faded. */
static void evict(struct labels *labels, const struct labels_input *input)
{
	const struct label *top = NULL;
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		if (labels->slots[i].used && labels->slots[i].wanted && labels->slots[i].what.rank == LABEL_MANOEUVRE)
			top = &labels->slots[i];
	bool waiting = top && !top->on && in_reach(top, input);
	for (uint32_t i = 0; i < LABELS_MAX; i++) {
		struct label *label = &labels->slots[i];
		bool fresh = label->on && input->now_ns - label->on_since_ns < (int64_t)(LIFE_S * 1e9f);
		label->evicted =
			!fresh && waiting && label != top &&
			(label->what.string == top->what.string || gap(&label->box, &top->box) < CLEAR_ON_PX * input->scale);
	}
}

static void fade(struct label *label, float step)
{
	float strong = label->what.rank == LABEL_MANOEUVRE ? 1.0f : 0.0f;
	label->strength += fminf(fmaxf(strong - label->strength, -step), step);
	label->alpha = label->on ? fminf(label->alpha + step, 1.0f) : fmaxf(label->alpha - step, 0.0f);
	if (!label->wanted && label->alpha <= 0.0f && !label->on)
		label->used = false;
}

/* A corner ahead counts as soon as a label that appears now could not live through. */
static bool is_turning(struct labels *labels, const struct labels_input *input, float seconds)
{
	const struct nav_view *nav = input->nav;
	float turned = 1.0f - vec3_dot(labels->right, input->view->right);
	labels->right = input->view->right;
	float limit = TURNING_RPS * fmaxf(seconds, 1e-3f);
	bool corner = nav->routed && nav->next.manoeuvre > NAV_MANOEUVRE_STRAIGHT &&
				  nav->next.manoeuvre < NAV_MANOEUVRE_ARRIVE && input->kind != CAMERA_NORTH_UP;
	/* 1 - cos x is about x^2 / 2 */
	return turned > limit * limit / 2.0f || (corner && nav->next.distance_m < LIFE_S * nav->speed_mps + 8.0);
}

static void start_anew(struct labels *labels, const struct labels_input *input)
{
	memset(labels->slots, 0, sizeof(labels->slots));
	labels->kind = input->kind;
	labels->started = true;
	labels->right = input->view->right;
	labels->updated_ns = input->now_ns;
	labels->refreshed_ns = input->now_ns - REFRESH_NS;
}

void labels_update(struct labels *labels, const struct labels_input *input)
{
	struct label *order[LABELS_MAX];
	const struct label *placed[LABELS_MAX];
	uint32_t placed_count = 0;
	if (!labels->started || input->now_ns < labels->updated_ns || input->kind != labels->kind)
		start_anew(labels, input);
	float step = (float)fmin((double)(input->now_ns - labels->updated_ns) * 1e-9, 0.25) / FADE_S;
	labels->updated_ns = input->now_ns;
	labels->turning = is_turning(labels, input, step * FADE_S);
	if (input->now_ns - labels->refreshed_ns >= REFRESH_NS) {
		label_candidates_find(labels, input);
		take_candidates(labels, input->now_ns);
		labels->refreshed_ns = input->now_ns;
	}
	uint32_t count = sort_slots(labels, order);
	for (uint32_t i = 0; i < count; i++) {
		decide(labels, order[i], input, placed, placed_count, step);
		if (order[i]->on || order[i]->shown > 0.0f)
			placed[placed_count++] = order[i];
		fade(order[i], step);
	}
	evict(labels, input);
}

static struct rgba mix(struct rgba a, struct rgba b, float t)
{
	return (struct rgba){ a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t };
}

void labels_draw(const struct labels *labels, struct canvas *canvas, const struct palette *palette)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++) {
		const struct label *label = &labels->slots[i];
		if (!label->used || label->shown <= 0.0f)
			continue;
		struct text_style style = {
			.size_px = label->size_px,
			.fill = rgba_fade(mix(palette->label, palette->label_strong, label->strength), label->shown),
			.halo = rgba_fade(palette->label_halo, label->shown),
			.halo_px = 0.13f * label->size_px,
			.weight = 0.014f + 0.008f * label->strength,
			.align = TEXT_CENTER,
			.angle_rad = label->angle_rad,
		};
		struct text_line line = text_line_string(labels->font, label->what.string);
		float down = text_middle(labels->font, label->size_px);
		float x = label->x - sinf(label->angle_rad) * down, y = label->y + cosf(label->angle_rad) * down;
		text_draw(canvas, labels->font, &line, x, y, &style);
	}
}
