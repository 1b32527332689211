// The distance as textured triangles ([S97] section 3): struct pkg_impostor_vertex of assets/pkg_format.h. Light, haze and
// what glass mirrors are worked out here, with the functions of city.vert, so that near and far look alike.
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
flat out highp float v_layer;
// A pixel is texel * v_paint + v_over + (its share of glass) * v_glass, encoded.
out highp vec3 v_paint;
out highp vec3 v_over;
out highp vec3 v_glass;
#ifdef LIT
out highp vec3 v_from_eye;    // m
flat out highp vec4 v_facing; // xy horizontal normal, z kind, w 1 wall or shop
#endif

const float MEAN_AO = 0.9; // albedo has it as a factor already; the sun's share of the light wants it once more

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	float kind = floor(a_page_code.y * (1.0 / 32.0) + 0.001);
	vec4 view = axis[int(a_page_code.y - kind * 32.0 + 0.5)];
	float z = dot(view.xyz, a_position_mm * 0.001) + view.w;
	v_uvz = vec3(a_uv * (z / 32768.0), z);
	v_layer = u_draw[0].w + a_page_code.x;

	vec3 from_eye = at_mm * 0.001;
	float distance_m = length(from_eye);
	vec3 normal = octahedral(a_normal_oct), to_eye = from_eye * (-1.0 / max(distance_m, 0.001));
	vec3 light = light_on(normal, kind, MEAN_AO) * (1.0 / MEAN_AO);
	vec4 between = air(from_eye, distance_m);
	v_paint = min(encode_srgb(min(light, vec3(2.0))), vec3(1.3)) * between.w;
	v_over = between.rgb;
	v_glass = mirrored(normal, to_eye) * (between.w * mirroring(normal, to_eye));
	if (kind == KIND_WATER) { // seen flat, its waves are less than a pixel
		float facing = 1.0 - max(to_eye.z, 0.0), square = facing * facing;
		float share = sqrt(0.03 + 0.75 * square * square * facing);
		v_paint *= 1.0 - share;
		v_over += encode_srgb(mix(haze.rgb, zenith.rgb, clamp(to_eye.z * 1.6, 0.0, 1.0)) * 0.9) * (share * between.w);
	}
#ifdef LIT
	v_from_eye = from_eye;
	v_facing = vec4(normal.xy, kind, step(kind, KIND_SHOP));
#endif
}
