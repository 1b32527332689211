/*
 * The OpenGL ES 3.0 back end, sole user of GL. State that a draw needs is compared with what the context has, so a
 * sorted draw list costs one GL call a draw. What is newer than ES 3.0 is probed into struct gfx_caps and has a way
 * round.
 */
#include <GLES3/gl31.h> /* names only: what is called is of 3.0, or asked for */
/* after it */
#include <GLES2/gl2ext.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/log.h"
#include "render/etc2_block.h"
#include "render/gfx_backend.h"
#include "render/shader_files.h"

#define DECODED_TEXELS 16384 /* blocks become texels in strips of so many at most */

typedef void (*storage_samples_fn)(
	GLenum target, GLsizei samples, GLenum internal, GLsizei width, GLsizei height, GLboolean fixed);
typedef void (*draw_base_vertex_fn)(GLenum mode, GLsizei count, GLenum type, const void *indices, GLint base_vertex);

struct gles3 {
	draw_base_vertex_fn draw_base_vertex;
	storage_samples_fn storage_samples; /* NULL: samples are averaged by a blit */
	PFNGLEGLIMAGETARGETTEXTURE2DOESPROC image_target;
	GLuint program, vertex_array, draw_framebuffer;
	GLuint textures[GFX_TEXTURES_MAX];
	GLuint blocks[GFX_BLOCKS_MAX];
	enum gfx_blend blend;
	enum gfx_depth depth;
	bool cull_back;
	float offset_factor, offset_units;
	uint8_t (*decoded)[4]; /* a strip, or NULL where the driver takes the blocks */
};

static const struct {
	GLenum internal, format, type;
} formats[GFX_FORMAT_COUNT] = {
	[GFX_RGBA8] = { GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE },
	[GFX_SRGBA8] = { GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE },
	[GFX_R8] = { GL_R8, GL_RED, GL_UNSIGNED_BYTE },
	[GFX_RG8] = { GL_RG8, GL_RG, GL_UNSIGNED_BYTE },
	[GFX_RGBA32UI] = { GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT },
	[GFX_ETC2_RGBA8] = { GL_COMPRESSED_RGBA8_ETC2_EAC, 0, 0 },
	[GFX_ETC2_SRGBA8] = { GL_COMPRESSED_SRGB8_ALPHA8_ETC2_EAC, 0, 0 },
	[GFX_EAC_RG11] = { GL_COMPRESSED_RG11_EAC, 0, 0 },
};

static const struct {
	GLint components;
	GLenum type;
	GLboolean normalized;
} attribute_formats[GFX_ATTRIBUTE_FORMAT_COUNT] = {
	[GFX_F32X1] = { 1, GL_FLOAT, GL_FALSE },
	[GFX_F32X2] = { 2, GL_FLOAT, GL_FALSE },
	[GFX_F32X3] = { 3, GL_FLOAT, GL_FALSE },
	[GFX_F32X4] = { 4, GL_FLOAT, GL_FALSE },
	[GFX_I32X3] = { 3, GL_INT, GL_FALSE },
	[GFX_I8X2_SNORM] = { 2, GL_BYTE, GL_TRUE },
	[GFX_U8X2] = { 2, GL_UNSIGNED_BYTE, GL_FALSE },
	[GFX_U8X4] = { 4, GL_UNSIGNED_BYTE, GL_FALSE },
	[GFX_U8X4_UNORM] = { 4, GL_UNSIGNED_BYTE, GL_TRUE },
	[GFX_U16X2] = { 2, GL_UNSIGNED_SHORT, GL_FALSE },
};

static bool has_extension(const char *name)
{
	GLint count = 0;
	glGetIntegerv(GL_NUM_EXTENSIONS, &count);
	for (GLint i = 0; i < count; i++) {
		const char *have = (const char *)glGetStringi(GL_EXTENSIONS, (GLuint)i);
		if (have && !strcmp(have, name))
			return true;
	}
	return false;
}

static draw_base_vertex_fn probe_base_vertex(const struct gfx *gfx, int version)
{
	if (!gfx->config.get_proc)
		return NULL;
	if (version >= 32)
		return (draw_base_vertex_fn)gfx->config.get_proc("glDrawElementsBaseVertex");
	if (has_extension("GL_OES_draw_elements_base_vertex"))
		return (draw_base_vertex_fn)gfx->config.get_proc("glDrawElementsBaseVertexOES");
	if (has_extension("GL_EXT_draw_elements_base_vertex"))
		return (draw_base_vertex_fn)gfx->config.get_proc("glDrawElementsBaseVertexEXT");
	return NULL;
}

static uint32_t get_u32(GLenum what)
{
	GLint value = 0;
	glGetIntegerv(what, &value);
	return value > 0 ? (uint32_t)value : 0;
}

