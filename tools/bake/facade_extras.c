/* What sticks out of walls: balconies, the awnings of shops. Open at the back, where they meet the wall. */
#include "tools/bake/buildings.h"

#include <math.h>

#include "platform/base/rng.h"

/* A block in front of a wall, from s0 to s1 along it. */
struct ledge {
	double s0, s1, out, low, high;
	double tile_m;
};

static struct shell_point on_wall(const struct wall *w, double s, double out, double z, double u, double v, double ao)
{
	struct dvec2 at = dvec2_add(w->a, dvec2_add(dvec2_scale(w->along, s), dvec2_scale(w->out, out)));
	return (struct shell_point){ { at.x, at.y, z }, (float)u, (float)v, (float)ao };
}

static void draw_ledge(const struct wall *w, const struct ledge *l, struct shell *shell)
{
	double t = l->tile_m, wide = (l->s1 - l->s0) / t, high = (l->high - l->low) / t, deep = l->out / t;
	shell_face(shell,
		(struct shell_point[4]){ on_wall(w, l->s0, l->out, l->low, 0, 0, 0.85),
			on_wall(w, l->s1, l->out, l->low, wide, 0, 0.85), on_wall(w, l->s1, l->out, l->high, wide, high, 1),
			on_wall(w, l->s0, l->out, l->high, 0, high, 1) },
		4);
	shell_face(shell,
		(struct shell_point[4]){ on_wall(w, l->s0, 0, l->low, 0, 0, 0.45), on_wall(w, l->s1, 0, l->low, wide, 0, 0.45),
			on_wall(w, l->s1, l->out, l->low, wide, deep, 0.7), on_wall(w, l->s0, l->out, l->low, 0, deep, 0.7) },
		4);
	shell_face(shell,
		(struct shell_point[4]){ on_wall(w, l->s0, l->out, l->high, 0, 0, 1),
			on_wall(w, l->s1, l->out, l->high, wide, 0, 1), on_wall(w, l->s1, 0, l->high, wide, deep, 0.7),
			on_wall(w, l->s0, 0, l->high, 0, deep, 0.7) },
		4);
	shell_face(shell,
		(struct shell_point[4]){ on_wall(w, l->s0, 0, l->low, 0, 0, 0.6),
			on_wall(w, l->s0, l->out, l->low, deep, 0, 0.85), on_wall(w, l->s0, l->out, l->high, deep, high, 1),
			on_wall(w, l->s0, 0, l->high, 0, high, 0.8) },
		4);
	shell_face(shell,
		(struct shell_point[4]){ on_wall(w, l->s1, l->out, l->low, 0, 0, 0.85),
			on_wall(w, l->s1, 0, l->low, deep, 0, 0.6), on_wall(w, l->s1, 0, l->high, deep, high, 0.8),
			on_wall(w, l->s1, l->out, l->high, 0, high, 1) },
		4);
}

/* Modern flats: one along each storey. */
static void draw_decks(
	const struct massing *m, const struct wall *w, double first, double storey, int storeys, struct shell *shell)
{
	uint8_t rgb[3];
	for (int i = 0; i < 3; i++)
		rgb[i] = (uint8_t)(m->facade.wall_rgb[i] / 2 + 122);
	shell_brush(shell, MATERIAL_BLANK_CONCRETE, rgb);
	double out = fmin(1.0, w->street_m * 0.2), margin = fmin(0.6, w->length * 0.1);
	for (int i = 0; i < storeys && i < 12; i++) {
		double z = first + storey * i;
		draw_ledge(w, &(struct ledge){ margin, w->length - margin, out, z - 0.12, z + storey * 0.36, 3.0 }, shell);
	}
}

