// Clear sky: a gradient, the sun's disc with its aureole, and at night some quiet stars. GRID: the gradient alone.
#ifdef GRID
in mediump vec3 v_color;
out mediump vec4 o_color;

void main()
{
	o_color = vec4(v_color, 1.0);
}
#else
in highp vec3 v_direction;
out mediump vec4 o_color;

// A star in about one cell of twelve; cells are squares of a cube's faces.
float star(highp vec3 d)
{
	highp vec3 a = abs(d);
	highp vec2 face = a.z >= max(a.x, a.y) ? d.xy / a.z : a.x >= a.y ? d.yz / a.x + 7.0 : d.xz / a.y + 13.0;
	highp vec2 at = face * 60.0, cell = floor(at);
	highp vec3 p = fract(vec3(cell.xyx) * vec3(0.1031, 0.1030, 0.0973));
	p += dot(p, p.yzx + 33.33);
	highp vec2 pick = fract((p.xx + p.yz) * p.zy);
	highp float away = length(fract(at) - 0.2 - 0.6 * pick);
	return step(pick.x, 0.12) * smoothstep(0.06, 0.0, away) * (0.3 + 0.7 * pick.y);
}

void main()
{
	highp vec3 d = normalize(v_direction);
	vec3 color = sky_in(d);
	float towards = max(dot(d, sun_direction.xyz), 0.0);
	float day = 1.0 - sun_direction.w;
	color += sun_color.rgb * day * (smoothstep(0.99985, 0.99995, towards) * 0.6 + pow(towards, 96.0) * 0.22);
	if (zenith.w > 0.01 && d.z > 0.02)
		color += vec3(0.16, 0.17, 0.20) * star(d) * zenith.w * smoothstep(0.02, 0.3, d.z);
	o_color = vec4(encode_srgb(min(color, vec3(0.93))), 1.0);
}
#endif
