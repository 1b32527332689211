#include "tools/bake/skeleton.h"

#include <math.h>
#include <stdlib.h>

#include "platform/base/rng.h"

#define NEVER 1e300
#define LINE_NONE UINT32_MAX
#define JITTER_M 0.0004
#define SAME_NODE_M 0.02

struct line {
	struct dvec2 along, normal; /* normal points inwards */
	double offset, speed;       /* normal . x == offset + speed t */
	double delay;               /* NEVER when the speed does not change */
	uint32_t edge;              /* of the outline */
	uint32_t base_a, base_b;    /* nodes */
};

/* A vertex of the wavefront, between line `left` that ends in it and line `right` that starts in it. */
struct wave {
	uint32_t prev, next;
	uint32_t left, right;
	uint32_t node; /* where it was born */
	double born;
	struct dvec2 at, velocity;
	bool live;
};

/* A node pair that bounds the faces of both lines. */
struct arc {
	uint32_t from, to;
	uint32_t left, right;
};

struct front {
	struct skeleton *out;
	ARRAY(struct line) lines;
	ARRAY(struct wave) waves;
	ARRAY(struct arc) arcs;
	size_t live;
	double now;
	bool failed;
};

struct event {
	double t;
	uint32_t wave;  /* that meets its next, or that splits */
	uint32_t other; /* NEXT, or the vertex that starts the edge which is hit */
	bool split;
};

static struct dvec2 wave_at(const struct wave *wave, double t)
{
	return dvec2_add(wave->at, dvec2_scale(wave->velocity, t - wave->born));
}

static uint32_t add_node(struct front *front, struct dvec2 at, double t)
{
	ARRAY_PUSH(&front->out->nodes, (struct skeleton_node){ at, t });
	if (!isfinite(at.x) || !isfinite(at.y))
		front->failed = true;
	return (uint32_t)front->out->nodes.count - 1;
}

static void add_arc(struct front *front, uint32_t from, uint32_t to, uint32_t left, uint32_t right)
{
	if (from != to)
		ARRAY_PUSH(&front->arcs, (struct arc){ from, to, left, right });
}

/* The meeting point of two moving lines moves with v: n_l . v = s_l, n_r . v = s_r. */
static void set_velocity(struct front *front, struct wave *wave)
{
	const struct line *l = &front->lines.items[wave->left], *r = &front->lines.items[wave->right];
	double det = dvec2_cross(l->normal, r->normal);
	if (fabs(det) < 1e-12) {
		wave->velocity = dvec2_scale(l->normal, fmin(l->speed, r->speed));
		return;
	}
	wave->velocity.x = (l->speed * r->normal.y - r->speed * l->normal.y) / det;
	wave->velocity.y = (r->speed * l->normal.x - l->speed * r->normal.x) / det;
}

static uint32_t add_wave(struct front *front, uint32_t left, uint32_t right, uint32_t node)
{
	struct wave wave = { .left = left, .right = right, .node = node, .born = front->now, .live = true };
	wave.at = front->out->nodes.items[node].at;
	set_velocity(front, &wave);
	ARRAY_PUSH(&front->waves, wave);
	front->live++;
	return (uint32_t)front->waves.count - 1;
}

static void retire(struct front *front, uint32_t index, uint32_t node)
{
	struct wave *wave = &front->waves.items[index];
	add_arc(front, wave->node, node, wave->left, wave->right);
	wave->live = false;
	front->live--;
}

static void join(struct front *front, uint32_t prev, uint32_t next)
{
	front->waves.items[prev].next = next;
	front->waves.items[next].prev = prev;
}

/* A loop of two has no area left: what lies between its two vertices is a ridge. */
static void close_if_flat(struct front *front, uint32_t index)
{
	uint32_t other = front->waves.items[index].next;
	if (front->waves.items[other].next != index)
		return;
	uint32_t node = front->waves.items[index].node;
	front->waves.items[index].live = false;
	front->live--;
	if (other != index)
		retire(front, other, node);
}

static struct dvec2 jittered(struct dvec2 at, size_t index)
{
	uint64_t hash = hash_u64(index + 1);
	at.x += ((double)(hash & 0xFFFF) / 65535.0 - 0.5) * 2.0 * JITTER_M;
	at.y += ((double)(hash >> 16 & 0xFFFF) / 65535.0 - 0.5) * 2.0 * JITTER_M;
	return at;
}

