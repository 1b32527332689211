// An impostor for measuring, placed as impostor.vert places it.
layout(location = 0) in highp vec3 a_position_mm; // from the cell's origin
layout(location = 1) in highp vec2 a_uv;          // 1/128 texel of the page
layout(location = 2) in highp vec2 a_page_code;   // page; capture view + 32 kind

// 0: the cell's origin from the eye, mm; w first layer of its pages
// 1 to 4: clip from eye-relative mm, by column
// 5: x first layer of its truth
uniform highp vec4 u_draw[6];

layout(std140) uniform Impostor {
	highp vec4 axis[32];
};

out highp vec3 v_uvz;
flat out highp float v_page;

void main()
{
	gl_Position = mat4(u_draw[1], u_draw[2], u_draw[3], u_draw[4]) * vec4(a_position_mm + u_draw[0].xyz, 1.0);
	float kind = floor(a_page_code.y * (1.0 / 32.0) + 0.001);
	vec4 view = axis[int(a_page_code.y - kind * 32.0 + 0.5)];
	float z = dot(view.xyz, a_position_mm * 0.001) + view.w;
	v_uvz = vec3(a_uv * (z / 32768.0), z);
	v_page = a_page_code.x;
}
