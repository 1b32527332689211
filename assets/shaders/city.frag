// One surface shader for the city, in the variants of city.vert. Branches go by the material's kind, which is constant
// over a triangle; llvmpipe runs both sides of a branch, hence the variants.
in highp vec2 v_uv;
in highp vec3 v_paint;
in highp vec3 v_over;
flat in highp vec4 v_what;
#ifdef HAS_WALL
in highp vec4 v_glass;
#endif
#ifdef HAS_GROUND
in highp vec2 v_map;
#endif
#ifdef HAS_WATER
in highp vec3 v_from_eye;
#endif

uniform highp vec4 u_draw[6];
uniform sampler2DArray u_textures;
#ifdef HAS_GROUND
uniform sampler2D u_light_map;
#endif

out mediump vec4 o_color;

const vec3 LAMP_LIGHT = vec3(0.56, 0.40, 0.22);
const vec3 WARM_ROOM = vec3(0.80, 0.66, 0.44); // encoded
const vec3 COOL_ROOM = vec3(0.68, 0.69, 0.69);
const vec3 SHOP_LIGHT = vec3(0.85, 0.76, 0.61);

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
	return room * sqrt(on);
}
#endif

#ifdef HAS_WATER
// `body` is the water's own colour, haze included. Encoded.
vec3 water(vec3 body)
{
	highp float distance_m = length(v_from_eye);
	vec3 to_eye = v_from_eye * (-1.0 / max(distance_m, 0.001));
	highp vec2 at = v_from_eye.xy + eye.xy;
	float t = eye.w;
	vec2 wave = cos(at * 0.9 + vec2(t * 0.7, t * 0.5)) + cos(at.yx * vec2(1.7, -1.3) + vec2(-t * 0.9, t * 1.1));
	wave += 0.5 * cos(dot(at, vec2(3.1, 2.3)) + t * 1.7);
	float calm = 0.028 / (1.0 + distance_m * 0.03); // seen flat, waves are less than a pixel
	vec3 n = normalize(vec3(wave * calm, 1.0));
	vec3 r = reflect(-to_eye, n);
	vec3 sky = encode_srgb(mix(haze.rgb, zenith.rgb, clamp(r.z * 1.6, 0.0, 1.0)) * 0.9);
	float facing = 1.0 - max(dot(to_eye, n), 0.0), square = facing * facing;
	float fresnel = 0.03 + 0.75 * square * square * facing;
	float spark = pow(max(dot(r, sun_direction.xyz), 0.0), 180.0) * (1.0 - sun_direction.w);
	vec4 between = air(v_from_eye, distance_m);
	float share = sqrt(fresnel);
	vec3 shine = sky * share + sqrt(sun_color.rgb) * (spark * 0.6);
	return body * (1.0 - share) + between.rgb * share + shine * between.w;
}
#endif

void main()
{
	vec4 texel = texture(u_textures, vec3(v_uv, v_what.x));
	vec3 paint = v_paint;
	float alpha = 1.0;
#ifdef HAS_GROUND
	float open = step(abs(v_what.y - KIND_GROUND - 0.5), 0.6); // ground or marking
	vec2 map = texture(u_light_map, v_map).rg;
#ifdef LIT
	// what the lamps add, in the tint that is left when the sky's light is taken out again
	vec3 by_day = sky_color.rgb + sun_color.rgb * max(sun_direction.z, 0.0);
	vec3 lit = sqrt(vec3(map.r) + LAMP_LIGHT * (map.g * sun_color.w) / by_day);
#else
	float lit = sqrt(map.r);
#endif
	paint *= mix(lit * 0.0 + 1.0, lit, open);
	alpha = v_what.y == KIND_MARKING ? texel.a : 1.0;
#endif
	vec3 color = texel.rgb * paint + v_over;
#if defined(HAS_GROUND) && defined(LIT)
	if (v_what.y == KIND_LAMP)
		color = mix(color, vec3(0.90, 0.83, 0.70), sun_color.w);
#endif
#ifdef HAS_WALL
	vec3 glass = texel.rgb * v_glass.w + v_glass.rgb;
#ifdef LIT
	vec3 room = rooms(v_what.y == KIND_SHOP, v_what.w, fwidth(v_uv));
	glass += room * (1.0 - glass);
#endif
	color = mix(color, glass, texel.a * v_what.z);
#endif
#ifdef HAS_WATER
	color = v_what.y == KIND_WATER ? water(color) : color;
#endif
#ifdef FADE
	alpha *= u_draw[0].w;
#endif
	o_color = vec4(color, alpha);
}
