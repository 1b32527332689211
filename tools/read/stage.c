#include "tools/read/stage.h"

#include <bzlib.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "tools/read/text.h"

#define CHUNK_BYTES 65536
/* A city is well below; a bomb is not. */
#define UNPACKED_LIMIT_BYTES ((uint64_t)32 << 30)

static bool ends_with(const char *path, const char *ending)
{
	size_t length = strlen(path), tail = strlen(ending);
	return length >= tail && !strcasecmp(path + length - tail, ending);
}

static int fail(const char *path, int error)
{
	log_error("%s: %s", path, error == EISDIR ? "is a directory, a file is wanted" : strerror(error));
	return -error;
}

/* The first bytes decide, so that a wrong ending does no harm; PBF has no magic but starts with a short length. */
static int sniff(const char *path, unsigned char head[16], size_t *size)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return fail(path, errno);
	struct stat status;
	if (fstat(fd, &status) < 0 || S_ISDIR(status.st_mode)) {
		close(fd);
		return fail(path, EISDIR);
	}
	ssize_t got = read(fd, head, 16);
	int error = errno;
	close(fd);
	if (got < 0)
		return fail(path, error);
	*size = (size_t)got;
	if (!got) {
		log_error("%s: the file is empty", path);
		return -EBADMSG;
	}
	return 0;
}

static enum input_format format_of(const char *path, const unsigned char *head, size_t size)
{
	size_t i = size >= 3 && head[0] == 0xEF && head[1] == 0xBB && head[2] == 0xBF ? 3 : 0;
	while (i < size && (head[i] == ' ' || head[i] == '\t' || head[i] == '\n' || head[i] == '\r'))
		i++;
	if (i < size && head[i] == '{')
		return INPUT_JSON;
	if (i < size && head[i] == '<')
		return INPUT_OSM_XML;
	if (size >= 6 && !head[0] && !head[1] && head[4] == 0x0A)
		return INPUT_OSM_PBF;
	return ends_with(path, ".osm") || ends_with(path, ".osm.gz") || ends_with(path, ".osm.bz2") ? INPUT_OSM_XML
		   : ends_with(path, ".json") || ends_with(path, ".json.gz")                            ? INPUT_JSON
																								: INPUT_OSM_PBF;
}

static int make_folder(struct staged *staged)
{
	const char *base = getenv("TMPDIR");
	if (!base || !*base || strlen(base) > 40)
		base = "/tmp";
	snprintf(staged->folder, sizeof(staged->folder), "%s/blvd-XXXXXX", base);
	if (mkdtemp(staged->folder))
		return 0;
	int error = errno;
	log_error("%s: cannot make a temporary folder: %s", staged->folder, strerror(error));
	staged->folder[0] = 0;
	return -error;
}

static int write_chunk(FILE *to, const char *path, const void *data, size_t size, uint64_t *total)
{
	*total += size;
	if (*total > UNPACKED_LIMIT_BYTES) {
		log_error("%s: unpacks to more than %llu GiB", path, (unsigned long long)(UNPACKED_LIMIT_BYTES >> 30));
		return -EBADMSG;
	}
	if (fwrite(data, 1, size, to) == size)
		return 0;
	log_error("%s: unpacking: %s", path, strerror(errno));
	return -EIO;
}

static int unpack_gz(const char *path, FILE *to)
{
	gzFile from = gzopen(path, "rb");
	if (!from)
		return fail(path, errno ? errno : ENOMEM);
	unsigned char buffer[CHUNK_BYTES];
	uint64_t total = 0;
	int got, status = 0;
	while (!status && (got = gzread(from, buffer, sizeof(buffer))) > 0)
		status = write_chunk(to, path, buffer, (size_t)got, &total);
	long long place = (long long)gzoffset(from);
	/* gzread() takes a file that ends early for its end; only closing it tells. */
	int closed = gzclose(from);
	if (!status && (got < 0 || closed != Z_OK)) {
		log_error("%s: byte %lld: the compressed data is %s", path, place, got < 0 ? "damaged" : "cut short");
		status = -EBADMSG;
	}
	return status;
}

static int unpack_bz2(const char *path, FILE *to)
{
	FILE *file = fopen(path, "rbe");
	if (!file)
		return fail(path, errno);
	unsigned char buffer[CHUNK_BYTES];
	uint64_t total = 0;
	int error = BZ_OK, status = 0;
	bool more = true;
	/* Parallel packers write several streams in a row: go on behind each with what the library read too far. */
	char unused[BZ_MAX_UNUSED];
	int unused_count = 0;
	while (more && !status) {
		BZFILE *from = BZ2_bzReadOpen(&error, file, 0, 0, unused, unused_count);
		while (error == BZ_OK && !status) {
			int got = BZ2_bzRead(&error, from, buffer, sizeof(buffer));
			if (error == BZ_OK || error == BZ_STREAM_END)
				status = write_chunk(to, path, buffer, (size_t)got, &total);
		}
		if (!status && error != BZ_STREAM_END) {
			log_error("%s: byte %ld: the compressed data is %s", path, ftell(file),
				error == BZ_UNEXPECTED_EOF ? "cut short" : "damaged");
			status = -EBADMSG;
		}
		unused_count = 0;
		if (!status) {
			void *rest;
			int ignored;
			BZ2_bzReadGetUnused(&ignored, from, &rest, &unused_count);
			memcpy(unused, rest, (size_t)unused_count);
			int next = unused_count ? 0 : fgetc(file);
			more = next != EOF;
			if (more && !unused_count)
				ungetc(next, file);
		}
		BZ2_bzReadClose(&(int){ 0 }, from);
	}
	fclose(file);
	return status;
}

