/* Pictures of what a package holds, for people. */
#ifndef BLVD_TOOLS_INSPECT_PICTURES_H
#define BLVD_TOOLS_INSPECT_PICTURES_H

#include "assets/pkg.h"

/* Writes graph.png, light.png, textures.png and glyphs.png, those whose data is there. Returns 0 or -errno after
 * logging one line. */
int inspect_pictures(const struct pkg *pkg, const char *folder);

#endif
