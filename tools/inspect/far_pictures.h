/* Pictures of the impostors along one half-edge: pages as stored, triangles as seen from where the cell begins. */
#ifndef BLVD_TOOLS_INSPECT_FAR_PICTURES_H
#define BLVD_TOOLS_INSPECT_FAR_PICTURES_H

#include "assets/pkg.h"

/* Writes DIR/pages-STRETCH.png and DIR/wire-STRETCH.png for each of its impostors. Returns 0 or -errno after logging
 * one line. */
int far_pictures(const struct pkg *pkg, uint32_t half, const char *folder);

#endif
