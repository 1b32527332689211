/* Glyphs from a signed distance field with a halo behind; shapes (range 0) as they are. SHAPE: nothing but shapes.
   Colour is premultiplied. */
#ifdef SHAPE
in vec4 v_fill;

layout(location = 0) out vec4 o_color;

void main()
{
	o_color = vec4(v_fill.rgb * v_fill.a, v_fill.a);
}
#else
uniform sampler2D u_atlas;

in vec2 v_uv;
in vec4 v_fill;
in vec4 v_halo;
in vec3 v_field;

layout(location = 0) out vec4 o_color;

void main()
{
	vec4 fill = vec4(v_fill.rgb * v_fill.a, v_fill.a);
	if (v_field.x == 0.0) {
		o_color = fill;
		return;
	}
	float inside = (texture(u_atlas, v_uv).r - 128.0 / 255.0) * v_field.x + v_field.z;
	float core = clamp(inside + 0.5, 0.0, 1.0);
	float halo = smoothstep(-0.5, max(0.6 * v_field.y, 1.0), inside + v_field.y) * v_halo.a;
	o_color = fill * core + vec4(v_halo.rgb, 1.0) * (halo * (1.0 - core * v_fill.a));
}
#endif
