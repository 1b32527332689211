// The city's geometry for measuring, placed as city.vert places it: what is seen in each pixel, and where.
layout(location = 0) in highp vec3 a_position_mm; // from the chunk's origin

// 0: chunk's origin from the eye, mm
// 1 to 4: clip from eye-relative mm, by column
// 5: xy number of what is drawn, its low and its high 16 bits
uniform highp vec4 u_draw[6];

out highp vec3 v_from_eye; // m

void main()
{
	vec3 at_mm = a_position_mm + u_draw[0].xyz;
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(at_mm, 1.0);
	v_from_eye = at_mm * 0.001;
}
