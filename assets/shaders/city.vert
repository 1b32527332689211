// The city's geometry: struct pkg_mesh_vertex of assets/pkg_format.h. Light, haze and reflections are worked out here, so
// that a pixel costs a texel and a few products. Few varyings: a software rasteriser pays for each, twice.
//
// Variants by what a draw contains: HAS_WALL (walls, shops), HAS_GROUND (ground, markings, lamps), HAS_WATER, and LIT
// when lamps or windows shine. Roofs, foliage and solids are in all of them.
layout(location = 0) in highp vec3 a_position_mm; // from the chunk's origin
layout(location = 1) in highp vec2 a_normal_oct;
layout(location = 2) in highp vec2 a_ao_material; // 0 to 255 each
layout(location = 3) in highp vec2 a_uv;          // 1/256 tile
layout(location = 4) in highp vec4 a_tint_seed;   // sRGB 0 to 1, seed 0 to 1

// 0: chunk's origin from the eye, mm (whole numbers: sums are exact, so neighbours share their edges to the bit); w fade
// 1 to 4: clip from eye-relative mm, by column
// 5: xy light map coordinate of the eye, zw light map coordinates per metre
uniform highp vec4 u_draw[6];

layout(std140) uniform Materials {
	highp vec4 materials[256]; // enum pkg_material_kind, layer, gloss, 0
};
#if defined(HAS_WALL) && defined(LIT)
uniform sampler2D u_light_map; // r open sky, g street light
#endif

// A pixel is texel * v_paint + v_over, encoded.
out highp vec2 v_uv;
out highp vec3 v_paint;
out highp vec3 v_over;
flat out highp vec4 v_what; // layer, kind, 1 wall or shop, seed
#ifdef HAS_WALL
out highp vec4 v_glass; // of glass: texel * w + rgb
#endif
#ifdef HAS_GROUND
out highp vec2 v_map;
#endif
#ifdef HAS_WATER
out highp vec3 v_from_eye; // m
#endif

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	vec3 from_eye = at_mm * 0.001;
	float distance_m = length(from_eye);
	v_uv = a_uv * (1.0 / 256.0);

	vec4 material = materials[int(a_ao_material.y + 0.5)];
	float wall = step(material.x, KIND_SHOP);
	vec3 normal = octahedral(a_normal_oct), to_eye = from_eye * (-1.0 / max(distance_m, 0.001));
	v_what = vec4(material.y, material.x, wall, floor(a_tint_seed.w * 255.0 + 0.5));

	vec3 light = light_on(normal, material.x, a_ao_material.x * (1.0 / 255.0));
#if defined(HAS_WALL) && defined(LIT)
	// the light of the pavement in front of the wall, less with every storey
	vec2 at = u_draw[5].xy + (from_eye.xy + normal.xy * 2.5) * u_draw[5].zw;
	light += LAMP_LIGHT * (textureLod(u_light_map, at, 0.0).g * exp2(-0.9 * v_uv.y) * wall * sun_color.w);
#endif
	vec4 between = air(from_eye, distance_m);
	vec3 mirror = mirrored(normal, to_eye) * between.w;
	float gloss = wall > 0.5 ? 0.0 : material.z * 0.35;
	v_paint = min(a_tint_seed.rgb * encode_srgb(min(light, vec3(2.0))), vec3(0.97)) * (between.w * (1.0 - gloss));
	v_over = between.rgb + mirror * gloss;
#ifdef HAS_WALL
	float share = mirroring(normal, to_eye);
	v_glass = vec4(between.rgb + mirror * share, encode_srgb(vec3(light.g * 0.7)).g * between.w * (1.0 - share));
#endif
#ifdef HAS_GROUND
	v_map = u_draw[5].xy + from_eye.xy * u_draw[5].zw;
#endif
#ifdef HAS_WATER
	v_from_eye = from_eye;
#endif
}
