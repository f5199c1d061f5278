// What a baked tile is to the traversals: its measures, its grids, and lookups in them.
//
// GDM paper, section 4.1: d(x, y, z, theta, phi) = sum over i of W_i(x, y, phi) E_i(theta, z). Interpolating W and E each on its
// own grid interpolates their product in all five dimensions. Another layout has the azimuth in E: W_i(x, y) E_i(phi, theta, z).
#ifndef MESOSHELL_LIB_TILE
#define MESOSHELL_LIB_TILE

struct Tile {
    vec3 scale;          // metric texture space = texture space * scale = (1, aspect, height)
    vec3 gdm_nodes;      // nx, ny, nz
    float gdm_polar;     // ntheta
    vec2 gdm_azimuths;   // nphi along the weights, along the eigenmaps; 0 where they have no such axis
    int gdm_groups;      // SVD terms / 4, rounded up
    bool gdm_shares;     // terms sum to shares of the distance to the end of the slab
    vec3 sdf_nodes;      // nodes of the distance field and of the density along u, v, w
    vec3 facet_cells;    // cells of the facets along u, v, w; 0: there are none
};

// The host defines these. Node coordinates: x and y in [0, n], the last node repeating the first; phi in [0, nphi] likewise;
// z, theta in [0, n - 1]. Nodes are (x, y, phi) and (z, theta, phi), phi 0 where the array has no such axis. Four SVD terms come
// back at once.
vec4 fetch_gdm_weights(vec3 node, int group);
vec4 fetch_gdm_eigenmaps(vec3 node, int group);
float fetch_sdf(vec3 node);
// The solid's share of the voxel around a node, in [0, 1]: 1/2 - distance / voxel at the nodes, in steps of 1/256.
float fetch_density(vec3 node);
// A texel of the facets (facets.glsl), bit for bit: not filtered.
vec4 fetch_facets(vec3 texel);

const float TWO_PI = 6.28318530718f;
const float PI = 3.14159265359f;
const float HORIZON_DISTANCE = 16.0f; // tile widths: where rays end that never leave the slab, or far away

// (theta, phi) of a unit vector: theta from +w in [0, pi], phi from +u toward +v in [0, 2 pi).
vec2 direction_angles(vec3 dir)
{
    float theta = acos(clamp(dir.z, -1.0f, 1.0f));
    float phi = 0.0f;
    if (dir.x != 0.0f || dir.y != 0.0f) {
        phi = atan(dir.y, dir.x);
    }
    if (phi < 0.0f) {
        phi += TWO_PI;
    }
    return vec2(theta, phi);
}

// Distance in tile widths from height z to where a unit direction leaves the slab.
float slab_distance(float z, float dir_z, float height)
{
    if (abs(dir_z) < 1.0e-6f) {
        return HORIZON_DISTANCE;
    }
    return min(dir_z > 0.0f ? (height - z) / dir_z : z / -dir_z, HORIZON_DISTANCE);
}

// Distance in tile widths from a point of texture space along a unit direction of metric texture space.
float lookup_gdm(Tile tile, vec3 pos_texture, vec3 dir_metric)
{
    vec2 angles = direction_angles(dir_metric);
    float height = clamp(pos_texture.z, 0.0f, 1.0f);
    float turn = angles.y / TWO_PI;
    vec3 weight_node = vec3(fract(pos_texture.x) * tile.gdm_nodes.x, fract(pos_texture.y) * tile.gdm_nodes.y,
                            turn * tile.gdm_azimuths.x);
    vec3 eigen_node = vec3(height * (tile.gdm_nodes.z - 1.0f), angles.x / PI * (tile.gdm_polar - 1.0f),
                           turn * tile.gdm_azimuths.y);
    float sum = 0.0f;
    for (int group = 0; group < tile.gdm_groups; ++group) {
        sum += dot(fetch_gdm_weights(weight_node, group), fetch_gdm_eigenmaps(eigen_node, group));
    }
    if (tile.gdm_shares) {
        sum *= slab_distance(height * tile.scale.z, dir_metric.z, tile.scale.z);
    }
    return max(sum, 0.0f);
}

// Signed distance in tile widths, negative inside.
float lookup_sdf(Tile tile, vec3 pos_texture)
{
    return fetch_sdf(vec3(fract(pos_texture.x) * tile.sdf_nodes.x, fract(pos_texture.y) * tile.sdf_nodes.y,
                          clamp(pos_texture.z, 0.0f, 1.0f) * (tile.sdf_nodes.z - 1.0f)));
}

// The solid's share around a point of texture space; its surface is where that is 1/2.
float lookup_density(Tile tile, vec3 pos_texture)
{
    return fetch_density(vec3(fract(pos_texture.x) * tile.sdf_nodes.x, fract(pos_texture.y) * tile.sdf_nodes.y,
                              clamp(pos_texture.z, 0.0f, 1.0f) * (tile.sdf_nodes.z - 1.0f)));
}

// Gradient of the distance field in metric texture space, by central differences over one voxel.
vec3 sdf_gradient(Tile tile, vec3 pos_texture)
{
    vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        vec3 offset = vec3(0.0f);
        offset[axis] = 0.5f / tile.sdf_nodes.x / tile.scale[axis];
        gradient[axis] = lookup_sdf(tile, pos_texture + offset) - lookup_sdf(tile, pos_texture - offset);
    }
    return gradient;
}

#endif