static void probe(struct gfx *gfx, struct gles3 *gl, int version)
{
	struct gfx_caps *caps = &gfx->caps;
	gl->draw_base_vertex = probe_base_vertex(gfx, version);
	caps->base_vertex = gl->draw_base_vertex != NULL;
	snprintf(caps->renderer, sizeof(caps->renderer), "%s", (const char *)glGetString(GL_RENDERER));
	snprintf(caps->version, sizeof(caps->version), "%s", (const char *)glGetString(GL_VERSION));
	caps->software = strstr(caps->renderer, "llvmpipe") || strstr(caps->renderer, "softpipe");
	/* llvmpipe of Mesa 22.3 offers it, is slow with it, and loops for ever on some derivatives */
	caps->anisotropy = !caps->software && has_extension("GL_EXT_texture_filter_anisotropic");
	if (caps->anisotropy)
		glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &caps->max_anisotropy);
	/* Mesa keeps no compiled shader for its blit: 40 ms of every start */
	if (caps->software && version >= 31 && gfx->config.get_proc)
		gl->storage_samples = (storage_samples_fn)gfx->config.get_proc("glTexStorage2DMultisample");
	caps->clip_control = has_extension("GL_EXT_clip_control");
	if (gfx->config.get_proc && has_extension("GL_OES_EGL_image_external_essl3"))
		gl->image_target = (PFNGLEGLIMAGETARGETTEXTURE2DOESPROC)gfx->config.get_proc("glEGLImageTargetTexture2DOES");
	caps->external = gl->image_target != NULL;
	caps->timer_query = has_extension("GL_EXT_disjoint_timer_query");
	caps->max_samples = get_u32(GL_MAX_SAMPLES);
	caps->max_texture_px = get_u32(GL_MAX_TEXTURE_SIZE);
	caps->max_array_layers = get_u32(GL_MAX_ARRAY_TEXTURE_LAYERS);
	log_info("OpenGL: %s, %s", caps->renderer, caps->version);
}

static int gles3_init(struct gfx *gfx, struct arena *arena)
{
	GLint major = 0, minor = 0;
	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glGetIntegerv(GL_MINOR_VERSION, &minor);
	if (major < 3) {
		log_error("OpenGL ES 3.0 is needed, this context has %d.%d", major, minor);
		return -ENOTSUP;
	}
	struct gles3 *gl = ARENA_ARRAY(arena, struct gles3, 1);
	if (!gl)
		return -ENOMEM;
	gfx->impl = gl;
	probe(gfx, gl, major * 10 + minor);
	/* llvmpipe would decode them when they are written too, five times as slowly, and keep the blocks beside the texels
	 */
	if (gfx->caps.software)
		gl->decoded = arena_alloc(arena, (size_t)DECODED_TEXELS * 4, 64);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glDisable(GL_DITHER);
	glDepthFunc(GL_LEQUAL);
	return 0;
}

static void gles3_finish(struct gfx *gfx)
{
	(void)gfx;
}

/* Objects are filled through GL_COPY_WRITE_BUFFER, which no vertex array object remembers. */
static int gles3_buffer_create(struct gfx *gfx, struct gfx_buffer_slot *slot)
{
	(void)gfx;
	int copies = slot->desc.usage == GFX_STREAM ? GFX_STREAM_COPIES : 1;
	GLenum usage = slot->desc.usage == GFX_STREAM ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW;
	while (glGetError() != GL_NO_ERROR)
		;
	glGenBuffers(copies, slot->native);
	for (int i = 0; i < copies; i++) {
		glBindBuffer(GL_COPY_WRITE_BUFFER, slot->native[i]);
		glBufferData(GL_COPY_WRITE_BUFFER, (GLsizeiptr)slot->desc.bytes, slot->desc.data, usage);
	}
	if (glGetError() == GL_NO_ERROR)
		return 0;
	glDeleteBuffers(copies, slot->native);
	return -ENOMEM;
}

static void gles3_buffer_destroy(struct gfx *gfx, struct gfx_buffer_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	int copies = slot->desc.usage == GFX_STREAM ? GFX_STREAM_COPIES : 1;
	glDeleteBuffers(copies, slot->native);
	memset(gl->blocks, 0, sizeof(gl->blocks));
}

static GLuint current_copy(const struct gfx *gfx, const struct gfx_buffer_slot *slot)
{
	return slot->native[slot->desc.usage == GFX_STREAM ? gfx->stream_copy : 0];
}

static void gles3_buffer_write(
	struct gfx *gfx, struct gfx_buffer_slot *slot, uint32_t offset, const void *data, uint32_t bytes)
{
	glBindBuffer(GL_COPY_WRITE_BUFFER, current_copy(gfx, slot));
	glBufferSubData(GL_COPY_WRITE_BUFFER, (GLintptr)offset, (GLsizeiptr)bytes, data);
}

static GLenum texture_kind(const struct gfx_texture_slot *slot)
{
	if (slot->external)
		return GL_TEXTURE_EXTERNAL_OES;
	return slot->desc.layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
}

/* Binds on the last unit, which then holds something unknown to the cache. */
static void bind_for_change(struct gles3 *gl, const struct gfx_texture_slot *slot)
{
	glActiveTexture(GL_TEXTURE0 + GFX_TEXTURES_MAX);
	glBindTexture(texture_kind(slot), slot->native);
	(void)gl;
}

