/* Contacts by hand-made time stamps: bounces, presses, a knob's quadrature; against plain models on random cases. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/rng.h"
#include "platform/gpio/debounce.h"
#include "platform/gpio/press.h"
#include "platform/gpio/quadrature.h"

#define CASES 100000
#define HOLD_NS (10 * NS_PER_MS)

struct edge {
	int64_t time_ns;
	bool level;
};

static void a_bouncing_contact_changes_once_and_at_its_last_edge(void **state)
{
	(void)state;
	static const int64_t times_us[] = { 0, 300, 700, 1500, 1600 }; /* up, down, up, down, up */
	struct debounce contact = { .hold_ns = HOLD_NS };
	assert_true(debounce_feed(&contact, false, -NS_PER_S));
	for (int i = 0; i < 5; i++)
		assert_false(debounce_feed(&contact, i % 2 == 0, times_us[i] * 1000));
	assert_false(debounce_settle(&contact, 11599 * NS_PER_MS / 1000));
	assert_int_equal(debounce_sure_ns(&contact, 11 * NS_PER_MS), 1600000);
	assert_true(debounce_settle(&contact, 11600 * NS_PER_MS / 1000));
	assert_true(contact.level);
	assert_int_equal(contact.level_ns, 1600000);
	assert_false(debounce_settle(&contact, NS_PER_S));
}

static void a_spike_shorter_than_the_hold_is_nothing(void **state)
{
	(void)state;
	struct debounce contact = { .hold_ns = HOLD_NS };
	debounce_feed(&contact, false, 0);
	assert_false(debounce_feed(&contact, true, NS_PER_S));
	assert_false(debounce_feed(&contact, false, NS_PER_S + HOLD_NS - 1));
	assert_false(debounce_settle(&contact, 2 * NS_PER_S));
	assert_false(contact.level);
}

static void a_contact_that_never_rests_keeps_its_level_and_is_told(void **state)
{
	(void)state;
	struct debounce contact = { .hold_ns = HOLD_NS };
	debounce_feed(&contact, false, 0);
	int64_t now = NS_PER_S;
	for (int i = 0; i < 900; i++, now += NS_PER_MS)
		assert_false(debounce_feed(&contact, i % 2 == 0, now));
	assert_false(debounce_chatters(&contact, now));
	for (int i = 0; i < 300; i++, now += NS_PER_MS)
		assert_false(debounce_feed(&contact, i % 2 == 0, now));
	assert_true(debounce_chatters(&contact, now));
	assert_false(contact.level);
	assert_false(debounce_chatters(&contact, now + HOLD_NS)); /* at rest again */
}

static void edges_out_of_order_or_repeated_do_no_harm(void **state)
{
	(void)state;
	struct debounce contact = { .hold_ns = HOLD_NS };
	debounce_feed(&contact, false, NS_PER_S);
	assert_false(debounce_feed(&contact, true, NS_PER_S - 5));
	assert_false(debounce_feed(&contact, true, NS_PER_S + 5));
	assert_true(debounce_settle(&contact, NS_PER_S + HOLD_NS));
	assert_int_equal(contact.level_ns, NS_PER_S);
}

/* Edges of a random contact: quiet times, bursts, exact multiples of the hold. */
static int random_edges(struct rng *rng, struct edge *edges, int most)
{
	int count = 1 + (int)(rng_u32(rng) % (unsigned)most);
	int64_t now = 0;
	bool level = false;
	for (int i = 0; i < count; i++) {
		switch (rng_u32(rng) % 4) {
		case 0:
			now += (int64_t)rng_range(rng, 0.0, 1e6);
			break;
		case 1:
			now += (int64_t)rng_range(rng, 5e6, 15e6);
			break;
		case 2:
			now += HOLD_NS + (int64_t)(rng_u32(rng) % 3) - 1;
			break;
		default:
			now += (int64_t)rng_range(rng, 0.0, 1e8);
			break;
		}
		level = rng_u32(rng) % 8 ? !level : level; /* an edge may be lost */
		edges[i] = (struct edge){ now, level };
	}
	return count;
}

/* The same in one look back over all edges: every run of one level that lasted. */
static int model(const struct edge *edges, int count, int64_t end_ns, struct edge *out)
{
	int changes = 0;
	bool accepted = false;
	for (int i = 0; i < count;) {
		int next = i + 1;
		while (next < count && edges[next].level == edges[i].level)
			next++;
		int64_t until = next < count ? edges[next].time_ns : end_ns;
		if (edges[i].level != accepted && until - edges[i].time_ns >= HOLD_NS) {
			accepted = edges[i].level;
			out[changes++] = edges[i];
		}
		i = next;
	}
	return changes;
}

