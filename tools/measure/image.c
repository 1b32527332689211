#include "tools/measure/image.h"

#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/city/pool.h"

int image_read_png(struct image *image, const char *path)
{
	*image = (struct image){ 0 };
	png_image png = { .version = PNG_IMAGE_VERSION };
	if (!png_image_begin_read_from_file(&png, path)) {
		log_error("%s: %s", path, png.message);
		return -EBADMSG;
	}
	png.format = PNG_FORMAT_RGB;
	image->rgb = array_grow(NULL, &(size_t){ 0 }, PNG_IMAGE_SIZE(png), 1);
	if (!png_image_finish_read(&png, NULL, image->rgb, 0, NULL)) {
		log_error("%s: %s", path, png.message);
		image_finish(image);
		return -EBADMSG;
	}
	image->width = png.width;
	image->height = png.height;
	return 0;
}

int image_write_png(const struct image *image, const char *path)
{
	png_image png = {
		.version = PNG_IMAGE_VERSION, .width = image->width, .height = image->height, .format = PNG_FORMAT_RGB
	};
	if (!png_image_write_to_file(&png, path, 0, image->rgb, 0, NULL)) {
		log_error("%s: %s", path, png.message);
		return -EIO;
	}
	return 0;
}

void image_finish(struct image *image)
{
	array_free(image->rgb);
	*image = (struct image){ 0 };
}