static void set_sampling(const struct gfx *gfx, const struct gfx_texture_slot *slot)
{
	static const GLint min_filters[] = { [GFX_NEAREST] = GL_NEAREST,
		[GFX_LINEAR] = GL_LINEAR,
		[GFX_TRILINEAR] = GL_LINEAR_MIPMAP_LINEAR,
		[GFX_ANISOTROPIC] = GL_LINEAR_MIPMAP_LINEAR };
	GLenum kind = texture_kind(slot);
	GLint wrap = slot->desc.wrap == GFX_REPEAT ? GL_REPEAT : GL_CLAMP_TO_EDGE;
	/* a second level costs a CPU a sixth of a street's frame */
	bool one_level = slot->desc.filter == GFX_ANISOTROPIC && gfx->caps.software;
	glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, one_level ? GL_LINEAR_MIPMAP_NEAREST : min_filters[slot->desc.filter]);
	glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, slot->desc.filter == GFX_NEAREST ? GL_NEAREST : GL_LINEAR);
	glTexParameteri(kind, GL_TEXTURE_WRAP_S, wrap);
	glTexParameteri(kind, GL_TEXTURE_WRAP_T, wrap);
	glTexParameteri(kind, GL_TEXTURE_MAX_LEVEL, (GLint)slot->desc.levels - 1);
	if (slot->desc.filter == GFX_ANISOTROPIC && gfx->caps.anisotropy)
		glTexParameterf(
			kind, GL_TEXTURE_MAX_ANISOTROPY_EXT, gfx->caps.max_anisotropy < 4.0f ? gfx->caps.max_anisotropy : 4.0f);
}

static bool decodes(const struct gfx *gfx, const struct gfx_texture_slot *slot)
{
	const struct gles3 *gl = gfx->impl;
	bool blocks = slot->desc.format == GFX_ETC2_RGBA8 || slot->desc.format == GFX_ETC2_SRGBA8;
	return gl->decoded && blocks && slot->desc.width * 4 <= DECODED_TEXELS;
}

/* What GL stores. */
static enum gfx_format stored_format(const struct gfx *gfx, const struct gfx_texture_slot *slot)
{
	if (!decodes(gfx, slot))
		return slot->desc.format;
	return slot->desc.format == GFX_ETC2_RGBA8 ? GFX_RGBA8 : GFX_SRGBA8;
}

static int gles3_texture_create(struct gfx *gfx, struct gfx_texture_slot *slot)
{
	const struct gfx_texture_desc *desc = &slot->desc;
	while (glGetError() != GL_NO_ERROR)
		;
	glGenTextures(1, &slot->native);
	bind_for_change(gfx->impl, slot);
	GLsizei levels = (GLsizei)desc->levels, width = (GLsizei)desc->width, height = (GLsizei)desc->height;
	GLenum internal = formats[stored_format(gfx, slot)].internal;
	if (desc->layers)
		glTexStorage3D(GL_TEXTURE_2D_ARRAY, levels, internal, width, height, (GLsizei)desc->layers);
	else
		glTexStorage2D(GL_TEXTURE_2D, levels, internal, width, height);
	if (glGetError() != GL_NO_ERROR) {
		glDeleteTextures(1, &slot->native);
		return -ENOMEM;
	}
	set_sampling(gfx, slot);
	return 0;
}

