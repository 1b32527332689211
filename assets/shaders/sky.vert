// Behind everything: one triangle over the whole screen, or GRID: a grid of cells, two triangles each, with the gradient
// worked out at their corners, or SUN: two triangles around the sun.
// 0: forward, 1: right * tan(half width), 2: up * tan(half height); of the view. w of 0: tan(half width) of SUN
uniform highp vec4 u_draw[3];
#ifdef GRID
out mediump vec3 v_color;

const int COLUMNS = 16, ROWS = 16; // struct sky draws 6 vertices for each cell
#else
out highp vec3 v_direction;
#endif

#ifdef SUN
void main()
{
	vec3 sun = sun_direction.xyz;
	vec3 across = normalize(cross(sun, abs(sun.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
	vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 3, gl_VertexID >= 2) * 2.0 - 1.0;
	vec3 to = sun + (across * corner.x + cross(across, sun) * corner.y) * u_draw[0].w;
	vec2 at = vec2(dot(to, u_draw[1].xyz), dot(to, u_draw[2].xyz));
	at /= vec2(dot(u_draw[1].xyz, u_draw[1].xyz), dot(u_draw[2].xyz, u_draw[2].xyz));
	v_direction = to;
	gl_Position = vec4(at, vec2(dot(to, u_draw[0].xyz)));
}
#else
void main()
{
#ifdef GRID
	int corner = gl_VertexID % 6, cell = gl_VertexID / 6;
	ivec2 step_xy = ivec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
	ivec2 cell_xy = ivec2(cell % COLUMNS, cell / COLUMNS);
	vec2 at = vec2(cell_xy + step_xy) * (2.0 / vec2(COLUMNS, ROWS)) - 1.0;
#else
	vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
#endif
	vec3 direction = u_draw[0].xyz + u_draw[1].xyz * at.x + u_draw[2].xyz * at.y;
#ifdef GRID
	v_color = encode_srgb(min(sky_in(normalize(direction)), vec3(0.93)));
#else
	v_direction = direction;
#endif
	gl_Position = vec4(at, 1.0, 1.0);
}
#endif
