#include "render/reverse_view.h"

#include <math.h>

#include "render/overlay.h"
#include "render/stroke_font.h"

#define VERTICES 16384u
#define CONSTANTS 7u
#define EXTERNAL_DEFINES                                                                                               \
	"#extension GL_OES_EGL_image_external_essl3 : require\n#define NO_FRAME_BLOCK 1\n#define EXTERNAL 1\n"
#define NIGHT_PICTURE 0.72f /* of the light of a picture by night: it must not dazzle */

static int make_program(struct reverse_view *view, enum reverse_view_layout layout)
{
	static const char *const defines[REVERSE_VIEW_LAYOUTS] = {
		[REVERSE_VIEW_PLANES] = "#define NO_FRAME_BLOCK 1\n",
		[REVERSE_VIEW_PACKED] = "#define NO_FRAME_BLOCK 1\n#define PACKED 1\n",
		[REVERSE_VIEW_SWAPPED] = "#define NO_FRAME_BLOCK 1\n#define SWAPPED 1\n",
		[REVERSE_VIEW_RGB] = "#define NO_FRAME_BLOCK 1\n#define RGB 1\n",
		[REVERSE_VIEW_EXTERNAL] = EXTERNAL_DEFINES,
	};
	bool one_plane = layout == REVERSE_VIEW_RGB || layout == REVERSE_VIEW_EXTERNAL;
	if (layout == REVERSE_VIEW_EXTERNAL && !gfx_caps(view->gfx)->external)
		return 0;
	struct gfx_program_desc program = {
		.vertex = "camera.vert",
		.fragment = "camera.frag",
		.defines = defines[layout],
		.textures = { "u_plane0", one_plane ? NULL : "u_plane1" },
	};
	int status = gfx_program_create(view->gfx, &program, &view->programs[layout]);
	if (status < 0)
		return status;
	struct gfx_pipeline_desc pipeline = {
		.program = view->programs[layout],
		.primitive = GFX_TRIANGLE_STRIP,
		.blend = GFX_OPAQUE,
		.depth = GFX_DEPTH_OFF,
	};
	return gfx_pipeline_create(view->gfx, &pipeline, &view->pipelines[layout]);
}

static int make_texture(struct reverse_view *view, enum gfx_format format, gfx_texture *out)
{
	struct gfx_texture_desc desc = {
		.format = format,
		.width = view->config.width,
		.height = view->config.height,
		.filter = GFX_LINEAR,
		.wrap = GFX_CLAMP,
	};
	return gfx_texture_create(view->gfx, &desc, out);
}

int reverse_view_init(struct reverse_view *view, struct arena *arena, const struct screen *screen,
	const struct reverse_view_config *config)
{
	static const struct pkg no_package;
	*view = (struct reverse_view){ .config = *config, .screen = screen, .gfx = screen->gfx };
	int status = canvas_init(&view->canvas, arena, view->gfx, &no_package, VERTICES);
	for (int layout = 0; status == 0 && layout < REVERSE_VIEW_LAYOUTS; layout++)
		status = make_program(view, (enum reverse_view_layout)layout);
	if (status == 0)
		status = make_texture(view, GFX_R8, &view->one);
	if (status == 0)
		status = make_texture(view, GFX_RG8, &view->two);
	if (status == 0)
		status = make_texture(view, GFX_RGBA8, &view->four);
	if (status < 0)
		reverse_view_finish(view);
	return status;
}

void reverse_view_finish(struct reverse_view *view)
{
	if (!view->gfx)
		return;
	canvas_finish(&view->canvas);
	gfx_texture_destroy(view->gfx, view->one);
	gfx_texture_destroy(view->gfx, view->two);
	gfx_texture_destroy(view->gfx, view->four);
	for (int i = 0; i < REVERSE_VIEW_LAYOUTS; i++) {
		gfx_pipeline_destroy(view->gfx, view->pipelines[i]);
		gfx_program_destroy(view->gfx, view->programs[i]);
	}
	*view = (struct reverse_view){ 0 };
}

