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
const uint MADE_UP = 0x80000000u; // PKG_TRUTH_MADE_UP
const uint UNKNOWN = 0xFFFFFFFFu; // TRUTH_UNKNOWN

void main()
{
	highp vec2 uv = v_uvz.xy / v_uvz.z;
	if (texture(u_pages, vec3(uv, u_draw[0].w + v_page)).a < CUT)
		discard;
	highp vec2 at = uv * 256.0 - 0.5;
	ivec2 low = ivec2(floor(at));
	vec2 part = at - floor(at);
	int layer = int(u_draw[5].x + v_page + 0.5);
	uvec4 texels[4];
	highp float shares[4];
	uint object = 0u; // of the nearest texel that shows one: what is painted beyond an outline has none
	highp float most = -1.0;
	for (int i = 0; i < 4; i++) {
		ivec2 corner = ivec2(i & 1, i >> 1);
		texels[i] = texelFetch(u_truth, ivec3(clamp(low + corner, 0, 255), layer), 0);
		vec2 share = mix(1.0 - part, part, vec2(corner));
		shares[i] = share.x * share.y;
		if (texels[i].x != 0u && shares[i] > most) {
			most = shares[i];
			object = texels[i].x;
		}
	}
	vec3 sum = vec3(0.0);
	float weights = 0.0;
	for (int i = 0; i < 4; i++) {
		float weight = texels[i].x == object ? max(shares[i], 1e-6) : 0.0;
		sum += uintBitsToFloat(texels[i].yzw) * weight;
		weights += weight;
	}
	// something is drawn here all the same: UNKNOWN when nothing around it says what
	highp vec3 place = object != 0u ? sum / weights : vec3(0.0);
	o_color = vec4(0.0);
	o_truth = uvec4(object != 0u ? object & ~MADE_UP : UNKNOWN, floatBitsToUint(place + u_draw[0].xyz * 0.001));
}
