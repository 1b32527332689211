/*
 * A rotary encoder's two contacts to detents. Every edge of both is looked at: a bounce of one contact goes there and
 * back and adds up to nothing, so no debounce time is needed and none limits the speed. Where the knob rests the count
 * starts anew: an edge that was lost costs at most the detent it belongs to, never the ones after it.
 */
#ifndef BLVD_PLATFORM_GPIO_QUADRATURE_H
#define BLVD_PLATFORM_GPIO_QUADRATURE_H

#include <stdbool.h>
#include <stdint.h>

#define QUADRATURE_LEARN_NS INT64_C(500000000) /* where the knob stays for so long is where it rests */

struct quadrature {
	unsigned steps; /* edges a detent: 4, 2 or 1 */
	bool known[2];
	uint8_t state; /* contact a is bit 1, b is bit 0 */
	uint8_t rest;  /* the state at a detent, of encoders with 4 edges; learned: both contacts alike */
	int count;     /* edges since the last detent, clockwise positive */
	int64_t changed_ns;
	uint64_t lost; /* detents given up because edges were missing */
};

void quadrature_init(struct quadrature *knob, unsigned steps);
/* An edge of contact 0 (a) or 1 (b). Clockwise a leads b. Returns detents turned: -1, 0 or 1. */
int quadrature_edge(struct quadrature *knob, unsigned contact, bool level, int64_t time_ns);
/* A level that was read: what was under way is not known any more. */
void quadrature_level(struct quadrature *knob, unsigned contact, bool level, int64_t time_ns);

#endif
