#include "platform/gpio/debounce.h"

static bool settled(const struct debounce *contact, int64_t now_ns)
{
	return now_ns - contact->raw_ns >= contact->hold_ns;
}

bool debounce_settle(struct debounce *contact, int64_t now_ns)
{
	if (!contact->known || contact->raw == contact->level || !settled(contact, now_ns))
		return false;
	contact->level = contact->raw;
	contact->level_ns = contact->raw_ns;
	return true;
}

bool debounce_feed(struct debounce *contact, bool raw, int64_t time_ns)
{
	if (!contact->known) {
		contact->known = true;
		contact->raw = contact->level = raw;
		contact->raw_ns = contact->level_ns = contact->unsettled_ns = time_ns;
		return true;
	}
	if (time_ns < contact->raw_ns)
		time_ns = contact->raw_ns;
	bool changed = debounce_settle(contact, time_ns);
	if (raw != contact->raw) {
		if (settled(contact, time_ns))
			contact->unsettled_ns = time_ns;
		contact->raw = raw;
		contact->raw_ns = time_ns;
	}
	return debounce_settle(contact, time_ns) || changed;
}

int64_t debounce_sure_ns(const struct debounce *contact, int64_t now_ns)
{
	return contact->raw == contact->level ? now_ns : contact->raw_ns;
}

bool debounce_chatters(const struct debounce *contact, int64_t now_ns)
{
	return contact->known && !settled(contact, now_ns) && now_ns - contact->unsettled_ns > DEBOUNCE_CHATTER_NS;
}
