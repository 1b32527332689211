// The distance as textured triangles ([S97] section 3): struct pkg_impostor_vertex of assets/pkg_format.h. Light and what
// glass mirrors are worked out here, with the functions of city.vert, so that near and far look alike. Haze and water are
// left to the pixels: triangles may be kilometres long.
//
// Variants: LIT when lamps or windows shine.
layout(location = 0) in highp vec3 a_position_mm; // from the cell's origin
layout(location = 1) in highp vec2 a_uv;          // 1/128 texel of the page
layout(location = 2) in highp vec2 a_page_code;   // page; capture view + 32 kind
layout(location = 3) in highp vec2 a_normal_oct;

// 0: the cell's origin from the eye, mm; w first layer of its pages
// 1 to 4: clip from eye-relative mm, by column
// 5: xy light map coordinate of the eye, zw light map coordinates per metre
// 6: x share of pixels that are left, while dissolving
uniform highp vec4 u_draw[7];

layout(std140) uniform Impostor {
	highp vec4 axis[32]; // depth in each capture view of a point p, m from the cell's origin: dot(xyz, p) + w
};

out highp vec3 v_uvz; // u z, v z, z: linear in space, where u and v alone are not
flat out highp vec4 v_what; // xy horizontal normal, z kind, w layer
// A pixel before haze is texel * v_paint + (its share of glass) * v_glass, encoded.
out highp vec3 v_paint;
out highp vec3 v_glass;
out highp vec3 v_from_eye; // m

const float MEAN_AO = 0.9; // albedo has it as a factor already; the sun's share of the light wants it once more

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	float kind = floor(a_page_code.y * (1.0 / 32.0) + 0.001);
	vec4 view = axis[int(a_page_code.y - kind * 32.0 + 0.5)];
	float z = dot(view.xyz, a_position_mm * 0.001) + view.w;
	v_uvz = vec3(a_uv * (z / 32768.0), z);

	vec3 from_eye = at_mm * 0.001;
	vec3 normal = octahedral(a_normal_oct), to_eye = from_eye * (-1.0 / max(length(from_eye), 0.001));
	vec3 light = light_on(normal, kind, MEAN_AO) * (1.0 / MEAN_AO);
	v_what = vec4(normal.xy, kind, u_draw[0].w + a_page_code.x);
	bool ground = abs(kind - KIND_GROUND - 0.5) < 0.6; // or marking: without a tint, so city.vert's limit is known here
	v_paint = min(encode_srgb(min(light, vec3(2.0))), vec3(ground ? 0.97 : 1.3));
	v_glass = mirrored(normal, to_eye) * mirroring(normal, to_eye);
	v_from_eye = from_eye;
}