/* Town houses: a slab above the door, or long ones at the first and the last floor. */
static void draw_stone(
	const struct massing *m, const struct wall *w, double first, double storey, int storeys, struct shell *shell)
{
	bool door = m->door_wall == (uint32_t)(w - m->walls.items);
	unsigned luck = (unsigned)(m->hash >> 33) % 100;
	int bays = (int)fmax(1.0, round(w->length / m->facade.bay_m));
	double bay = w->length / bays;
	shell_brush(shell, MATERIAL_TRIM, m->facade.base_rgb);
	if (m->facade.upper == MATERIAL_WALL_ASHLAR || m->facade.upper == MATERIAL_WALL_FRENCH) {
		int floors[2] = { 0, storeys >= 4 ? storeys - 1 : 0 };
		for (int i = 0; i < (floors[1] > 0 ? 2 : 1) && luck < 70; i++) {
			double z = first + storey * floors[i];
			draw_ledge(
				w, &(struct ledge){ bay * 0.12, w->length - bay * 0.12, 0.55, z - 0.1, z + storey * 0.1, 2.0 }, shell);
		}
	} else if (door && luck < 45 && bays >= 3 && m->facade.door == MATERIAL_DOOR_PORTAL) {
		double middle = bay * ((bays == 1 ? 0 : bays / 2 - (int)(m->hash >> 50 & 1) * (bays % 2 == 0)) + 0.5);
		draw_ledge(
			w, &(struct ledge){ middle - bay * 0.46, middle + bay * 0.46, 0.7, first - 0.15, first + 0.1, 2.0 }, shell);
	}
}

void facade_balconies(
	const struct massing *m, const struct wall *w, double first, double storey, int storeys, struct shell *shell)
{
	if (w->street_m > 26.0 || w->street_m < 3.0 || w->length < 5.0 || storey < 2.2 ||
		m->building->kind == BUILDING_CIVIC)
		return;
	if (m->facade.upper == MATERIAL_WALL_BALCONY && (m->hash >> 35) % 100 < 60)
		draw_decks(m, w, first, storey, storeys, shell);
	else if (m->facade.cornice && m->has_ground_floor)
		draw_stone(m, w, first, storey, storeys, shell);
}

void facade_awning(const struct massing *m, const struct wall *w, double s0, double s1, double z, struct shell *shell)
{
	static const uint8_t cloths[6][3] = { { 168, 104, 94 }, { 104, 128, 114 }, { 100, 114, 140 }, { 198, 176, 134 },
		{ 150, 142, 132 }, { 222, 214, 200 } };
	double out = fmin(1.1, w->street_m * 0.25), drop = out * 0.5, wide = round((s1 - s0) / 2.0);
	if (out < 0.4 || s1 - s0 < 1.5)
		return;
	shell_brush(shell, MATERIAL_AWNING, cloths[hash_u64(m->hash + (uint64_t)(s0 * 8.0)) % 6]);
	struct shell_point back_a = on_wall(w, s0, 0.02, z, 0, 1, 1), back_b = on_wall(w, s1, 0.02, z, wide, 1, 1);
	struct shell_point lip_a = on_wall(w, s0, out, z - drop, 0, 0.2, 1),
					   lip_b = on_wall(w, s1, out, z - drop, wide, 0.2, 1);
	struct shell_point low_a = on_wall(w, s0, out, z - drop - 0.2, 0, 0, 0.9),
					   low_b = on_wall(w, s1, out, z - drop - 0.2, wide, 0, 0.9);
	struct shell_point foot_a = on_wall(w, s0, 0.02, z - drop - 0.2, 0, 0, 0.5),
					   foot_b = on_wall(w, s1, 0.02, z - drop - 0.2, wide, 0, 0.5);
	shell_face(shell, (struct shell_point[4]){ lip_a, lip_b, back_b, back_a }, 4);
	shell_face(shell, (struct shell_point[4]){ low_a, low_b, lip_b, lip_a }, 4);
	low_a.ao = low_b.ao = 0.6f;
	shell_face(shell, (struct shell_point[4]){ foot_a, foot_b, low_b, low_a }, 4);
	foot_a.u = back_a.u = foot_b.u = back_b.u = 0.5f;
	low_a.u = lip_a.u = low_b.u = lip_b.u = 1.0f;
	shell_face(shell, (struct shell_point[4]){ foot_a, low_a, lip_a, back_a }, 4);
	shell_face(shell, (struct shell_point[4]){ low_b, foot_b, back_b, lip_b }, 4);
}
