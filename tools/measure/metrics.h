/* How two pictures differ. */
#ifndef BLVD_TOOLS_MEASURE_METRICS_H
#define BLVD_TOOLS_MEASURE_METRICS_H

#include "tools/measure/image.h"

struct image_difference {
	int max;        /* largest difference of any channel, 0 to 255 */
	double mean;    /* mean absolute difference of all channels */
	double mse;     /* mean square */
	double psnr_db; /* 10 log10(255^2 / mse); infinite for equal pictures */
	double ssim; /* of luma; Wang et al. 2004, "Image Quality Assessment", eq. 13: 11 x 11 Gaussian window of sigma 1.5,
					mean over the windows that lie inside the picture. 1 for pictures smaller than the window only when
					they are equal, else 0 */
	double differing; /* share of pixels with any difference */
	double within_2;  /* share of pixels whose channels all differ by at most 2 */
};

/* Pictures of one size. */
void image_compare(const struct image *a, const struct image *b, struct image_difference *out);

/* Grey where equal; differences eight times enlarged. Returns 0 or -EIO. */
int image_write_difference(const struct image *a, const struct image *b, const char *path);

#endif
