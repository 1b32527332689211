/* The overlay's colours by day and by night, and everything between while the light changes. */
#ifndef BLVD_RENDER_PALETTE_H
#define BLVD_RENDER_PALETTE_H

#include "render/canvas.h"

struct palette {
	struct rgba card, card_edge, shadow;
	struct rgba text, text_dim; /* on a card */
	struct rgba accent;         /* the next manoeuvre's card */
	struct rgba accent_text, accent_dim;
	struct rgba route, route_edge, route_arrow, route_shade; /* on the street; arrow in light and shade */
	struct rgba label, label_halo;                           /* in the scene */
	struct rgba label_strong;                                /* the next manoeuvre's street */
	struct rgba warning, warning_text;                       /* sensors, messages */
	struct rgba choice, choice_text;                         /* the row of the menu that a push would act on */
	struct rgba over_limit;
	struct rgba sign_face, sign_ring, sign_text;
	struct rgba north;
};

/* `day` from 0, night, to 1. */
void palette_mix(struct palette *out, float day);

#endif
