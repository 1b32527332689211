// See impostor.vert. DISSOLVE leaves a share of the pixels, by an ordered dither; TINT and WIRE are for looking at what is
// far.
in highp vec3 v_uvz;
flat in highp vec4 v_what;
in highp vec3 v_paint;
in highp vec3 v_glass;
in highp vec3 v_from_eye;

uniform highp vec4 u_draw[7];
uniform highp sampler2DArray u_pages;
#ifdef LIT
uniform sampler2D u_light_map;
#endif

out mediump vec4 o_color;

const float CUT = 64.0 / 255.0;    // PKG_PAGE_CUT
const float SOLID = 128.0 / 255.0; // PKG_PAGE_SOLID

#ifdef DISSOLVE
// 8 x 8 ordered dither (Bayer 1973): 0 to 63/64.
float threshold()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	int x = at.x ^ at.y, y = at.y;
	int bits = (x & 1) << 5 | (y & 1) << 4 | (x & 2) << 2 | (y & 2) << 1 | (x & 4) >> 1 | (y & 4) >> 2;
	return float(bits) * (1.0 / 64.0);
}
#endif

#ifdef LIT
// Some rooms are lit; bays and storeys of 3 m stand in for the tiles of near walls.
vec3 far_rooms()
{
	vec2 along = normalize(vec2(-v_what.y, v_what.x) + vec2(0.0, 1e-4));
	highp vec3 place = v_from_eye + eye.xyz;
	highp vec2 tile = vec2(dot(place.xy, along), place.z) * (1.0 / 3.0);
	float seed = floor(dot(v_what.xy, vec2(53.0, 91.0)));
	return rooms(v_what.z == KIND_SHOP, tile, seed, fwidth(tile)) * step(v_what.z, KIND_SHOP);
}
#endif

#ifdef WIRE
void main()
{
	o_color = vec4(0.12, 0.10, 0.30, 1.0);
}
#else
void main()
{
#ifdef DISSOLVE
	if (threshold() >= u_draw[6].x)
		discard;
#endif
	vec4 texel = texture(u_pages, vec3(v_uvz.xy / v_uvz.z, v_what.w));
	if (texel.a < CUT)
		discard;
	float glass = clamp((texel.a - SOLID) * (1.0 / (1.0 - SOLID)), 0.0, 1.0);
	vec3 paint = v_paint;
#ifdef LIT
	vec2 map = texture(u_light_map, u_draw[5].xy + v_from_eye.xy * u_draw[5].zw).rg;
	float open = step(abs(v_what.z - KIND_GROUND - 0.5), 0.6); // ground or marking, whose albedo has map.r as a factor
	paint *= sqrt(1.0 + lamp_light(map.g) * (open / max(map.r, 0.1)));
#endif
	vec3 color = texel.rgb * paint + v_glass * glass;
	highp float distance_m = length(v_from_eye);
	if (v_what.z == KIND_WATER) { // without waves: seen flat, they are less than a pixel
		vec4 shine = water_shine(vec3(0.0, 0.0, 1.0), v_from_eye * (-1.0 / max(distance_m, 0.001)));
		color = color * (1.0 - shine.w) + shine.rgb;
	}
	vec4 between = air(v_from_eye, distance_m);
	color = color * between.w + between.rgb;
#ifdef LIT
	color += far_rooms() * (1.0 - color) * glass;
#endif
#ifdef TINT
	color = mix(color, vec3(0.90, 0.20, 0.55), 0.5);
#endif
	o_color = vec4(min(color, vec3(0.97)), 1.0);
}
#endif
