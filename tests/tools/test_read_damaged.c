/* Damaged .osm.pbf files: cut short and flipped at places spread over the whole file. Whatever comes out, nothing may
 * crash (the sanitizers watch), and what is refused is refused with -EBADMSG. BLVD_FUZZ_COUNT sets how many. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/read/osm_parse.h"

struct sample {
	uint8_t *bytes;
	size_t size;
	char path[64];
	int count;
};

static int set_up(void **state)
{
	const char *data = getenv("BLVD_DATA"), *count = getenv("BLVD_FUZZ_COUNT");
	char path[1024];
	struct file_map map;
	static struct sample sample;
	snprintf(path, sizeof(path), "%s/city/tiny/rome-piazza-vittorio.osm.pbf", data ? data : "../shared/data");
	*state = NULL;
	if (file_map_open(&map, path)) {
		printf("skipped: no BLVD_DATA (%s)\n", path);
		return 0;
	}
	sample.size = map.bytes.size;
	sample.bytes = malloc(sample.size);
	memcpy(sample.bytes, map.bytes.data, sample.size);
	file_map_close(&map);
	snprintf(sample.path, sizeof(sample.path), "/tmp/blvd-damaged-%d.osm.pbf", (int)getpid());
	sample.count = count ? atoi(count) : 40;
	*state = &sample;
	return 0;
}

static int tear_down(void **state)
{
	struct sample *sample = *state;
	if (sample) {
		unlink(sample->path);
		free(sample->bytes);
	}
	return 0;
}

static int parse(const struct sample *sample, const uint8_t *bytes, size_t size)
{
	struct report report = { 0 };
	struct osm_store store;
	FILE *file = fopen(sample->path, "wb");
	assert_non_null(file);
	fwrite(bytes, 1, size, file);
	fclose(file);
	osm_store_init(&store, &report);
	struct staged staged;
	int status = stage_open(&staged, sample->path);
	if (!status)
		status = osm_parse(&store, &staged, sample->path);
	stage_close(&staged);
	osm_store_finish(&store);
	return status;
}

/* Says on the way how often a damage went unnoticed: those bytes are checked by nobody (the file's header, mostly). */
static void refuses_files_that_are_cut_short(void **state)
{
	const struct sample *sample = *state;
	struct rng rng = rng_seed(1);
	int whole = 0;
	if (!sample) {
		skip();
		return; /* for the analyzer */
	}
	for (int i = 0; i < sample->count; i++) {
		size_t size = 1 + (size_t)(rng_unit(&rng) * (double)(sample->size - 1));
		int status = parse(sample, sample->bytes, size);
		assert_true(status == 0 || status == -EBADMSG);
		whole += status == 0;
	}
	printf("%d of %d cuts fell between two blobs\n", whole, sample->count);
	assert_true(whole * 20 <= sample->count);
}

static void survives_flipped_bytes(void **state)
{
	const struct sample *sample = *state;
	struct rng rng = rng_seed(2);
	int unnoticed = 0;
	if (!sample) {
		skip();
		return; /* for the analyzer */
	}
	for (int i = 0; i < sample->count; i++) {
		size_t at = (size_t)(rng_unit(&rng) * (double)sample->size);
		/* Every other one in the first kilobytes, where the framing is. */
		if (i % 2)
			at %= 400;
		uint8_t flip = (uint8_t)(1 + rng_u32(&rng) % 255);
		sample->bytes[at] ^= flip;
		int status = parse(sample, sample->bytes, sample->size);
		sample->bytes[at] ^= flip;
		assert_true(status == 0 || status == -EBADMSG);
		unnoticed += status == 0;
	}
	printf("%d of %d flips went unnoticed\n", unnoticed, sample->count);
}

static uint64_t take_varint(const uint8_t **at)
{
	uint64_t value = 0;
	for (unsigned shift = 0;; shift += 7) {
		uint8_t byte = *(*at)++;
		value |= (uint64_t)(byte & 0x7F) << shift;
		if (!(byte & 0x80))
			return value;
	}
}

