// The city's geometry for capturing: struct pkg_mesh_vertex, three of its own for each triangle, without indices.
layout(location = 0) in highp vec3 a_position_mm; // from the chunk's origin
layout(location = 1) in highp vec2 a_normal_oct;
layout(location = 2) in highp vec2 a_ao_material; // 0 to 255 each
layout(location = 3) in highp vec2 a_uv;          // 1/256 tile
layout(location = 4) in highp vec4 a_tint_seed;   // sRGB 0 to 1, seed 0 to 1

// 0: chunk's origin from the eye, mm; w 1: decals
// 1 to 4: clip from eye-relative mm, by column
// 5: xy light map coordinate of the eye, zw light map coordinates per metre
uniform highp vec4 u_draw[6];

flat out highp uint v_triangle; // + 1
#ifdef COLOR
layout(std140) uniform Materials {
	highp vec4 materials[256]; // enum pkg_material_kind, layer, gloss, 0
};

out highp vec3 v_from_eye; // m
out highp vec2 v_uv;
out highp vec4 v_paint; // tint times AO; w of glass, which has no tint
flat out highp vec3 v_normal;
flat out highp vec3 v_material; // as in Materials
#endif

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	v_triangle = uint(gl_VertexID) / 3u + 1u;
#ifdef COLOR
	vec3 shade = encode_srgb(vec3(1.0, 0.7, 0.0) * (a_ao_material.x * (1.0 / 255.0)));
	v_from_eye = at_mm * 0.001;
	v_uv = a_uv * (1.0 / 256.0);
	v_paint = vec4(a_tint_seed.rgb * shade.x, shade.y);
	v_normal = octahedral(a_normal_oct);
	v_material = materials[int(a_ao_material.y + 0.5)].xyz;
#endif
}
