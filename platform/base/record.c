#include "platform/base/record.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#define MAGIC "BLVDKEEP"

struct record_header {
	char magic[8];
	uint64_t number;
	uint32_t version;
	uint32_t bytes;
	uint32_t crc32; /* of this struct with this field 0, then of the bytes */
	uint32_t reserved;
};
static_assert(sizeof(struct record_header) == 32, "on-disk layout");

/* The usual CRC-32 (reflected 0x04C11DB7), bit by bit: a record is a few hundred bytes. */
static uint32_t crc32_of(uint32_t crc, const void *bytes, size_t size)
{
	const uint8_t *at = bytes;
	crc = ~crc;
	for (size_t i = 0; i < size; i++) {
		crc ^= at[i];
		for (int bit = 0; bit < 8; bit++)
			crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
	}
	return ~crc;
}

static uint32_t checksum(const struct record_header *header, const void *bytes)
{
	struct record_header copy = *header;
	copy.crc32 = 0;
	return crc32_of(crc32_of(0, &copy, sizeof(copy)), bytes, header->bytes);
}

/* Reads one generation into the buffer. Returns whether it is whole. */
static bool read_generation(struct record *record, unsigned which, struct record_header *header)
{
	int64_t size = record->ops->read(record->context, record->path[which], record->buffer, sizeof(record->buffer));
	if (size < (int64_t)sizeof(*header))
		return false;
	memcpy(header, record->buffer, sizeof(*header));
	return !memcmp(header->magic, MAGIC, sizeof(header->magic)) && header->number > 0 &&
		   header->bytes <= RECORD_BYTES_MAX && (int64_t)(header->bytes + sizeof(*header)) == size &&
		   checksum(header, record->buffer + sizeof(*header)) == header->crc32;
}

static bool make_paths(struct record *record, const char *folder, const char *name)
{
	const int room = RECORD_PATH_MAX;
	return snprintf(record->folder, sizeof(record->folder), "%s", folder) < room &&
		   snprintf(record->path[0], sizeof(record->path[0]), "%s/%s.0", folder, name) < room &&
		   snprintf(record->path[1], sizeof(record->path[1]), "%s/%s.1", folder, name) < room &&
		   snprintf(record->part, sizeof(record->part), "%s/%s.new", folder, name) < room;
}

int record_open(struct record *record, const struct file_ops *ops, void *context, const char *folder, const char *name,
	uint32_t version, void *out, size_t size)
{
	memset(record, 0, sizeof(*record));
	record->ops = ops;
	record->context = context;
	if (!make_paths(record, folder, name))
		return -ENAMETOOLONG;
	int found = 0;
	for (unsigned i = 0; i < 2; i++) {
		struct record_header header;
		if (!read_generation(record, i, &header) || header.number <= record->number)
			continue;
		record->number = header.number;
		record->newest = i;
		/* one of another version is newer all the same: it is not overwritten by the next save */
		found = header.version == version ? (int)header.bytes : 0;
		memset(out, 0, size);
		if (found)
			memcpy(out, record->buffer + sizeof(header), header.bytes < size ? header.bytes : size);
	}
	return found;
}

static int write_whole(struct record *record, size_t size)
{
	const struct file_ops *ops = record->ops;
	int fd = ops->create(record->context, record->part);
	if (fd < 0)
		return fd;
	int64_t status = 0;
	for (size_t done = 0; done < size && status >= 0;) {
		status = ops->write(record->context, fd, record->buffer + done, size - done);
		if (status == 0)
			status = -EIO;
		done += status > 0 ? (size_t)status : 0;
	}
	if (status >= 0)
		status = ops->sync(record->context, fd);
	int closed = ops->close(record->context, fd);
	return status < 0 ? (int)status : closed;
}

int record_save(struct record *record, uint32_t version, const void *bytes, size_t size)
{
	assert(size <= RECORD_BYTES_MAX);
	const struct file_ops *ops = record->ops;
	unsigned older = record->number ? 1 - record->newest : 0;
	struct record_header header = {
		.magic = MAGIC, .number = record->number + 1, .version = version, .bytes = (uint32_t)size
	};
	header.crc32 = checksum(&header, bytes);
	memcpy(record->buffer, &header, sizeof(header));
	memcpy(record->buffer + sizeof(header), bytes, size);
	int status = write_whole(record, sizeof(header) + size);
	if (!status)
		status = ops->rename(record->context, record->part, record->path[older]);
	if (status) {
		ops->remove(record->context, record->part); /* a full disk is not made fuller */
		return status;
	}
	record->number = header.number;
	record->newest = older;
	return ops->sync_folder(record->context, record->folder);
}
