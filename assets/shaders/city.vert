// The city's geometry: struct pkg_mesh_vertex of assets/pkg_format.h. Everything that is linear over a triangle, or
// constant over it, is worked out here.
layout(location = 0) in highp vec3 a_position_mm; // from the chunk's origin
layout(location = 1) in highp vec2 a_normal_oct;
layout(location = 2) in highp vec2 a_ao_material; // 0 to 255 each
layout(location = 3) in highp vec2 a_uv;          // 1/256 tile
layout(location = 4) in highp vec4 a_tint_seed;   // sRGB 0 to 1, seed 0 to 1

// 0: chunk's origin from the eye, mm (whole numbers: sums are exact, so neighbours share their edges to the bit); w fade
// 1 to 4: clip from eye-relative mm, by column
// 5: xy light map coordinate of the eye, zw light map coordinates per metre
uniform highp vec4 u_draw[6];

struct MaterialRow {
	highp vec4 mean; // linear rgb, gloss
	highp vec4 kind; // enum pkg_material_kind, layer
};
layout(std140) uniform Materials {
	MaterialRow materials[256];
};
uniform sampler2D u_light_map; // r open sky, g street light

out highp vec3 v_from_eye; // m
out highp vec2 v_uv;
out mediump vec3 v_light;    // of sun and sky, AO included
out mediump vec3 v_tint;     // linear
out mediump float v_glow;    // street light on walls
flat out mediump vec4 v_mean_gloss;
flat out highp vec3 v_kind_layer_seed;
flat out mediump vec3 v_normal;

vec3 octahedral(vec2 e)
{
	vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
	if (n.z < 0.0)
		n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
	return normalize(n);
}

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	v_from_eye = at_mm * 0.001;
	v_uv = a_uv * (1.0 / 256.0);

	MaterialRow material = materials[int(a_ao_material.y + 0.5)];
	v_kind_layer_seed = vec3(material.kind.xy, floor(a_tint_seed.w * 255.0 + 0.5));
	v_mean_gloss = material.mean;
	v_tint = decode_srgb(a_tint_seed.rgb);
	v_normal = octahedral(a_normal_oct);

	float ao = a_ao_material.x * (1.0 / 255.0);
	float facing = dot(v_normal, sun_direction.xyz);
	if (material.kind.x == KIND_FOLIAGE)
		facing = facing * 0.6 + 0.4; // light goes through leaves
	vec3 ambient = mix(ground_color.rgb, sky_color.rgb, v_normal.z * 0.5 + 0.5);
	v_light = (ambient + sun_color.rgb * max(facing, 0.0) * mix(0.5, 1.0, ao)) * ao;

	v_glow = 0.0;
	if (material.kind.x <= KIND_SHOP && v_normal.z < 0.5) {
		// the light of the pavement in front of the wall, less with every storey
		vec2 at = u_draw[5].xy + (v_from_eye.xy + v_normal.xy * 2.5) * u_draw[5].zw;
		v_glow = textureLod(u_light_map, at, 0.0).g * exp2(-0.9 * v_uv.y) * sun_color.w;
	}
}
