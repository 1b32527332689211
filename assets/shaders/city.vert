// The city's geometry: struct pkg_mesh_vertex of assets/pkg_format.h. Everything that is linear over a triangle, or
// constant over it, is worked out here. Few varyings: a software rasteriser pays for each, twice.
//
// Variants by what a draw contains: HAS_WALL (walls, shops), HAS_GROUND (ground, markings, lamps), HAS_WATER, and LIT when lamps or
// windows shine. Roofs,
// foliage and solids are in all of them.
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

out highp vec3 v_from_eye; // m
out highp vec2 v_uv;
out highp vec4 v_color; // linear tint times light, AO included; w the light alone
flat out highp vec4 v_normal_code; // code: kind + 16 layer + 4096 seed
#ifndef HAS_GROUND
flat out mediump float v_gloss;
#endif

const vec3 LAMP_LIGHT = vec3(0.56, 0.40, 0.22);

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	v_from_eye = at_mm * 0.001;
	v_uv = a_uv * (1.0 / 256.0);

	vec4 material = materials[int(a_ao_material.y + 0.5)];
	vec3 normal = octahedral(a_normal_oct);
	v_normal_code = vec4(normal, material.x + 16.0 * material.y + 4096.0 * floor(a_tint_seed.w * 255.0 + 0.5));
#ifndef HAS_GROUND
	v_gloss = material.z;
#endif

	float ao = a_ao_material.x * (1.0 / 255.0);
	float facing = dot(normal, sun_direction.xyz);
	facing = material.x == KIND_FOLIAGE ? facing * 0.6 + 0.4 : facing; // light goes through leaves
	vec3 ambient = mix(ground_color.rgb, sky_color.rgb, normal.z * 0.5 + 0.5);
	vec3 light = (ambient + sun_color.rgb * (max(facing, 0.0) * (0.5 + 0.5 * ao))) * ao;
#if defined(HAS_WALL) && defined(LIT)
	// the light of the pavement in front of the wall, less with every storey
	vec2 at = u_draw[5].xy + (v_from_eye.xy + normal.xy * 2.5) * u_draw[5].zw;
	float wall = step(material.x, KIND_SHOP) * sun_color.w;
	light += LAMP_LIGHT * (textureLod(u_light_map, at, 0.0).g * exp2(-0.9 * v_uv.y) * wall);
#endif
	v_color = vec4(decode_srgb(a_tint_seed.rgb) * light, light.g);
}