static void write_plane(struct reverse_view *view, gfx_texture texture, uint32_t texel_bytes, uint32_t width,
	uint32_t height, const uint8_t *from, uint32_t stride)
{
	struct gfx_region region = { .width = width, .height = height, .layers = 1, .row_texels = stride / texel_bytes };
	gfx_texture_write(view->gfx, texture, &region, from);
}

bool reverse_view_upload(struct reverse_view *view, const struct camera_frame *frame)
{
	static const enum reverse_view_layout layouts[CAMERA_FORMAT_COUNT] = { [CAMERA_YUYV] = REVERSE_VIEW_PACKED,
		[CAMERA_UYVY] = REVERSE_VIEW_SWAPPED,
		[CAMERA_NV12] = REVERSE_VIEW_PLANES,
		[CAMERA_PLANES] = REVERSE_VIEW_PLANES,
		[CAMERA_RGBX] = REVERSE_VIEW_RGB,
		[CAMERA_BGRX] = REVERSE_VIEW_RGB };
	uint32_t width = frame->width, height = frame->height;
	if (width > view->config.width || height > view->config.height || frame->chroma_width > view->config.width ||
		frame->chroma_height > view->config.height)
		return false;
	view->layout = layouts[frame->format];
	view->frame = *frame;
	view->any = true;
	switch (view->layout) {
	case REVERSE_VIEW_PLANES:
		write_plane(view, view->one, 1, width, height, frame->plane[0], frame->stride[0]);
		write_plane(view, view->two, 2, frame->chroma_width, frame->chroma_height, frame->plane[1], frame->stride[1]);
		break;
	case REVERSE_VIEW_RGB:
		write_plane(view, view->four, 4, width, height, frame->plane[0], frame->stride[0]);
		break;
	default: /* the same bytes twice: filtered luma of every pixel, filtered chroma of every pair */
		write_plane(view, view->two, 2, width, height, frame->plane[0], frame->stride[0]);
		write_plane(view, view->four, 4, width / 2, height, frame->plane[0], frame->stride[0]);
	}
	return true;
}

void reverse_view_use(struct reverse_view *view, const struct camera_frame *frame, gfx_texture texture)
{
	view->layout = REVERSE_VIEW_EXTERNAL;
	view->external = texture;
	view->frame = *frame;
	view->any = true;
}

void reverse_view_forget(struct reverse_view *view)
{
	if (view->layout == REVERSE_VIEW_EXTERNAL)
		view->any = false;
	view->external.id = 0;
}

/* Rows of the matrix from what the texture holds (0 to 1) to RGB, the fourth column added. */
static void color_matrix(const struct camera_frame *frame, bool external, float gain, float (*rows)[4])
{
	if (external || frame->format == CAMERA_RGBX || frame->format == CAMERA_BGRX) {
		bool swap = !external && frame->format == CAMERA_BGRX;
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 4; k++)
				rows[i][k] = k == (swap ? 2 - i : i) ? gain : 0.0f;
		return;
	}
	float kr = frame->matrix == CAMERA_BT709 ? 0.2126f : 0.299f, kb = frame->matrix == CAMERA_BT709 ? 0.0722f : 0.114f;
	float kg = 1.0f - kr - kb, y = frame->full_range ? 1.0f : 255.0f / 219.0f;
	float c = frame->full_range ? 1.0f : 255.0f / 224.0f, black = frame->full_range ? 0.0f : 16.0f / 255.0f;
	const float u[3] = { 0.0f, -2.0f * kb * (1.0f - kb) / kg, 2.0f * (1.0f - kb) };
	const float v[3] = { 2.0f * (1.0f - kr), -2.0f * kr * (1.0f - kr) / kg, 0.0f };
	for (int i = 0; i < 3; i++) {
		rows[i][0] = gain * y;
		rows[i][1] = gain * c * u[i];
		rows[i][2] = gain * c * v[i];
		rows[i][3] = gain * (-y * black - c * (u[i] + v[i]) * 128.0f / 255.0f);
	}
}

