/*
 * The city package, byte for byte: the one copy of the on-disk structs, shared by the writer (tools) and
 * the readers (assets, nav, render). assets/SPEC.md says the same in words; a change here is a change there.
 *
 * Little endian, fixed layout, no pointers. A file is a header, a table of sections, and the sections, each aligned to
 * PKG_ALIGN and padded with zero bytes. Readers must treat every value as hostile until pkg_open() or pkg_verify()
 * has checked it.
 *
 * Frames: "city frame" is platform/base/geo.h's plane at the origin of `struct pkg_meta`: x east, y north, z up
 * (metres above the vertical datum of the terrain, 0 without terrain), in int32 millimetres.
 */
#ifndef BLVD_ASSETS_PKG_FORMAT_H
#define BLVD_ASSETS_PKG_FORMAT_H

#include <assert.h>
#include <stdint.h>

#define PKG_MAGIC "BLVDPKG\n"
#define PKG_VERSION_MAJOR 3 /* readers refuse another major version */
#define PKG_VERSION_MINOR 0 /* readers accept any minor version, and ignore sections they do not know */
#define PKG_ALIGN 4096u
#define PKG_NONE UINT32_MAX /* "no index" */

#define PKG_TAG(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

struct pkg_header {
	char magic[8];
	uint16_t version_major;
	uint16_t version_minor;
	uint32_t section_count;
	uint64_t file_bytes;   /* whole file; anything else is a truncated or grown file */
	uint32_t table_crc32;  /* CRC-32 (zlib) of the section table */
	uint32_t header_crc32; /* CRC-32 of this struct with this field 0 */
	uint8_t reserved[32];
};
static_assert(sizeof(struct pkg_header) == 64, "on-disk layout");

/* The table follows the header at once. Tags are unique; sections do not overlap; ascending offsets. */
struct pkg_section {
	uint32_t tag;
	uint32_t element_bytes; /* size of one element */
	uint64_t offset;        /* from the start of the file; multiple of PKG_ALIGN */
	uint64_t bytes;         /* multiple of element_bytes */
	uint32_t crc32;         /* of the section's bytes; 0 for GEOM and CELD, whose parts have their own */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_section) == 32, "on-disk layout");

/* META: one element. */
#define PKG_META PKG_TAG('M', 'E', 'T', 'A')
struct pkg_meta {
	double origin_lat_deg, origin_lon_deg;
	int32_t min_mm[3], max_mm[3];  /* bounds of all geometry */
	uint32_t city_name;            /* STRS offset */
	uint32_t attribution;          /* STRS offset; shown wherever the city is drawn */
	uint64_t source_hash;          /* of inputs and options: same input, same bytes */
	uint64_t triangle_count;       /* of all chunks together */
	uint32_t right_hand_traffic;   /* 1 drive on the right, 0 on the left */
	uint32_t utc_offset_minutes;   /* two's complement; local mean time for the sun when the log has no zone */
	uint64_t resident_bound_bytes; /* proven bound of what must be resident for cells; 0 when no cells are stored */
	uint8_t reserved[48];
};
static_assert(sizeof(struct pkg_meta) == 128, "on-disk layout");

/* STRS: UTF-8 strings, each NUL-terminated; offset 0 is the empty string. element_bytes 1. */
#define PKG_STRS PKG_TAG('S', 'T', 'R', 'S')

/*
 * The street graph (DESIGN "Words", [S97] 4.1). Edge e has half-edges 2e (along its polyline) and 2e+1 (against it):
 * twin(h) = h ^ 1. Faces lie to the left of their half-edges. In-plane half-edges form the planar subdivision; an
 * edge that crosses others at another level (tunnel, flyover) is off-plane: its two half-edges are a face of their own.
 */
