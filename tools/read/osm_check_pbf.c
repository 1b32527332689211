/*
 * The framing and the protobuf structure of .osm.pbf, after the format's description at
 * https://wiki.openstreetmap.org/wiki/PBF_Format. Every blob is inflated and every index into its string table, every
 * length and every count is checked. Cost: about half of what reading takes.
 */
#include "tools/read/osm_check.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"

#define HEADER_LIMIT_BYTES 65536u
#define BLOB_LIMIT_BYTES (32u << 20)

struct cursor {
	const uint8_t *at, *end;
};

struct field {
	uint32_t number, wire;
	uint64_t value;      /* wire 0 */
	struct cursor bytes; /* wire 2 */
};

/* Why the file is refused; the first reason stays. */
struct check {
	const char *name;
	size_t blob_offset;
	const char *problem;
	uint64_t strings;
};

static bool refuse(struct check *check, const char *problem)
{
	if (!check->problem)
		check->problem = problem;
	return false;
}

static bool read_varint(struct cursor *from, uint64_t *out)
{
	uint64_t value = 0;
	for (unsigned shift = 0; shift < 64; shift += 7) {
		if (from->at == from->end)
			return false;
		uint8_t byte = *from->at++;
		value |= (uint64_t)(byte & 0x7F) << shift;
		if (!(byte & 0x80)) {
			*out = value;
			return true;
		}
	}
	return false;
}

static int64_t zigzag(uint64_t value)
{
	return (int64_t)(value >> 1) ^ -(int64_t)(value & 1);
}

static bool skip(struct cursor *from, uint64_t count)
{
	if (count > (uint64_t)(from->end - from->at))
		return false;
	from->at += count;
	return true;
}

/* False at the end (check->problem unset) and at a fault (set). */
static bool next_field(struct check *check, struct cursor *from, struct field *field)
{
	uint64_t key;
	if (from->at == from->end)
		return false;
	if (!read_varint(from, &key) || key >> 3 == 0 || key >> 3 > 536870911)
		return refuse(check, "a damaged field");
	field->number = (uint32_t)(key >> 3);
	field->wire = (uint32_t)(key & 7);
	const uint8_t *start;
	switch (field->wire) {
	case 0:
		return read_varint(from, &field->value) || refuse(check, "a damaged number");
	case 1:
		return skip(from, 8) || refuse(check, "a field that is cut short");
	case 2:
		if (!read_varint(from, &field->value))
			return refuse(check, "a damaged length");
		start = from->at;
		if (!skip(from, field->value))
			return refuse(check, "a field that is longer than what holds it");
		field->bytes = (struct cursor){ start, from->at };
		return true;
	case 5:
		return skip(from, 4) || refuse(check, "a field that is cut short");
	default:
		return refuse(check, "a field of unknown type");
	}
}

/* Counts the varints of a packed field; those of string indices must be below the number of strings. */
static bool check_packed(struct check *check, struct cursor bytes, bool indices, uint64_t *count)
{
	for (*count = 0; bytes.at < bytes.end; (*count)++) {
		uint64_t value;
		if (!read_varint(&bytes, &value))
			return refuse(check, "a damaged list of numbers");
		if (indices && value >= check->strings)
			return refuse(check, "a tag that names no string");
	}
	return true;
}

static bool expect_bytes(struct check *check, const struct field *field)
{
	return field->wire == 2 || refuse(check, "a field of the wrong type");
}

static bool check_info(struct check *check, struct cursor from)
{
	struct field field;
	while (next_field(check, &from, &field))
		if (field.number == 5 && field.wire == 0 && field.value >= check->strings)
			return refuse(check, "a user that names no string");
	return !check->problem;
}

/* Users are stored as differences. */
static bool check_dense_info(struct check *check, struct cursor from)
{
	struct field field;
	while (next_field(check, &from, &field)) {
		int64_t user = 0;
		if (field.number != 5 || field.wire != 2)
			continue;
		for (uint64_t value; field.bytes.at < field.bytes.end;) {
			if (!read_varint(&field.bytes, &value))
				return refuse(check, "a damaged list of numbers");
			int64_t step = zigzag(value);
			if (step > INT32_MAX || step < -INT32_MAX)
				return refuse(check, "a user that names no string");
			user += step;
			if (user < 0 || (uint64_t)user >= check->strings)
				return refuse(check, "a user that names no string");
		}
	}
	return !check->problem;
}

