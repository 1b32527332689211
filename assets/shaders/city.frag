// One surface shader for the city. Branches go by the material's kind, which is constant over a triangle.
in highp vec3 v_from_eye;
in highp vec2 v_uv;
in mediump vec3 v_light;
in mediump vec3 v_tint;
in mediump float v_glow;
flat in mediump vec4 v_mean_gloss;
flat in highp vec3 v_kind_layer_seed;
flat in mediump vec3 v_normal;

uniform highp vec4 u_draw[6];
uniform sampler2DArray u_textures;
uniform sampler2D u_light_map;

out mediump vec4 o_color;

const vec3 LAMP_LIGHT = vec3(0.56, 0.40, 0.22);
const vec3 WARM_ROOM = vec3(0.62, 0.40, 0.17);
const vec3 COOL_ROOM = vec3(0.42, 0.44, 0.42);
const vec3 SHOP_LIGHT = vec3(0.70, 0.55, 0.34);

highp float hash(highp vec3 p)
{
	p = fract(p * vec3(0.1031, 0.1130, 0.1370));
	p += dot(p, p.yzx + 33.33);
	return fract((p.x + p.y) * p.z);
}

// Sky and buildings across the street, as glass shows them.
vec3 mirrored(vec3 to_eye)
{
	vec3 r = reflect(-to_eye, v_normal);
	vec3 sky = mix(haze.rgb, zenith.rgb, clamp(r.z * 1.4, 0.0, 1.0));
	return mix(ground_color.rgb * 0.35, sky, smoothstep(-0.02, 0.22, r.z));
}

// Light of the rooms behind the glass of a wall. Far off, where a tile is less than a pixel, its mean.
vec3 rooms(bool shop)
{
	float share = shop ? ground_color.w : sky_color.w;
	highp vec2 tile = floor(v_uv);
	float pick = hash(vec3(tile, v_kind_layer_seed.z * 1.7 + 3.0));
	if (shop)
		pick = hash(vec3(v_kind_layer_seed.z, floor(tile.x * 0.34), 5.0));
	float on = step(pick, share);
	vec2 width = fwidth(v_uv);
	float detail = 1.0 - smoothstep(0.35, 0.9, max(width.x, width.y));
	on = mix(share, on * (0.55 + 0.45 * fract(pick * 57.0)), detail);
	vec3 room = shop ? SHOP_LIGHT : mix(WARM_ROOM, COOL_ROOM, step(0.8, fract(pick * 13.0)));
	return room * on;
}

vec3 wall(vec4 texel, vec3 to_eye, bool shop)
{
	vec3 light = v_light + LAMP_LIGHT * v_glow;
	vec3 masonry = decode_srgb(texel.rgb) * v_tint * light;
	if (texel.a < 0.02)
		return masonry;
	float grazing = 1.0 - max(dot(to_eye, v_normal), 0.0);
	float fresnel = 0.16 + 0.5 * grazing * grazing * grazing;
	vec3 glass = decode_srgb(texel.rgb) * light * 0.7;
	glass = mix(glass, mirrored(to_eye), fresnel);
	if (sky_color.w + ground_color.w > 0.001)
		glass += rooms(shop);
	return mix(masonry, glass, texel.a);
}

vec3 water(vec3 to_eye, float distance_m)
{
	highp vec2 at = v_from_eye.xy + eye.xy;
	float t = eye.w;
	vec2 wave = cos(at * 0.9 + vec2(t * 0.7, t * 0.5)) + cos(at.yx * vec2(1.7, -1.3) + vec2(-t * 0.9, t * 1.1));
	wave += 0.5 * cos(dot(at, vec2(3.1, 2.3)) + t * 1.7);
	float calm = 0.028 / (1.0 + distance_m * 0.012);
	vec3 n = normalize(vec3(wave * calm, 1.0));
	vec3 r = reflect(-to_eye, n);
	vec3 sky = mix(haze.rgb, zenith.rgb, clamp(r.z * 1.6, 0.0, 1.0));
	float fresnel = 0.03 + 0.75 * pow(1.0 - max(dot(to_eye, n), 0.0), 5.0);
	vec3 body = v_mean_gloss.rgb * v_tint * v_light;
	float spark = pow(max(dot(r, sun_direction.xyz), 0.0), 180.0) * (1.0 - sun_direction.w);
	return mix(body, sky * 0.9, fresnel) + sun_color.rgb * spark * 0.6;
}

#ifdef FADE
// Ordered dither, 4 x 4: needs no drawing order and keeps the depth right.
void dissolve(float share)
{
	ivec2 p = ivec2(gl_FragCoord.xy) & 3;
	int bayer = ((p.x ^ p.y) & 1) * 8 + (p.y & 1) * 4 + (((p.x ^ p.y) >> 1) & 1) * 2 + ((p.y >> 1) & 1);
	if ((float(bayer) + 0.5) * (1.0 / 16.0) >= share)
		discard;
}
#endif

void main()
{
#ifdef FADE
	dissolve(u_draw[0].w);
#endif
	float kind = v_kind_layer_seed.x;
	vec4 texel = texture(u_textures, vec3(v_uv, v_kind_layer_seed.y));
	float distance_m = length(v_from_eye);
	vec3 to_eye = v_from_eye * (-1.0 / max(distance_m, 0.001));
	float alpha = 1.0;
	vec3 color;
	if (kind <= KIND_SHOP) {
		color = wall(texel, to_eye, kind == KIND_SHOP);
	} else if (kind == KIND_GROUND || kind == KIND_MARKING) {
		vec2 map = texture(u_light_map, u_draw[5].xy + v_from_eye.xy * u_draw[5].zw).rg;
		vec3 light = v_light * map.r + LAMP_LIGHT * map.g * sun_color.w;
		color = decode_srgb(texel.rgb) * v_tint * light;
		alpha = kind == KIND_MARKING ? texel.a : 1.0;
	} else if (kind == KIND_WATER) {
		color = water(to_eye, distance_m);
	} else if (kind == KIND_LAMP) {
		color = mix(decode_srgb(texel.rgb) * v_tint * v_light, vec3(0.80, 0.66, 0.45), sun_color.w);
	} else {
		color = decode_srgb(texel.rgb) * v_tint * v_light;
		float gloss = v_mean_gloss.a;
		if (gloss > 0.15)
			color = mix(color, mirrored(to_eye), gloss * 0.35);
	}
	color = hazed(color, v_from_eye);
	o_color = vec4(encode_srgb(min(color, vec3(0.93))), alpha);
}
