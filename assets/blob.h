/*
 * Blobs of CELD: raw LZMA2 (the format of liblzma's LZMA_FILTER_LZMA2 without a container), as SPEC.md has it.
 * Unpacking costs about 17 ms a raw MiB on a desktop core.
 */
#ifndef BLVD_ASSETS_BLOB_H
#define BLVD_ASSETS_BLOB_H

#include "assets/pkg.h"
#include "platform/base/arena.h"

/* Unpacks blobs without touching the heap after init. One reader belongs to one thread. */
struct blob_reader;
/* What init takes of its arena, at most. */
#define BLOB_READER_BYTES (PKG_BLOB_WINDOW + (64u << 10))

/* Returns 0 or -ENOMEM. */
int blob_reader_init(struct blob_reader **out, struct arena *arena);
/* `out` has blob->raw_bytes. Returns 0, or -EBADMSG when the checksum, the stream or its length is wrong. */
int blob_read(struct blob_reader *reader, const struct pkg *pkg, const struct pkg_blob *blob, void *out);

#endif
