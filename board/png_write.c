#include "board/png_write.h"

#include <errno.h>
#include <limits.h>
#include <png.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"

/* Filter 'up' and level 1: frames are written while driving, speed counts more than size. */
static int encode(FILE *file, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png ? png_create_info_struct(png) : NULL;
	if (!info || setjmp(png_jmpbuf(png))) {
		png_destroy_write_struct(&png, &info);
		return errno ? -errno : -EIO;
	}
	png_init_io(png, file);
	png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
		PNG_FILTER_TYPE_DEFAULT);
	png_set_compression_level(png, 1);
	png_set_filter(png, 0, PNG_FILTER_UP);
	png_write_info(png, info);
	png_set_filler(png, 0, PNG_FILLER_AFTER);
	for (uint32_t y = 0; y < height; y++)
		png_write_row(png, rgba + (size_t)y * width * 4);
	png_write_end(png, info);
	png_destroy_write_struct(&png, &info);
	return 0;
}

int png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	char part[PATH_MAX];
	int err = 0;
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part)) {
		err = -ENAMETOOLONG;
		goto out;
	}
	errno = 0;
	FILE *file = fopen(part, "wb");
	if (!file) {
		err = -errno;
		goto out;
	}
	err = encode(file, rgba, width, height);
	if (fclose(file) && !err)
		err = -errno;
	if (!err && rename(part, path))
		err = -errno;
	if (err)
		unlink(part);
out:
	if (err)
		log_error("%s: cannot write picture: %s", path, strerror(-err));
	return err;
}
