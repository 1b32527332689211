#include "tools/far/assemble.h"

#include <errno.h>
#include <string.h>

#include "assets/pkg_check.h"
#include "platform/base/log.h"
#include "tools/far/unit.h"

void far_sections_finish(struct far_sections *sections)
{
	ARRAY_FINISH(&sections->stretches);
	ARRAY_FINISH(&sections->cells);
}

static uint64_t align_blob(uint64_t at)
{
	return (at + PKG_BLOB_ALIGN - 1) / PKG_BLOB_ALIGN * PKG_BLOB_ALIGN;
}

static void move_blob(struct pkg_blob *blob, uint64_t by)
{
	if (blob->stored_bytes)
		blob->offset += by;
}

static void add_record(struct far_sections *out, const struct unit_record *record, const struct pkg_stretch *cut)
{
	struct pkg_stretch stretch = record->stretch;
	uint64_t at = align_blob(out->blob_bytes);
	stretch.edge = cut->edge;
	stretch.from_mm = cut->from_mm;
	stretch.to_mm = cut->to_mm;
	move_blob(&stretch.local, at);
	move_blob(&stretch.pvs, at);
	ARRAY_PUSH(&out->stretches, stretch);
	for (int way = 0; way < 2; way++) {
		struct pkg_cell cell = record->cells[way];
		move_blob(&cell.impostor, at);
		move_blob(&cell.truth, at);
		ARRAY_PUSH(&out->cells, cell);
	}
	if (record->bytes)
		out->blob_bytes = at + record->bytes;
}

int far_sections_gather(
	struct far_sections *out, const struct far_plan *plan, const char *folder, const uint64_t *unit_hashes)
{
	*out = (struct far_sections){ 0 };
	for (uint32_t i = 0; i < far_plan_units(plan); i++) {
		struct unit_file unit;
		uint32_t first = plan->unit_first.items[i], count = plan->unit_first.items[i + 1] - first;
		int err = unit_open(&unit, folder, unit_hashes[i]);
		if (!err && unit.head->count != count)
			err = -EBADMSG;
		if (err) {
			log_error(
				"%s: unit %016llx is gone or damaged: %s", folder, (unsigned long long)unit_hashes[i], strerror(-err));
			unit_close(&unit);
			return err;
		}
		for (uint32_t k = 0; k < count; k++)
			add_record(out, &unit.records[k], &plan->stretches.items[first + k]);
		unit_close(&unit);
	}
	return 0;
}

/* --- writing --- */

struct emit {
	const struct far_plan *plan;
	const char *folder;
	const uint64_t *unit_hashes;
	uint64_t at;
};

static int put(struct emit *emit, FILE *file, const void *bytes, uint64_t size)
{
	if (size && fwrite(bytes, 1, size, file) != size)
		return errno ? -errno : -EIO;
	emit->at += size;
	return 0;
}

static int emit_unit(struct emit *emit, FILE *file, uint64_t hash)
{
	static const uint8_t zeros[PKG_BLOB_ALIGN];
	struct unit_file unit;
	int err = unit_open(&unit, emit->folder, hash);
	for (uint32_t i = 0; !err && i < unit.head->count; i++) {
		const struct unit_record *record = &unit.records[i];
		if (!record->bytes)
			continue;
		err = put(emit, file, zeros, align_blob(emit->at) - emit->at);
		if (!err)
			err = put(emit, file, unit.blobs + record->first_byte, record->bytes);
	}
	unit_close(&unit);
	return err;
}

static int emit_blobs(void *context, FILE *file)
{
	struct emit *emit = context;
	int err = 0;
	emit->at = 0;
	for (uint32_t i = 0; i < far_plan_units(emit->plan) && !err; i++)
		err = emit_unit(emit, file, emit->unit_hashes[i]);
	return err;
}

static bool is_far(uint32_t tag)
{
	return tag == PKG_STRC || tag == PKG_CIDX || tag == PKG_CELL || tag == PKG_CELD;
}

/* All but the far field, with another META. */
static uint32_t copy_base(const struct pkg *pkg, const struct pkg_meta *meta, struct pkg_file_section *out)
{
	const struct pkg_section *sections;
	uint32_t count = pkg_sections(pkg, &sections), kept = 0;
	for (uint32_t i = 0; i < count && kept < PKG_FILE_SECTIONS_MAX - 4; i++) {
		if (is_far(sections[i].tag))
			continue;
		out[kept++] = (struct pkg_file_section){
			.tag = sections[i].tag,
			.element_bytes = sections[i].element_bytes,
			.bytes = sections[i].tag == PKG_META ? (const void *)meta : pkg->map.bytes.data + sections[i].offset,
			.size = sections[i].bytes,
		};
	}
	return kept;
}

int far_assemble(const char *path, const struct pkg *pkg, const struct far_plan *plan,
	const struct far_sections *sections, const char *folder, const uint64_t *unit_hashes, uint64_t resident_bound)
{
	struct pkg_file_section out[PKG_FILE_SECTIONS_MAX];
	struct pkg_meta meta = *pkg->meta;
	struct emit emit = { .plan = plan, .folder = folder, .unit_hashes = unit_hashes };
	meta.resident_bound_bytes = resident_bound;
	uint32_t count = copy_base(pkg, &meta, out);
	if (sections) {
		const stretch_array *stretches = &sections->stretches;
		out[count++] = (struct pkg_file_section){ .tag = PKG_STRC,
			.element_bytes = sizeof(*stretches->items),
			.bytes = stretches->items,
			.size = stretches->count * sizeof(*stretches->items) };
		out[count++] = (struct pkg_file_section){ .tag = PKG_CIDX,
			.element_bytes = sizeof(*plan->first.items),
			.bytes = plan->first.items,
			.size = plan->first.count * sizeof(*plan->first.items) };
		out[count++] = (struct pkg_file_section){ .tag = PKG_CELL,
			.element_bytes = sizeof(*sections->cells.items),
			.bytes = sections->cells.items,
			.size = sections->cells.count * sizeof(*sections->cells.items) };
		out[count++] = (struct pkg_file_section){
			.tag = PKG_CELD, .element_bytes = 1, .size = sections->blob_bytes, .emit = emit_blobs, .context = &emit
		};
	}
	int err = pkg_file_write(path, out, count);
	if (err)
		log_error("%s: cannot write: %s", path, strerror(-err));
	return err;
}