static void random_chatter_gives_what_lasted_however_often_one_looks(void **state)
{
	(void)state;
	struct rng rng = rng_seed(4);
	struct edge edges[40], wanted[40] = { { 0 } };
	uint64_t changes = 0;
	for (int n = 0; n < CASES; n++) {
		int count = random_edges(&rng, edges, 40), found = 0;
		int64_t end_ns = edges[count - 1].time_ns + (int64_t)rng_range(&rng, 0.0, 2e7);
		int expected = model(edges, count, end_ns, wanted);
		struct debounce contact = { .hold_ns = HOLD_NS };
		debounce_feed(&contact, false, -NS_PER_S);
		for (int i = 0; i <= count; i++) {
			int64_t at = i < count ? edges[i].time_ns : end_ns;
			bool changed = rng_u32(&rng) % 3 == 0 && debounce_settle(&contact, at);
			if (i < count)
				changed = debounce_feed(&contact, edges[i].level, at) || changed;
			else
				changed = debounce_settle(&contact, at) || changed;
			if (!changed)
				continue;
			assert_true(found < expected);
			assert_int_equal(contact.level_ns, wanted[found].time_ns);
			assert_int_equal(contact.level, wanted[found].level);
			found++;
		}
		assert_int_equal(found, expected);
		changes += (uint64_t)found;
	}
	assert_true(changes > CASES);
}

static void presses_are_short_at_their_end_and_long_as_soon_as_they_are(void **state)
{
	(void)state;
	struct press press = { .long_ns = 700 * NS_PER_MS };
	assert_int_equal(press_feed(&press, true, 0), PRESS_NONE);
	assert_int_equal(press_settle(&press, 699 * NS_PER_MS), PRESS_NONE);
	assert_int_equal(press_feed(&press, false, 699 * NS_PER_MS), PRESS_SHORT);
	assert_int_equal(press_feed(&press, true, NS_PER_S), PRESS_NONE);
	assert_int_equal(press_settle(&press, NS_PER_S + 700 * NS_PER_MS), PRESS_LONG);
	assert_int_equal(press_settle(&press, NS_PER_S + 900 * NS_PER_MS), PRESS_NONE);
	assert_int_equal(press_feed(&press, false, 3 * NS_PER_S), PRESS_NONE);
	/* nobody looked in between */
	assert_int_equal(press_feed(&press, true, 4 * NS_PER_S), PRESS_NONE);
	assert_int_equal(press_feed(&press, false, 5 * NS_PER_S), PRESS_LONG);
	/* the line was lost while down */
	press_feed(&press, true, 6 * NS_PER_S);
	press_cancel(&press);
	assert_int_equal(press_feed(&press, false, 7 * NS_PER_S), PRESS_NONE);
}

static void a_held_zoom_button_repeats_without_a_burst(void **state)
{
	(void)state;
	struct press press = { .long_ns = 400 * NS_PER_MS, .repeat_ns = 100 * NS_PER_MS };
	assert_int_equal(press_feed(&press, true, 0), PRESS_SHORT);
	assert_int_equal(press_settle(&press, 399 * NS_PER_MS), PRESS_NONE);
	assert_int_equal(press_settle(&press, 400 * NS_PER_MS), PRESS_SHORT);
	assert_int_equal(press_settle(&press, 499 * NS_PER_MS), PRESS_NONE);
	assert_int_equal(press_settle(&press, 5000 * NS_PER_MS), PRESS_SHORT); /* after a stall */
	assert_int_equal(press_settle(&press, 5050 * NS_PER_MS), PRESS_NONE);
	assert_int_equal(press_feed(&press, false, 5060 * NS_PER_MS), PRESS_NONE);
}

/* The knob as it is made: a position in edges, its contacts by that. */
struct hand {
	struct quadrature knob;
	int position, detents;
	int64_t now_ns;
};

static bool contact_at(int position, unsigned contact)
{
	static const uint8_t states[4] = { 0, 2, 3, 1 };
	return states[position & 3] >> (1 - contact) & 1;
}

static void begin(struct hand *hand, unsigned steps)
{
	*hand = (struct hand){ 0 };
	quadrature_init(&hand->knob, steps);
	quadrature_level(&hand->knob, 0, false, 0);
	quadrature_level(&hand->knob, 1, false, 0);
}

static void step(struct hand *hand, int direction, int64_t after_ns)
{
	unsigned contact = contact_at(hand->position + direction, 0) != contact_at(hand->position, 0) ? 0 : 1;
	hand->position += direction;
	hand->now_ns += after_ns;
	hand->detents += quadrature_edge(&hand->knob, contact, contact_at(hand->position, contact), hand->now_ns);
}

static void every_kind_of_encoder_counts_its_detents(void **state)
{
	(void)state;
	static const unsigned kinds[] = { 1, 2, 4 };
	for (int k = 0; k < 3; k++) {
		struct hand hand;
		begin(&hand, kinds[k]);
		for (unsigned i = 0; i < 25 * kinds[k]; i++)
			step(&hand, 1, NS_PER_MS);
		assert_int_equal(hand.detents, 25);
		for (unsigned i = 0; i < 32 * kinds[k]; i++)
			step(&hand, -1, NS_PER_MS / 1000);
		assert_int_equal(hand.detents, -7);
	}
}

