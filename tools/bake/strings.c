#include "tools/bake/strings.h"

#include <string.h>

/* FNV-1a. */
static uint32_t hash_text(const char *text)
{
	uint32_t hash = 2166136261u;
	for (; *text; text++)
		hash = (hash ^ (uint8_t)*text) * 16777619u;
	return hash;
}

static uint32_t *find_slot(struct string_table *table, const char *text)
{
	size_t mask = table->slots.capacity - 1;
	for (size_t at = hash_text(text) & mask;; at = (at + 1) & mask) {
		uint32_t *slot = &table->slots.items[at];
		if (!*slot || !strcmp(table->bytes.items + *slot - 1, text))
			return slot;
	}
}

static void grow_slots(struct string_table *table)
{
	size_t capacity = table->slots.capacity ? table->slots.capacity * 2 : 1024;
	ARRAY_FINISH(&table->slots);
	table->slots.items = array_grow(NULL, &table->slots.capacity, capacity, sizeof(uint32_t));
	table->slots.capacity = capacity;
	memset(table->slots.items, 0, capacity * sizeof(uint32_t));
	for (size_t at = 1; at < table->bytes.count; at += strlen(table->bytes.items + at) + 1)
		*find_slot(table, table->bytes.items + at) = (uint32_t)at + 1;
}

uint32_t strings_intern(struct string_table *table, const char *text)
{
	if (!table->bytes.count)
		ARRAY_PUSH(&table->bytes, '\0');
	if (!text || !*text)
		return 0;
	if ((size_t)table->used * 2 >= table->slots.capacity)
		grow_slots(table);
	uint32_t *slot = find_slot(table, text);
	if (*slot)
		return *slot - 1;
	uint32_t at = (uint32_t)table->bytes.count;
	size_t size = strlen(text) + 1;
	ARRAY_RESERVE(&table->bytes, at + size);
	memcpy(table->bytes.items + at, text, size);
	table->bytes.count += size;
	*slot = at + 1;
	table->used++;
	return at;
}

void strings_finish(struct string_table *table)
{
	ARRAY_FINISH(&table->bytes);
	ARRAY_FINISH(&table->slots);
	table->used = 0;
}