#define PKG_NODE PKG_TAG('N', 'O', 'D', 'E')
enum pkg_node_flags {
	PKG_NODE_SIGNALS = 1 << 0,
	PKG_NODE_STOP = 1 << 1,
	PKG_NODE_GIVE_WAY = 1 << 2,
	PKG_NODE_CROSSING = 1 << 3,   /* pedestrians */
	PKG_NODE_ROUNDABOUT = 1 << 4, /* mini-roundabout, or a junction on a roundabout */
	PKG_NODE_BOUNDARY = 1 << 5,   /* the data ends here, the street does not */
};
struct pkg_node {
	int32_t pos_mm[3];
	uint32_t first_out; /* into OUTS */
	uint32_t out_count; /* half-edges leaving, in-plane and off-plane, counter-clockwise by heading */
	uint32_t flags;     /* enum pkg_node_flags */
	uint32_t component; /* connected component, 0 is the largest */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_node) == 32, "on-disk layout");

#define PKG_OUTS PKG_TAG('O', 'U', 'T', 'S') /* uint32_t half-edge ids */

#define PKG_HALF PKG_TAG('H', 'A', 'L', 'F')
struct pkg_half {
	uint32_t origin;     /* node */
	uint32_t next, prev; /* half-edges of the same face cycle */
	uint32_t face;
};
static_assert(sizeof(struct pkg_half) == 16, "on-disk layout");

#define PKG_EDGE PKG_TAG('E', 'D', 'G', 'E')
enum pkg_edge_flags {
	PKG_EDGE_FORWARD = 1 << 0,  /* cars may drive along half-edge 2e */
	PKG_EDGE_BACKWARD = 1 << 1, /* cars may drive along half-edge 2e+1 */
	PKG_EDGE_BRIDGE = 1 << 2,
	PKG_EDGE_TUNNEL = 1 << 3,
	PKG_EDGE_ROUNDABOUT = 1 << 4,
	PKG_EDGE_OFF_PLANE = 1 << 5,
	PKG_EDGE_LINK = 1 << 6,    /* slip road */
	PKG_EDGE_PRIVATE = 1 << 7, /* access private, destination or delivery: routes start or end here only */
	PKG_EDGE_LIT = 1 << 8,
};
enum pkg_street_class {
	PKG_STREET_MOTORWAY,
	PKG_STREET_TRUNK,
	PKG_STREET_PRIMARY,
	PKG_STREET_SECONDARY,
	PKG_STREET_TERTIARY,
	PKG_STREET_UNCLASSIFIED,
	PKG_STREET_RESIDENTIAL,
	PKG_STREET_LIVING,
	PKG_STREET_SERVICE,
	PKG_STREET_CLASS_COUNT,
};
struct pkg_edge {
	uint32_t first_point; /* into POLY; from node of half 2e to node of half 2e+1, both included */
	uint32_t point_count; /* >= 2 */
	uint32_t length_mm;   /* along the polyline, horizontal */
	uint32_t name;        /* STRS offset, 0 none */
	uint32_t ref;         /* STRS offset, 0 none: road number */
	uint16_t flags;       /* enum pkg_edge_flags */
	uint16_t width_mm;    /* carriageway */
	uint8_t street_class; /* enum pkg_street_class */
	uint8_t lanes_forward, lanes_backward;
	uint8_t speed_kmh;    /* limit; inferred by class where the data has none */
	uint8_t speed_posted; /* 1: the limit is in the data, 0: inferred */
	int8_t layer;
	uint16_t reserved;
	int64_t source_id; /* OSM way */
};
static_assert(sizeof(struct pkg_edge) == 40, "on-disk layout");

#define PKG_POLY PKG_TAG('P', 'O', 'L', 'Y')
struct pkg_point {
	int32_t pos_mm[3]; /* city frame; z is the carriageway's surface */
};
static_assert(sizeof(struct pkg_point) == 12, "on-disk layout");

