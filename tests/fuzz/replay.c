/*
 * A fuzz target without libFuzzer: every input of a corpus, then inputs made from them, the same ones every time.
 *   fuzz_replay_NAME CORPUS RUNS [-v]     -v prints each input before it is tried: the last one is what broke it
 * Each input lies in memory of exactly its size, so that a sanitizer sees a read beyond it.
 */
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"

#define INPUTS_MAX 4096
#define SIZE_MAX_BYTES 4096u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
	uint8_t *data;
	size_t size;
};

static struct input inputs[INPUTS_MAX];
static size_t input_count;
static bool verbose;

static void try_input(const uint8_t *data, size_t size)
{
	uint8_t *exact = malloc(size ? size : 1);
	if (!exact)
		abort();
	memcpy(exact, data, size);
	for (size_t i = 0; verbose && i < size; i++)
		printf("%02x", data[i]);
	if (verbose) {
		printf("\n");
		fflush(stdout);
	}
	LLVMFuzzerTestOneInput(exact, size);
	free(exact);
}

static bool load_file(const char *folder, const char *name)
{
	char path[4096];
	static uint8_t bytes[SIZE_MAX_BYTES];
	if (snprintf(path, sizeof(path), "%s/%s", folder, name) >= (int)sizeof(path))
		return false;
	FILE *file = fopen(path, "rb");
	if (!file)
		return false;
	struct input *input = &inputs[input_count];
	input->size = fread(bytes, 1, sizeof(bytes), file);
	fclose(file);
	input->data = malloc(input->size ? input->size : 1);
	if (!input->data)
		return false;
	memcpy(input->data, bytes, input->size);
	input_count++;
	return true;
}

/* By name, so that the order is the same everywhere. */
static bool load_corpus(const char *folder)
{
	struct dirent **entries;
	int count = scandir(folder, &entries, NULL, alphasort);
	bool good = count >= 0;
	for (int i = 0; i < count; i++) {
		if (good && entries[i]->d_name[0] != '.' && input_count < INPUTS_MAX)
			good = load_file(folder, entries[i]->d_name);
		free(entries[i]);
	}
	if (count >= 0)
		free(entries);
	return good && input_count > 0;
}

static size_t below(struct rng *rng, size_t end)
{
	return end ? rng_u32(rng) % end : 0;
}

/* One change of one kind; returns the new size. */
static size_t change(struct rng *rng, uint8_t *data, size_t size)
{
	static const uint8_t telling[] = { 0, 1, 0x7F, 0x80, 0xFF, ' ', '\n', '0', '9', '-', '"' };
	const struct input *other = &inputs[below(rng, input_count)];
	size_t at = below(rng, size), from = below(rng, other->size), count = below(rng, 16) + 1;
	switch (rng_u32(rng) % 5) {
	case 0:
		if (size)
			data[at] ^= (uint8_t)(1u << below(rng, 8));
		return size;
	case 1:
		if (size)
			data[at] = telling[below(rng, sizeof(telling))];
		return size;
	case 2: /* a piece goes */
		count = count < size - at ? count : size - at;
		memmove(data + at, data + at + count, size - at - count);
		return size - count;
	case 3: /* a piece of another one comes in between */
		count = count < other->size - from ? count : other->size - from;
		if (size + count > SIZE_MAX_BYTES)
			return size;
		memmove(data + at + count, data + at, size - at);
		memcpy(data + at, other->data + from, count);
		return size + count;
	default: /* or over it */
		count = other->size - from < size - at ? other->size - from : size - at;
		memcpy(data + at, other->data + from, count);
		return size;
	}
}

int main(int argc, char **argv)
{
	static uint8_t data[SIZE_MAX_BYTES];
	struct rng rng = rng_seed(1);
	verbose = argc == 4 && !strcmp(argv[3], "-v");
	if (argc != 3 && !verbose) {
		fprintf(stderr, "usage: %s CORPUS RUNS [-v]\n", argv[0]);
		return 2;
	}
	if (!load_corpus(argv[1])) {
		fprintf(stderr, "%s: no corpus there\n", argv[1]);
		return 3;
	}
	for (size_t i = 0; i < input_count; i++)
		try_input(inputs[i].data, inputs[i].size);
	long runs = strtol(argv[2], NULL, 10);
	for (long i = 0; i < runs; i++) {
		const struct input *base = &inputs[below(&rng, input_count)];
		size_t size = base->size;
		memcpy(data, base->data, size);
		for (size_t changes = 1 + below(&rng, 4); changes; changes--)
			size = change(&rng, data, size);
		try_input(data, size);
	}
	printf("%zu inputs of the corpus and %ld made from them\n", input_count, runs);
	for (size_t i = 0; i < input_count; i++)
		free(inputs[i].data);
	return 0;
}
