/* Pictures of an impostor's mesh, to look at: patches in flat colours, triangles' sides over them. */
#ifndef BLVD_TESTS_MESH_PICTURE_H
#define BLVD_TESTS_MESH_PICTURE_H

#include "tools/impostor/impostor.h"

/* Writes a PNG of one capture's patches, `zoom` pixels a pixel: farthest first, only what the texels show; texels to be
 * filled are darker. The capture itself is grey below. */
void mesh_picture(const char *path, const struct impostor_mesh *mesh, const struct capture_image *image, int zoom);

#endif
