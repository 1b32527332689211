/* The camera's arithmetic: points to pixels and back. */
#include <stdlib.h>

#include "tools/impostor/capture.h"

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

bool capture_project(const struct capture_view *view, struct dvec3 point, double *x, double *y, double *z)
{
	struct dvec3 from_eye = { point.x - view->eye.x, point.y - view->eye.y, point.z - view->eye.z };
	double depth = dot(from_eye, view->forward);
	if (!(depth > 0))
		return false;
	*x = view->centre_x + view->focal_px * dot(from_eye, view->right) / depth;
	*y = view->centre_y - view->focal_px * dot(from_eye, view->up) / depth;
	*z = depth;
	return true;
}

struct dvec3 capture_point(const struct capture_view *view, double x, double y, double disparity)
{
	double depth = 1 / disparity;
	double to_right = depth * (x - view->centre_x) / view->focal_px;
	double to_up = depth * (view->centre_y - y) / view->focal_px;
	return (struct dvec3){
		view->eye.x + depth * view->forward.x + to_right * view->right.x + to_up * view->up.x,
		view->eye.y + depth * view->forward.y + to_right * view->right.y + to_up * view->up.y,
		view->eye.z + depth * view->forward.z + to_right * view->right.z + to_up * view->up.z,
	};
}

void capture_image_finish(struct capture_image *image)
{
	free(image->rgba);
	free(image->pixels);
	*image = (struct capture_image){ 0 };
}