static uint8_t *put_varint(uint8_t *to, uint64_t value)
{
	for (; value >= 0x80; value >>= 7)
		*to++ = (uint8_t)(value | 0x80);
	*to++ = (uint8_t)value;
	return to;
}

static uint8_t *put_blob(uint8_t *to, const char *type, const uint8_t *raw, size_t size)
{
	uint8_t head[64], *h = head, tag[16], *t = tag;
	*t++ = 0x0A; /* Blob.raw */
	t = put_varint(t, size);
	*h++ = 0x0A; /* BlobHeader.type */
	h = put_varint(h, strlen(type));
	memcpy(h, type, strlen(type));
	h += strlen(type);
	*h++ = 0x18; /* BlobHeader.datasize */
	h = put_varint(h, (uint64_t)(t - tag) + size);
	*to++ = 0;
	*to++ = 0;
	*to++ = 0;
	*to++ = (uint8_t)(h - head);
	memcpy(to, head, (size_t)(h - head));
	to += h - head;
	memcpy(to, tag, (size_t)(t - tag));
	to += t - tag;
	memcpy(to, raw, size);
	return to + size;
}

/* The whole file with its blobs stored unpacked, so that no checksum stands between a flip and the reader. Returns the
 * size; `*out` is the caller's. */
static size_t unpacked(const struct sample *sample, uint8_t **out)
{
	const uint8_t *at = sample->bytes, *end = at + sample->size;
	uint8_t *to = *out = malloc(sample->size * 20);
	assert_non_null(to);
	for (bool first = true; at < end; first = false) {
		size_t header = (size_t)at[2] << 8 | at[3], size = 0, packed_size = 0, raw_size = 0;
		const uint8_t *head = at + 4, *head_end = head + header, *packed = NULL;
		while (head < head_end) {
			uint64_t key = take_varint(&head), value = take_varint(&head);
			if (key == 0x18)
				size = value;
			else
				head += value;
		}
		const uint8_t *blob = head_end, *blob_end = blob + size;
		while (blob < blob_end) {
			uint64_t key = take_varint(&blob), value = take_varint(&blob);
			if (key == 0x10) {
				raw_size = value;
			} else {
				packed = blob;
				packed_size = value;
				blob += value;
			}
		}
		uint8_t *raw = malloc(raw_size + 1);
		uLongf got = raw_size;
		assert_int_equal(uncompress(raw, &got, packed, packed_size), Z_OK);
		to = put_blob(to, first ? "OSMHeader" : "OSMData", raw, raw_size);
		free(raw);
		at = blob_end;
	}
	return (size_t)(to - *out);
}

static void survives_nonsense_without_checksums(void **state)
{
	const struct sample *sample = *state;
	struct rng rng = rng_seed(3);
	int unnoticed = 0;
	if (!sample) {
		skip();
		return; /* for the analyzer */
	}
	uint8_t *bytes;
	size_t size = unpacked(sample, &bytes);
	assert_int_equal(parse(sample, bytes, size), 0);
	for (int i = 0; i < sample->count; i++) {
		size_t places[8];
		uint8_t flips[8];
		for (int k = 0; k < 8; k++) {
			/* Half of the flips hit the starts of the blobs, where the lists of strings are. */
			places[k] = (size_t)(rng_unit(&rng) * (k % 2 ? (double)size : 20000.0));
			flips[k] = (uint8_t)(1 + rng_u32(&rng) % 255);
		}
		int hits = 1 + i % 8;
		for (int k = 0; k < hits; k++)
			bytes[places[k]] ^= flips[k];
		int status = parse(sample, bytes, size);
		for (int k = hits; k-- > 0;)
			bytes[places[k]] ^= flips[k];
		assert_true(status == 0 || status == -EBADMSG);
		unnoticed += status == 0;
	}
	printf("%d of %d files with flips could be read all the same\n", unnoticed, sample->count);
	free(bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(refuses_files_that_are_cut_short),
		cmocka_unit_test(survives_flipped_bytes),
		cmocka_unit_test(survives_nonsense_without_checksums),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
