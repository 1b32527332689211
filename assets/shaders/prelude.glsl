// Goes in front of every shader, after the version line and the defines (VERTEX or FRAGMENT, and the variant's own).
precision highp float;
precision highp int;
precision highp sampler2DArray;

// enum pkg_material_kind of assets/pkg_format.h
#define KIND_WALL 0.0
#define KIND_SHOP 1.0
#define KIND_ROOF 2.0
#define KIND_GROUND 3.0
#define KIND_MARKING 4.0
#define KIND_WATER 5.0
#define KIND_FOLIAGE 6.0
#define KIND_SOLID 7.0
#define KIND_LAMP 8.0

#ifndef NO_FRAME_BLOCK // for what needs no light: an active block must always be bound
// What all shaders of a frame share: struct frame_block of render/frame_block.h, binding 0.
layout(std140) uniform Frame {
	highp vec4 sun_direction; // xyz towards the sun or moon, w night: 0 day to 1 night
	highp vec4 sun_color;     // linear, w strength of lamps
	highp vec4 sky_color;     // linear ambient from above, w share of lit windows 0 to 1
	highp vec4 ground_color;  // linear ambient from below, w share of lit shops
	highp vec4 haze;          // linear colour at the horizon, w extinction per metre
	highp vec4 zenith;        // linear colour overhead, w share of stars
	highp vec4 eye;           // xy position modulo 1,024 m, z height above the city's datum; w seconds modulo 1,024
	highp vec4 screen;        // width, height, 1 / width, 1 / height
};
#endif

// Linear light to sRGB: least-squares fit in square roots, within 2/255 of the curve.
vec3 encode_srgb(vec3 c)
{
	vec3 s1 = sqrt(max(c, 0.0)), s2 = sqrt(s1), s3 = sqrt(s2);
	return 0.942088 * s1 + 0.338879 * s2 - 0.173669 * s3 - 0.110115 * c;
}

// sRGB to linear light: least-squares cubic, within 0.002 of the curve.
vec3 decode_srgb(vec3 c)
{
	return c * (c * (c * 0.317443 + 0.668301) + 0.015990);
}

// Unit vector of struct pkg_mesh_vertex.normal_oct.
vec3 octahedral(vec2 e)
{
	vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
	vec2 folded = (1.0 - abs(n.yx)) * (step(0.0, n.xy) * 2.0 - 1.0);
	n.xy = n.z < 0.0 ? folded : n.xy;
	return n * inversesqrt(dot(n, n));
}

// Share of light that the glass of a wall mirrors.
float mirroring(vec3 normal, vec3 to_eye)
{
	float grazing = 1.0 - max(dot(to_eye, normal), 0.0);
	return 0.16 + 0.5 * grazing * grazing * grazing;
}

#ifndef NO_FRAME_BLOCK
// The clear sky in a direction (unit), without sun or stars.
vec3 sky_in(vec3 direction)
{
	float up = max(direction.z, 0.0);
	float towards_sun = max(dot(direction.xy, sun_direction.xy), 0.0);
	vec3 low = haze.rgb * (1.0 + 0.35 * towards_sun * towards_sun * (1.0 - sun_direction.w));
	return mix(low, zenith.rgb, 1.0 - exp2(-4.2 * up));
}

// Surfaces are lit at their vertices and mixed in encoded colour: a product of colours is the product of their encodings
// (near enough), so a pixel needs neither to decode nor to encode.

// Linear light on a surface; `ao` is its open share of the sky.
vec3 light_on(vec3 normal, float kind, float ao)
{
	float facing = dot(normal, sun_direction.xyz);
	facing = kind == KIND_FOLIAGE ? facing * 0.6 + 0.4 : facing; // light goes through leaves
	vec3 ambient = mix(ground_color.rgb, sky_color.rgb, normal.z * 0.5 + 0.5);
	return (ambient + sun_color.rgb * (max(facing, 0.0) * (0.5 + 0.5 * ao))) * ao;
}

// Sky and buildings across the street, as something smooth shows them. Encoded.
vec3 mirrored(vec3 normal, vec3 to_eye)
{
	float up = 2.0 * dot(to_eye, normal) * normal.z - to_eye.z;
	vec3 sky = mix(haze.rgb, zenith.rgb, clamp(up * 1.4, 0.0, 1.0));
	return encode_srgb(mix(ground_color.rgb * 0.35, sky, smoothstep(-0.02, 0.22, up)));
}

// Air between the eye and a place `d` metres away: rgb its encoded colour times the share that it covers, w the share
// of what lies behind that still shows. One haze for near and far. It is thinner higher up.
vec4 air(highp vec3 from_eye, highp float d)
{
	// 1.3: shares of encoded colours look thinner than shares of light
	float clear = exp2(-1.3 * haze.w * d / (1.0 + max(from_eye.z, 0.0) * 0.002));
	float towards_sun = max(dot(from_eye.xy, sun_direction.xy) / max(d, 1.0), 0.0) * (1.0 - sun_direction.w);
	return vec4(encode_srgb(min(haze.rgb * (1.0 + 0.35 * towards_sun), vec3(0.93))) * (1.0 - clear), clear);
}

const vec3 LAMP_LIGHT = vec3(0.56, 0.40, 0.22);

// What lamps add to the open ground, in the tint that is left when the sky's light is taken out again; `glow` of the
// light map.
vec3 lamp_light(float glow)
{
	vec3 by_day = sky_color.rgb + sun_color.rgb * max(sun_direction.z, 0.0);
	return LAMP_LIGHT * (glow * sun_color.w) / by_day;
}

// What water with this normal mirrors: rgb sky and sun, encoded, w the share of its own colour that they take.
vec4 water_shine(vec3 n, vec3 to_eye)
{
	vec3 r = reflect(-to_eye, n);
	vec3 sky = encode_srgb(mix(haze.rgb, zenith.rgb, clamp(r.z * 1.6, 0.0, 1.0)) * 0.9);
	float facing = 1.0 - max(dot(to_eye, n), 0.0), square = facing * facing;
	float share = sqrt(0.03 + 0.75 * square * square * facing);
	float spark = pow(max(dot(r, sun_direction.xyz), 0.0), 180.0) * (1.0 - sun_direction.w);
	return vec4(sky * share + sqrt(sun_color.rgb) * (spark * 0.6), share);
}

highp float hash(highp vec3 p)
{
	p = fract(p * vec3(0.1031, 0.1130, 0.1370));
	p += dot(p, p.yzx + 33.33);
	return fract((p.x + p.y) * p.z);
}

// Light of the rooms behind the glass of a wall, encoded. A tile is a bay by a storey, `width` what of it a pixel spans.
// Far off, where a tile is less than a pixel, the mean.
vec3 rooms(bool shop, highp vec2 at_tile, float seed, vec2 width)
{
	const vec3 warm = vec3(0.80, 0.66, 0.44), cool = vec3(0.68, 0.69, 0.69), shop_light = vec3(0.85, 0.76, 0.61);
	float share = shop ? ground_color.w : sky_color.w;
	highp vec2 tile = floor(at_tile);
	highp vec3 key = shop ? vec3(seed, floor(tile.x * 0.34), 5.0) : vec3(tile, seed * 1.7 + 3.0);
	float pick = hash(key);
	float on = step(pick, share) * (0.55 + 0.45 * fract(pick * 57.0));
	on = mix(on, share * 0.8, smoothstep(0.35, 0.9, max(width.x, width.y)));
	return (shop ? shop_light : mix(warm, cool, step(0.8, fract(pick * 13.0)))) * sqrt(on);
}
#endif
