#include "tests/assets/far_city.h"

#include <assert.h>
#include <lzma.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "assets/impostor_fold.h"
#include "platform/base/rng.h"

struct buffer {
	uint8_t *bytes;
	size_t size, room;
};

/* Appends; NULL appends zeros. Returns where. */
static size_t put(struct buffer *buffer, const void *bytes, size_t size)
{
	size_t at = buffer->size;
	while (at + size > buffer->room) {
		buffer->room = 2 * buffer->room + 4096;
		buffer->bytes = realloc(buffer->bytes, buffer->room);
		assert(buffer->bytes);
	}
	if (bytes && size)
		memcpy(buffer->bytes + at, bytes, size);
	else if (size)
		memset(buffer->bytes + at, 0, size);
	buffer->size += size;
	return at;
}

static void align(struct buffer *buffer, size_t to)
{
	put(buffer, NULL, (to - buffer->size % to) % to);
}

enum { META, STRS, NODE, OUTS, HALF, EDGE, POLY, FACE, MATL, TEXA, CHNK, OBJS, GEOM, STRC, CIDX, CELL, CELD, SECTIONS };

static const struct {
	uint32_t tag, element_bytes;
} kinds[SECTIONS] = {
	[META] = { PKG_META, sizeof(struct pkg_meta) },
	[STRS] = { PKG_STRS, 1 },
	[NODE] = { PKG_NODE, sizeof(struct pkg_node) },
	[OUTS] = { PKG_OUTS, 4 },
	[HALF] = { PKG_HALF, sizeof(struct pkg_half) },
	[EDGE] = { PKG_EDGE, sizeof(struct pkg_edge) },
	[POLY] = { PKG_POLY, sizeof(struct pkg_point) },
	[FACE] = { PKG_FACE, sizeof(struct pkg_face) },
	[MATL] = { PKG_MATL, sizeof(struct pkg_material) },
	[TEXA] = { PKG_TEXA, 1 },
	[CHNK] = { PKG_CHNK, sizeof(struct pkg_chunk) },
	[OBJS] = { PKG_OBJS, sizeof(struct pkg_object) },
	[GEOM] = { PKG_GEOM, 1 },
	[STRC] = { PKG_STRC, sizeof(struct pkg_stretch) },
	[CIDX] = { PKG_CIDX, 4 },
	[CELL] = { PKG_CELL, sizeof(struct pkg_cell) },
	[CELD] = { PKG_CELD, 1 },
};

struct builder {
	const struct far_city_config *config;
	struct buffer sections[SECTIONS];
	struct rng rng;
};

static uint32_t stretch_count(const struct far_city_config *config)
{
	return config->edges * config->stretches_an_edge;
}

static int32_t edge_mm(const struct far_city_config *config)
{
	return (int32_t)config->stretches_an_edge * FAR_CITY_STRETCH_MM;
}

static void build_graph(struct builder *b)
{
	const uint32_t edges = b->config->edges;
	struct buffer *s = b->sections;
	for (uint32_t n = 0; n <= edges; n++) {
		struct pkg_node node = { .pos_mm = { (int32_t)n * edge_mm(b->config) },
			.first_out = n ? 2 * n - 1 : 0,
			.out_count = n == 0 || n == edges ? 1 : 2 };
		put(&s[NODE], &node, sizeof(node));
		if (n < edges)
			put(&s[OUTS], &(uint32_t){ 2 * n }, 4);
		if (n > 0)
			put(&s[OUTS], &(uint32_t){ 2 * n - 1 }, 4);
	}
	for (uint32_t e = 0; e < edges; e++) {
		struct pkg_half there = {
			.origin = e, .next = e + 1 < edges ? 2 * e + 2 : 2 * e + 1, .prev = e ? 2 * e - 2 : 1
		};
		struct pkg_half back = {
			.origin = e + 1, .next = e ? 2 * e - 1 : 0, .prev = e + 1 < edges ? 2 * e + 3 : 2 * e
		};
		put(&s[HALF], &there, sizeof(there));
		put(&s[HALF], &back, sizeof(back));
		struct pkg_edge edge = { .first_point = 2 * e,
			.point_count = 2,
			.length_mm = (uint32_t)edge_mm(b->config),
			.flags = PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD,
			.width_mm = 6000 };
		put(&s[EDGE], &edge, sizeof(edge));
		for (uint32_t end = e; end <= e + 1; end++)
			put(&s[POLY], &(struct pkg_point){ { (int32_t)end * edge_mm(b->config) } }, sizeof(struct pkg_point));
	}
	struct pkg_face face = { .half_count = 2 * edges, .parent = PKG_NONE, .flags = PKG_FACE_OUTER };
	put(&s[FACE], &face, sizeof(face));
}