#define PKG_FACE PKG_TAG('F', 'A', 'C', 'E')
enum pkg_face_flags {
	PKG_FACE_OUTER = 1 << 0,     /* unbounded side of a component: area is negative */
	PKG_FACE_OFF_PLANE = 1 << 1, /* the two halves of an off-plane edge: area is 0 */
};
struct pkg_face {
	double area_m2; /* signed, counter-clockwise positive */
	uint32_t first_half;
	uint32_t half_count;
	uint32_t component;
	uint32_t parent; /* for an outer face: the bounded face it lies in, or PKG_NONE */
	uint32_t flags;  /* enum pkg_face_flags */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_face) == 32, "on-disk layout");

/* TURN: forbidden moves. `only_` restrictions are stored as the moves that they forbid. */
#define PKG_TURN PKG_TAG('T', 'U', 'R', 'N')
struct pkg_turn {
	uint32_t from_half; /* arriving half-edge */
	uint32_t to_half;   /* leaving half-edge; origin of to_half == end of from_half. Sorted by from, then to. */
};
static_assert(sizeof(struct pkg_turn) == 8, "on-disk layout");

/* HGRD: ground heights on a grid. element_bytes 1: a struct pkg_height_grid, then columns * rows int32_t mm, row by row
 * from the south. Between posts the ground is linear on the two triangles cut by the diagonal from south-west to
 * north-east. Absent: 0. */
#define PKG_HGRD PKG_TAG('H', 'G', 'R', 'D')
struct pkg_height_grid {
	int32_t origin_mm[2]; /* south-west post */
	uint32_t step_mm;
	uint32_t columns, rows;
	uint32_t reserved[3];
};
static_assert(sizeof(struct pkg_height_grid) == 32, "on-disk layout");

/* MATL: materials; struct pkg_mesh_vertex.material is an index here. At most 256. */
#define PKG_MATL PKG_TAG('M', 'A', 'T', 'L')
enum pkg_material_kind {
	PKG_MATERIAL_WALL, /* texture alpha: 255 glass, 0 wall. Wall is tinted by the vertex colour, glass is not; windows
						  light at night */
	PKG_MATERIAL_SHOP, /* as WALL, but its glass is lit in the evening as a whole */
	PKG_MATERIAL_ROOF,
	PKG_MATERIAL_GROUND,  /* horizontal, receives the light map: carriageway, sidewalk, squares, grass */
	PKG_MATERIAL_MARKING, /* decal on the carriageway; alpha of the texture is wear */
	PKG_MATERIAL_WATER,
	PKG_MATERIAL_FOLIAGE,
	PKG_MATERIAL_SOLID, /* trunks, poles, bridge sides, tunnel walls */
	PKG_MATERIAL_LAMP,  /* emissive at night */
	PKG_MATERIAL_KIND_COUNT,
};
struct pkg_material {
	uint8_t kind;  /* enum pkg_material_kind */
	uint8_t layer; /* of the texture array TEXA */
	uint8_t gloss; /* 0 matt to 255 mirror */
	uint8_t reserved;
	float mean_rgb[3]; /* mean of the layer in linear light, for distance tone */
};
static_assert(sizeof(struct pkg_material) == 16, "on-disk layout");

/* TEXA: the texture array, element_bytes 1: struct pkg_texture_array, then per mip level (largest first) all layers,
 * tightly packed. */
#define PKG_TEXA PKG_TAG('T', 'E', 'X', 'A')
enum pkg_texture_format {
	PKG_TEXTURE_RGBA8 = 0,     /* sRGB colour, linear alpha */
	PKG_TEXTURE_ETC2_RGBA = 1, /* GL_COMPRESSED_SRGB8_ALPHA8_ETC2_EAC */
	PKG_TEXTURE_R8 = 2,
	PKG_TEXTURE_RG8 = 3,
};
struct pkg_texture_array {
	uint32_t format; /* enum pkg_texture_format */
	uint32_t width, height, layers, levels;
	uint32_t reserved[3];
};
static_assert(sizeof(struct pkg_texture_array) == 32, "on-disk layout");

/* LMAP: light map of the ground, element_bytes 1: struct pkg_light_map, then its texels from the south-west, row by
 * row, or their blocks. R: ambient occlusion, 1 open sky. G: street light at night, 0 dark. */
