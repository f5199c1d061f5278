// One fragment: the ray of the pixel against the mesostructure in this prism, with the hit's own depth.
// The rasterized hull only says which prisms a pixel may meet; where the ray enters and leaves is found exactly here.
#include "../lib/pixel.glsl"
#include "../host/textures.glsl"

// A host may name both ahead: a program of one traversal has none of the others' registers and branches.
#ifndef SHELL_TRAVERSAL
#define SHELL_TRAVERSAL params.mode.x
#endif
#ifndef SHELL_FINS
#define SHELL_FINS params.mode.z
#endif

void main()
{
    vec3 origin = ray_origin(params.eye_object, pos_object);
    vec3 dir = ray_direction(params.eye_object, pos_object);
    float t_near = ray_near(clip_from_object, origin, dir);
    Tile tile = tile_of(params);
    Prism prism = make_prism(prism_texel_0, prism_texel_1, prism_texel_2, prism_texel_3, prism_texel_4, prism_texel_5,
                             prism_texel_6, prism_texel_7);
    ShellHit hit = trace_prism(prism, origin, dir, t_near, SHELL_FINS, SHELL_TRAVERSAL, tile, tolerance_of(params));
    if (!hit.hit) {
        discard;
    }
    float depth = window_depth(clip_from_object, origin + dir * hit.t);
    if (depth > 1.0f) {
        discard;
    }
    gl_FragDepth = depth;

    if (params.mode.y == OUTPUT_TEXTURE) {
        frag_color = vec4(hit.pos_texture, seen_distance(params.eye_object, hit.t, t_near));
    } else {
        vec3 normal_object = hit_normal(prism, hit, params.mode.x, tile);
        if (params.mode.y == OUTPUT_NORMAL) {
            frag_color = vec4(normal_object, float(hit.fetches));
        } else {
            frag_color = vec4(hit_color(params, normal_object), 1.0f);
        }
    }
}
