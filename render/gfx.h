/*
 * The graphics interface: what the renderer asks of a GPU, and nothing of how. Two back ends answer it: OpenGL ES 3.0
 * (gfx_gles3.c) and one without GL for tests (gfx_dummy.c). Handles are slot plus generation: a stale handle is caught,
 * a zeroed one means "none". Every pool is sized by gfx_init(), objects are made at start, and nothing of ours is
 * allocated afterwards. Every byte that an object takes on the GPU is counted, mip levels and samples included.
 *
 * Use, once: gfx_init, create objects. Per frame: gfx_frame_begin, then passes: gfx_pass_begin, gfx_draw...,
 * gfx_pass_end. All calls come from the thread that owns the GL context.
 *
 * Conventions: clip space as in OpenGL; front faces are counter-clockwise; colours written by shaders are sRGB-encoded
 * by the shader itself (targets are plain RGBA8), so blending mixes encoded values.
 */
#ifndef BLVD_RENDER_GFX_H
#define BLVD_RENDER_GFX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform/base/arena.h"

typedef struct {
	uint32_t id;
} gfx_buffer;
typedef struct {
	uint32_t id;
} gfx_texture;
typedef struct {
	uint32_t id;
} gfx_target;
typedef struct {
	uint32_t id;
} gfx_program;
typedef struct {
	uint32_t id;
} gfx_pipeline;

#define GFX_ATTRIBUTES_MAX 8
#define GFX_TEXTURES_MAX 4   /* units a draw can use */
#define GFX_BLOCKS_MAX 4     /* uniform blocks a draw can use */
#define GFX_CONSTANTS_MAX 16 /* vec4 of per-draw constants */
#define GFX_STREAM_COPIES 3  /* a stream buffer exists this often, so that writing never waits for drawing */

enum gfx_buffer_kind { GFX_BUFFER_VERTEX, GFX_BUFFER_INDEX, GFX_BUFFER_UNIFORM };
enum gfx_usage {
	GFX_STATIC, /* written rarely, drawn often */
	GFX_STREAM, /* undefined at every gfx_frame_begin(); write it before it is drawn. Costs GFX_STREAM_COPIES times */
};
struct gfx_buffer_desc {
	enum gfx_buffer_kind kind;
	enum gfx_usage usage;
	uint32_t bytes;
	const void *data; /* `bytes` of it, or NULL: undefined */
};

enum gfx_format {
	GFX_RGBA8,
	GFX_SRGBA8, /* colour is decoded to linear light when sampled */
	GFX_R8,
	GFX_RG8,
	GFX_ETC2_RGBA8,
	GFX_ETC2_SRGBA8,
	GFX_EAC_RG11,
	GFX_RGBA32UI, /* whole numbers; nearest filter only */
	GFX_FORMAT_COUNT,
};
enum gfx_filter {
	GFX_NEAREST,
	GFX_LINEAR,
	GFX_TRILINEAR,   /* needs all levels */
	GFX_ANISOTROPIC, /* trilinear where the GPU has no anisotropy; one level at a time where it is a CPU */
};
enum gfx_wrap { GFX_CLAMP, GFX_REPEAT };
struct gfx_texture_desc {
	enum gfx_format format;
	uint32_t width, height;
	uint32_t layers; /* 0: a plain 2D texture; else an array */
	uint32_t levels; /* 0 means 1 */
	enum gfx_filter filter;
	enum gfx_wrap wrap;
};
struct gfx_region {
	uint32_t level;
	uint32_t x, y, layer;
	uint32_t width, height, layers; /* layers: 1 for plain textures */
	uint32_t row_texels;            /* from row to row in memory; 0: tight. Not for blocks */
};

/* A second, whole-numbered output of a target, `layout(location = 1) out`: every shader drawn into it must write it.
 * Not blended; cleared to 0 together with the colour. */
enum gfx_ids {
	GFX_IDS_NONE,
	GFX_IDS_R32UI,    /* highp uint */
	GFX_IDS_RGBA32UI, /* highp uvec4 */
};

/* Something to draw into: RGBA8 colour and depth of 24 bits. The resolved colour can be read back and sampled. */
struct gfx_target_desc {
	uint32_t width, height;
	uint32_t samples; /* 0 or 1: none; more is clamped to what the GPU has, see gfx_target_samples() */
	enum gfx_ids ids; /* can be read back; there are no samples then */
	bool depth_16;    /* depth of 16 bits: half of its bytes and of their traffic */
	bool plain_first; /* one sample until gfx_target_refine(): a first picture that is cheaper. Counted in full at once
					   */
};

/* How shaders are named and bound. Files are those of assets/shaders, without path. Every program may declare
 * `uniform highp vec4 u_draw[N]` (N <= GFX_CONSTANTS_MAX): the constants of struct gfx_draw. */
