/*
 * The materials of a bake: what each texture layer shows, how it is lit, and how large one tile is. The generators
 * choose by name; materials.c paints the layers (tools/bake/paint_*.c) and writes MATL and TEXA.
 */
#ifndef BLVD_TOOLS_BAKE_MATERIALS_H
#define BLVD_TOOLS_BAKE_MATERIALS_H

#include "assets/pkg_format.h"
#include "tools/city/pool.h"

enum material_id {
	/* ground, painted by paint_ground.c */
	MATERIAL_ASPHALT,
	MATERIAL_ASPHALT_OLD,
	MATERIAL_COBBLE,
	MATERIAL_PAVING, /* sidewalks */
	MATERIAL_KERB,
	MATERIAL_SQUARE, /* large slabs of squares */
	MATERIAL_GRAVEL,
	MATERIAL_SAND,
	MATERIAL_GRASS,
	MATERIAL_PARK, /* lawn, a little darker */
	MATERIAL_FOREST,
	MATERIAL_PITCH,
	MATERIAL_SOIL,
	MATERIAL_YARD, /* inside blocks: the ground between buildings */
	MATERIAL_WATER,
	MATERIAL_BALLAST,
	MATERIAL_MARKING, /* white paint, uniform */
	MATERIAL_MARKING_YELLOW,
	MATERIAL_CONCRETE, /* bridge sides, quay walls, tunnel walls */
	MATERIAL_METAL,    /* lamp posts, rails */
	MATERIAL_LAMP,
	MATERIAL_BARK,
	MATERIAL_LEAF,
	MATERIAL_NEEDLE,
	MATERIAL_ROCK,
	/* roofs, painted by paint_roofs.c */
	MATERIAL_ROOF_TILES,
	MATERIAL_ROOF_SLATE,
	MATERIAL_ROOF_METAL,
	MATERIAL_ROOF_COPPER,
	MATERIAL_ROOF_GRAVEL,
	MATERIAL_ROOF_CONCRETE,
	MATERIAL_ROOF_GLASS,
	MATERIAL_ROOF_GRASS,
	/* walls: one tile is one bay by one storey; painted by paint_walls.c. From here on the walls' author adds what is
	   needed. */
	MATERIAL_WALL_FIRST,
	/* upper storeys */
	MATERIAL_WALL_TALL = MATERIAL_WALL_FIRST, /* plaster, tall casement with a stone surround */
	MATERIAL_WALL_SHUTTER_GREEN,
	MATERIAL_WALL_SHUTTER_GREY,
	MATERIAL_WALL_SHUTTER_BROWN,
	MATERIAL_WALL_FRENCH,   /* French window with a railing */
	MATERIAL_WALL_ASHLAR,   /* cut stone, tall window, railing */
	MATERIAL_WALL_PEDIMENT, /* stone surround under a pediment */
	MATERIAL_WALL_VILLA,
	MATERIAL_WALL_PAIR, /* two narrow windows */
	MATERIAL_WALL_SMALL,
	MATERIAL_WALL_WIDE, /* post-war flats: wide window, roller blind */
	MATERIAL_WALL_BRICK_SASH,
	MATERIAL_WALL_BRICK_WIDE,
	MATERIAL_WALL_STRIP,   /* ribbon window */
	MATERIAL_WALL_GRID,    /* concrete grid, deep windows */
	MATERIAL_WALL_BALCONY, /* modern flats with balconies */
	MATERIAL_WALL_CURTAIN_BLUE,
	MATERIAL_WALL_CURTAIN_GREY,
	MATERIAL_WALL_CURTAIN_DARK,
	MATERIAL_WALL_PIER, /* stone piers between narrow windows */
	MATERIAL_WALL_INDUSTRIAL,
	MATERIAL_WALL_CIVIC,
	MATERIAL_WALL_SCHOOL,
	MATERIAL_WALL_CHURCH, /* tall arched window; one tile is the whole height */
	MATERIAL_WALL_BELFRY,
	MATERIAL_WALL_BOARDS, /* clapboard with a sash window */
	MATERIAL_WALL_BAY,    /* the same with a bay window */
	MATERIAL_WALL_GREENHOUSE,
	/* without openings */
	MATERIAL_BLANK_PLASTER,
	MATERIAL_BLANK_BRICK,
	MATERIAL_BLANK_STONE,
	MATERIAL_BLANK_CONCRETE,
	MATERIAL_BLANK_BOARDS,
	MATERIAL_BLANK_METAL,
	/* ground floors; their upper fifth is plain */
	MATERIAL_GROUND_PLASTER,
	MATERIAL_GROUND_RUSTIC,
	MATERIAL_GROUND_BRICK,
	MATERIAL_GROUND_BOARDS,
	MATERIAL_GROUND_MODERN,
	MATERIAL_GROUND_LOBBY,
	/* one bay of a ground floor with a door */
	MATERIAL_DOOR_PORTAL,
	MATERIAL_DOOR_PANEL,
	MATERIAL_DOOR_GLASS,
	MATERIAL_DOOR_BRICK,
	MATERIAL_DOOR_BOARDS,
	MATERIAL_DOOR_CHURCH,
	MATERIAL_GATE_GARAGE,
	MATERIAL_GATE_INDUSTRIAL,
	/* shop fronts */
	MATERIAL_SHOP_CLASSIC,
	MATERIAL_SHOP_GLASS,
	MATERIAL_SHOP_AWNING,
	MATERIAL_SHOP_CAFE,
	MATERIAL_SHOP_CLASSIC_BLUE,
	MATERIAL_SHOP_CLASSIC_RED,
	MATERIAL_SHOP_PALE,
	MATERIAL_SHOP_STONE,
	/* trim */
	MATERIAL_CORNICE, /* one tile high is the whole cornice */
	MATERIAL_TRIM,    /* eaves, gutters, copings */
	MATERIAL_DORMER,
	MATERIAL_AWNING, /* cloth in stripes; v 0 to 0.2 is what hangs down in front */
	MATERIAL_WALL_END,
	MATERIAL_LIMIT = 256,
};

#define MATERIAL_TEXTURE_PX 256

/* One layer being painted: MATERIAL_TEXTURE_PX squared RGBA, sRGB colour, alpha as enum pkg_material_kind says. Tiles
 * seamlessly. */
struct material_layer {
	uint8_t (*px)[4];
	enum pkg_material_kind kind;
	uint8_t gloss;
};

/* Each paints all of its materials into layers[id]; returns the number of the highest id it painted plus one. */
int paint_ground(struct material_layer *layers);
int paint_roofs(struct material_layer *layers);
int paint_walls(struct material_layer *layers);

/* MATL and TEXA, mip levels included (box filter in linear light). */
struct materials {
	ARRAY(struct pkg_material) table;
	ARRAY(uint8_t) texture; /* struct pkg_texture_array and the bytes behind it */
};
/* `format`: RGBA8 or ETC2_RGBA. */
void materials_paint(struct materials *out, enum pkg_texture_format format);
void materials_finish(struct materials *materials);

#endif