static int unpack(struct staged *staged, const char *path, bool bz2)
{
	FILE *to = fopen(staged->path, "wbxe");
	if (!to)
		return fail(staged->path, errno);
	int status = bz2 ? unpack_bz2(path, to) : unpack_gz(path, to);
	if (fclose(to) && !status)
		status = fail(staged->path, errno);
	return status;
}

int stage_open(struct staged *staged, const char *path)
{
	unsigned char head[16];
	size_t size = 0;
	*staged = (struct staged){ 0 };
	int status = sniff(path, head, &size);
	if (status)
		return status;
	bool gz = size >= 2 && head[0] == 0x1F && head[1] == 0x8B, bz2 = size >= 3 && !memcmp(head, "BZh", 3);
	static const char *const endings[] = { ".osm", ".pbf", ".json" };
	if (!gz && !bz2) {
		staged->format = format_of(path, head, size);
		if (ends_with(path, endings[staged->format]) || staged->format == INPUT_JSON) {
			snprintf(staged->path, sizeof(staged->path), "%s", path);
			return 0;
		}
	}
	status = make_folder(staged);
	if (status)
		return status;
	snprintf(staged->path, sizeof(staged->path), "%s/input", staged->folder);
	if (gz || bz2) {
		status = unpack(staged, path, bz2);
	} else {
		char *real = realpath(path, NULL);
		status = real && !symlink(real, staged->path) ? 0 : fail(path, errno);
		free(real);
	}
	if (!status)
		status = sniff(staged->path, head, &size);
	if (!status) {
		char named[sizeof(staged->path)];
		staged->format = format_of(path, head, size);
		snprintf(named, sizeof(named), "%s/input%s", staged->folder, endings[staged->format]);
		status = rename(staged->path, named) ? fail(named, errno) : 0;
		if (!status)
			snprintf(staged->path, sizeof(staged->path), "%s", named);
	}
	if (status)
		stage_close(staged);
	return status;
}

void stage_close(struct staged *staged)
{
	if (!staged->folder[0])
		return;
	if (!strncmp(staged->path, staged->folder, strlen(staged->folder)))
		unlink(staged->path);
	rmdir(staged->folder);
	staged->folder[0] = 0;
}

/* The bytes of a character that XML 1.0 allows, or 0. Near the end of the file a copy stands in, for text_sequence()
 * wants a NUL. */
static size_t allowed(const uint8_t *at, size_t left)
{
	char tail[5] = { 0 };
	memcpy(tail, at, left < 4 ? left : 4);
	size_t length = text_sequence(tail);
	bool control = length == 1 && (uint8_t)tail[0] < 0x20 && !strchr("\t\n\r", tail[0]);
	return control ? 0 : length;
}

static bool is_utf8(const struct span *bytes)
{
	char head[201] = { 0 };
	memcpy(head, bytes->data, bytes->size < 200 ? bytes->size : 200);
	char *end = strstr(head, "?>");
	if (end)
		*end = 0;
	const char *encoding = end ? strstr(head, "encoding") : NULL;
	/* UTF-16 has a zero in its first two bytes or a mark that is no UTF-8. */
	bool wide = bytes->size >= 2 && (!head[0] || !head[1] || (uint8_t)head[0] >= 0xFE);
	return !wide && (!encoding || strcasestr(encoding, "utf-8"));
}

static int write_mended(FILE *to, const struct span *bytes)
{
	for (size_t i = 0; i < bytes->size;) {
		size_t length = allowed(bytes->data + i, bytes->size - i);
		uint8_t byte = bytes->data[i];
		if (length)
			fwrite(bytes->data + i, 1, length, to);
		else if (byte < 0xA0)
			fputc(' ', to);
		else
			fprintf(to, "%c%c", 0xC0 | byte >> 6, 0x80 | (byte & 0x3F));
		i += length ? length : 1;
	}
	return ferror(to) ? -EIO : 0;
}

static uint64_t count_bad(const struct span *bytes)
{
	uint64_t bad = 0;
	bool last = false;
	for (size_t i = 0; i < bytes->size;) {
		size_t length = allowed(bytes->data + i, bytes->size - i);
		bad += !length && !last;
		last = !length;
		i += length ? length : 1;
	}
	return bad;
}

int stage_mend_text(struct staged *staged, const char *name, uint64_t *mended)
{
	struct file_map map;
	char path[sizeof(staged->folder) + 16];
	int status = file_map_open(&map, staged->path);
	*mended = 0;
	if (status)
		return fail(name, -status);
	if (is_utf8(&map.bytes))
		*mended = count_bad(&map.bytes);
	if (*mended && !staged->folder[0])
		status = make_folder(staged);
	if (*mended && !status) {
		snprintf(path, sizeof(path), "%s/mended.osm", staged->folder);
		FILE *to = fopen(path, "wbxe");
		status = to ? write_mended(to, &map.bytes) : -errno;
		if (to && fclose(to) && !status)
			status = -errno;
		if (status)
			fail(path, -status);
	}
	file_map_close(&map);
	if (*mended && !status) {
		/* Only what lies in the folder is ours to remove. */
		if (!strncmp(staged->path, staged->folder, strlen(staged->folder)))
			unlink(staged->path);
		snprintf(staged->path, sizeof(staged->path), "%s", path);
	}
	return status;
}
