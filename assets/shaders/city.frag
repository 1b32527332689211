// One surface shader for the city, in the variants of city.vert. Branches go by the material's kind, which is constant
// over a triangle; llvmpipe runs both sides of a branch, hence the variants.
in highp vec3 v_from_eye;
in highp vec2 v_uv;
in highp vec4 v_color;
flat in highp vec4 v_normal_code;
#ifndef HAS_GROUND
flat in mediump float v_gloss;
#endif

uniform highp vec4 u_draw[6];
uniform sampler2DArray u_textures;
#ifdef HAS_GROUND
uniform sampler2D u_light_map;
#endif

out mediump vec4 o_color;

const vec3 LAMP_LIGHT = vec3(0.56, 0.40, 0.22);
const vec3 WARM_ROOM = vec3(0.62, 0.40, 0.17);
const vec3 COOL_ROOM = vec3(0.42, 0.44, 0.42);
const vec3 SHOP_LIGHT = vec3(0.70, 0.55, 0.34);

// Sky and buildings across the street, as something smooth shows them.
vec3 mirrored(vec3 to_eye)
{
	float up = 2.0 * dot(to_eye, v_normal_code.xyz) * v_normal_code.z - to_eye.z;
	vec3 sky = mix(haze.rgb, zenith.rgb, clamp(up * 1.4, 0.0, 1.0));
	return mix(ground_color.rgb * 0.35, sky, smoothstep(-0.02, 0.22, up));
}

#if defined(HAS_WALL) && defined(LIT)
highp float hash(highp vec3 p)
{
	p = fract(p * vec3(0.1031, 0.1130, 0.1370));
	p += dot(p, p.yzx + 33.33);
	return fract((p.x + p.y) * p.z);
}

// Light of the rooms behind the glass of a wall. Far off, where a tile is less than a pixel, its mean.
vec3 rooms(bool shop, float seed, vec2 width)
{
	float share = shop ? ground_color.w : sky_color.w;
	highp vec2 tile = floor(v_uv);
	highp vec3 key = shop ? vec3(seed, floor(tile.x * 0.34), 5.0) : vec3(tile, seed * 1.7 + 3.0);
	float pick = hash(key);
	float on = step(pick, share) * (0.55 + 0.45 * fract(pick * 57.0));
	on = mix(on, share * 0.8, smoothstep(0.35, 0.9, max(width.x, width.y)));
	vec3 room = shop ? SHOP_LIGHT : mix(WARM_ROOM, COOL_ROOM, step(0.8, fract(pick * 13.0)));
	return room * on;
}
#endif

#ifdef HAS_WALL
vec3 wall(vec4 texel, vec3 to_eye, bool shop, float seed, vec2 width)
{
	vec3 painted = decode_srgb(texel.rgb);
	vec3 glass = mix(painted * (v_color.w * 0.7), mirrored(to_eye), mirroring(v_normal_code.xyz, to_eye));
#ifdef LIT
	glass += rooms(shop, seed, width);
#endif
	return mix(painted * v_color.rgb, glass, texel.a);
}
#endif

#ifdef HAS_WATER
vec3 water(vec3 body, vec3 to_eye, float distance_m)
{
	highp vec2 at = v_from_eye.xy + eye.xy;
	float t = eye.w;
	vec2 wave = cos(at * 0.9 + vec2(t * 0.7, t * 0.5)) + cos(at.yx * vec2(1.7, -1.3) + vec2(-t * 0.9, t * 1.1));
	wave += 0.5 * cos(dot(at, vec2(3.1, 2.3)) + t * 1.7);
	float calm = 0.028 / (1.0 + distance_m * 0.03); // seen flat, waves are less than a pixel
	vec3 n = normalize(vec3(wave * calm, 1.0));
	vec3 r = reflect(-to_eye, n);
	vec3 sky = mix(haze.rgb, zenith.rgb, clamp(r.z * 1.6, 0.0, 1.0));
	float facing = 1.0 - max(dot(to_eye, n), 0.0), square = facing * facing;
	float fresnel = 0.03 + 0.75 * square * square * facing;
	float spark = pow(max(dot(r, sun_direction.xyz), 0.0), 180.0) * (1.0 - sun_direction.w);
	return mix(body, sky * 0.9, fresnel) + sun_color.rgb * (spark * 0.6);
}
#endif

void main()
{
	highp float code = v_normal_code.w;
	highp float seed = floor(code * (1.0 / 4096.0) + 0.0001);
	code -= seed * 4096.0;
	float layer = floor(code * (1.0 / 16.0) + 0.01), kind = code - layer * 16.0;
	vec4 texel = texture(u_textures, vec3(v_uv, layer));
	highp float distance_m = length(v_from_eye);
	vec3 to_eye = v_from_eye * (-1.0 / max(distance_m, 0.001));
	vec3 color = decode_srgb(texel.rgb) * v_color.rgb;
	float alpha = 1.0;
#ifdef HAS_GROUND
	vec2 map = texture(u_light_map, u_draw[5].xy + v_from_eye.xy * u_draw[5].zw).rg;
	if (kind == KIND_GROUND || kind == KIND_MARKING) {
#ifdef LIT
		// what the lamps add, in the tint that is left when the sky's light is taken out again
		vec3 by_day = sky_color.rgb + sun_color.rgb * max(sun_direction.z, 0.0);
		color *= vec3(map.r) + LAMP_LIGHT * (map.g * sun_color.w) / by_day;
#else
		color *= map.r;
#endif
		alpha = kind == KIND_MARKING ? texel.a : 1.0;
	}
#ifdef LIT
	if (kind == KIND_LAMP)
		color = mix(color, vec3(0.80, 0.66, 0.45), sun_color.w);
#endif
#else
	color = mix(color, mirrored(to_eye), v_gloss * 0.35);
#endif
#ifdef HAS_WALL
#ifdef LIT
	vec2 width = fwidth(v_uv);
#else
	const vec2 width = vec2(0.0);
#endif
	if (kind <= KIND_SHOP)
		color = wall(texel, to_eye, kind == KIND_SHOP, seed, width);
#endif
#ifdef HAS_WATER
	if (kind == KIND_WATER)
		color = water(color, to_eye, distance_m);
#endif
	color = hazed(color, v_from_eye, distance_m);
#ifdef FADE
	alpha *= u_draw[0].w;
#endif
	o_color = vec4(encode_srgb(min(color, vec3(0.93))), alpha);
}
