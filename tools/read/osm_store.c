#include "tools/read/osm_store.h"

#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/read/text.h"

struct osm_interned {
	const char *text; /* NULL: free slot */
	uint64_t hash;
};

void osm_store_init(struct osm_store *store, struct report *report)
{
	*store = (struct osm_store){ .report = report };
}

void osm_store_finish(struct osm_store *store)
{
	ARRAY_FINISH(&store->nodes);
	ARRAY_FINISH(&store->ways);
	ARRAY_FINISH(&store->relations);
	array_free(store->interned);
	store->interned = NULL;
	pool_finish(&store->pool);
}

static uint64_t hash_text(const char *text)
{
	uint64_t hash = UINT64_C(0xCBF29CE484222325); /* FNV-1a */
	for (; *text; text++)
		hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001B3);
	return hash_u64(hash);
}

static struct osm_interned *find_slot(struct osm_interned *slots, size_t capacity, const char *text, uint64_t hash)
{
	for (size_t i = hash & (capacity - 1);; i = (i + 1) & (capacity - 1)) {
		if (!slots[i].text || (slots[i].hash == hash && !strcmp(slots[i].text, text)))
			return &slots[i];
	}
}

static void grow_interned(struct osm_store *store)
{
	size_t capacity = store->interned_capacity ? store->interned_capacity * 2 : 4096, bytes = 0;
	struct osm_interned *slots = array_grow(NULL, &bytes, capacity, sizeof(*slots));
	memset(slots, 0, capacity * sizeof(*slots));
	for (size_t i = 0; i < store->interned_capacity; i++) {
		struct osm_interned *old = &store->interned[i];
		if (old->text)
			*find_slot(slots, capacity, old->text, old->hash) = *old;
	}
	array_free(store->interned);
	store->interned = slots;
	store->interned_capacity = capacity;
}

const char *osm_store_text(struct osm_store *store, const char *text, int64_t id)
{
	if (store->interned_count * 2 >= store->interned_capacity)
		grow_interned(store);
	uint64_t hash = hash_text(text);
	struct osm_interned *slot = find_slot(store->interned, store->interned_capacity, text, hash);
	if (slot->text)
		return slot->text;
	const char *kept;
	if (text_is_clean(text)) {
		kept = pool_string(&store->pool, text);
		*slot = (struct osm_interned){ kept, hash };
		store->interned_count++;
	} else { /* not interned under its bad bytes: each element that has them counts */
		report_fault(store->report, FAULT_BAD_STRING, FAULT_MENDED, id);
		kept = text_mend(&store->pool, text);
	}
	return kept;
}

void osm_store_add_node(struct osm_store *store, const struct osm_node *node)
{
	ARRAY_PUSH(&store->nodes, *node);
}

void osm_store_add_way(struct osm_store *store, const struct osm_way *way)
{
	ARRAY_PUSH(&store->ways, *way);
}

void osm_store_add_relation(struct osm_store *store, const struct osm_relation *relation)
{
	ARRAY_PUSH(&store->relations, *relation);
}

/* Stable by construction: files come sorted, so the insertion into place is the rare case and merging does it. */
#define DEFINE_SORT(name, type)                                                                                        \
	static void merge_##name(type *items, type *spare, size_t low, size_t middle, size_t high)                         \
	{                                                                                                                  \
		memcpy(spare + low, items + low, (high - low) * sizeof(type));                                                 \
		for (size_t i = low, j = middle, k = low; k < high; k++)                                                       \
			items[k] = j >= high || (i < middle && spare[i].id <= spare[j].id) ? spare[i++] : spare[j++];              \
	}                                                                                                                  \
	static void sort_##name(type *items, type *spare, size_t low, size_t high)                                         \
	{                                                                                                                  \
		if (high - low < 2)                                                                                            \
			return;                                                                                                    \
		size_t middle = low + (high - low) / 2;                                                                        \
		sort_##name(items, spare, low, middle);                                                                        \
		sort_##name(items, spare, middle, high);                                                                       \
		if (items[middle - 1].id > items[middle].id)                                                                   \
			merge_##name(items, spare, low, middle, high);                                                             \
	}                                                                                                                  \
	static size_t settle_##name(type *items, size_t count)                                                             \
	{                                                                                                                  \
		size_t capacity = 0, kept = 0;                                                                                 \
		type *spare = array_grow(NULL, &capacity, count + 1, sizeof(type));                                            \
		sort_##name(items, spare, 0, count);                                                                           \
		array_free(spare);                                                                                             \
		for (size_t i = 0; i < count; i++) {                                                                           \
			if (i + 1 < count && items[i].id == items[i + 1].id)                                                       \
				continue;                                                                                              \
			items[kept++] = items[i];                                                                                  \
		}                                                                                                              \
		return kept;                                                                                                   \
	}                                                                                                                  \
	static type *find_##name(type *items, size_t count, int64_t id)                                                    \
	{                                                                                                                  \
		size_t low = 0, high = count;                                                                                  \
		while (low < high) {                                                                                           \
			size_t middle = low + (high - low) / 2;                                                                    \
			if (items[middle].id < id)                                                                                 \
				low = middle + 1;                                                                                      \
			else                                                                                                       \
				high = middle;                                                                                         \
		}                                                                                                              \
		return low < count && items[low].id == id ? &items[low] : NULL;                                                \
	}

