// The lie of the land, at the end of the depth range: seen where nothing else is.
layout(location = 0) in highp vec3 a_from_eye; // m

// 0 to 3: clip from eye-relative metres, by column
uniform highp vec4 u_draw[4];

out mediump vec3 v_color;

const vec3 TONE = vec3(0.54, 0.55, 0.50); // streets, yards and green together, encoded

void main()
{
	gl_Position = mat4(u_draw[0], u_draw[1], u_draw[2], u_draw[3]) * vec4(a_from_eye, 1.0);
	gl_Position.z = gl_Position.w;
	vec4 between = air(a_from_eye, length(a_from_eye));
	v_color = TONE * encode_srgb(light_on(vec3(0.0, 0.0, 1.0), KIND_GROUND, 0.8)) * between.w + between.rgb;
}
