// Goes in front of every shader, after the version line and the defines (VERTEX or FRAGMENT, and the variant's own).
precision highp float;
precision highp int;
precision highp sampler2DArray;

#ifndef NO_FRAME_BLOCK // for what needs no light: an active block must always be bound
// What all shaders of a frame share: struct frame_block of render/frame_block.h, binding 0.
layout(std140) uniform Frame {
	highp vec4 sun_direction; // xyz towards the sun or moon, w night: 0 day to 1 night
	highp vec4 sun_color;     // linear, w strength of lamps
	highp vec4 sky_color;     // linear ambient from above, w share of lit windows 0 to 1
	highp vec4 ground_color;  // linear ambient from below, w share of lit shops
	highp vec4 haze;          // linear colour at the horizon, w extinction per metre
	highp vec4 zenith;        // linear colour overhead, w share of stars
	highp vec4 eye;           // xyz eye height above the city's datum in z; x, y unused; w simulated seconds, modulo 1024
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
