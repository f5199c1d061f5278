// Lambert under one sun and a uniform ambient light, in linear color.
#ifndef MESOSHELL_LIB_SHADE
#define MESOSHELL_LIB_SHADE

vec3 shade_lambert(vec3 base_color, vec3 normal_world, vec3 to_light_world, vec3 light_color, vec3 ambient_color)
{
    float cosine = max(dot(normal_world, to_light_world), 0.0f);
    return base_color * (ambient_color + light_color * cosine);
}

#endif