/* Whole, as large as fits, in the middle. */
static struct box place_picture(const struct reverse_view *view)
{
	float width = (float)view->screen->width, height = (float)view->screen->height;
	float aspect = (float)view->frame.width / (float)view->frame.height;
	float w = fminf(width, height * aspect), h = w / aspect;
	return (struct box){ (width - w) / 2.0f, (height - h) / 2.0f, (width + w) / 2.0f, (height + h) / 2.0f };
}

/* Texture places of the corners of a part of `width` x `height` of the texture; `last`: the middle of its last texel,
 * beyond which other pictures' would be mixed in. */
static void texture_box(const struct reverse_view *view, uint32_t width, uint32_t height, float out[4], float last[2])
{
	float w = (float)view->config.width, h = (float)view->config.height;
	bool mirror = view->config.guide.mirror;
	out[0] = mirror ? (float)width / w : 0.0f;
	out[1] = 0.0f;
	out[2] = mirror ? 0.0f : (float)width / w;
	out[3] = (float)height / h;
	last[0] = ((float)width - 0.5f) / w;
	last[1] = ((float)height - 0.5f) / h;
}

static void whole_box(const struct reverse_view *view, float out[4], float last[2])
{
	bool mirror = view->config.guide.mirror;
	out[0] = mirror ? 1.0f : 0.0f;
	out[1] = 0.0f;
	out[2] = mirror ? 0.0f : 1.0f;
	out[3] = last[0] = last[1] = 1.0f;
}

static void draw_picture(const struct reverse_view *view, const struct box *at, bool night)
{
	float constants[CONSTANTS][4] = { 0 }, width = (float)view->screen->width, height = (float)view->screen->height;
	const struct camera_frame *frame = &view->frame;
	bool external = view->layout == REVERSE_VIEW_EXTERNAL;
	bool packed = view->layout == REVERSE_VIEW_PACKED || view->layout == REVERSE_VIEW_SWAPPED;
	constants[0][0] = at->x0 / width * 2.0f - 1.0f;
	constants[0][1] = 1.0f - at->y0 / height * 2.0f;
	constants[0][2] = at->x1 / width * 2.0f - 1.0f;
	constants[0][3] = 1.0f - at->y1 / height * 2.0f;
	if (external)
		whole_box(view, constants[1], constants[6]);
	else
		texture_box(view, frame->width, frame->height, constants[1], constants[6]);
	if (packed)
		texture_box(view, frame->width / 2, frame->height, constants[2], constants[6] + 2);
	else
		texture_box(view, frame->chroma_width, frame->chroma_height, constants[2], constants[6] + 2);
	color_matrix(frame, external, night ? NIGHT_PICTURE : 1.0f, constants + 3);
	struct gfx_draw draw = {
		.pipeline = view->pipelines[view->layout],
		.count = 4,
		.constants = constants[0],
		.constant_count = CONSTANTS,
	};
	if (external) {
		draw.textures[0] = view->external;
	} else if (view->layout == REVERSE_VIEW_RGB) {
		draw.textures[0] = view->four;
	} else {
		draw.textures[0] = packed ? view->two : view->one;
		draw.textures[1] = packed ? view->four : view->two;
	}
	gfx_draw(view->gfx, &draw);
}

static float brightness(bool night)
{
	return night ? 0.75f : 1.0f;
}