static bool check_dense(struct check *check, struct cursor from)
{
	struct field field;
	uint64_t ids = 0, lats = 0, lons = 0, ignored;
	while (next_field(check, &from, &field)) {
		bool known = field.number == 1 || field.number == 5 || (field.number >= 8 && field.number <= 10);
		if (!known)
			continue;
		if (!expect_bytes(check, &field))
			return false;
		if (field.number == 5) {
			if (!check_dense_info(check, field.bytes))
				return false;
			continue;
		}
		uint64_t *count = field.number == 1 ? &ids : field.number == 8 ? &lats : field.number == 9 ? &lons : &ignored;
		if (!check_packed(check, field.bytes, field.number == 10, count))
			return false;
	}
	if (!check->problem && (ids != lats || ids != lons))
		return refuse(check, "nodes with too few places");
	return !check->problem;
}

static bool check_way_or_relation(struct check *check, struct cursor from, bool relation)
{
	struct field field;
	uint64_t count[11] = { 0 };
	while (next_field(check, &from, &field)) {
		bool info = field.number == 4;
		bool list = field.number == 2 || field.number == 3 || field.number == 8 || (relation && field.number <= 10);
		if (field.number == 1 || (!info && !list) || field.number > 10)
			continue;
		if (!expect_bytes(check, &field))
			return false;
		if (info ? !check_info(check, field.bytes)
				 : !check_packed(check, field.bytes,
					   field.number == 2 || field.number == 3 || (relation && field.number == 8), &count[field.number]))
			return false;
	}
	if (check->problem)
		return false;
	if (count[2] != count[3])
		return refuse(check, "a tag without a value");
	if (relation && (count[8] != count[9] || count[8] != count[10]))
		return refuse(check, "a relation with half a member");
	return true;
}

static bool check_group(struct check *check, struct cursor from)
{
	struct field field;
	while (next_field(check, &from, &field)) {
		if (field.number > 4)
			continue;
		if (!expect_bytes(check, &field))
			return false;
		if (field.number == 1)
			return refuse(
				check, "nodes that are not dense, which is not supported (rewrite the file with dense nodes)");
		bool sound = field.number == 2 ? check_dense(check, field.bytes)
									   : check_way_or_relation(check, field.bytes, field.number == 4);
		if (!sound)
			return false;
	}
	return !check->problem;
}

static bool check_strings(struct check *check, struct cursor from)
{
	struct field field;
	while (next_field(check, &from, &field))
		check->strings += field.number == 1 && field.wire == 2;
	return !check->problem;
}

static bool check_block(struct check *check, struct cursor from)
{
	struct field field;
	bool ended = false, table = false;
	check->strings = 0;
	while (next_field(check, &from, &field)) {
		if (field.number == 1 && expect_bytes(check, &field)) {
			if (table)
				return refuse(check, "two string tables");
			table = true;
			check_strings(check, field.bytes);
		} else if (field.number == 2 && expect_bytes(check, &field)) {
			/* readosm takes strings as it meets them and stops at field 17. */
			if (!table || ended)
				return refuse(check, "a block whose parts are in an order that is not supported");
			check_group(check, field.bytes);
		} else if (field.number == 17) {
			ended = true;
			if (field.wire != 0 || field.value != 100)
				return refuse(check, "a granularity other than 100 nanodegrees, which is not supported");
		} else if ((field.number == 19 || field.number == 20) && (field.wire != 0 || field.value)) {
			return refuse(check, "an offset of its places, which is not supported");
		}
		if (check->problem)
			return false;
	}
	return !check->problem;
}

static bool inflate_blob(struct check *check, struct cursor packed, uint64_t raw_size, struct cursor *out)
{
	uint8_t *raw = malloc(raw_size ? raw_size : 1);
	if (!raw)
		return refuse(check, "more data than there is memory");
	uLongf got = (uLongf)raw_size;
	int status = uncompress(raw, &got, packed.at, (uLong)(packed.end - packed.at));
	if (status != Z_OK || got != raw_size) {
		free(raw);
		return refuse(check, "damaged compressed data");
	}
	*out = (struct cursor){ raw, raw + raw_size };
	return true;
}

