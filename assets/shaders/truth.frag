// A number and a position instead of a colour; see truth.vert.
in highp vec3 v_from_eye;

uniform highp vec4 u_draw[6];

layout(location = 0) out mediump vec4 o_color;
layout(location = 1) out highp uvec4 o_truth; // the number, then the bits of the position from the eye

void main()
{
	o_color = vec4(0.0);
	o_truth = uvec4(uint(u_draw[5].x) + (uint(u_draw[5].y) << 16), floatBitsToUint(v_from_eye));
}
