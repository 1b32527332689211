/* One pass over the image, a least-squares fit a question. */
#include "tools/impostor/foliage_light.h"

#include <math.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/impostor/oct_normal.h"

#define SLOTS_MIN 64
#define SPREAD_MIN 4.0 /* px^2 added to the spread of positions: a crown of a few pixels has one normal */
#define LENGTH_MIN 0.2 /* where the fit is shorter, the mean is taken */

/* The slot that has an object, or the empty one where it belongs. */
static uint32_t *slot_of(const struct foliage_light *light, uint32_t object)
{
	size_t mask = light->slots.count - 1, at = hash_u64(object) & mask;
	while (light->slots.items[at] && light->crowns.items[light->slots.items[at] - 1].object != object)
		at = (at + 1) & mask;
	return &light->slots.items[at];
}

static void make_slots(struct foliage_light *light, size_t count)
{
	ARRAY_RESERVE(&light->slots, count);
	light->slots.count = count;
	memset(light->slots.items, 0, count * sizeof(uint32_t));
	for (uint32_t i = 0; i < light->crowns.count; i++)
		*slot_of(light, light->crowns.items[i].object) = i + 1;
}

static struct crown *crown_of(struct foliage_light *light, uint32_t object)
{
	uint32_t *slot = slot_of(light, object);
	if (!*slot) {
		ARRAY_PUSH(&light->crowns, (struct crown){ .object = object });
		*slot = (uint32_t)light->crowns.count;
		if (2 * light->crowns.count > light->slots.count) {
			make_slots(light, 2 * light->slots.count);
			slot = slot_of(light, object);
		}
	}
	return &light->crowns.items[*slot - 1];
}

static void add_pixel(struct crown *crown, const int8_t oct[2], double x, double y)
{
	struct dvec3 normal = oct_unit_normal(oct);
	const double unit[3] = { normal.x, normal.y, normal.z };
	crown->pixels++;
	crown->x += x;
	crown->y += y;
	crown->xx += x * x;
	crown->xy += x * y;
	crown->yy += y * y;
	for (int i = 0; i < 3; i++) {
		crown->normal[i] += unit[i];
		crown->normal_x[i] += unit[i] * x;
		crown->normal_y[i] += unit[i] * y;
	}
}

void foliage_light_find(struct foliage_light *light, const struct capture_image *image)
{
	*light = (struct foliage_light){ 0 };
	make_slots(light, SLOTS_MIN);
	uint32_t width = image->view.width, count = width * image->view.height;
	struct crown *crown = NULL;
	for (uint32_t i = 0; i < count; i++) {
		const struct capture_pixel *pixel = &image->pixels[i];
		if (!pixel->object || pixel->kind != PKG_MATERIAL_FOLIAGE)
			continue;
		if (!crown || crown->object != pixel->object)
			crown = crown_of(light, pixel->object);
		add_pixel(crown, pixel->normal_oct, i % width + 0.5, i / width + 0.5);
	}
}

void foliage_light_finish(struct foliage_light *light)
{
	ARRAY_FINISH(&light->crowns);
	ARRAY_FINISH(&light->slots);
}

bool foliage_light_at(const struct foliage_light *light, uint32_t object, double x, double y, int8_t normal_oct[2])
{
	uint32_t slot = *slot_of(light, object);
	if (!slot)
		return false;
	const struct crown *crown = &light->crowns.items[slot - 1];
	double scale = 1 / crown->pixels, mean_x = crown->x * scale, mean_y = crown->y * scale;
	double xx = crown->xx * scale - mean_x * mean_x + SPREAD_MIN, yy = crown->yy * scale - mean_y * mean_y + SPREAD_MIN;
	double xy = crown->xy * scale - mean_x * mean_y, determinant = xx * yy - xy * xy;
	double mean[3], fitted[3], squares = 0;
	for (int i = 0; i < 3; i++) {
		mean[i] = crown->normal[i] * scale;
		double along_x = crown->normal_x[i] * scale - mean[i] * mean_x;
		double along_y = crown->normal_y[i] * scale - mean[i] * mean_y;
		fitted[i] =
			mean[i] +
			((along_x * yy - along_y * xy) * (x - mean_x) + (along_y * xx - along_x * xy) * (y - mean_y)) / determinant;
		squares += fitted[i] * fitted[i];
	}
	bool fits = squares > LENGTH_MIN * LENGTH_MIN;
	if (!fits && mean[0] == 0 && mean[1] == 0 && mean[2] == 0)
		return false;
	const double *taken = fits ? fitted : mean;
	oct_encode((struct dvec3){ taken[0], taken[1], taken[2] }, normal_oct);
	return true;
}