static int gles3_texture_import(struct gfx *gfx, struct gfx_texture_slot *slot, void *image)
{
	struct gles3 *gl = gfx->impl;
	while (glGetError() != GL_NO_ERROR)
		;
	glGenTextures(1, &slot->native);
	bind_for_change(gl, slot);
	gl->image_target(GL_TEXTURE_EXTERNAL_OES, image);
	glTexParameteri(GL_TEXTURE_EXTERNAL_OES, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_EXTERNAL_OES, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_EXTERNAL_OES, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_EXTERNAL_OES, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	if (glGetError() == GL_NO_ERROR)
		return 0;
	glDeleteTextures(1, &slot->native);
	return -EINVAL;
}

static void gles3_texture_destroy(struct gfx *gfx, struct gfx_texture_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	glDeleteTextures(1, &slot->native);
	memset(gl->textures, 0, sizeof(gl->textures));
}

static void write_texels(
	const struct gfx_texture_slot *slot, const struct gfx_region *r, enum gfx_format stored, const void *texels)
{
	GLenum internal = formats[stored].internal, format = formats[stored].format, type = formats[stored].type;
	GLint level = (GLint)r->level, x = (GLint)r->x, y = (GLint)r->y, z = (GLint)r->layer;
	GLsizei w = (GLsizei)r->width, h = (GLsizei)r->height, d = (GLsizei)r->layers;
	GLsizei bytes = (GLsizei)gfx_format_bytes(stored, r->width, r->height, r->layers);
	if (r->row_texels)
		glPixelStorei(GL_UNPACK_ROW_LENGTH, (GLint)r->row_texels);
	if (slot->desc.layers && format)
		glTexSubImage3D(GL_TEXTURE_2D_ARRAY, level, x, y, z, w, h, d, format, type, texels);
	else if (slot->desc.layers)
		glCompressedTexSubImage3D(GL_TEXTURE_2D_ARRAY, level, x, y, z, w, h, d, internal, bytes, texels);
	else if (format)
		glTexSubImage2D(GL_TEXTURE_2D, level, x, y, w, h, format, type, texels);
	else
		glCompressedTexSubImage2D(GL_TEXTURE_2D, level, x, y, w, h, internal, bytes, texels);
	if (r->row_texels)
		glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

/* Blocks of the region, in strips of whole rows of blocks. */
static void write_decoded(
	const struct gfx *gfx, const struct gfx_texture_slot *slot, const struct gfx_region *r, const uint8_t *blocks)
{
	const struct gles3 *gl = gfx->impl;
	const enum gfx_format stored = stored_format(gfx, slot);
	const uint32_t rows = DECODED_TEXELS / r->width & ~3u;
	for (uint32_t layer = 0; layer < r->layers; layer++) {
		for (uint32_t row = 0; row < r->height; row += rows) {
			struct gfx_region strip = *r;
			strip.layer = r->layer + layer;
			strip.layers = 1;
			strip.y = r->y + row;
			strip.height = r->height - row < rows ? r->height - row : rows;
			etc2_decode(gl->decoded, blocks, strip.width, strip.height);
			write_texels(slot, &strip, stored, gl->decoded);
			blocks += gfx_format_bytes(slot->desc.format, strip.width, strip.height, 1);
		}
	}
}

static void gles3_texture_write(
	struct gfx *gfx, struct gfx_texture_slot *slot, const struct gfx_region *region, const void *texels)
{
	bind_for_change(gfx->impl, slot);
	if (decodes(gfx, slot))
		write_decoded(gfx, slot, region, texels);
	else
		write_texels(slot, region, slot->desc.format, texels);
}

static GLenum depth_format(const struct gfx_target_desc *desc)
{
	return desc->depth_16 ? GL_DEPTH_COMPONENT16 : GL_DEPTH_COMPONENT24;
}

/* The smallest number of samples that the GPU has and that is no less than what is wished; its largest otherwise. */
static uint32_t granted_samples(const struct gfx_target_desc *desc)
{
	GLint counts[16] = { 0 }, count = 0, granted = 0;
	if (desc->samples < 2)
		return 1;
	glGetInternalformativ(GL_RENDERBUFFER, depth_format(desc), GL_NUM_SAMPLE_COUNTS, 1, &count);
	glGetInternalformativ(GL_RENDERBUFFER, depth_format(desc), GL_SAMPLES, 16, counts);
	for (int i = 0; i < count && i < 16; i++) /* descending */
		if (!granted || counts[i] >= (GLint)desc->samples)
			granted = counts[i];
	return granted > 1 ? (uint32_t)granted : 1;
}

static GLuint make_renderbuffer(GLenum format, const struct gfx_target_desc *desc, uint32_t samples)
{
	GLuint name = 0;
	glGenRenderbuffers(1, &name);
	glBindRenderbuffer(GL_RENDERBUFFER, name);
	glRenderbufferStorageMultisample(
		GL_RENDERBUFFER, samples > 1 ? (GLsizei)samples : 0, format, (GLsizei)desc->width, (GLsizei)desc->height);
	return name;
}

static void gles3_target_destroy(struct gfx *gfx, struct gfx_target_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	if (slot->framebuffer != slot->resolve_framebuffer)
		glDeleteFramebuffers(1, &slot->framebuffer);
	glDeleteFramebuffers(1, &slot->resolve_framebuffer);
	glDeleteRenderbuffers(1, &slot->depth);
	glDeleteTextures(1, &slot->samples); /* 0: nothing */
	glDeleteProgram(slot->resolve_program);
	glDeleteVertexArrays(1, &slot->resolve_vertices);
	gl->program = gl->vertex_array = 0;
	if (slot->color)
		glDeleteRenderbuffers(1, &slot->color);
	if (slot->ids)
		glDeleteRenderbuffers(1, &slot->ids);
	gl->draw_framebuffer = 0;
}

static void attach_ids(struct gfx_target_slot *slot)
{
	static const GLenum both[] = { GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1 };
	slot->ids = make_renderbuffer(slot->desc.ids == GFX_IDS_R32UI ? GL_R32UI : GL_RGBA32UI, &slot->desc, 1);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_RENDERBUFFER, slot->ids);
	glDrawBuffers(2, both);
}

static int link_program(GLuint program, const struct gfx_program_desc *desc, const char *version);

/* The colours as a texture of samples and a program that averages them; false: by a blit then. */
static bool attach_samples(struct gles3 *gl, struct gfx_target_slot *slot)
{
	char defines[64];
	snprintf(defines, sizeof(defines), "#define NO_FRAME_BLOCK 1\n#define SAMPLES %u\n", slot->desc.samples);
	struct gfx_program_desc desc = { .vertex = "resolve.vert", .fragment = "resolve.frag", .defines = defines };
	if (!gl->storage_samples || slot->desc.ids)
		return false;
	slot->resolve_program = glCreateProgram();
	if (link_program(slot->resolve_program, &desc, "310 es")) {
		glDeleteProgram(slot->resolve_program);
		slot->resolve_program = 0;
		return false;
	}
	glUseProgram(slot->resolve_program);
	gl->program = slot->resolve_program;
	glUniform1i(glGetUniformLocation(slot->resolve_program, "u_samples"), GFX_TEXTURES_MAX);
	glGenVertexArrays(1, &slot->resolve_vertices);
	glGenTextures(1, &slot->samples);
	glActiveTexture(GL_TEXTURE0 + GFX_TEXTURES_MAX);
	glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, slot->samples);
	gl->storage_samples(GL_TEXTURE_2D_MULTISAMPLE, (GLsizei)slot->desc.samples, GL_RGBA8, (GLsizei)slot->desc.width,
		(GLsizei)slot->desc.height, GL_TRUE);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D_MULTISAMPLE, slot->samples, 0);
	return true;
}

