/* Packs what goes into CELD (assets/blob.h reads it). */
#ifndef BLVD_TOOLS_IMPOSTOR_BLOB_WRITE_H
#define BLVD_TOOLS_IMPOSTOR_BLOB_WRITE_H

#include "assets/pkg_format.h"
#include "tools/impostor/triangle_set.h"

/* What stays in a city is packed as small as it gets, at 5 MB/s; what is for measuring only, five times as fast. */
enum blob_effort { BLOB_SMALL, BLOB_QUICK };

/* Appends the packed bytes of `raw`, aligned, and says where they are. The same bytes in, the same bytes out. Returns
 * 0, or -ENOMEM. */
int blob_append(byte_array *out, const byte_array *raw, enum blob_effort effort, struct pkg_blob *blob);

#endif