DEFINE_SORT(nodes, struct osm_node)
DEFINE_SORT(ways, struct osm_way)
DEFINE_SORT(relations, struct osm_relation)

#define SETTLE(store, name, kind)                                                                                      \
	do {                                                                                                               \
		size_t kept = settle_##name((store)->name.items, (store)->name.count);                                         \
		(store)->duplicates[kind] += (store)->name.count - kept;                                                       \
		(store)->name.count = kept;                                                                                    \
	} while (0)

void osm_store_sort(struct osm_store *store)
{
	SETTLE(store, nodes, ELEMENT_NODE);
	SETTLE(store, ways, ELEMENT_WAY);
	SETTLE(store, relations, ELEMENT_RELATION);
}

struct osm_node *osm_store_node(const struct osm_store *store, int64_t id)
{
	struct osm_node *node = find_nodes(store->nodes.items, store->nodes.count, id);
	return node && !node->bad ? node : NULL;
}

struct osm_way *osm_store_way(const struct osm_store *store, int64_t id)
{
	return find_ways(store->ways.items, store->ways.count, id);
}

struct osm_relation *osm_store_relation(const struct osm_store *store, int64_t id)
{
	return find_relations(store->relations.items, store->relations.count, id);
}

void osm_store_project(struct osm_store *store, const struct geo_frame *frame)
{
	for (size_t i = 0; i < store->nodes.count; i++) {
		struct osm_node *node = &store->nodes.items[i];
		node->at = geo_to_plane(frame, (struct geo_point){ node->lat_deg, node->lon_deg });
	}
}

void osm_mark(uint8_t *fate, enum element_fate next)
{
	if (*fate == ELEMENT_IGNORED || next == ELEMENT_USED)
		*fate = (uint8_t)next;
}

void osm_store_tally(const struct osm_store *store)
{
	struct report *report = store->report;
	for (size_t i = 0; i < store->nodes.count; i++)
		report->elements[ELEMENT_NODE][store->nodes.items[i].fate]++;
	for (size_t i = 0; i < store->ways.count; i++)
		report->elements[ELEMENT_WAY][store->ways.items[i].fate]++;
	for (size_t i = 0; i < store->relations.count; i++)
		report->elements[ELEMENT_RELATION][store->relations.items[i].fate]++;
	for (int kind = 0; kind < ELEMENT_KIND_COUNT; kind++)
		report->elements[kind][ELEMENT_IGNORED] += store->duplicates[kind];
}

const char *osm_tag(const struct osm_tags *tags, const char *key)
{
	for (size_t i = 0; i < tags->count; i++)
		if (!strcmp(tags->items[i].key, key))
			return tags->items[i].value;
	return NULL;
}

bool osm_tag_is(const struct osm_tags *tags, const char *key, const char *value)
{
	const char *found = osm_tag(tags, key);
	return found && !strcmp(found, value);
}

bool osm_tag_yes(const struct osm_tags *tags, const char *key)
{
	const char *found = osm_tag(tags, key);
	return found && strcmp(found, "no") != 0;
}
