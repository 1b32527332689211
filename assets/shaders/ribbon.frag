/* A coloured band with a lighter edge, chevrons around the manoeuvre, faded at both ends. ARROW: two shades. */


uniform highp vec4 u_draw[10];

in float v_lateral;
in float v_s;

layout(location = 0) out vec4 o_color;

#ifndef ARROW
/* 1 inside of a chevron: bars that point ahead, 1.6 m in every 5 m. Fades where they become too fine to see. */
float chevrons()
{
	float phase = v_s + 1.7 * abs(v_lateral);
	float fine = fwidth(phase) / 5.0;
	float bar = abs(fract(phase / 5.0) - 0.5) * 5.0;
	float inside = smoothstep(1.7 - 5.0 * fine, 1.7 + 5.0 * fine, bar);
	float reach = u_draw[8].y;
	float distance_m = abs(v_s + u_draw[4].w - u_draw[8].x);
	float near = reach > 0.0 ? 1.0 - smoothstep(0.5 * reach, reach, distance_m) : 0.0;
	float within = 1.0 - smoothstep(0.55, 0.62, abs(v_lateral));
	return inside * near * within * (1.0 - smoothstep(0.12, 0.3, fine));
}
#endif

void main()
{
	float alpha = u_draw[8].z;
#ifdef ARROW
	vec3 color = mix(u_draw[6].rgb, u_draw[5].rgb, v_lateral);
#else
	float across = abs(v_lateral);
	float pixel = fwidth(v_lateral);
	float edge = smoothstep(0.87 - pixel, 0.87 + pixel, across);
	vec3 color = mix(u_draw[5].rgb, u_draw[8].y > 0.0 ? u_draw[9].rgb : u_draw[6].rgb, 0.85 * chevrons());
	color = mix(color, u_draw[6].rgb, edge);
	alpha *= 1.0 - smoothstep(1.0 - min(pixel, 0.9), 1.0, across) * 0.8;
	alpha *= smoothstep(u_draw[7].x, u_draw[7].x + u_draw[7].y, v_s);
	alpha *= 1.0 - smoothstep(u_draw[7].z - u_draw[7].w, u_draw[7].z, v_s);
#endif
	o_color = vec4(color * alpha, alpha);
}
