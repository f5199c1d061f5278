// One vertex: a corner of a prism, fetched from the prism table.
#include "../lib/prism.glsl"
#include "../host/textures.glsl"

void main()
{
    prism_id = int(corner) / 6;
    int column = int(corner) % 6;
    vec4 texel = fetch_prism_texel(prism_id, column);
    pos_object = texel.xyz;
    gl_Position = clip_from_object * vec4(pos_object, 1.0f);
}
