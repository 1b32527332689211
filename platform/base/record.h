/*
 * A small record in a folder that outlives a power cut at any moment: two generations, NAME.0 and NAME.1, each with a
 * number and a checksum. A save never touches the newer one: it writes NAME.new, waits until that is on the medium,
 * renames it over the older one, and waits for the name. So after a cut the newest whole record is found, which is the
 * last one that was saved or the one being saved. The number, not a clock, says which is newer.
 *
 * One process at a time; every call may wait for the medium, so none belongs into the frame loop.
 */
#ifndef BLVD_PLATFORM_BASE_RECORD_H
#define BLVD_PLATFORM_BASE_RECORD_H

#include <stdbool.h>

#include "platform/base/file_ops.h"

#define RECORD_BYTES_MAX 4096
#define RECORD_PATH_MAX 512

struct record {
	const struct file_ops *ops;
	void *context;
	char folder[RECORD_PATH_MAX], path[2][RECORD_PATH_MAX], part[RECORD_PATH_MAX];
	uint64_t number; /* of the newest whole generation; 0: there is none */
	unsigned newest; /* which one that is */
	uint8_t buffer[RECORD_BYTES_MAX + 64];
};

/* Finds what is there and copies the newest whole record of this version to `out`, at most `size` bytes; what a shorter
 * one lacks is zero. Returns its length, 0 when there is none (no folder, no files, all damaged, another version), or
 * -ENAMETOOLONG. `ops` is borrowed. */
int record_open(struct record *record, const struct file_ops *ops, void *context, const char *folder, const char *name,
	uint32_t version, void *out, size_t size);

/* Returns 0 once the record is on the medium, else -errno, and then the one before is still whole. */
int record_save(struct record *record, uint32_t version, const void *bytes, size_t size);

#endif