#define PKG_LMAP PKG_TAG('L', 'M', 'A', 'P')
enum pkg_light_format {
	PKG_LIGHT_RG8 = 0,
	PKG_LIGHT_EAC_RG11 = 1, /* GL_COMPRESSED_RG11_EAC */
};
#define PKG_LIGHT_SIDE_MAX 16384u
struct pkg_light_map {
	int32_t origin_mm[2]; /* south-west corner of the first texel */
	uint32_t texel_mm;
	uint32_t width, height; /* <= PKG_LIGHT_SIDE_MAX */
	uint32_t format;        /* enum pkg_light_format */
	uint32_t reserved[2];
};
static_assert(sizeof(struct pkg_light_map) == 32, "on-disk layout");

/*
 * Geometry. A chunk is the unit of loading: one vertex array, one index array, in GEOM. Its indices are cut into
 * passes, drawn in this order, and into objects. Positions are relative to the chunk's origin.
 */
enum pkg_pass {
	PKG_PASS_OPAQUE,
	PKG_PASS_DECAL, /* lies on opaque horizontal surfaces; drawn with a depth bias towards the eye */
	PKG_PASS_COUNT,
};
#define PKG_CHNK PKG_TAG('C', 'H', 'N', 'K')
enum pkg_chunk_kind {
	PKG_CHUNK_BLOCK,  /* buildings and trees of a block */
	PKG_CHUNK_GROUND, /* streets, ground, water, bridges of a tile */
};
struct pkg_chunk {
	int32_t origin_mm[3];
	int32_t min_mm[3], max_mm[3];         /* city frame */
	uint32_t kind;                        /* enum pkg_chunk_kind */
	uint32_t face;                        /* block, or PKG_NONE */
	uint32_t first_object, object_count;  /* into OBJS */
	uint32_t vertex_count;                /* <= 65,536 */
	uint32_t index_count[PKG_PASS_COUNT]; /* multiples of 3; passes follow one another */
	uint64_t vertex_offset;               /* into GEOM; multiple of 64 */
	uint64_t index_offset;                /* into GEOM; multiple of 64; uint16_t each */
	uint32_t crc32;                       /* of the vertex bytes, then the index bytes */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_chunk) == 88, "on-disk layout");

#define PKG_GEOM PKG_TAG('G', 'E', 'O', 'M') /* element_bytes 1 */
struct pkg_mesh_vertex {
	int32_t pos_mm[3];    /* from the chunk's origin */
	int8_t normal_oct[2]; /* octahedral map (Meyer et al. 2010, "On Floating-Point Normal Vectors"), 127 = 1 */
	uint8_t ao;           /* ambient occlusion, 255 open */
	uint8_t material;     /* into MATL */
	uint16_t uv[2];       /* 1/256 of a texture tile; wraps. On walls one tile is one bay by one storey */
	uint8_t rgb[3];       /* sRGB tint */
	uint8_t seed;         /* varies by building: which windows are lit */
};
static_assert(sizeof(struct pkg_mesh_vertex) == 24, "on-disk layout");

#define PKG_OBJS PKG_TAG('O', 'B', 'J', 'S')
enum pkg_object_kind {
	PKG_OBJECT_BUILDING,
	PKG_OBJECT_TREE,
	PKG_OBJECT_GROUND, /* carriageways, sidewalks, areas, kerbs, markings of a tile */
	PKG_OBJECT_WATER,
	PKG_OBJECT_BRIDGE,
	PKG_OBJECT_TUNNEL,
	PKG_OBJECT_FURNITURE, /* lamps, signals, signs */
};
enum pkg_object_flags {
	PKG_OBJECT_LANDMARK = 1 << 0, /* keeps its shape and is seen from afar */
};
struct pkg_object {
	int64_t source_id;            /* OSM id, 0 none; a relation's is negative */
	int32_t min_mm[3], max_mm[3]; /* city frame */
	uint32_t chunk;
	uint32_t first_index[PKG_PASS_COUNT]; /* from the start of the chunk's index array */
	uint32_t index_count[PKG_PASS_COUNT];
	uint16_t kind;  /* enum pkg_object_kind */
	uint16_t flags; /* enum pkg_object_flags */
	uint32_t name;  /* STRS offset, 0 none */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_object) == 64, "on-disk layout");

