/*
 * A unit: UNIT_STRETCHES stretches that follow one another, baked, in a file of its own. Its name is the hash of what
 * it was made of, so a file that is there need not be made again; it is renamed into place, so it is whole.
 */
#ifndef BLVD_TOOLS_FAR_UNIT_H
#define BLVD_TOOLS_FAR_UNIT_H

#include "platform/base/file_map.h"
#include "tools/impostor/cell_bake.h"

#define UNIT_STRETCHES 16

struct unit_head {
	char magic[8];
	uint32_t count; /* stretches */
	uint32_t crc32; /* of what follows */
	uint64_t hash;  /* of the input, as in the name */
	uint64_t bytes; /* of the blobs */
};
/* Then: count of these, then the blobs, each record's from its `first_byte`, which is aligned as in CELD. */
struct unit_record {
	struct pkg_stretch stretch; /* edge and place as when it was baked; blob offsets from first_byte */
	struct pkg_cell cells[2];
	uint64_t first_byte, bytes;
};

struct unit_file {
	struct file_map map;
	const struct unit_head *head;
	const struct unit_record *records;
	const uint8_t *blobs;
};

/* Returns 0, -errno, or -EBADMSG when it is not whole, not of this hash, or not of this version. */
int unit_open(struct unit_file *unit, const char *folder, uint64_t hash);
void unit_close(struct unit_file *unit);

/* Returns 0 or -errno after logging one line. */
int unit_write(const char *folder, uint64_t hash, const struct baked_stretch *baked, uint32_t count);

#endif