static void attach_depth(struct gfx_target_slot *slot, uint32_t samples)
{
	slot->depth = make_renderbuffer(depth_format(&slot->desc), &slot->desc, samples);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, slot->depth);
}

/* A framebuffer of desc.samples a pixel in front of the one that has the picture. */
static void attach_multisampled(struct gles3 *gl, struct gfx_target_slot *slot)
{
	glGenFramebuffers(1, &slot->framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, slot->framebuffer);
	attach_depth(slot, slot->desc.samples);
	if (attach_samples(gl, slot))
		return;
	slot->color = make_renderbuffer(GL_RGBA8, &slot->desc, slot->desc.samples);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, slot->color);
}

static void attach(struct gles3 *gl, struct gfx_target_slot *slot, GLuint texture)
{
	glGenFramebuffers(1, &slot->resolve_framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, slot->resolve_framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
	slot->framebuffer = slot->resolve_framebuffer;
	slot->desc.samples = granted_samples(&slot->desc);
	slot->plain = slot->plain && slot->desc.samples > 1;
	if (slot->desc.samples > 1 && !slot->plain)
		attach_multisampled(gl, slot);
	else
		attach_depth(slot, 1);
	if (slot->desc.ids)
		attach_ids(slot);
}

static bool complete(void)
{
	return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && glGetError() == GL_NO_ERROR;
}

static int gles3_target_create(struct gfx *gfx, struct gfx_target_slot *slot, struct gfx_texture_slot *texture)
{
	int err = gles3_texture_create(gfx, texture);
	if (err)
		return err;
	attach(gfx->impl, slot, texture->native);
	if (complete())
		return 0;
	gles3_target_destroy(gfx, slot);
	gles3_texture_destroy(gfx, texture);
	return -ENOMEM;
}

static int gles3_target_refine(struct gfx *gfx, struct gfx_target_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	struct gfx_target_slot plain = *slot;
	gl->draw_framebuffer = 0;
	attach_multisampled(gl, slot);
	if (complete()) {
		glBindFramebuffer(GL_FRAMEBUFFER, slot->resolve_framebuffer);
		glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, 0);
		glDeleteRenderbuffers(1, &plain.depth);
		return 0;
	}
	struct gfx_target_slot failed = *slot;
	failed.resolve_framebuffer = 0; /* 0: nothing */
	gles3_target_destroy(gfx, &failed);
	*slot = plain;
	return -ENOMEM;
}

static const char *shader_text(const char *name)
{
	for (const struct shader_file *file = shader_files; file->name; file++)
		if (!strcmp(file->name, name))
			return file->text;
	return NULL;
}

/* The text GL sees: version, the program's defines, prelude.glsl, the file. */
static GLuint compile(GLenum stage, const char *name, const char *defines, const char *version)
{
	const char *text = shader_text(name), *prelude = shader_text("prelude.glsl");
	if (!text || !prelude) {
		log_error("shader %s: not built in", name);
		return 0;
	}
	const char *stage_define = stage == GL_VERTEX_SHADER ? "#define VERTEX 1\n" : "#define FRAGMENT 1\n";
	const char *parts[] = { "#version ", version, "\n", stage_define, defines ? defines : "", prelude, "#line 1\n",
		text };
	GLuint shader = glCreateShader(stage);
	glShaderSource(shader, (GLsizei)(sizeof(parts) / sizeof(parts[0])), parts, NULL);
	glCompileShader(shader);
	GLint ok = 0;
	glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return shader;
	char why[512] = "";
	glGetShaderInfoLog(shader, sizeof(why), NULL, why);
	log_error("shader %s: %s", name, why);
	glDeleteShader(shader);
	return 0;
}

static int link_program(GLuint program, const struct gfx_program_desc *desc, const char *version)
{
	GLuint vertex = compile(GL_VERTEX_SHADER, desc->vertex, desc->defines, version);
	GLuint fragment = vertex ? compile(GL_FRAGMENT_SHADER, desc->fragment, desc->defines, version) : 0;
	if (!fragment) {
		glDeleteShader(vertex);
		return -EINVAL;
	}
	glAttachShader(program, vertex);
	glAttachShader(program, fragment);
	glLinkProgram(program);
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	GLint ok = 0;
	glGetProgramiv(program, GL_LINK_STATUS, &ok);
	if (ok)
		return 0;
	char why[512] = "";
	glGetProgramInfoLog(program, sizeof(why), NULL, why);
	log_error("shaders %s and %s: %s", desc->vertex, desc->fragment, why);
	return -EINVAL;
}

static int gles3_program_create(struct gfx *gfx, struct gfx_program_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	slot->native = glCreateProgram();
	int err = link_program(slot->native, &slot->desc, "300 es");
	if (err) {
		glDeleteProgram(slot->native);
		return err;
	}
	glUseProgram(slot->native);
	gl->program = slot->native;
	slot->constants = glGetUniformLocation(slot->native, "u_draw");
	for (GLuint i = 0; i < GFX_BLOCKS_MAX && slot->desc.blocks[i]; i++) {
		GLuint index = glGetUniformBlockIndex(slot->native, slot->desc.blocks[i]);
		if (index != GL_INVALID_INDEX)
			glUniformBlockBinding(slot->native, index, i);
	}
	for (GLint i = 0; i < GFX_TEXTURES_MAX && slot->desc.textures[i]; i++)
		glUniform1i(glGetUniformLocation(slot->native, slot->desc.textures[i]), i);
	return 0;
}