/* Text. FONT: element_bytes 1: struct pkg_font, then atlas_width * atlas_height R8 signed distances (128 is the
 * outline, above is inside, `spread_px` texels to the ends), then at `glyphs_offset` glyph_count struct pkg_glyph. */
#define PKG_FONT PKG_TAG('F', 'O', 'N', 'T')
struct pkg_font {
	uint32_t atlas_width, atlas_height;
	uint32_t glyph_count;
	uint32_t glyphs_offset; /* from the start of the section, multiple of 4 */
	float em_px;            /* atlas pixels of 1 em */
	float spread_px;
	float ascent_em, descent_em, cap_height_em; /* descent is negative */
	uint32_t ascii_first;                       /* glyph of U+0020; U+0021 to U+007E follow in order */
	uint32_t reserved[2];
};
static_assert(sizeof(struct pkg_font) == 48, "on-disk layout");
struct pkg_glyph {
	uint16_t atlas_x, atlas_y, atlas_width, atlas_height; /* texels, spread included; 0 x 0 for blanks */
	float left_em, top_em;                                /* of the texel rectangle from the pen; y up */
	float advance_em;
	uint32_t codepoint; /* of unshaped UI text; 0 for glyphs that only shaping reaches */
};
static_assert(sizeof(struct pkg_glyph) == 24, "on-disk layout");

/* TEXT: shaped strings (HarfBuzz at bake time), sorted by `string`. GRUN: their glyphs, in visual order. */
#define PKG_TEXT PKG_TAG('T', 'E', 'X', 'T')
struct pkg_text {
	uint32_t string;      /* STRS offset */
	uint32_t first_glyph; /* into GRUN */
	uint32_t glyph_count;
	float width_em;
};
static_assert(sizeof(struct pkg_text) == 16, "on-disk layout");
#define PKG_GRUN PKG_TAG('G', 'R', 'U', 'N')
struct pkg_glyph_at {
	uint32_t glyph;
	float x_em, y_em; /* pen position from the start of the string */
};
static_assert(sizeof(struct pkg_glyph_at) == 12, "on-disk layout");

/*
 * The far field (DESIGN "Baking" 5 to 7). All of these sections are there, or none is.
 *
 * A stretch is a part of an edge that is short enough by the magnification rule (FACTS, "Parallax"). Its view cell is
 * a box: eyes over the axis from `start_mm` to `end_mm` (on the carriageway's surface), up to half_width_mm to either
 * side of it and as far beyond its ends as `overrun_mm` says, eye_min_mm to eye_max_mm above it. Stretch s has two
 * cells: cell 2s looks along half-edge 2 edge, cell 2s+1 along its twin; a cell's distant model is what lies in the
 * half-space in front of it, whatever the heading. The local model is the stretch's, for all headings.
 */
