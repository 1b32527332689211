/*
 * A contact's level without its bounces, by the edges' time stamps alone: a level counts when it has lasted `hold_ns`,
 * and then from the edge that began it. How often one looks changes nothing but when one hears of it.
 */
#ifndef BLVD_PLATFORM_GPIO_DEBOUNCE_H
#define BLVD_PLATFORM_GPIO_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

#define DEBOUNCE_CHATTER_NS INT64_C(1000000000) /* unsettled for longer: the contact is faulty */

struct debounce {
	int64_t hold_ns; /* 0: every edge counts */
	bool known;
	bool level;       /* accepted */
	int64_t level_ns; /* of the edge that began it */
	bool raw;         /* after the last edge */
	int64_t raw_ns;
	int64_t unsettled_ns; /* since when no level has lasted; meaningful while raw has not settled */
};

/* Both return true when the accepted level changed. The first level ever heard counts at once. Times never go back;
 * one that does counts as the last one. */
bool debounce_feed(struct debounce *contact, bool raw, int64_t time_ns);
bool debounce_settle(struct debounce *contact, int64_t now_ns);

/* Up to when the accepted level is certain: an edge that has not settled yet may turn out to be its end. */
int64_t debounce_sure_ns(const struct debounce *contact, int64_t now_ns);

/* Edges have come for so long without a level that lasted. */
bool debounce_chatters(const struct debounce *contact, int64_t now_ns);

#endif
