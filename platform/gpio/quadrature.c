#include "platform/gpio/quadrature.h"

#include <stdlib.h>

void quadrature_init(struct quadrature *knob, unsigned steps)
{
	*knob = (struct quadrature){ .steps = steps };
}

static bool at_rest(const struct quadrature *knob)
{
	if (knob->steps == 4)
		return knob->state == knob->rest;
	return knob->steps == 1 || knob->state == 0 || knob->state == 3;
}

/* Encoders rest with both contacts open or both closed; which of the two depends on the wiring. */
static void learn_rest(struct quadrature *knob, int64_t time_ns)
{
	bool alike = knob->state == 0 || knob->state == 3;
	if (alike && time_ns - knob->changed_ns >= QUADRATURE_LEARN_NS && knob->rest != knob->state) {
		knob->rest = knob->state;
		knob->count = 0;
	}
}

static uint8_t with_contact(uint8_t state, unsigned contact, bool level)
{
	uint8_t bit = contact == 0 ? 2 : 1;
	return (uint8_t)(level ? state | bit : state & ~bit);
}

/* Clockwise the states follow each other as 00, 10, 11, 01. */
static int direction(uint8_t from, uint8_t to)
{
	static const uint8_t place[4] = { 0, 3, 1, 2 };
	return ((place[to] - place[from]) & 3) == 1 ? 1 : -1;
}

static int finish_detent(struct quadrature *knob)
{
	int half = (int)knob->steps / 2, count = knob->count;
	knob->count = 0;
	if (abs(count) != (int)knob->steps && count != 0)
		knob->lost++;
	return abs(count) > half || knob->steps == 1 ? (count > 0) - (count < 0) : 0;
}

int quadrature_edge(struct quadrature *knob, unsigned contact, bool level, int64_t time_ns)
{
	uint8_t next = with_contact(knob->state, contact, level);
	if (!knob->known[0] || !knob->known[1]) {
		quadrature_level(knob, contact, level, time_ns);
		return 0;
	}
	if (next == knob->state)
		return 0; /* the edge before it was lost */
	learn_rest(knob, time_ns);
	knob->count += direction(knob->state, next);
	knob->state = next;
	knob->changed_ns = time_ns;
	return at_rest(knob) ? finish_detent(knob) : 0;
}

void quadrature_level(struct quadrature *knob, unsigned contact, bool level, int64_t time_ns)
{
	uint8_t next = with_contact(knob->state, contact, level);
	bool first = !knob->known[0] || !knob->known[1];
	knob->known[contact] = true;
	knob->count = 0;
	if (next != knob->state)
		knob->changed_ns = time_ns;
	knob->state = next;
	if (first && knob->known[0] && knob->known[1] && (next == 0 || next == 3))
		knob->rest = next; /* a knob that nobody touches rests */
}