#define PKG_STRC PKG_TAG('S', 'T', 'R', 'C')
struct pkg_blob {          /* bytes of CELD */
	uint64_t offset;       /* multiple of PKG_BLOB_ALIGN */
	uint32_t stored_bytes; /* 0: there is none. Raw LZMA2, with a window of PKG_BLOB_WINDOW */
	uint32_t raw_bytes;    /* after unpacking */
	uint32_t crc32;        /* of the stored bytes */
	uint32_t reserved;
};
static_assert(sizeof(struct pkg_blob) == 24, "on-disk layout");
#define PKG_BLOB_ALIGN 64u
#define PKG_BLOB_WINDOW (256u << 10)
struct pkg_stretch {
	uint32_t edge;
	uint32_t from_mm, to_mm; /* along the edge's polyline, horizontal; an edge's stretches cover it without a gap */
	int32_t start_mm[3], end_mm[3];
	uint16_t half_width_mm, overrun_mm;
	uint16_t eye_min_mm, eye_max_mm;
	uint32_t near_mm;         /* triangles nearer than this to the axis, seen from above, are local */
	uint32_t local_triangles; /* kept in the local model, of ... */
	uint32_t near_triangles;  /* ... so many that are near enough */
	uint32_t pvs_triangles;   /* of the visible set of both cells, without the local ones */
	uint32_t reserved;
	struct pkg_blob local; /* struct pkg_set_head ... */
	struct pkg_blob pvs;   /* the same: what some pose of the view cell sees of the distant model; may be absent */
	uint64_t input_hash;   /* of everything that this stretch and its cells were made of */
};
static_assert(sizeof(struct pkg_stretch) == 120, "on-disk layout");

/* CIDX: uint32_t first_stretch[edge_count + 1]; stretches are sorted by edge, then from_mm. An edge may have none. */
#define PKG_CIDX PKG_TAG('C', 'I', 'D', 'X')

#define PKG_CELL PKG_TAG('C', 'E', 'L', 'L')
enum pkg_cell_kind {
	PKG_CELL_NOTHING,  /* nothing distant is in view: nothing is stored */
	PKG_CELL_GEOMETRY, /* what is distant is drawn from the stretch's pvs */
	PKG_CELL_IMPOSTOR,
	PKG_CELL_KIND_COUNT,
};
enum pkg_cell_reason {
	PKG_REASON_NONE_IN_VIEW,     /* nothing */
	PKG_REASON_FEWER_TRIANGLES,  /* geometry is cheaper */
	PKG_REASON_ERROR_TOO_LARGE,  /* geometry: no impostor within the limits keeps the accuracy */
	PKG_REASON_IMPOSTOR_CHEAPER, /* impostor */
	PKG_REASON_TAU_RELAXED,      /* impostor, and error_px > tau_px: the bound on triangles or bytes came first */
	PKG_REASON_COUNT,
};
struct pkg_cell {
	uint8_t kind;   /* enum pkg_cell_kind */
	uint8_t reason; /* enum pkg_cell_reason */
	uint16_t page_count;
	uint32_t vertex_count, index_count; /* of the impostor */
	uint32_t seen_triangles;            /* of the distant geometry that the cell sees */
	float tau_px;                       /* accuracy asked for when it was made */
	float error_px;                     /* largest displacement over the view cell, by the mesh's own bound */
	float over_share;                   /* share of texels whose displacement may exceed tau_px */
	uint32_t split_mm;                  /* z_s: distance from the capture pose to the nearest distant geometry */
	int32_t origin_mm[3];               /* of the impostor's positions */
	uint32_t reserved;
	struct pkg_blob impostor; /* struct pkg_impostor_head ... */
	struct pkg_blob truth;    /* for measuring, usually absent: struct pkg_truth_texel of every texel of every page */
};
static_assert(sizeof(struct pkg_cell) == 96, "on-disk layout");

/* element_bytes 1; the blobs, each with its own checksum: stretch by stretch the local set, the visible set, cell 2s's
 * impostor and truth, cell 2s + 1's, as far as they are stored. No gaps but zeros up to the next multiple of
 * PKG_BLOB_ALIGN. */
#define PKG_CELD PKG_TAG('C', 'E', 'L', 'D')

/* A set of triangles: the head, object_count struct pkg_set_object sorted by object, then the masks, one after
 * another, of those objects that are not kept whole: one bit a triangle, lowest bit first, whole bytes; opaque
 * triangles first, in the order of the object's indices. */
struct pkg_set_head {
	uint32_t object_count;
	uint32_t triangle_count; /* kept */
};
static_assert(sizeof(struct pkg_set_head) == 8, "on-disk layout");
struct pkg_set_object {
	uint32_t object; /* into OBJS */
	uint32_t kept;   /* triangles; all of the object's: it has no mask */
};
static_assert(sizeof(struct pkg_set_object) == 8, "on-disk layout");