static void a_knob_that_trembles_at_a_detent_does_not_count(void **state)
{
	(void)state;
	struct hand hand;
	begin(&hand, 4);
	for (int i = 0; i < 1000; i++)
		step(&hand, i % 2 ? -1 : 1, NS_PER_MS);
	assert_int_equal(hand.detents, 0);
	for (int i = 0; i < 400; i++)
		step(&hand, i % 4 == 0 || i % 4 == 3 ? -1 : 1, NS_PER_MS);
	assert_int_equal(hand.detents, 0);
}

static void a_knob_wired_the_other_way_up_is_learned(void **state)
{
	(void)state;
	struct hand hand = { .position = 2 };
	quadrature_init(&hand.knob, 4);
	quadrature_level(&hand.knob, 0, true, 0);
	quadrature_level(&hand.knob, 1, true, 0);
	for (int i = 0; i < 12; i++)
		step(&hand, 1, NS_PER_MS);
	assert_int_equal(hand.detents, 3);
	/* first heard in the middle of a turn: where it then stays is its rest */
	begin(&hand, 4);
	step(&hand, 1, NS_PER_MS);
	step(&hand, 1, NS_PER_MS);
	hand.now_ns += NS_PER_S;
	hand.detents = 0;
	for (int i = 0; i < 12; i++)
		step(&hand, -1, NS_PER_MS);
	assert_int_equal(hand.detents, -3);
}

/* Bounces of either contact at every edge, also more of them than any queue holds. */
static void random_turns_with_bounces_count_exactly(void **state)
{
	(void)state;
	struct rng rng = rng_seed(9);
	struct hand hand;
	begin(&hand, 4);
	int truth = 0;
	for (int n = 0; n < CASES; n++) {
		int direction = rng_u32(&rng) % 2 ? 1 : -1;
		for (int edge = 0; edge < 4; edge++) {
			step(&hand, direction, (int64_t)rng_range(&rng, 1e3, 2e6));
			for (unsigned bounce = rng_u32(&rng) % 4; bounce > 0; bounce--) {
				step(&hand, -direction, (int64_t)rng_range(&rng, 1e2, 1e5));
				step(&hand, direction, (int64_t)rng_range(&rng, 1e2, 1e5));
			}
		}
		truth += direction;
	}
	assert_int_equal(hand.detents, truth);
	assert_int_equal(hand.knob.lost, 0);
}

/* Whatever edges are lost: a detent each at most, none is made up, and the ones after it are right again. */
static void lost_edges_cost_their_own_detent_only(void **state)
{
	(void)state;
	struct rng rng = rng_seed(11);
	struct hand hand;
	begin(&hand, 4);
	int turned = 0, hurt = 0;
	for (int n = 0; n < CASES; n++) {
		bool loses = rng_u32(&rng) % 10 == 0;
		int before = hand.detents;
		for (int edge = 0; edge < 4; edge++) {
			if (loses && rng_u32(&rng) % 2)
				hand.position++; /* unheard */
			else
				step(&hand, 1, NS_PER_MS);
		}
		/* the queue overran: both contacts are read */
		if (loses) {
			quadrature_level(&hand.knob, 0, contact_at(hand.position, 0), hand.now_ns);
			quadrature_level(&hand.knob, 1, contact_at(hand.position, 1), hand.now_ns);
		}
		int gained = hand.detents - before;
		assert_true(gained == 1 || (loses && gained >= -1 && gained <= 1));
		turned++;
		hurt += loses;
	}
	assert_true(hand.detents >= turned - 2 * hurt);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bouncing_contact_changes_once_and_at_its_last_edge),
		cmocka_unit_test(a_spike_shorter_than_the_hold_is_nothing),
		cmocka_unit_test(a_contact_that_never_rests_keeps_its_level_and_is_told),
		cmocka_unit_test(edges_out_of_order_or_repeated_do_no_harm),
		cmocka_unit_test(random_chatter_gives_what_lasted_however_often_one_looks),
		cmocka_unit_test(presses_are_short_at_their_end_and_long_as_soon_as_they_are),
		cmocka_unit_test(a_held_zoom_button_repeats_without_a_burst),
		cmocka_unit_test(every_kind_of_encoder_counts_its_detents),
		cmocka_unit_test(a_knob_that_trembles_at_a_detent_does_not_count),
		cmocka_unit_test(a_knob_wired_the_other_way_up_is_learned),
		cmocka_unit_test(random_turns_with_bounces_count_exactly),
		cmocka_unit_test(lost_edges_cost_their_own_detent_only),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
