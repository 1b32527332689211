/*
 * Everything for the driver that is not the city: the route on the street, street names, read-outs. One object;
 * memory from the arena and all GL objects at overlay_init(), nothing afterwards.
 *
 * Per frame: overlay_update() outside of passes. Then inside the pass: overlay_draw_world() in every depth slice after
 * its geometry (with that slice's gfx_depth_range), overlay_draw_hidden() in every slice again when all geometry is
 * drawn, overlay_draw_screen() last.
 */
#ifndef BLVD_RENDER_OVERLAY_H
#define BLVD_RENDER_OVERLAY_H

#include "render/hud.h"
#include "render/labels.h"
#include "render/route_ribbon.h"

/* Zero takes the default. */
struct overlay_config {
	enum wording_units units;      /* default: the country's */
	bool zone_given;               /* false: no zone is known, the time still to go stands for the arrival time */
	int32_t utc_offset_minutes;    /* local time minus UTC, with zone_given */
	uint32_t vertices;             /* of flat shapes and text; default 8,192 */
	uint32_t ribbon_points;        /* default 4,096 */
	const char *const *menu_words; /* every word of the menu; borrowed during overlay_init(), the words for ever */
	uint32_t menu_word_count;
};

/* What the driver has chosen, and what the driver's side has to say. Plain values, every frame. */
struct overlay_driver {
	const struct menu_view *menu; /* NULL: closed */
	const char *devices;          /* what is wrong with controls and lines, NULL nothing */
	enum wording_units units;     /* UNITS_AUTO: the country's */
	bool no_names;                /* of streets */
	bool light_chosen;            /* day or night by choice or by the car's lamps: `daylight` alone counts */
};

struct overlay_input {
	const struct view *view;
	const struct nav_view *nav;
	enum camera_kind kind;
	int64_t time_ns;                     /* simulated or monotonic */
	float daylight;                      /* 0 night to 1 day; nav->ambient goes first when it is known */
	bool map_damaged;                    /* parts of the map could not be read */
	const char *message;                 /* shown as it is, NULL none */
	const struct overlay_driver *driver; /* NULL: as it was configured, no menu */
};

struct overlay {
	const struct pkg *pkg;
	struct gfx *gfx;
	struct overlay_config config;
	struct text_font font;
	struct canvas canvas;
	struct labels labels;
	struct ribbon ribbon;
	struct palette palette;
	struct menu_words menu_words;
	struct hud_memory memory;
	struct view view; /* of this frame */
	struct ribbon_look look;
	bool by_day;
	float day; /* eased by_day */
	bool started;
	int64_t time_ns;
	struct box taken[HUD_BOXES_MAX]; /* by read-outs, this frame */
	uint32_t taken_count;
};

/* Returns 0, -ENOMEM, -EINVAL (shader; logged). `gfx` NULL draws nothing (tests). `config` NULL takes the defaults. */
int overlay_init(struct overlay *overlay, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	const struct overlay_config *config);
void overlay_finish(struct overlay *overlay);

void overlay_update(struct overlay *overlay, const struct overlay_input *input);
void overlay_draw_world(const struct overlay *overlay, enum view_slice_id slice);
void overlay_draw_hidden(const struct overlay *overlay, enum view_slice_id slice);
void overlay_draw_screen(const struct overlay *overlay);

/* Pixels of one length of a 720 px screen; small screens get a little more than their share to stay readable. */
float overlay_scale(uint32_t width, uint32_t height);

#endif