/* An impostor: the head, view_count struct pkg_impostor_view, vertices, indices (uint16_t, triangles, nearest first),
 * these two folded (assets/impostor_fold.h), padding to 16 bytes, pages (GL_COMPRESSED_RGBA8_ETC2_EAC, PKG_PAGE_PX
 * square, first row at v = 0). Texels: rgb is sRGB albedo times tint times ambient occlusion, not lit, and less by what
 * the surface mirrors instead. Alpha is 0 where nothing is, and PKG_PAGE_SOLID or more (less the codec's error) where
 * something is; the share that mirrors as window glass does, of gloss on roofs too, is a = (alpha - PKG_PAGE_SOLID) /
 * (255 - PKG_PAGE_SOLID), clamped. How they are lit: tools/impostor/capture.h. What filters make of both is cut in the
 * middle: below PKG_PAGE_CUT there is nothing. Sampling is projective: (u z, v z, z) is linear in space, where z is the
 * depth in the capture view. */
#define PKG_PAGE_PX 256u
#define PKG_PAGE_BYTES 65536u
#define PKG_PAGE_SOLID 128
#define PKG_PAGE_CUT 64
#define PKG_IMPOSTOR_VIEWS_MAX 32
#define PKG_IMPOSTOR_STEP_MAX 16
struct pkg_impostor_head {
	uint32_t vertex_count; /* <= 65,535 */
	uint32_t index_count;
	uint32_t page_count;
	uint16_t view_count; /* <= PKG_IMPOSTOR_VIEWS_MAX */
	uint16_t step_log2;  /* <= PKG_IMPOSTOR_STEP_MAX; positions are stored in 2^step_log2 mm */
};
static_assert(sizeof(struct pkg_impostor_head) == 16, "on-disk layout");
struct pkg_impostor_view {
	float axis[4]; /* depth in m of a point p, metres from the cell's origin: dot(axis.xyz, p) + axis.w */
};
static_assert(sizeof(struct pkg_impostor_view) == 16, "on-disk layout");
struct pkg_impostor_vertex {
	int32_t pos_mm[3]; /* from the cell's origin */
	uint16_t uv[2];    /* 1/128 texel of the page */
	uint8_t page;
	uint8_t view_kind;    /* capture view, plus 32 * (enum pkg_material_kind clamped to 7) */
	int8_t normal_oct[2]; /* as pkg_mesh_vertex */
};
static_assert(sizeof(struct pkg_impostor_vertex) == 20, "on-disk layout");
#define PKG_TRUTH_MADE_UP (UINT32_C(1) << 31)
struct pkg_truth_texel {
	uint32_t
		object; /* + 1; 0: not covered. With PKG_TRUTH_MADE_UP: no capture saw this, pos_m is on the surface's plane */
	float pos_m[3]; /* what the texel shows, from the cell's origin */
};
static_assert(sizeof(struct pkg_truth_texel) == 16, "on-disk layout");

/* OCCL: solids that hide what is behind them, as walls: footprints (joined, by height) shrunk by
 * PKG_OCCLUDER_SHRINK_MM, standing on the ground. What the shrunk walls hide from a point, the real ones hide from
 * everywhere within that distance of it (Wonka, Wimmer, Schmalstieg 2000, "Visibility Preprocessing with Occluder
 * Fusion for Urban Walkthroughs", section 3). */
#define PKG_OCCL PKG_TAG('O', 'C', 'C', 'L')
#define PKG_OCCLUDER_SHRINK_MM 2000
struct pkg_occluder {
	int32_t from_mm[2], to_mm[2]; /* the solid is to the left */
	int32_t top_mm;               /* everything below, down to the ground, is solid */
	uint32_t solid;               /* walls of one outline and its holes share it and follow one another; 0, 1, 2 ... */
};
static_assert(sizeof(struct pkg_occluder) == 24, "on-disk layout");

#endif