static void gles3_program_destroy(struct gfx *gfx, struct gfx_program_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	glDeleteProgram(slot->native);
	gl->program = 0;
}

static int gles3_pipeline_create(struct gfx *gfx, struct gfx_pipeline_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	glGenVertexArrays(1, &slot->native);
	glBindVertexArray(slot->native);
	gl->vertex_array = slot->native;
	for (GLuint i = 0; i < slot->desc.attribute_count; i++)
		glEnableVertexAttribArray(i);
	return 0;
}

static void gles3_pipeline_destroy(struct gfx *gfx, struct gfx_pipeline_slot *slot)
{
	struct gles3 *gl = gfx->impl;
	glDeleteVertexArrays(1, &slot->native);
	gl->vertex_array = 0;
}

static void bind_framebuffer(struct gles3 *gl, GLuint name)
{
	glBindFramebuffer(GL_FRAMEBUFFER, name);
	gl->draw_framebuffer = name;
}

static void set_depth(struct gles3 *gl, enum gfx_depth depth)
{
	if (gl->depth == depth)
		return;
	if (depth == GFX_DEPTH_OFF)
		glDisable(GL_DEPTH_TEST);
	else
		glEnable(GL_DEPTH_TEST);
	glDepthFunc(depth == GFX_DEPTH_BEHIND ? GL_GREATER : GL_LEQUAL);
	glDepthMask(depth == GFX_DEPTH_TEST_WRITE);
	gl->depth = depth;
}

static void gles3_depth_range(struct gfx *gfx, float near_depth, float far_depth)
{
	(void)gfx;
	glDepthRangef(near_depth, far_depth);
}

static void clear_target(const struct gfx_target_slot *slot, const struct gfx_clear *clear)
{
	static const GLuint none[4];
	GLbitfield depth = clear->depth ? GL_DEPTH_BUFFER_BIT : 0u;
	if (!slot->ids) {
		glClearColor(clear->rgba[0], clear->rgba[1], clear->rgba[2], clear->rgba[3]);
		glClear((clear->color ? GL_COLOR_BUFFER_BIT : 0u) | depth);
		return;
	}
	/* one value for buffers of two kinds is undefined */
	glClear(depth);
	if (clear->color) {
		glClearBufferfv(GL_COLOR, 0, clear->rgba);
		glClearBufferuiv(GL_COLOR, 1, none);
	}
}

static void gles3_pass_begin(struct gfx *gfx, struct gfx_target_slot *slot, const struct gfx_clear *clear)
{
	bind_framebuffer(gfx->impl, slot->framebuffer);
	glViewport(0, 0, (GLsizei)slot->width, (GLsizei)slot->height);
	glDepthRangef(0.0f, 1.0f);
	set_depth(gfx->impl, GFX_DEPTH_TEST_WRITE);
	bool part = slot->width < slot->desc.width || slot->height < slot->desc.height;
	if (part) { /* drawing keeps to the viewport, clearing does not */
		glEnable(GL_SCISSOR_TEST);
		glScissor(0, 0, (GLsizei)slot->width, (GLsizei)slot->height);
	}
	clear_target(slot, clear);
	if (part)
		glDisable(GL_SCISSOR_TEST);
}