static void add_line(struct front *front, const struct skeleton_outline *outline, size_t a, size_t b)
{
	struct dvec2 from = front->out->nodes.items[a].at, to = front->out->nodes.items[b].at;
	struct dvec2 along = dvec2_sub(to, from);
	double length = dvec2_length(along);
	if (length < 1e-9) {
		front->failed = true;
		length = 1.0;
	}
	along = dvec2_scale(along, 1.0 / length);
	struct line line = { .along = along, .normal = { -along.y, along.x }, .speed = outline->speed[a], .delay = NEVER };
	line.offset = dvec2_dot(line.normal, from);
	line.edge = (uint32_t)a;
	line.base_a = (uint32_t)a;
	line.base_b = (uint32_t)b;
	if (outline->delay && outline->delay[a] > 0.0) {
		line.speed = 0.0;
		line.delay = outline->delay[a];
	}
	ARRAY_PUSH(&front->lines, line);
}

static void start_ring(struct front *front, const struct skeleton_outline *outline, size_t first, size_t end)
{
	for (size_t i = first; i < end; i++)
		add_line(front, outline, i, i + 1 < end ? i + 1 : first);
	for (size_t i = first; i < end; i++)
		add_wave(front, (uint32_t)(i > first ? i - 1 : end - 1), (uint32_t)i, (uint32_t)i);
	for (size_t i = first; i < end; i++)
		join(front, (uint32_t)i, (uint32_t)(i + 1 < end ? i + 1 : first));
}

static bool start_front(struct front *front, const struct skeleton_outline *outline)
{
	size_t total = outline->ring_first[outline->ring_count];
	for (size_t i = 0; i < total; i++)
		add_node(front, jittered(outline->points[i], i), 0.0);
	for (size_t r = 0; r < outline->ring_count; r++) {
		if (outline->ring_first[r + 1] - outline->ring_first[r] < 3)
			return false;
		start_ring(front, outline, outline->ring_first[r], outline->ring_first[r + 1]);
	}
	return !front->failed;
}

static double meeting_time(const struct front *front, const struct wave *a, const struct wave *b)
{
	struct dvec2 along = front->lines.items[a->right].along;
	double length = dvec2_dot(dvec2_sub(wave_at(b, front->now), wave_at(a, front->now)), along);
	double rate = dvec2_dot(dvec2_sub(b->velocity, a->velocity), along);
	return rate < -1e-12 ? front->now + fmax(length, 0.0) / -rate : NEVER;
}

static double split_time(const struct front *front, const struct wave *wave, const struct wave *a, double best)
{
	if (a->right == wave->left || a->right == wave->right)
		return NEVER;
	const struct line *line = &front->lines.items[a->right];
	double rate = dvec2_dot(line->normal, wave->velocity) - line->speed;
	if (rate > -1e-12)
		return NEVER;
	double distance = dvec2_dot(line->normal, wave_at(wave, front->now)) - line->offset - line->speed * front->now;
	if (distance < -1e-6)
		return NEVER;
	double t = front->now + fmax(distance, 0.0) / -rate;
	if (t >= best)
		return NEVER;
	struct dvec2 at = wave_at(wave, t);
	const struct wave *b = &front->waves.items[a->next];
	bool behind = dvec2_dot(dvec2_sub(at, wave_at(a, t)), line->along) < -1e-9;
	bool beyond = dvec2_dot(dvec2_sub(at, wave_at(b, t)), line->along) > 1e-9;
	return behind || beyond ? NEVER : t;
}

static bool reflex(const struct front *front, const struct wave *wave)
{
	return dvec2_cross(front->lines.items[wave->left].along, front->lines.items[wave->right].along) < -1e-9;
}

static struct event next_event(const struct front *front)
{
	struct event best = { .t = NEVER };
	const struct wave *waves = front->waves.items;
	for (uint32_t i = 0; i < front->waves.count; i++) {
		if (!waves[i].live)
			continue;
		double t = meeting_time(front, &waves[i], &waves[waves[i].next]);
		if (t < best.t)
			best = (struct event){ t, i, waves[i].next, false };
	}
	for (uint32_t i = 0; i < front->waves.count; i++) {
		if (!waves[i].live || !reflex(front, &waves[i]))
			continue;
		for (uint32_t k = 0; k < front->waves.count; k++) {
			if (!waves[k].live)
				continue;
			double t = split_time(front, &waves[i], &waves[k], best.t);
			if (t < best.t)
				best = (struct event){ t, i, k, true };
		}
	}
	return best;
}

static void meet(struct front *front, uint32_t a, uint32_t b)
{
	const struct wave *waves = front->waves.items;
	uint32_t before = waves[a].prev, after = waves[b].next;
	uint32_t left = waves[a].left, right = waves[b].right;
	struct dvec2 pa = wave_at(&waves[a], front->now), pb = wave_at(&waves[b], front->now);
	uint32_t node = add_node(front, dvec2_scale(dvec2_add(pa, pb), 0.5), front->now);
	bool triangle = before == after && before != a && before != b;
	retire(front, a, node);
	retire(front, b, node);
	if (before == b)
		return;
	if (triangle) {
		retire(front, before, node);
		return;
	}
	uint32_t made = add_wave(front, left, right, node);
	join(front, before, made);
	join(front, made, after);
	close_if_flat(front, made);
}

