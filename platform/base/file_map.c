#include "platform/base/file_map.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define FAULT_BYTES ((uintptr_t)64 << 10) /* Linux maps so much around what is touched */

static int map_fd(struct file_map *map, int fd)
{
	struct stat info;
	if (fstat(fd, &info) < 0)
		return -errno;
	if (S_ISDIR(info.st_mode))
		return -EISDIR;
	if (info.st_size == 0)
		return 0;
	void *at = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
	if (at == MAP_FAILED)
		return -errno;
	map->bytes = (struct span){ .data = at, .size = (size_t)info.st_size };
	return 0;
}

int file_map_open(struct file_map *map, const char *path)
{
	*map = (struct file_map){ 0 };
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	int status = map_fd(map, fd);
	close(fd);
	return status;
}

void file_map_close(struct file_map *map)
{
	if (map->bytes.data)
		munmap((void *)(uintptr_t)map->bytes.data, map->bytes.size);
	*map = (struct file_map){ 0 };
}

void file_map_let_go(const struct file_map *map, const void *at, size_t bytes)
{
	const uintptr_t base = (uintptr_t)map->bytes.data, from = (uintptr_t)at, last = base + map->bytes.size;
	if (!map->bytes.data || from < base || bytes > map->bytes.size || from - base > map->bytes.size - bytes)
		return;
	/* a fault brings its neighbours along: what else lies there is only looked up once more */
	uintptr_t first = from / FAULT_BYTES * FAULT_BYTES,
			  end = (from + bytes + FAULT_BYTES - 1) / FAULT_BYTES * FAULT_BYTES;
	first = first < base ? base : first;
	end = end > last ? last : end;
	madvise((void *)first, end - first, MADV_DONTNEED);
}
