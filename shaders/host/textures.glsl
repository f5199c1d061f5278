// The fetches of lib/ from a map's textures. Filtering is trilinear and clamps to the edge; periodic axes carry one repeated
// node at their end.

// Layers of a group of four terms.
float stack_layers(float azimuths)
{
    return azimuths > 0.0f ? azimuths + 1.0f : 1.0f;
}

vec4 fetch_gdm_weights(vec3 node, int group)
{
    float layers = stack_layers(params.gdm_directions.y);
    vec3 size = vec3(params.gdm_nodes.x + 1.0f, params.gdm_nodes.y + 1.0f, params.gdm_nodes.w * layers);
    vec3 stacked = vec3(node.x, node.y, node.z + float(group) * layers);
    return textureLod(gdm_weights, (stacked + 0.5f) / size, 0.0f);
}

vec4 fetch_gdm_eigenmaps(vec3 node, int group)
{
    float layers = stack_layers(params.gdm_directions.z);
    vec3 size = vec3(params.gdm_nodes.z, params.gdm_directions.x, params.gdm_nodes.w * layers);
    vec3 stacked = vec3(node.x, node.y, node.z + float(group) * layers);
    return textureLod(gdm_eigenmaps, (stacked + 0.5f) / size, 0.0f);
}

float fetch_sdf(vec3 node)
{
    vec3 size = vec3(params.sdf_nodes.x + 1.0f, params.sdf_nodes.y + 1.0f, params.sdf_nodes.z);
    return textureLod(sdf_volume, (node + 0.5f) / size, 0.0f).x;
}

float fetch_density(vec3 node)
{
    vec3 size = vec3(params.sdf_nodes.x + 1.0f, params.sdf_nodes.y + 1.0f, params.sdf_nodes.z);
    return textureLod(density_volume, (node + 0.5f) / size, 0.0f).x;
}

vec4 fetch_facets(vec3 texel)
{
    return texelFetch(facet_volume, ivec3(texel), 0);
}