static void build_chunk(struct builder *b, uint32_t index)
{
	const struct far_city_config *config = b->config;
	struct buffer *s = b->sections, *geometry = &s[GEOM];
	const uint32_t triangles = config->triangles_an_object, objects = config->objects_a_chunk;
	struct pkg_chunk chunk = { .face = PKG_NONE,
		.first_object = index * objects,
		.object_count = objects,
		.vertex_count = objects * (triangles + 3),
		.index_count = { objects * triangles * 3, objects * 3 } };
	chunk.origin_mm[0] = chunk.min_mm[0] = (int32_t)index * FAR_CITY_STRETCH_MM;
	chunk.max_mm[0] = chunk.min_mm[0] + FAR_CITY_STRETCH_MM;
	chunk.min_mm[1] = 8000;
	chunk.max_mm[1] = 20000;
	align(geometry, 64);
	chunk.vertex_offset = geometry->size;
	for (uint32_t i = 0; i < chunk.vertex_count; i++) {
		struct pkg_mesh_vertex vertex = { .pos_mm = { (int32_t)i, 8000, 0 }, .material = (uint8_t)(i % 3) };
		put(geometry, &vertex, sizeof(vertex));
	}
	align(geometry, 64);
	chunk.index_offset = geometry->size;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		for (uint32_t object = 0; object < objects; object++)
			for (uint32_t t = 0; t < (pass ? 1 : triangles); t++)
				for (uint32_t corner = 0; corner < 3; corner++)
					put(geometry, &(uint16_t){ (uint16_t)(object * (triangles + 3) + t + corner) }, 2);
	uint8_t *bytes = geometry->bytes;
	uLong crc = crc32(0, bytes + chunk.vertex_offset, chunk.vertex_count * (uInt)sizeof(struct pkg_mesh_vertex));
	chunk.crc32 = (uint32_t)crc32(crc, bytes + chunk.index_offset, (uInt)(geometry->size - chunk.index_offset));
	put(&s[CHNK], &chunk, sizeof(chunk));
	for (uint32_t i = 0; i < objects; i++) {
		struct pkg_object object = { .chunk = index,
			.first_index = { i * triangles * 3, objects * triangles * 3 + i * 3 },
			.index_count = { triangles * 3, 3 } };
		memcpy(object.min_mm, chunk.min_mm, sizeof(object.min_mm));
		memcpy(object.max_mm, chunk.max_mm, sizeof(object.max_mm));
		put(&s[OBJS], &object, sizeof(object));
	}
}

/* Packs and appends to CELD. */
static struct pkg_blob put_blob(struct builder *b, const struct buffer *raw)
{
	struct buffer *all = &b->sections[CELD];
	lzma_options_lzma options;
	lzma_filter filters[] = { { LZMA_FILTER_LZMA2, &options }, { LZMA_VLI_UNKNOWN, NULL } };
	bool unknown = lzma_lzma_preset(&options, 1);
	options.dict_size = PKG_BLOB_WINDOW;
	size_t stored = 0, room = raw->size + raw->size / 8 + 64;
	uint8_t *bytes = malloc(room);
	assert(bytes && !unknown);
	lzma_ret status = lzma_raw_buffer_encode(filters, NULL, raw->bytes, raw->size, bytes, &stored, room);
	assert(status == LZMA_OK);
	(void)unknown, (void)status;
	align(all, PKG_BLOB_ALIGN);
	struct pkg_blob blob = { .offset = all->size,
		.stored_bytes = (uint32_t)stored,
		.raw_bytes = (uint32_t)raw->size,
		.crc32 = (uint32_t)crc32(0, bytes, (uInt)stored) };
	put(all, bytes, stored);
	free(bytes);
	return blob;
}

/* Objects of chunks first to last, of each every nth triangle. */
static void put_objects(struct builder *b, uint32_t first, uint32_t last, uint32_t nth, struct buffer *objects,
	struct buffer *masks, struct pkg_set_head *head)
{
	const uint32_t per_chunk = b->config->objects_a_chunk, triangles = b->config->triangles_an_object + 1;
	for (uint32_t i = first * per_chunk; i < last * per_chunk; i++) {
		struct pkg_set_object object = { .object = i };
		uint8_t *mask = calloc((triangles + 7) / 8, 1);
		assert(mask);
		for (uint32_t t = 0; t < triangles; t += nth) {
			mask[t / 8] |= (uint8_t)(1u << t % 8);
			object.kept++;
		}
		put(objects, &object, sizeof(object));
		if (object.kept < triangles)
			put(masks, mask, (triangles + 7) / 8);
		free(mask);
		head->object_count++;
		head->triangle_count += object.kept;
	}
}