struct gfx_program_desc {
	const char *vertex, *fragment;
	const char *defines;                    /* lines of "#define X 1\n", or NULL */
	const char *textures[GFX_TEXTURES_MAX]; /* sampler of each unit, NULL ends */
	const char *blocks[GFX_BLOCKS_MAX];     /* uniform block of each binding, NULL ends */
};

enum gfx_attribute_format {
	GFX_F32X1,
	GFX_F32X2,
	GFX_F32X3,
	GFX_F32X4,
	GFX_I32X3,      /* arrives as float, not scaled */
	GFX_I8X2_SNORM, /* -1 to 1 */
	GFX_U8X2,       /* arrives as float 0 to 255 */
	GFX_U8X4,
	GFX_U8X4_UNORM, /* 0 to 1 */
	GFX_U16X2,      /* arrives as float 0 to 65,535 */
	GFX_ATTRIBUTE_FORMAT_COUNT,
};
struct gfx_attribute { /* of location i, where i is its place in the array */
	enum gfx_attribute_format format;
	uint32_t offset;
};
enum gfx_blend {
	GFX_OPAQUE,
	GFX_BLEND,         /* src * alpha + dst * (1 - alpha) */
	GFX_PREMULTIPLIED, /* src + dst * (1 - alpha) */
};
enum gfx_depth {
	GFX_DEPTH_OFF,
	GFX_DEPTH_TEST, /* less or equal */
	GFX_DEPTH_TEST_WRITE,
	GFX_DEPTH_BEHIND, /* greater, not written: what something else hides */
};
enum gfx_primitive { GFX_TRIANGLES, GFX_TRIANGLE_STRIP, GFX_LINES };
enum gfx_index { GFX_INDEX_NONE, GFX_INDEX_U16, GFX_INDEX_U32 };
struct gfx_pipeline_desc {
	gfx_program program;
	uint32_t stride;
	uint32_t attribute_count; /* 0: the vertex shader uses gl_VertexID alone */
	struct gfx_attribute attributes[GFX_ATTRIBUTES_MAX];
	enum gfx_primitive primitive;
	enum gfx_index index;
	enum gfx_blend blend;
	enum gfx_depth depth;
	bool cull_back;
	float offset_factor, offset_units; /* polygon offset; 0, 0 is none */
};

struct gfx_draw {
	gfx_pipeline pipeline;
	gfx_buffer vertices;
	uint32_t vertex_offset; /* bytes; multiple of the stride. Indices count from here */
	gfx_buffer indices;
	uint32_t first; /* first index, or first vertex without indices */
	uint32_t count; /* indices or vertices */
	gfx_texture textures[GFX_TEXTURES_MAX];
	gfx_buffer blocks[GFX_BLOCKS_MAX]; /* whole uniform buffers */
	const float *constants;            /* constant_count vec4 for u_draw, or NULL */
	uint32_t constant_count;
};

/* What the context can do beyond ES 3.0; probed once. */
struct gfx_caps {
	bool software; /* drawn by the CPU */
	bool base_vertex;
	bool anisotropy;
	bool clip_control;
	bool timer_query;
	bool external; /* gfx_texture_import() works */
	float max_anisotropy;
	uint32_t max_samples;
	uint32_t max_texture_px, max_array_layers;
	char renderer[96], version[96];
};

struct gfx_stats {
	uint64_t frames;
	uint32_t draws, triangles; /* since gfx_frame_begin() */
	uint64_t bytes;            /* of all living objects */
	uint64_t bytes_high_water;
	uint64_t bytes_uploaded; /* since gfx_frame_begin() */
	uint32_t refused;        /* creations that found a full pool */
};

/* Capacities; 0 takes the default. */
struct gfx_config {
	uint32_t buffers;                            /* default 64 */
	uint32_t textures;                           /* default 32 */
	uint32_t targets;                            /* default 8 */
	uint32_t programs;                           /* default 48 */
	uint32_t pipelines;                          /* default 96 */
	void (*(*get_proc)(const char *name))(void); /* for what is beyond ES 3.0; NULL: none of it is used */
};

struct gfx_ops;                        /* a back end; see gfx_backend.h */
extern const struct gfx_ops gfx_gles3; /* needs a current context */
extern const struct gfx_ops gfx_dummy;

struct gfx;

/* Returns 0 and the device, made of `arena`'s memory; -ENOMEM; -ENOTSUP when the context is older than ES 3.0. */
int gfx_init(struct gfx **out, struct arena *arena, const struct gfx_ops *ops, const struct gfx_config *config);
/* Destroys every object that still lives. NULL does nothing. */
void gfx_finish(struct gfx *gfx);

const struct gfx_caps *gfx_caps(const struct gfx *gfx);
const struct gfx_stats *gfx_stats(const struct gfx *gfx);

/* Creation: 0, -ENOMEM when the pool or the GPU is full, -EINVAL when a shader does not compile (logged). On failure
 * *out is the zero handle. Destroying the zero handle does nothing. */
