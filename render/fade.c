/* One ray a point; opacity goes exponentially to its aim. Cost: FADE_POINTS_MAX walks over the chunks. */
#include "render/fade.h"

#include <math.h>

#define RATE_PER_S 7.0

static struct fade_entry *find(struct fade *fade, uint32_t object)
{
	for (uint32_t i = 0; i < fade->count; i++)
		if (fade->entries[i].object == object)
			return &fade->entries[i];
	return NULL;
}

static void want(struct fade *fade, uint32_t object)
{
	struct fade_entry *entry = find(fade, object);
	if (!entry && fade->count < FADE_OBJECTS_MAX) {
		entry = &fade->entries[fade->count++];
		*entry = (struct fade_entry){ .object = object, .opacity = 1.0f };
	}
	if (entry)
		entry->wanted = true;
}

static void ease(struct fade *fade, double dt_s)
{
	float keep = dt_s < 0.0 ? 0.0f : (float)exp(-RATE_PER_S * dt_s);
	uint32_t kept = 0;
	for (uint32_t i = 0; i < fade->count; i++) {
		struct fade_entry entry = fade->entries[i];
		float aim = entry.wanted ? fade->opacity : 1.0f;
		entry.opacity = aim + (entry.opacity - aim) * keep;
		if (entry.wanted || entry.opacity < 0.99f)
			fade->entries[kept++] = entry;
	}
	fade->count = kept;
}

void fade_update(struct fade *fade, const struct obstacles *obstacles, const int64_t eye_mm[3],
	const int64_t (*points_mm)[3], uint32_t count, int64_t time_ns)
{
	uint32_t objects[FADE_OBJECTS_MAX], found = 0;
	for (uint32_t i = 0; i < count && i < FADE_POINTS_MAX; i++)
		found = obstacles_between(obstacles, eye_mm, points_mm[i], objects, found, FADE_OBJECTS_MAX);
	for (uint32_t i = 0; i < fade->count; i++)
		fade->entries[i].wanted = false;
	for (uint32_t i = 0; i < found; i++)
		want(fade, objects[i]);
	bool cut = fade->time_ns == 0 || time_ns < fade->time_ns;
	ease(fade, cut ? -1.0 : (double)(time_ns - fade->time_ns) * 1e-9);
	fade->time_ns = time_ns;
}
