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
	vec4 shine = water_shine(n, to_eye), between = air(v_from_eye, distance_m);
	return body * (1.0 - shine.w) + between.rgb * shine.w + shine.rgb * between.w;
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
	vec3 lit = sqrt(map.r + lamp_light(map.g));
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
	vec3 room = rooms(v_what.y == KIND_SHOP, v_uv, v_what.w, fwidth(v_uv));
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
