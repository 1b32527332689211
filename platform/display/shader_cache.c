/* Names as in Mesa 22 to 25: one file a shader, or since 24 one for all of them; either has its index beside it. */
#include "platform/display/shader_cache.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "platform/base/log.h"

#define PATH_SIZE 512
#define ROOM_BYTES (4 << 20) /* an index, and the shaders of a start */

#define KINDS 2

/* The index of one kind of cache. False: there is no folder for it. */
static bool index_path(int kind, char path[PATH_SIZE])
{
	static const char *const kinds[KINDS] = { "mesa_shader_cache", "mesa_shader_cache_db" };
	static const char *const folders[][2] = { { "MESA_SHADER_CACHE_DIR", "" }, { "XDG_CACHE_HOME", "" },
		{ "HOME", "/.cache" } };
	for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++) {
		const char *folder = getenv(folders[i][0]);
		if (folder && *folder)
			return snprintf(path, PATH_SIZE, "%s%s/%s/index", folder, folders[i][1], kinds[kind]) < PATH_SIZE;
	}
	return false;
}

/* 0: every byte of the file has its block. -ENOENT: there is none, or an empty one. */
static int fill_holes(const char *path)
{
	struct stat status;
	int fd = open(path, O_RDWR | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	int err = fstat(fd, &status) ? -errno : status.st_size == 0 ? -ENOENT : 0;
	if (!err && fallocate(fd, 0, 0, status.st_size))
		err = -errno;
	close(fd);
	return err;
}

/* Room where the path is going to be; its folders may not be there yet. */
static bool has_room(const char *path)
{
	char folder[PATH_SIZE];
	struct statvfs disk;
	snprintf(folder, sizeof(folder), "%s", path);
	while (statvfs(folder, &disk)) {
		char *slash = strrchr(folder, '/');
		if (errno != ENOENT || !slash || slash == folder)
			return true; /* not known */
		*slash = '\0';
	}
	return (unsigned long long)disk.f_bavail * disk.f_frsize >= ROOM_BYTES;
}

void shader_cache_check(void)
{
	char path[PATH_SIZE];
	bool whole = false, torn = false;
	if (getenv("MESA_SHADER_CACHE_DISABLE"))
		return;
	for (int kind = 0; kind < KINDS && index_path(kind, path); kind++) {
		int err = fill_holes(path);
		bool not_ours = err == -EACCES || err == -EPERM || err == -EROFS; /* Mesa cannot map it either */
		whole = whole || err == 0 || not_ours;
		torn = torn || (err && err != -ENOENT && !not_ours);
	}
	if ((whole && !torn) || !index_path(0, path) || has_room(path))
		return;
	log_warn("%s: no room for compiled shaders; they are not kept", path);
	setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
}

void shader_cache_reserve(void)
{
	char path[PATH_SIZE];
	if (getenv("MESA_SHADER_CACHE_DISABLE"))
		return;
	for (int kind = 0; kind < KINDS && index_path(kind, path); kind++) {
		int err = fill_holes(path);
		if (err && err != -ENOENT)
			log_debug("%s: %s", path, strerror(-err));
	}
}
