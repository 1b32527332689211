// The triangle that is seen, and with COLOR its surface as city.frag has it before light: what light is multiplied
// with, and the share that mirrors as window glass does. What is mirrored, what shines and the haze are added when the
// capture is shown.
flat in highp uint v_triangle;

layout(location = 0) out mediump vec4 o_color;
layout(location = 1) out highp uint o_triangle;

#ifdef COLOR
in highp vec3 v_from_eye;
in highp vec2 v_uv;
in highp vec4 v_paint;
flat in highp vec3 v_normal;
flat in highp vec3 v_material;

uniform highp vec4 u_draw[6];
uniform sampler2DArray u_textures;
uniform sampler2D u_light_map;

// As city.vert and city.frag, in the same encoded colour, without light and air.
vec4 surface(float kind, vec4 texel, vec3 to_eye)
{
	float share = mirroring(v_normal, to_eye), gloss = v_material.z * 0.35;
	if (kind <= KIND_SHOP)
		return vec4(texel.rgb * mix(v_paint.rgb, vec3(v_paint.w * (1.0 - share)), texel.a), texel.a);
	vec3 color = texel.rgb * v_paint.rgb * (1.0 - gloss);
	if (kind == KIND_GROUND || kind == KIND_MARKING)
		color *= sqrt(texture(u_light_map, u_draw[5].xy + v_from_eye.xy * u_draw[5].zw).r);
	return vec4(color, gloss / share);
}
#endif

void main()
{
#ifdef COLOR
	float kind = v_material.x;
	vec4 texel = texture(u_textures, vec3(v_uv, v_material.y));
	vec4 seen = surface(kind, texel, -normalize(v_from_eye));
	// decals blend, and by nothing but their wear
	float share = u_draw[0].w > 0.5 ? (kind == KIND_MARKING ? texel.a : 1.0) : seen.a;
	o_color = vec4(seen.rgb, share);
#else
	o_color = vec4(0.0);
#endif
	o_triangle = v_triangle;
}