static void set_blend(struct gles3 *gl, enum gfx_blend blend)
{
	if (gl->blend == blend)
		return;
	if (blend == GFX_OPAQUE) {
		glDisable(GL_BLEND);
	} else {
		glEnable(GL_BLEND);
		glBlendFuncSeparate(
			blend == GFX_BLEND ? GL_SRC_ALPHA : GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
	}
	gl->blend = blend;
}

static void set_cull(struct gles3 *gl, bool cull_back)
{
	if (gl->cull_back == cull_back)
		return;
	if (cull_back)
		glEnable(GL_CULL_FACE);
	else
		glDisable(GL_CULL_FACE);
	gl->cull_back = cull_back;
}

static bool differ(float a, float b)
{
	return a < b || a > b;
}

static void set_offset(struct gles3 *gl, float factor, float units)
{
	if (!differ(gl->offset_factor, factor) && !differ(gl->offset_units, units))
		return;
	if (differ(factor, 0.0f) || differ(units, 0.0f))
		glEnable(GL_POLYGON_OFFSET_FILL);
	else
		glDisable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(factor, units);
	gl->offset_factor = factor;
	gl->offset_units = units;
}

/* Points the pipeline's vertex array object at the buffers. Returns the base vertex left for the draw call. */
static GLint bind_vertices(const struct gfx *gfx, struct gfx_pipeline_slot *pipeline, const struct gfx_draw *draw)
{
	if (!draw->vertices.id)
		return 0;
	GLuint buffer = current_copy(gfx, gfx_buffer_at(gfx, draw->vertices));
	bool base = gfx->caps.base_vertex && pipeline->desc.index != GFX_INDEX_NONE;
	uint32_t offset = base ? 0 : draw->vertex_offset;
	if (pipeline->bound_vertices != buffer || pipeline->bound_offset != offset) {
		glBindBuffer(GL_ARRAY_BUFFER, buffer);
		for (GLuint i = 0; i < pipeline->desc.attribute_count; i++) {
			const struct gfx_attribute *a = &pipeline->desc.attributes[i];
			glVertexAttribPointer(i, attribute_formats[a->format].components, attribute_formats[a->format].type,
				attribute_formats[a->format].normalized, (GLsizei)pipeline->desc.stride,
				(const void *)(uintptr_t)(offset + a->offset));
		}
		pipeline->bound_vertices = buffer;
		pipeline->bound_offset = offset;
	}
	return base ? (GLint)(draw->vertex_offset / pipeline->desc.stride) : 0;
}

static void bind_indices(const struct gfx *gfx, struct gfx_pipeline_slot *pipeline, const struct gfx_draw *draw)
{
	GLuint buffer = current_copy(gfx, gfx_buffer_at(gfx, draw->indices));
	if (pipeline->bound_indices == buffer)
		return;
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
	pipeline->bound_indices = buffer;
}

static void bind_resources(const struct gfx *gfx, struct gles3 *gl, const struct gfx_draw *draw)
{
	for (GLuint i = 0; i < GFX_TEXTURES_MAX; i++) {
		if (!draw->textures[i].id)
			continue;
		const struct gfx_texture_slot *slot = gfx_texture_at(gfx, draw->textures[i]);
		if (gl->textures[i] == slot->native)
			continue;
		glActiveTexture(GL_TEXTURE0 + i);
		glBindTexture(texture_kind(slot), slot->native);
		gl->textures[i] = slot->native;
	}
	for (GLuint i = 0; i < GFX_BLOCKS_MAX; i++) {
		if (!draw->blocks[i].id)
			continue;
		GLuint buffer = current_copy(gfx, gfx_buffer_at(gfx, draw->blocks[i]));
		if (gl->blocks[i] == buffer)
			continue;
		glBindBufferBase(GL_UNIFORM_BUFFER, i, buffer);
		gl->blocks[i] = buffer;
	}
}

static void bind_state(const struct gfx *gfx, struct gles3 *gl, const struct gfx_pipeline_slot *pipeline)
{
	GLuint program = gfx_program_at(gfx, pipeline->desc.program)->native;
	if (gl->program != program)
		glUseProgram(program);
	gl->program = program;
	if (gl->vertex_array != pipeline->native)
		glBindVertexArray(pipeline->native);
	gl->vertex_array = pipeline->native;
	set_blend(gl, pipeline->desc.blend);
	set_depth(gl, pipeline->desc.depth);
	set_cull(gl, pipeline->desc.cull_back);
	set_offset(gl, pipeline->desc.offset_factor, pipeline->desc.offset_units);
}

static void gles3_draw(struct gfx *gfx, const struct gfx_draw *draw)
{
	struct gles3 *gl = gfx->impl;
	struct gfx_pipeline_slot *pipeline = gfx_pipeline_at(gfx, draw->pipeline);
	bind_state(gfx, gl, pipeline);
	bind_resources(gfx, gl, draw);
	GLint base = bind_vertices(gfx, pipeline, draw);
	GLint constants = gfx_program_at(gfx, pipeline->desc.program)->constants;
	if (draw->constants && constants >= 0)
		glUniform4fv(constants, (GLsizei)draw->constant_count, draw->constants);
	static const GLenum modes[] = {
		[GFX_TRIANGLES] = GL_TRIANGLES, [GFX_TRIANGLE_STRIP] = GL_TRIANGLE_STRIP, [GFX_LINES] = GL_LINES
	};
	GLenum mode = modes[pipeline->desc.primitive];
	if (pipeline->desc.index == GFX_INDEX_NONE) {
		glDrawArrays(mode, (GLint)draw->first, (GLsizei)draw->count);
		return;
	}
	bind_indices(gfx, pipeline, draw);
	bool wide = pipeline->desc.index == GFX_INDEX_U32;
	GLenum type = wide ? GL_UNSIGNED_INT : GL_UNSIGNED_SHORT;
	const void *first = (const void *)((uintptr_t)draw->first * (wide ? 4 : 2));
	if (base)
		gl->draw_base_vertex(mode, (GLsizei)draw->count, type, first, base);
	else
		glDrawElements(mode, (GLsizei)draw->count, type, first);
}

/* The viewport is that of the pass. */
static void average_samples(struct gles3 *gl, const struct gfx_target_slot *slot)
{
	bind_framebuffer(gl, slot->resolve_framebuffer);
	set_depth(gl, GFX_DEPTH_OFF);
	set_blend(gl, GFX_OPAQUE);
	set_cull(gl, false);
	glActiveTexture(GL_TEXTURE0 + GFX_TEXTURES_MAX);
	glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, slot->samples);
	glUseProgram(slot->resolve_program);
	gl->program = slot->resolve_program;
	glBindVertexArray(slot->resolve_vertices);
	gl->vertex_array = slot->resolve_vertices;
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

static void gles3_pass_end(struct gfx *gfx, struct gfx_target_slot *slot)
{
	static const GLenum depth = GL_DEPTH_ATTACHMENT, color = GL_COLOR_ATTACHMENT0;
	glInvalidateFramebuffer(GL_FRAMEBUFFER, 1, &depth);
	if (slot->framebuffer == slot->resolve_framebuffer)
		return;
	if (slot->samples) {
		average_samples(gfx->impl, slot);
		return;
	}
	GLint w = (GLint)slot->width, h = (GLint)slot->height;
	glBindFramebuffer(GL_READ_FRAMEBUFFER, slot->framebuffer);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, slot->resolve_framebuffer);
	glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
	glInvalidateFramebuffer(GL_READ_FRAMEBUFFER, 1, &color);
}

