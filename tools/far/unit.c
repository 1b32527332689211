#include "tools/far/unit.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "platform/base/log.h"

#define MAGIC "BLVDUNI1"

static int name_of(char path[PATH_MAX], const char *folder, uint64_t hash, const char *suffix)
{
	int length = snprintf(path, PATH_MAX, "%s/%016llx.unit%s", folder, (unsigned long long)hash, suffix);
	return length < PATH_MAX ? 0 : -ENAMETOOLONG;
}

static bool is_whole(const struct unit_file *unit, uint64_t hash)
{
	struct span file = unit->map.bytes;
	const struct unit_head *head = (const void *)file.data;
	if (file.size < sizeof(*head) || memcmp(head->magic, MAGIC, sizeof(head->magic)) != 0 || head->hash != hash ||
		head->count > UNIT_STRETCHES)
		return false;
	uint64_t before = sizeof(*head) + head->count * sizeof(struct unit_record);
	if (file.size < before || file.size - before != head->bytes || head->bytes > UINT32_MAX)
		return false;
	return crc32(0, file.data + sizeof(*head), (uInt)(file.size - sizeof(*head))) == head->crc32;
}

int unit_open(struct unit_file *unit, const char *folder, uint64_t hash)
{
	char path[PATH_MAX];
	*unit = (struct unit_file){ 0 };
	int err = name_of(path, folder, hash, "");
	if (!err)
		err = file_map_open(&unit->map, path);
	if (err)
		return err;
	if (!is_whole(unit, hash)) {
		file_map_close(&unit->map);
		return -EBADMSG;
	}
	unit->head = (const void *)unit->map.bytes.data;
	unit->records = (const void *)(unit->head + 1);
	unit->blobs = (const uint8_t *)(unit->records + unit->head->count);
	return 0;
}

void unit_close(struct unit_file *unit)
{
	file_map_close(&unit->map);
	*unit = (struct unit_file){ 0 };
}

/* Into memory of `size` bytes. */
static uint8_t *pack(struct pool *pool, uint64_t hash, const struct baked_stretch *baked, uint32_t count, size_t *size)
{
	struct unit_record records[UNIT_STRETCHES] = { 0 };
	size_t before = sizeof(struct unit_head) + count * sizeof(records[0]), at = 0;
	for (uint32_t i = 0; i < count; i++) {
		records[i] = (struct unit_record){ .stretch = baked[i].stretch,
			.cells = { baked[i].cells[0], baked[i].cells[1] },
			.first_byte = at,
			.bytes = baked[i].bytes.count };
		at = (at + baked[i].bytes.count + PKG_BLOB_ALIGN - 1) / PKG_BLOB_ALIGN * PKG_BLOB_ALIGN;
	}
	*size = before + at;
	uint8_t *out = pool_alloc(pool, *size);
	memcpy(out + sizeof(struct unit_head), records, count * sizeof(records[0]));
	for (uint32_t i = 0; i < count; i++)
		if (baked[i].bytes.count)
			memcpy(out + before + records[i].first_byte, baked[i].bytes.items, baked[i].bytes.count);
	struct unit_head head = { .magic = MAGIC, .count = count, .hash = hash, .bytes = at };
	head.crc32 = (uint32_t)crc32(0, out + sizeof(head), (uInt)(*size - sizeof(head)));
	memcpy(out, &head, sizeof(head));
	return out;
}

static int write_part(const char *part, const uint8_t *bytes, size_t size)
{
	FILE *file = fopen(part, "wb");
	if (!file)
		return -errno;
	errno = 0;
	bool written = fwrite(bytes, 1, size, file) == size && !fflush(file);
	int err = written ? 0 : errno ? -errno : -EIO;
	return fclose(file) && !err ? -errno : err;
}

int unit_write(const char *folder, uint64_t hash, const struct baked_stretch *baked, uint32_t count)
{
	char path[PATH_MAX], part[PATH_MAX], suffix[24];
	struct pool pool = { 0 };
	size_t size;
	snprintf(suffix, sizeof(suffix), ".%ld.part", (long)getpid());
	int err = name_of(path, folder, hash, "");
	err = err ? err : name_of(part, folder, hash, suffix);
	if (!err) {
		const uint8_t *bytes = pack(&pool, hash, baked, count, &size);
		err = write_part(part, bytes, size);
		if (!err && rename(part, path))
			err = -errno;
		if (err)
			unlink(part);
	}
	pool_finish(&pool);
	if (err)
		log_error("%s: cannot write a unit: %s", folder, strerror(-err));
	return err;
}
