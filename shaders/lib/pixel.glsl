// From the uniform block to a pixel: what the fragment stage and the reference renderer both do with a prism and a ray.
#ifndef MESOSHELL_LIB_PIXEL
#define MESOSHELL_LIB_PIXEL

#include "shade.glsl"
#include "shell_hit.glsl"

// What a pixel holds: mode.y of the uniform block.
const int OUTPUT_COLOR = 0;
const int OUTPUT_TEXTURE = 1;  // texture coordinate and distance from the eye
const int OUTPUT_NORMAL = 2;   // object-space normal and texture fetches

Tile tile_of(ShellParams p)
{
    Tile tile;
    tile.scale = vec3(1.0f, p.tile.y, p.tile.x);
    tile.gdm_nodes = vec3(p.gdm_nodes.x, p.gdm_nodes.y, p.gdm_nodes.z);
    tile.gdm_polar = p.gdm_directions.x;
    tile.gdm_azimuths = vec2(p.gdm_directions.y, p.gdm_directions.z);
    tile.gdm_groups = int(p.gdm_nodes.w);
    tile.gdm_shares = p.tile.z > 0.5f;
    tile.sdf_nodes = vec3(p.sdf_nodes.x, p.sdf_nodes.y, p.sdf_nodes.z);
    tile.facet_cells = vec3(p.facet_cells.x, p.facet_cells.y, p.facet_cells.z);
    return tile;
}

Tolerance tolerance_of(ShellParams p)
{
    Tolerance tolerance;
    float voxel = 1.0f / p.sdf_nodes.x;
    tolerance.gdm_hit = p.tolerance.x * voxel;
    tolerance.sdf_hit = p.tolerance.y * voxel;
    tolerance.sdf_steps = int(p.tolerance.z);
    float layers = p.tolerance.w >= 2.0f ? p.tolerance.w : p.sdf_nodes.z;
    tolerance.slice_layers = int(clamp(layers, 2.0f, 4096.0f));
    return tolerance;
}

// A point on the line of sight through pos_object, and its unit direction. The eye is homogeneous: a point for a
// perspective view, minus the view direction for an orthographic one.
vec3 ray_origin(vec4 eye_object, vec3 pos_object)
{
    return eye_object.w == 0.0f ? pos_object : vec3(eye_object.x, eye_object.y, eye_object.z);
}

vec3 ray_direction(vec4 eye_object, vec3 pos_object)
{
    return normalize(pos_object * eye_object.w - vec3(eye_object.x, eye_object.y, eye_object.z));
}

// Ray parameter where the ray crosses the near plane, clip z = -w.
float ray_near(mat4 clip_from_object, vec3 origin, vec3 dir)
{
    vec4 at_origin = clip_from_object * vec4(origin, 1.0f);
    vec4 along = clip_from_object * vec4(dir, 0.0f);
    return -(at_origin.z + at_origin.w) / (along.z + along.w);
}

// Depth in [0, 1] as a depth buffer holds it; beyond 1 past the far plane.
float window_depth(mat4 clip_from_object, vec3 pos_object)
{
    vec4 clip = clip_from_object * vec4(pos_object, 1.0f);
    return 0.5f * clip.z / clip.w + 0.5f;
}

// Object-space length from the eye (perspective) or from the near plane (orthographic).
float seen_distance(vec4 eye_object, float t, float t_near)
{
    return eye_object.w == 0.0f ? t - t_near : t;
}

vec3 hit_color(ShellParams p, vec3 normal_object)
{
    vec4 normal = p.world_from_object_normal * vec4(normal_object, 0.0f);
    vec3 normal_world = normalize(vec3(normal.x, normal.y, normal.z));
    vec3 to_light = normalize(vec3(p.light_world.x, p.light_world.y, p.light_world.z));
    return shade_lambert(vec3(p.base_color.x, p.base_color.y, p.base_color.z), normal_world, to_light,
                         vec3(p.light_color.x, p.light_color.y, p.light_color.z),
                         vec3(p.ambient_color.x, p.ambient_color.y, p.ambient_color.z));
}

#endif
