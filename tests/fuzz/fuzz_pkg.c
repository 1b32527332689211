/* A made-up package with any bytes changed, its checksums made right again: what opens must load without harm. Input:
 * changes of 4 bytes each, a place (24 bits, spread over the file) and a value. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include "assets/cell_loader.h"
#include "tests/assets/far_city.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const struct far_city_config street = { .edges = 2,
	.stretches_an_edge = 2,
	.objects_a_chunk = 2,
	.triangles_an_object = 9,
	.impostor_vertices = 12,
	.impostor_pages = 1,
	.geometry_every = 2 };

/* The blobs' and chunks' own checksums, as far as their places are still inside. */
static void sign_parts(uint8_t *bytes)
{
	struct far_city_part strc = far_city_section(bytes, PKG_STRC), cell = far_city_section(bytes, PKG_CELL);
	struct far_city_part celd = far_city_section(bytes, PKG_CELD);
	struct pkg_stretch *stretches = (void *)(bytes + strc.offset);
	struct pkg_cell *cells = (void *)(bytes + cell.offset);
	for (size_t i = 0; i < strc.size / sizeof(*stretches); i++) {
		struct pkg_blob *const blobs[] = { &stretches[i].local, &stretches[i].pvs, &cells[2 * i].impostor,
			&cells[2 * i + 1].impostor };
		for (int k = 0; k < 4; k++)
			if (blobs[k]->offset <= celd.size && blobs[k]->stored_bytes <= celd.size - blobs[k]->offset)
				blobs[k]->crc32 =
					(uint32_t)crc32(0, bytes + celd.offset + blobs[k]->offset, (uInt)blobs[k]->stored_bytes);
	}
}

static void load_all(const struct pkg *pkg)
{
	static _Alignas(64) uint8_t memory[16 << 20], staging[2 << 20];
	const struct cell_cache_config config = { .staging_bytes = sizeof(staging) };
	struct cell_limits limits;
	struct cell_loader loader;
	struct arena arena;
	arena_init(&arena, "fuzz", memory, sizeof(memory));
	cell_cache_limits(pkg, &config, &limits);
	struct cell_keep keep = { .local_ranges = ARENA_ARRAY(&arena, struct cell_range, limits.local_parts),
		.pvs_ranges = ARENA_ARRAY(&arena, struct cell_range, limits.pvs_parts),
		.local_parts = ARENA_ARRAY(&arena, struct cell_part, limits.local_parts),
		.pvs_parts = ARENA_ARRAY(&arena, struct cell_part, limits.pvs_parts) };
	for (int side = 0; side < 2; side++)
		keep.views[side] = ARENA_ARRAY(&arena, struct pkg_impostor_view, PKG_IMPOSTOR_VIEWS_MAX);
	if (!keep.local_ranges || !keep.pvs_ranges || !keep.local_parts || !keep.pvs_parts || !keep.views[0] ||
		!keep.views[1] || cell_loader_init(&loader, &arena, pkg, &config) < 0)
		return;
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		struct cell_slot slot;
		if (cell_loader_staging_bytes(&config, pkg, i) <= sizeof(staging))
			cell_loader_load(&loader, i, &limits, &keep, staging, sizeof(staging), &slot);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static uint8_t *good, *bytes;
	static size_t bytes_size;
	if (!good) {
		good = far_city_build(&street, &bytes_size);
		bytes = malloc(bytes_size);
	}
	memcpy(bytes, good, bytes_size);
	for (; size >= 4; data += 4, size -= 4) {
		size_t at = PKG_ALIGN + (data[0] | (size_t)data[1] << 8 | (size_t)data[2] << 16) % (bytes_size - PKG_ALIGN);
		bytes[at] = data[3];
	}
	sign_parts(bytes);
	far_city_sign(bytes);
	struct pkg pkg;
	struct pkg_fault fault;
	char path[64];
	int fd = memfd_create("fuzz", 0);
	if (fd < 0 || write(fd, bytes, bytes_size) != (ssize_t)bytes_size)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", fd);
	if (pkg_open(&pkg, path, &fault) == 0) {
		pkg_verify(&pkg, &fault);
		if (pkg.stretches)
			load_all(&pkg);
		pkg_close(&pkg);
	}
	close(fd);
	return 0;
}