static void add_note(struct reverse_view *view, const char *text, float scale, bool night)
{
	float width = stroke_font_width(text, 22.0f * scale) + 40.0f * scale, height = 48.0f * scale;
	float x = (float)view->screen->width / 2.0f, y = (float)view->screen->height - 20.0f * scale - height / 2.0f;
	struct box pill = { x - width / 2.0f, y - height / 2.0f, x + width / 2.0f, y + height / 2.0f };
	canvas_rounded_box(&view->canvas, pill, 14.0f * scale, 1.0f, rgba_hex(0x101418, 0.78f));
	float light = 0.96f * brightness(night);
	struct stroke_style style = {
		.cap_px = 22.0f * scale, .color = { light, light * 0.95f, light * 0.85f, 1.0f }, .align = TEXT_CENTER
	};
	stroke_font_draw(&view->canvas, text, x, y, &style);
}

static void begin(struct reverse_view *view)
{
	gfx_frame_begin(view->gfx);
	canvas_begin(&view->canvas, view->screen->width, view->screen->height);
}

static void pass_begin(struct reverse_view *view, float tone)
{
	canvas_upload(&view->canvas);
	struct gfx_clear clear = {
		.color = true, .depth = true, .rgba = { 0.06f * tone, 0.07f * tone, 0.08f * tone, 1.0f }
	};
	gfx_pass_begin(view->gfx, view->screen->target, &clear);
}

void reverse_view_draw(struct reverse_view *view, const struct reverse_view_state *state)
{
	float scale = overlay_scale(view->screen->width, view->screen->height);
	struct box at = view->any ? place_picture(view) : (struct box){ 0 };
	begin(view);
	guide_draw(
		&view->canvas, &view->config.guide, &at, state->angle_known, state->angle_rad, scale, brightness(state->night));
	if (state->note)
		add_note(view, state->note, scale, state->night);
	pass_begin(view, 0.0f);
	if (view->any)
		draw_picture(view, &at, state->night);
	canvas_draw(&view->canvas);
	gfx_pass_end(view->gfx);
}

/* A triangle with an exclamation mark. */
static void add_sign(struct reverse_view *view, float x, float y, float half, float light)
{
	const struct vec2 triangle[3] = { { x, y - half }, { x + 1.1f * half, y + 0.85f * half },
		{ x - 1.1f * half, y + 0.85f * half } };
	const struct vec2 bar[2] = { { x, y - 0.42f * half }, { x, y + 0.28f * half } };
	const struct rgba ink = { 0.08f, 0.06f, 0.02f, 1.0f };
	canvas_convex(&view->canvas, triangle, 3, 1.0f, (struct rgba){ light, 0.72f * light, 0.1f * light, 1.0f });
	canvas_stroke(&view->canvas, bar, 2, 0.22f * half, ink);
	canvas_disc(&view->canvas, (struct vec2){ x, y + 0.56f * half }, 0.13f * half, ink);
}

/* Smaller where the words would not fit the screen. */
static float fitting(const struct reverse_view *view, const char *text, float cap_px)
{
	float room = (float)view->screen->width * 0.9f, width = stroke_font_width(text, cap_px);
	return width > room ? cap_px * room / width : cap_px;
}

void reverse_view_notice(struct reverse_view *view, const char *title, const char *text, bool warning, bool night)
{
	float scale = overlay_scale(view->screen->width, view->screen->height), light = brightness(night);
	float x = (float)view->screen->width / 2.0f, y = (float)view->screen->height / 2.0f;
	begin(view);
	if (warning)
		add_sign(view, x, y - 130.0f * scale, 62.0f * scale, light);
	struct stroke_style style = { .cap_px = fitting(view, title, 44.0f * scale),
		.color = { 0.96f * light, 0.96f * light, 0.94f * light, 1.0f },
		.align = TEXT_CENTER };
	stroke_font_draw(&view->canvas, title, x, y, &style);
	style.cap_px = fitting(view, text, 26.0f * scale);
	style.color = (struct rgba){ 0.75f * light, 0.78f * light, 0.8f * light, 1.0f };
	stroke_font_draw(&view->canvas, text, x, y + 80.0f * scale, &style);
	pass_begin(view, 1.0f);
	canvas_draw(&view->canvas);
	gfx_pass_end(view->gfx);
}
