#include "platform/base/file_ops.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

static int system_create(void *context, const char *path)
{
	(void)context;
	int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
	return fd < 0 ? -errno : fd;
}

static int64_t system_write(void *context, int fd, const void *bytes, size_t size)
{
	(void)context;
	ssize_t n;
	do
		n = write(fd, bytes, size);
	while (n < 0 && errno == EINTR);
	return n < 0 ? -errno : n;
}

static int system_sync(void *context, int fd)
{
	(void)context;
	return fsync(fd) < 0 ? -errno : 0;
}

static int system_close(void *context, int fd)
{
	(void)context;
	return close(fd) < 0 ? -errno : 0;
}

static int system_rename(void *context, const char *from, const char *to)
{
	(void)context;
	return rename(from, to) < 0 ? -errno : 0;
}

static int system_remove(void *context, const char *path)
{
	(void)context;
	return unlink(path) < 0 ? -errno : 0;
}

static int system_sync_folder(void *context, const char *path)
{
	(void)context;
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	int status = fsync(fd) < 0 ? -errno : 0;
	close(fd);
	/* some file systems have no such thing and keep the order of names by themselves */
	return status == -EINVAL || status == -ENOTSUP ? 0 : status;
}

static int64_t system_read(void *context, const char *path, void *bytes, size_t size)
{
	(void)context;
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return -errno;
	size_t done = 0;
	int64_t status = 0;
	while (done < size) {
		ssize_t n = read(fd, (char *)bytes + done, size - done);
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			status = -errno;
		if (n <= 0)
			break;
		done += (size_t)n;
	}
	close(fd);
	return status < 0 ? status : (int64_t)done;
}

const struct file_ops file_ops_system = {
	.create = system_create,
	.write = system_write,
	.sync = system_sync,
	.close = system_close,
	.rename = system_rename,
	.remove = system_remove,
	.sync_folder = system_sync_folder,
	.read = system_read,
};