static void split(struct front *front, uint32_t index, uint32_t a)
{
	struct wave wave = front->waves.items[index];
	uint32_t b = front->waves.items[a].next, line = front->waves.items[a].right;
	uint32_t node = add_node(front, wave_at(&wave, front->now), front->now);
	retire(front, index, node);
	uint32_t first = add_wave(front, wave.left, line, node), second = add_wave(front, line, wave.right, node);
	join(front, wave.prev, first);
	join(front, first, b);
	join(front, a, second);
	join(front, second, wave.next);
	close_if_flat(front, first);
	if (front->waves.items[second].live)
		close_if_flat(front, second);
}

static uint32_t rest_at(struct front *front, uint32_t index)
{
	struct wave *wave = &front->waves.items[index];
	uint32_t node = add_node(front, wave_at(wave, front->now), front->now);
	wave = &front->waves.items[index];
	add_arc(front, wave->node, node, wave->left, wave->right);
	wave->at = front->out->nodes.items[node].at;
	wave->born = front->now;
	wave->node = node;
	return node;
}

/* A half hip: the gable ends here; what is left of its edge moves on as a line of its own. */
static void wake(struct front *front, uint32_t line_index)
{
	front->lines.items[line_index].delay = NEVER;
	size_t count = front->waves.count;
	for (uint32_t a = 0; a < count; a++) {
		if (!front->waves.items[a].live || front->waves.items[a].right != line_index)
			continue;
		uint32_t b = front->waves.items[a].next;
		struct line line = front->lines.items[line_index];
		line.base_a = rest_at(front, a);
		line.base_b = rest_at(front, b);
		line.speed = 1.0;
		line.offset -= front->now;
		ARRAY_PUSH(&front->lines, line);
		uint32_t made = (uint32_t)front->lines.count - 1;
		ARRAY_PUSH(&front->arcs, (struct arc){ line.base_a, line.base_b, line_index, LINE_NONE });
		front->waves.items[a].right = made;
		front->waves.items[b].left = made;
		set_velocity(front, &front->waves.items[a]);
		set_velocity(front, &front->waves.items[b]);
	}
}

static uint32_t next_waking(const struct front *front)
{
	uint32_t best = LINE_NONE;
	for (uint32_t i = 0; i < front->lines.count; i++)
		if (front->lines.items[i].delay < NEVER &&
			(best == LINE_NONE || front->lines.items[i].delay < front->lines.items[best].delay))
			best = i;
	return best;
}

static void run_front(struct front *front)
{
	size_t limit = front->waves.count * 8 + 64;
	for (size_t i = 0; front->live && !front->failed && i < limit; i++) {
		struct event event = next_event(front);
		uint32_t waking = next_waking(front);
		if (waking != LINE_NONE && front->lines.items[waking].delay <= event.t) {
			front->now = fmax(front->now, front->lines.items[waking].delay);
			wake(front, waking);
			continue;
		}
		if (event.t >= NEVER)
			break;
		front->now = fmax(front->now, event.t);
		if (event.split)
			split(front, event.wave, event.other);
		else
			meet(front, event.wave, event.other);
	}
	front->failed |= front->live > 0;
	front->out->t_max = front->now;
}

/* Nodes that fell together but for the jitter become one: the lowest index stands for all. */
static uint32_t *merged_nodes(const struct skeleton *skeleton, size_t outline_points)
{
	size_t count = skeleton->nodes.count;
	uint32_t *stand = malloc(sizeof(*stand) * (count + 1));
	for (uint32_t i = 0; stand && i < count; i++) {
		stand[i] = i;
		struct dvec2 at = skeleton->nodes.items[i].at;
		for (uint32_t k = 0; k < i && i >= outline_points; k++) {
			struct skeleton_node other = skeleton->nodes.items[k];
			if (stand[k] == k && fabs(other.t - skeleton->nodes.items[i].t) < SAME_NODE_M &&
				dvec2_length(dvec2_sub(other.at, at)) < SAME_NODE_M) {
				stand[i] = k;
				break;
			}
		}
	}
	return stand;
}

struct face_arcs {
	uint32_t from, to;
	bool used;
};

