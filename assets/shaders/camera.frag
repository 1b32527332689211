/* A camera's memory to RGB: by the matrix of the picture's standard, whose fourth column is added. PACKED: Y and U V of
   two pixels in one texel; SWAPPED: chroma first. RGB: colours as they are (the matrix may swap them). EXTERNAL: a
   buffer of the device itself, which the driver converts. u_draw[6]: the last places that are the picture's, of plane 0
   and 1. */
#ifdef EXTERNAL
uniform samplerExternalOES u_plane0;
#else
uniform sampler2D u_plane0;
uniform sampler2D u_plane1;
#endif
uniform highp vec4 u_draw[7];

in highp vec2 v_luma;
in highp vec2 v_chroma;

layout(location = 0) out vec4 o_color;

void main()
{
	highp vec2 luma = min(v_luma, u_draw[6].xy), chroma = min(v_chroma, u_draw[6].zw);
#if defined(EXTERNAL) || defined(RGB)
	highp vec4 seen = vec4(texture(u_plane0, luma).rgb, 1.0);
#elif defined(SWAPPED)
	highp vec4 seen = vec4(texture(u_plane0, luma).g, texture(u_plane1, chroma).rb, 1.0);
#elif defined(PACKED)
	highp vec4 seen = vec4(texture(u_plane0, luma).r, texture(u_plane1, chroma).ga, 1.0);
#else
	highp vec4 seen = vec4(texture(u_plane0, luma).r, texture(u_plane1, chroma).rg, 1.0);
#endif
	o_color = vec4(dot(u_draw[3], seen), dot(u_draw[4], seen), dot(u_draw[5], seen), 1.0);
}
