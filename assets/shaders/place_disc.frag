in highp vec2 v_at;
uniform highp vec4 u_draw[7];
out mediump vec4 o_color;

void main()
{
	highp float r = length(v_at);
	highp float px = max(fwidth(r), 1e-4);
	float inside = clamp((1.0 - r) / px + 0.5, 0.0, 1.0);
	// a thin rim, two pixels wide, and a fill that is stronger towards it
	float rim = clamp(1.5 - abs(r - 1.0) / px, 0.0, 1.0);
	float fill = inside * mix(0.22, 0.5, smoothstep(0.3, 1.0, r));
	o_color = vec4(u_draw[6].rgb, u_draw[6].a * max(fill, rim));
}