static bool check_blob(struct check *check, struct cursor from, bool is_data)
{
	struct field field;
	struct cursor raw = { 0 }, packed = { 0 };
	uint64_t raw_size = 0;
	while (next_field(check, &from, &field)) {
		if (field.number == 1 && field.wire == 2)
			raw = field.bytes;
		else if (field.number == 2 && field.wire == 0)
			raw_size = field.value;
		else if (field.number == 3 && field.wire == 2)
			packed = field.bytes;
		else if (field.number >= 4 && field.number <= 7)
			return refuse(check, "a compression other than zlib, which is not supported");
		else
			return refuse(check, "a damaged blob");
	}
	if (check->problem)
		return false;
	if (!packed.at && !raw.at)
		return refuse(check, "a blob without data");
	if (packed.at && raw.at)
		return refuse(check, "a damaged blob");
	if (raw_size > BLOB_LIMIT_BYTES)
		return refuse(check, "a blob of more than 32 MiB");
	struct cursor block = raw;
	if (packed.at && !inflate_blob(check, packed, raw_size, &block))
		return false;
	bool sound = !is_data || (block.at != block.end ? check_block(check, block) : refuse(check, "an empty block"));
	if (packed.at)
		free((void *)(uintptr_t)block.at);
	return sound;
}

static bool check_blob_header(struct check *check, struct cursor from, bool first, bool *is_data, uint64_t *size)
{
	struct field field;
	bool typed = false;
	while (next_field(check, &from, &field)) {
		if (field.number == 1 && field.wire == 2) {
			size_t length = (size_t)(field.bytes.end - field.bytes.at);
			*is_data = length == 7 && !memcmp(field.bytes.at, "OSMData", 7);
			if (!*is_data && (length != 9 || memcmp(field.bytes.at, "OSMHeader", 9) != 0))
				return refuse(check, "a blob of unknown type");
			typed = true;
		} else if (field.number == 3 && field.wire == 0) {
			*size = field.value;
		} else if (field.number != 2 || field.wire != 2) {
			return refuse(check, "a damaged blob header");
		}
	}
	if (check->problem)
		return false;
	if (!typed || *size == 0 || *size > BLOB_LIMIT_BYTES)
		return refuse(check, "a damaged blob header");
	if (first == *is_data)
		return refuse(check, first ? "no OSMHeader: this is no .osm.pbf file" : "a second OSMHeader");
	return true;
}

static bool check_file(struct check *check, struct cursor file)
{
	const uint8_t *start = file.at;
	for (bool first = true; file.at < file.end; first = false) {
		check->blob_offset = (size_t)(file.at - start);
		if (file.end - file.at < 4)
			return refuse(check, "the file is cut short");
		uint32_t header =
			(uint32_t)file.at[0] << 24 | (uint32_t)file.at[1] << 16 | (uint32_t)file.at[2] << 8 | file.at[3];
		file.at += 4;
		if (header == 0 || header > HEADER_LIMIT_BYTES)
			return refuse(check, first ? "this is no .osm.pbf file" : "a damaged blob header");
		struct cursor part = file;
		bool is_data = false;
		uint64_t size = 0;
		if (!skip(&file, header))
			return refuse(check, "the file is cut short");
		part.end = file.at;
		if (!check_blob_header(check, part, first, &is_data, &size))
			return false;
		part.at = file.at;
		if (!skip(&file, size))
			return refuse(check, "the file is cut short");
		part.end = file.at;
		if (!check_blob(check, part, is_data))
			return false;
	}
	return true;
}

int osm_check_pbf(const char *path, const char *name)
{
	struct file_map map;
	int status = file_map_open(&map, path);
	if (status) {
		log_error("%s: %s", name, strerror(-status));
		return status;
	}
	struct check check = { .name = name };
	if (!check_file(&check, (struct cursor){ map.bytes.data, map.bytes.data + map.bytes.size })) {
		log_error("%s: blob at byte %zu: %s", name, check.blob_offset, check.problem);
		status = -EBADMSG;
	}
	file_map_close(&map);
	return status;
}