int gfx_buffer_create(struct gfx *gfx, const struct gfx_buffer_desc *desc, gfx_buffer *out);
int gfx_texture_create(struct gfx *gfx, const struct gfx_texture_desc *desc, gfx_texture *out);
/* A texture of memory that is not the GPU's: `image` is one of EGL (platform/display/egl_image.h), which outlives it.
 * Only for samplerExternalOES, filtered, clamped, never written; counts no bytes. -ENOTSUP without gfx_caps.external,
 * -EINVAL when the driver refuses the image. */
int gfx_texture_import(struct gfx *gfx, void *image, uint32_t width, uint32_t height, gfx_texture *out);
int gfx_target_create(struct gfx *gfx, const struct gfx_target_desc *desc, gfx_target *out);
int gfx_program_create(struct gfx *gfx, const struct gfx_program_desc *desc, gfx_program *out);
int gfx_pipeline_create(struct gfx *gfx, const struct gfx_pipeline_desc *desc, gfx_pipeline *out);
void gfx_buffer_destroy(struct gfx *gfx, gfx_buffer buffer);
void gfx_texture_destroy(struct gfx *gfx, gfx_texture texture);
void gfx_target_destroy(struct gfx *gfx, gfx_target target);
void gfx_program_destroy(struct gfx *gfx, gfx_program program);
void gfx_pipeline_destroy(struct gfx *gfx, gfx_pipeline pipeline);

/* Never grows an object: a write that does not fit is a programmer's mistake and asserts. */
void gfx_buffer_write(struct gfx *gfx, gfx_buffer buffer, uint32_t offset, const void *data, uint32_t bytes);
/* Texels (ETC2, EAC: blocks) of the region, tightly packed but for row_texels, rows from v = 0 up. */
void gfx_texture_write(struct gfx *gfx, gfx_texture texture, const struct gfx_region *region, const void *texels);

/* The resolved colour of a target as a texture; owned by the target. */
gfx_texture gfx_target_texture(const struct gfx *gfx, gfx_target target);
uint32_t gfx_target_samples(const struct gfx *gfx, gfx_target target);
/* Gives a target of desc.plain_first its samples, between two passes; its picture stays. Where the GPU has no room for
 * them it goes on with one, which is logged. Any other target: nothing. */
void gfx_target_refine(struct gfx *gfx, gfx_target target);
/* From here on the target's lower left part is used as if it were the whole; at most what it was made with. Its size
 * on the GPU stays. Outside passes. */
void gfx_target_part(struct gfx *gfx, gfx_target target, uint32_t width, uint32_t height);

void gfx_frame_begin(struct gfx *gfx);

/* `between` is called after every creation and texture or buffer write outside of passes, so that long work (loading a
 * city) leaves time for something short. It may draw a frame of its own: stats and stream buffers of the frame around
 * it stay as they are. Not called from within itself; NULL ends it. */
void gfx_set_between(struct gfx *gfx, void (*between)(void *context), void *context);

struct gfx_clear {
	bool color, depth; /* depth is cleared to 1 */
	float rgba[4];
};
void gfx_pass_begin(struct gfx *gfx, gfx_target target, const struct gfx_clear *clear);
/* The slice of the depth buffer that following draws use; 0, 1 at the start of a pass. */
void gfx_depth_range(struct gfx *gfx, float near_depth, float far_depth);
void gfx_draw(struct gfx *gfx, const struct gfx_draw *draw);
/* Resolves the samples; the target can now be read, sampled and shown. */
void gfx_pass_end(struct gfx *gfx);

/* Copies a target's resolved colour to the context's window, whose size is given. Outside passes. */
void gfx_present(struct gfx *gfx, gfx_target target, uint32_t width, uint32_t height);
/* A pass over the context's window, without depth and without clearing: whoever begins it fills all of it. Ended by
 * gfx_window_end(). */
void gfx_window_begin(struct gfx *gfx, uint32_t width, uint32_t height);
void gfx_window_end(struct gfx *gfx);
/* Resolved colour, RGBA8, first row is the top of the picture: width * height * 4 bytes. Outside passes; waits. */
void gfx_read_rgba8(struct gfx *gfx, gfx_target target, void *out);
/* The same of a target's ids: width * height uint32_t, or four times as many. */
void gfx_read_ids(struct gfx *gfx, gfx_target target, uint32_t *out);

/* Bytes of a region of texels in a format. */
uint64_t gfx_format_bytes(enum gfx_format format, uint32_t width, uint32_t height, uint32_t layers);
/* Exact size on the GPU of an object so described. */
uint64_t gfx_buffer_bytes(const struct gfx_buffer_desc *desc);
uint64_t gfx_texture_bytes(const struct gfx_texture_desc *desc);
uint64_t gfx_target_bytes(const struct gfx_target_desc *desc); /* with desc->samples as granted */

#endif
