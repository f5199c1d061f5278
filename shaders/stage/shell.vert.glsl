// One vertex: a corner of a prism, fetched with the whole prism from the prism table.
#include "../host/prism_table.glsl"

void main()
{
    int prism = int(corner) / 6;
    prism_texel_0 = fetch_prism_texel(prism, 0);
    prism_texel_1 = fetch_prism_texel(prism, 1);
    prism_texel_2 = fetch_prism_texel(prism, 2);
    prism_texel_3 = fetch_prism_texel(prism, 3);
    prism_texel_4 = fetch_prism_texel(prism, 4);
    prism_texel_5 = fetch_prism_texel(prism, 5);
    prism_texel_6 = fetch_prism_texel(prism, 6);
    prism_texel_7 = fetch_prism_texel(prism, 7);
    pos_object = fetch_prism_texel(prism, int(corner) % 6).xyz;
    gl_Position = clip_from_object * vec4(pos_object, 1.0f);
    // The far side of a hull may lie beyond the far plane while the mesostructure does not: a hit's own depth decides.
    gl_Position.z = min(gl_Position.z, gl_Position.w);
}