static uint32_t at_most(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static struct pkg_blob put_set(struct builder *b, uint32_t stretch, bool local, uint32_t *triangles)
{
	const uint32_t end = stretch_count(b->config);
	struct buffer objects = { 0 }, masks = { 0 }, raw = { 0 };
	struct pkg_set_head head = { 0 };
	if (local) {
		put_objects(b, stretch, stretch + 1, 1, &objects, &masks, &head);
		put_objects(b, at_most(stretch + 1, end), at_most(stretch + 2, end), 2, &objects, &masks, &head);
	} else {
		put_objects(b, at_most(stretch + 2, end), at_most(stretch + 5, end), 3, &objects, &masks, &head);
	}
	put(&raw, &head, sizeof(head));
	put(&raw, objects.bytes, objects.size);
	put(&raw, masks.bytes, masks.size);
	struct pkg_blob blob = put_blob(b, &raw);
	*triangles = head.triangle_count;
	free(objects.bytes);
	free(masks.bytes);
	free(raw.bytes);
	return blob;
}

static struct pkg_cell put_cell(struct builder *b, bool impostor)
{
	const struct far_city_config *config = b->config;
	if (!impostor)
		return (struct pkg_cell){ .kind = PKG_CELL_GEOMETRY, .reason = PKG_REASON_FEWER_TRIANGLES };
	struct pkg_impostor_head head = { .vertex_count = config->impostor_vertices,
		.index_count = config->impostor_vertices * 3,
		.page_count = config->impostor_pages,
		.view_count = 2 };
	struct buffer raw = { 0 };
	put(&raw, &head, sizeof(head));
	for (uint32_t i = 0; i < head.view_count; i++)
		put(&raw, &(struct pkg_impostor_view){ { 1.0f, 0.0f, 0.0f, (float)i } }, sizeof(struct pkg_impostor_view));
	size_t vertices = raw.size;
	for (uint32_t i = 0; i < head.vertex_count; i++) {
		struct pkg_impostor_vertex vertex = { .pos_mm = { (int32_t)i, 100000, 0 },
			.uv = { (uint16_t)(i % 32768), 32768 },
			.page = (uint8_t)(i % config->impostor_pages),
			.view_kind = (uint8_t)(i % 2) };
		put(&raw, &vertex, sizeof(vertex));
	}
	for (uint32_t i = 0; i < head.index_count; i++)
		put(&raw, &(uint16_t){ (uint16_t)(i % head.vertex_count) }, 2);
	void *scratch = malloc(impostor_fold_bytes(head.vertex_count, head.index_count) + 1);
	impostor_fold(&head, raw.bytes + vertices, scratch);
	free(scratch);
	align(&raw, 16);
	for (uint32_t i = 0; i < head.page_count * PKG_PAGE_BYTES / 16; i++) {
		uint8_t block[16] = { 0 };
		for (int k = 0; k < 6; k++) /* about as compressible as real ones */
			block[k] = (uint8_t)rng_u32(&b->rng);
		put(&raw, block, sizeof(block));
	}
	struct pkg_cell cell = { .kind = PKG_CELL_IMPOSTOR,
		.reason = PKG_REASON_IMPOSTOR_CHEAPER,
		.page_count = (uint16_t)head.page_count,
		.vertex_count = head.vertex_count,
		.index_count = head.index_count,
		.tau_px = 1.0f,
		.impostor = put_blob(b, &raw) };
	free(raw.bytes);
	return cell;
}

static void build_stretch(struct builder *b, uint32_t index)
{
	const struct far_city_config *config = b->config;
	const uint32_t place = index % config->stretches_an_edge;
	bool geometry = config->geometry_every && index % config->geometry_every == 0;
	struct pkg_stretch stretch = { .edge = index / config->stretches_an_edge,
		.from_mm = place * FAR_CITY_STRETCH_MM,
		.to_mm = (place + 1) * FAR_CITY_STRETCH_MM,
		.half_width_mm = 4000,
		.overrun_mm = 2000,
		.eye_min_mm = 1200,
		.eye_max_mm = 4000,
		.near_mm = 100000 };
	stretch.start_mm[0] = (int32_t)index * FAR_CITY_STRETCH_MM;
	stretch.end_mm[0] = stretch.start_mm[0] + FAR_CITY_STRETCH_MM;
	stretch.local = put_set(b, index, true, &stretch.local_triangles);
	stretch.near_triangles = stretch.local_triangles;
	stretch.pvs = put_set(b, index, false, &stretch.pvs_triangles);
	put(&b->sections[STRC], &stretch, sizeof(stretch));
	if (place == 0)
		put(&b->sections[CIDX], &(uint32_t){ index }, 4);
	for (int side = 0; side < 2; side++) {
		struct pkg_cell cell = put_cell(b, !geometry);
		put(&b->sections[CELL], &cell, sizeof(cell));
	}
}

static void build_meta(struct builder *b)
{
	struct buffer *s = b->sections;
	put(&s[STRS], "\0Made-up", 9);
	uint32_t objects = stretch_count(b->config) * b->config->objects_a_chunk;
	struct pkg_meta meta = { .origin_lat_deg = 46.2,
		.origin_lon_deg = 6.1,
		.max_mm = { (int32_t)b->config->edges * edge_mm(b->config), 20000, 30000 },
		.city_name = 1,
		.attribution = 1,
		.triangle_count = (uint64_t)objects * (b->config->triangles_an_object + 1),
		.right_hand_traffic = 1,
		.resident_bound_bytes = 1 << 20 };
	put(&s[META], &meta, sizeof(meta));
	for (uint8_t kind = 0; kind < 3; kind++)
		put(&s[MATL], &(struct pkg_material){ .kind = kind }, sizeof(struct pkg_material));
	struct pkg_texture_array array = { .format = PKG_TEXTURE_R8, .width = 1, .height = 1, .layers = 1, .levels = 1 };
	put(&s[TEXA], &array, sizeof(array));
	put(&s[TEXA], "x", 1);
}

static uint8_t *join(struct builder *b, size_t *size)
{
	struct buffer file = { 0 };
	struct pkg_section table[SECTIONS] = { 0 };
	put(&file, NULL, sizeof(struct pkg_header) + sizeof(table));
	for (int i = 0; i < SECTIONS; i++) {
		align(&file, PKG_ALIGN);
		table[i] = (struct pkg_section){ .tag = kinds[i].tag,
			.element_bytes = kinds[i].element_bytes,
			.offset = file.size,
			.bytes = b->sections[i].size };
		put(&file, b->sections[i].bytes, b->sections[i].size);
		free(b->sections[i].bytes);
	}
	memcpy(file.bytes + sizeof(struct pkg_header), table, sizeof(table));
	struct pkg_header header = {
		.magic = PKG_MAGIC, .version_major = PKG_VERSION_MAJOR, .section_count = SECTIONS, .file_bytes = file.size
	};
	memcpy(file.bytes, &header, sizeof(header));
	far_city_sign(file.bytes);
	*size = file.size;
	return file.bytes;
}

uint8_t *far_city_build(const struct far_city_config *config, size_t *size)
{
	struct builder b = { .config = config, .rng = rng_seed(3) };
	build_meta(&b);
	build_graph(&b);
	for (uint32_t i = 0; i < stretch_count(config); i++)
		build_chunk(&b, i);
	for (uint32_t i = 0; i < stretch_count(config); i++)
		build_stretch(&b, i);
	put(&b.sections[CIDX], &(uint32_t){ stretch_count(config) }, 4);
	return join(&b, size);
}

static struct pkg_section *table_of(uint8_t *bytes)
{
	return (void *)(bytes + sizeof(struct pkg_header));
}

struct far_city_part far_city_section(const uint8_t *bytes, uint32_t tag)
{
	const struct pkg_section *table = (const void *)(bytes + sizeof(struct pkg_header));
	for (int i = 0; i < SECTIONS; i++)
		if (table[i].tag == tag)
			return (struct far_city_part){ table[i].offset, table[i].bytes };
	return (struct far_city_part){ 0 };
}

void far_city_sign(uint8_t *bytes)
{
	struct pkg_header *header = (void *)bytes;
	struct pkg_section *table = table_of(bytes);
	for (uint32_t i = 0; i < header->section_count; i++)
		if (table[i].tag != PKG_GEOM && table[i].tag != PKG_CELD)
			table[i].crc32 = (uint32_t)crc32(0, bytes + table[i].offset, (uInt)table[i].bytes);
	header->table_crc32 = (uint32_t)crc32(0, (const Bytef *)table, header->section_count * (uInt)sizeof(*table));
	header->header_crc32 = 0;
	header->header_crc32 = (uint32_t)crc32(0, bytes, sizeof(*header));
}

int far_city_open(const uint8_t *bytes, size_t size, struct pkg *pkg, struct pkg_fault *fault)
{
	char path[] = "/tmp/blvd-test-far-XXXXXX";
	int fd = mkstemp(path);
	assert(fd >= 0);
	ssize_t wrote = write(fd, bytes, size);
	assert(wrote == (ssize_t)size);
	(void)wrote;
	close(fd);
	int status = pkg_open(pkg, path, fault);
	unlink(path);
	return status;
}
