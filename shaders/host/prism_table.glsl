// The prism table as a texture, and a prism as it travels from the vertex stage to the fragments.

vec4 fetch_prism_texel(int prism, int texel)
{
    int prisms_per_row = 256;
    return texelFetch(prism_table, ivec2((prism % prisms_per_row) * 8 + texel, prism / prisms_per_row), 0);
}