/* Walks the arcs of one face from the end of its base edge back to the start. */
static bool walk_face(
	struct skeleton *out, const struct line *line, struct face_arcs *arcs, size_t count, const uint32_t *stand)
{
	uint32_t start = stand[line->base_a], at = stand[line->base_b];
	struct skeleton_face face = { .first = (uint32_t)out->face_nodes.count, .edge = line->edge };
	face.upright = line->speed <= 0.0;
	if (start == at)
		return true;
	ARRAY_PUSH(&out->face_nodes, start);
	ARRAY_PUSH(&out->face_nodes, at);
	for (size_t step = 0; at != start; step++) {
		size_t found = count;
		for (size_t i = 0; i < count && found == count; i++)
			if (!arcs[i].used && (arcs[i].from == at || arcs[i].to == at))
				found = i;
		if (found == count || step > count)
			return false;
		arcs[found].used = true;
		at = arcs[found].from == at ? arcs[found].to : arcs[found].from;
		if (at != start)
			ARRAY_PUSH(&out->face_nodes, at);
	}
	face.count = (uint32_t)out->face_nodes.count - face.first;
	ARRAY_PUSH(&out->faces, face);
	return true;
}

/* An arc met twice leaves no area between: a spur, which both sides of it would see. */
static size_t cancel_spurs(struct face_arcs *arcs, size_t count)
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = i + 1; k < count; k++)
			if ((arcs[i].from == arcs[k].from && arcs[i].to == arcs[k].to) ||
				(arcs[i].from == arcs[k].to && arcs[i].to == arcs[k].from)) {
				arcs[k] = arcs[--count];
				arcs[i] = arcs[--count];
				i = (size_t)-1;
				break;
			}
	return count;
}

static bool collect_faces(struct front *front, const uint32_t *stand)
{
	struct face_arcs *arcs = malloc(sizeof(*arcs) * (front->arcs.count + 1));
	bool good = arcs != NULL;
	for (uint32_t l = 0; good && l < front->lines.count; l++) {
		size_t count = 0;
		for (size_t i = 0; i < front->arcs.count; i++) {
			const struct arc *arc = &front->arcs.items[i];
			if ((arc->left == l || arc->right == l) && stand[arc->from] != stand[arc->to])
				arcs[count++] = (struct face_arcs){ stand[arc->from], stand[arc->to], false };
		}
		count = cancel_spurs(arcs, count);
		good = walk_face(front->out, &front->lines.items[l], arcs, count, stand);
	}
	free(arcs);
	return good;
}

static double face_area(const struct skeleton *skeleton, const struct skeleton_face *face)
{
	const uint32_t *nodes = skeleton->face_nodes.items + face->first;
	struct dvec2 base = skeleton->nodes.items[nodes[0]].at;
	double twice = 0.0;
	for (uint32_t i = 1; i + 1 < face->count; i++)
		twice += dvec2_cross(dvec2_sub(skeleton->nodes.items[nodes[i]].at, base),
			dvec2_sub(skeleton->nodes.items[nodes[i + 1]].at, base));
	return twice / 2.0;
}

static double outline_area(const struct skeleton_outline *outline)
{
	double twice = 0.0;
	for (size_t r = 0; r < outline->ring_count; r++) {
		size_t first = outline->ring_first[r], end = outline->ring_first[r + 1];
		for (size_t i = first; i < end; i++)
			twice += dvec2_cross(dvec2_sub(outline->points[i], outline->points[0]),
				dvec2_sub(outline->points[i + 1 < end ? i + 1 : first], outline->points[0]));
	}
	return twice / 2.0;
}

static bool areas_hold(const struct skeleton *skeleton, const struct skeleton_outline *outline)
{
	double whole = outline_area(outline), sum = 0.0, absolute = 0.0;
	for (size_t i = 0; i < skeleton->faces.count; i++) {
		double area = face_area(skeleton, &skeleton->faces.items[i]);
		sum += area;
		absolute += fabs(area);
	}
	double slack = 0.05 + 0.005 * whole;
	return fabs(sum - whole) < slack && fabs(absolute - whole) < slack;
}

bool skeleton_build(const struct skeleton_outline *outline, struct skeleton *out)
{
	out->nodes.count = out->face_nodes.count = out->faces.count = 0;
	out->t_max = 0.0;
	struct front front = { .out = out };
	bool good = start_front(&front, outline);
	size_t outline_points = out->nodes.count;
	if (good) {
		run_front(&front);
		good = !front.failed;
	}
	if (good) {
		uint32_t *stand = merged_nodes(out, outline_points);
		good = stand && collect_faces(&front, stand);
		free(stand);
	}
	for (size_t i = 0; i < outline_points && i < out->nodes.count; i++)
		out->nodes.items[i].at = outline->points[i];
	good = good && areas_hold(out, outline);
	ARRAY_FINISH(&front.lines);
	ARRAY_FINISH(&front.waves);
	ARRAY_FINISH(&front.arcs);
	return good;
}

void skeleton_finish(struct skeleton *skeleton)
{
	ARRAY_FINISH(&skeleton->nodes);
	ARRAY_FINISH(&skeleton->face_nodes);
	ARRAY_FINISH(&skeleton->faces);
}
