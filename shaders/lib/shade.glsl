// Lambert under one sun and a uniform ambient light, and the sRGB encoding of the result.
#ifndef MESOSHELL_LIB_SHADE
#define MESOSHELL_LIB_SHADE

vec3 shade_lambert(vec3 base_color, vec3 normal_world, vec3 to_light_world, vec3 light_color, vec3 ambient_color)
{
    float cosine = max(dot(normal_world, to_light_world), 0.0f);
    return base_color * (ambient_color + light_color * cosine);
}

float encode_srgb_channel(float linear)
{
    float value = clamp(linear, 0.0f, 1.0f);
    return value <= 0.0031308f ? 12.92f * value : 1.055f * pow(value, 1.0f / 2.4f) - 0.055f;
}

vec3 encode_srgb(vec3 linear)
{
    return vec3(encode_srgb_channel(linear.x), encode_srgb_channel(linear.y), encode_srgb_channel(linear.z));
}

#endif
