// What the texel of an impostor shows, and where that really is: struct pkg_truth_texel. Between texels of the same object
// the place is interpolated, as the colour is.
in highp vec3 v_uvz;
flat in highp float v_page;

uniform highp vec4 u_draw[6];
uniform highp sampler2DArray u_pages;
uniform highp usampler2DArray u_truth;

layout(location = 0) out mediump vec4 o_color;
layout(location = 1) out highp uvec4 o_truth; // object + 1, then the bits of the place from the eye, m

const float CUT = 64.0 / 255.0; // PKG_PAGE_CUT

void main()
{
	highp vec2 uv = v_uvz.xy / v_uvz.z;
	if (texture(u_pages, vec3(uv, u_draw[0].w + v_page)).a < CUT)
		discard;
	highp vec2 at = uv * 256.0 - 0.5;
	ivec2 low = ivec2(floor(at));
	vec2 part = at - floor(at);
	ivec2 nearest = low + ivec2(step(0.5, part));
	int layer = int(u_draw[5].x + v_page + 0.5);
	uvec4 middle = texelFetch(u_truth, ivec3(clamp(nearest, 0, 255), layer), 0);
	vec3 sum = vec3(0.0);
	float weights = 0.0;
	for (int i = 0; i < 4; i++) {
		ivec2 corner = ivec2(i & 1, i >> 1);
		uvec4 texel = texelFetch(u_truth, ivec3(clamp(low + corner, 0, 255), layer), 0);
		vec2 share = mix(1.0 - part, part, vec2(corner));
		float weight = texel.x == middle.x ? share.x * share.y : 0.0;
		sum += uintBitsToFloat(texel.yzw) * weight;
		weights += weight;
	}
	highp vec3 place = weights > 0.0 ? sum / weights : uintBitsToFloat(middle.yzw);
	o_color = vec4(0.0);
	o_truth = uvec4(middle.x, floatBitsToUint(place + u_draw[0].xyz * 0.001));
}
