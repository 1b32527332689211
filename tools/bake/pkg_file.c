#include "tools/bake/pkg_file.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <unistd.h>
#include <zlib.h>

static uint32_t crc_of(const void *head, size_t head_bytes, const void *bytes, uint64_t size)
{
	uLong crc = crc32(0L, head, (uInt)head_bytes);
	const uint8_t *at = bytes;
	for (uInt step; size > 0; at += step, size -= step) {
		step = size > (1u << 30) ? 1u << 30 : (uInt)size;
		crc = crc32(crc, at, step);
	}
	return (uint32_t)crc;
}

static int put(FILE *file, const void *bytes, size_t size)
{
	return size && fwrite(bytes, 1, size, file) != size ? -EIO : 0;
}

static int put_zeros_to(FILE *file, uint64_t *at, uint64_t to)
{
	static const uint8_t zeros[PKG_ALIGN];
	int status = put(file, zeros, (size_t)(to - *at));
	*at = to;
	return status;
}

/* Geometry and blobs have checksums inside. */
static bool checks_itself(const struct pkg_file_section *section)
{
	return section->tag == PKG_GEOM || section->emit;
}

static uint64_t lay_out(const struct pkg_file_section *sections, uint32_t count, struct pkg_section *table)
{
	uint64_t at = sizeof(struct pkg_header) + count * sizeof(*table);
	for (uint32_t i = 0; i < count; i++) {
		const struct pkg_file_section *from = &sections[i];
		at = (at + PKG_ALIGN - 1) / PKG_ALIGN * PKG_ALIGN;
		table[i] = (struct pkg_section){
			.tag = from->tag, .element_bytes = from->element_bytes, .offset = at, .bytes = from->head_bytes + from->size
		};
		if (!checks_itself(from))
			table[i].crc32 = crc_of(from->head, from->head_bytes, from->bytes, from->size);
		at += table[i].bytes;
	}
	return at;
}

static int put_section(FILE *file, const struct pkg_file_section *section)
{
	int status = put(file, section->head, section->head_bytes);
	if (status)
		return status;
	return section->emit ? section->emit(section->context, file) : put(file, section->bytes, section->size);
}

static int write_sections(FILE *file, const struct pkg_file_section *sections, uint32_t count)
{
	struct pkg_section table[PKG_FILE_SECTIONS_MAX] = { 0 };
	struct pkg_header header = {
		.magic = PKG_MAGIC, .version_major = PKG_VERSION_MAJOR, .version_minor = PKG_VERSION_MINOR
	};
	header.file_bytes = lay_out(sections, count, table);
	header.section_count = count;
	header.table_crc32 = crc_of(NULL, 0, table, count * sizeof(*table));
	header.header_crc32 = crc_of(NULL, 0, &header, sizeof(header));
	int status = put(file, &header, sizeof(header));
	if (!status)
		status = put(file, table, count * sizeof(*table));
	uint64_t at = sizeof(header) + count * sizeof(*table);
	for (uint32_t i = 0; i < count && !status; i++) {
		if (!(status = put_zeros_to(file, &at, table[i].offset)))
			status = put_section(file, &sections[i]);
		at += table[i].bytes;
	}
	return status;
}

int pkg_file_write(const char *path, const struct pkg_file_section *sections, uint32_t count)
{
	char part[PATH_MAX];
	if (count > PKG_FILE_SECTIONS_MAX)
		return -E2BIG;
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part))
		return -ENAMETOOLONG;
	errno = 0;
	FILE *file = fopen(part, "wb");
	if (!file)
		return -errno;
	int status = write_sections(file, sections, count);
	if (!status && (fflush(file) || fsync(fileno(file))))
		status = -errno;
	if (status == -EIO && errno)
		status = -errno;
	if (fclose(file) && !status)
		status = -errno;
	if (!status && rename(part, path))
		status = -errno;
	if (status)
		unlink(part);
	return status;
}