static void gles3_present(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t width, uint32_t height)
{
	(void)gfx;
	glBindFramebuffer(GL_READ_FRAMEBUFFER, slot->resolve_framebuffer);
	glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
	bool same = width == slot->width && height == slot->height;
	glBlitFramebuffer(0, 0, (GLint)slot->width, (GLint)slot->height, 0, 0, (GLint)width, (GLint)height,
		GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
}

static void gles3_window_begin(struct gfx *gfx, uint32_t width, uint32_t height)
{
	bind_framebuffer(gfx->impl, 0);
	glViewport(0, 0, (GLsizei)width, (GLsizei)height);
	set_depth(gfx->impl, GFX_DEPTH_OFF);
}

/* GL's first row is the bottom one: rows are swapped in place, a piece at a time. */
static void flip_rows(uint8_t *px, size_t row_bytes, uint32_t rows)
{
	uint8_t piece[1024];
	for (uint32_t top = 0, bottom = rows - 1; top < bottom; top++, bottom--) {
		for (size_t at = 0; at < row_bytes; at += sizeof(piece)) {
			size_t n = row_bytes - at < sizeof(piece) ? row_bytes - at : sizeof(piece);
			uint8_t *a = px + top * row_bytes + at, *b = px + bottom * row_bytes + at;
			memcpy(piece, a, n);
			memcpy(a, b, n);
			memcpy(b, piece, n);
		}
	}
}

static void gles3_read_rgba8(struct gfx *gfx, struct gfx_target_slot *slot, void *out)
{
	(void)gfx;
	glBindFramebuffer(GL_READ_FRAMEBUFFER, slot->resolve_framebuffer);
	glReadPixels(0, 0, (GLsizei)slot->width, (GLsizei)slot->height, GL_RGBA, GL_UNSIGNED_BYTE, out);
	flip_rows(out, (size_t)slot->width * 4, slot->height);
}

/* Four numbers a pixel is what every GPU can read; here one of them is wanted. */
static void read_first_of_four(const struct gfx_target_slot *slot, uint32_t *out)
{
	GLuint piece[256][4];
	for (uint32_t y = 0; y < slot->height; y++) {
		for (uint32_t x = 0; x < slot->width; x += 256) {
			uint32_t n = slot->width - x < 256 ? slot->width - x : 256;
			glReadPixels((GLint)x, (GLint)y, (GLsizei)n, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, piece);
			for (uint32_t i = 0; i < n; i++)
				out[(size_t)y * slot->width + x + i] = piece[i][0];
		}
	}
}

static void gles3_read_ids(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t *out)
{
	(void)gfx;
	glBindFramebuffer(GL_READ_FRAMEBUFFER, slot->framebuffer);
	glReadBuffer(GL_COLOR_ATTACHMENT1);
	uint32_t words = gfx_ids_words(slot->desc.ids);
	GLsizei width = (GLsizei)slot->width, height = (GLsizei)slot->height;
	if (words == 4)
		glReadPixels(0, 0, width, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, out);
	else if (get_u32(GL_IMPLEMENTATION_COLOR_READ_FORMAT) == GL_RED_INTEGER &&
			 get_u32(GL_IMPLEMENTATION_COLOR_READ_TYPE) == GL_UNSIGNED_INT)
		glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, out);
	else
		read_first_of_four(slot, out);
	glReadBuffer(GL_COLOR_ATTACHMENT0);
	flip_rows((uint8_t *)out, (size_t)slot->width * words * 4, slot->height);
}

const struct gfx_ops gfx_gles3 = {
	.name = "gles3",
	.init = gles3_init,
	.finish = gles3_finish,
	.buffer_create = gles3_buffer_create,
	.texture_create = gles3_texture_create,
	.texture_import = gles3_texture_import,
	.target_create = gles3_target_create,
	.program_create = gles3_program_create,
	.pipeline_create = gles3_pipeline_create,
	.buffer_destroy = gles3_buffer_destroy,
	.texture_destroy = gles3_texture_destroy,
	.target_refine = gles3_target_refine,
	.target_destroy = gles3_target_destroy,
	.program_destroy = gles3_program_destroy,
	.pipeline_destroy = gles3_pipeline_destroy,
	.buffer_write = gles3_buffer_write,
	.texture_write = gles3_texture_write,
	.pass_begin = gles3_pass_begin,
	.depth_range = gles3_depth_range,
	.draw = gles3_draw,
	.pass_end = gles3_pass_end,
	.present = gles3_present,
	.window_begin = gles3_window_begin,
	.read_rgba8 = gles3_read_rgba8,
	.read_ids = gles3_read_ids,
};
