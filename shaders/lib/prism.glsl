// A prism of the shell: its eight texels, its forward map from prism coordinates, and the derivative of that map.
#ifndef MESOSHELL_LIB_PRISM
#define MESOSHELL_LIB_PRISM

// Prism coordinates (q1, q2, w): barycentric weights of corner columns 1 and 2, and height; column 0 weighs 1 - q1 - q2.
// The map is linear in (q1, q2) and linear in w, so each fin is a bilinear patch that depends on its own corners alone.
struct Prism {
    vec3 base[3];      // base corners, object space
    vec3 director[3];  // top corner minus base corner, object space
    vec2 uv_base[3];   // (u, v) of the base corners, tiles
    vec2 uv_rise[3];   // (u, v) of the top corners minus that of the base corners, tiles
};

// Texel 0..7 of a prism in the prism table (docs/architecture.md); the host defines it.
vec4 fetch_prism_texel(int prism, int texel);

Prism load_prism(int index)
{
    vec4 v_first = fetch_prism_texel(index, 6);
    vec4 v_last = fetch_prism_texel(index, 7);
    float v[6];
    v[0] = v_first.x;
    v[1] = v_first.y;
    v[2] = v_first.z;
    v[3] = v_first.w;
    v[4] = v_last.x;
    v[5] = v_last.y;
    Prism prism;
    for (int i = 0; i < 3; ++i) {
        vec4 low = fetch_prism_texel(index, i);
        vec4 high = fetch_prism_texel(index, i + 3);
        prism.base[i] = vec3(low.x, low.y, low.z);
        prism.director[i] = vec3(high.x, high.y, high.z) - prism.base[i];
        prism.uv_base[i] = vec2(low.w, v[i]);
        prism.uv_rise[i] = vec2(high.w, v[i + 3]) - prism.uv_base[i];
    }
    return prism;
}

vec3 prism_position(Prism prism, vec3 q)
{
    vec3 p0 = prism.base[0] + prism.director[0] * q.z;
    vec3 p1 = prism.base[1] + prism.director[1] * q.z;
    vec3 p2 = prism.base[2] + prism.director[2] * q.z;
    return p0 + (p1 - p0) * q.x + (p2 - p0) * q.y;
}

vec3 prism_texture(Prism prism, vec3 q)
{
    vec2 t0 = prism.uv_base[0] + prism.uv_rise[0] * q.z;
    vec2 t1 = prism.uv_base[1] + prism.uv_rise[1] * q.z;
    vec2 t2 = prism.uv_base[2] + prism.uv_rise[2] * q.z;
    vec2 t = t0 + (t1 - t0) * q.x + (t2 - t0) * q.y;
    return vec3(t.x, t.y, q.z);
}

// A covector of metric texture space (the gradient of the tile's distance field) carried to object space: the inverse
// transpose of the prism map's Jacobian (survey 2014, appendix A), through prism coordinates. scale = (1, aspect, height)
// turns texture space into metric texture space. Not normalized; points the same way for mirrored maps.
vec3 prism_normal(Prism prism, vec3 q, vec3 scale, vec3 gradient_metric)
{
    vec3 p_q1 = (prism.base[1] - prism.base[0]) + (prism.director[1] - prism.director[0]) * q.z;
    vec3 p_q2 = (prism.base[2] - prism.base[0]) + (prism.director[2] - prism.director[0]) * q.z;
    vec3 p_w = prism.director[0] * (1.0f - q.x - q.y) + prism.director[1] * q.x + prism.director[2] * q.y;

    vec2 t_q1 = (prism.uv_base[1] - prism.uv_base[0]) + (prism.uv_rise[1] - prism.uv_rise[0]) * q.z;
    vec2 t_q2 = (prism.uv_base[2] - prism.uv_base[0]) + (prism.uv_rise[2] - prism.uv_rise[0]) * q.z;
    vec2 t_w = prism.uv_rise[0] * (1.0f - q.x - q.y) + prism.uv_rise[1] * q.x + prism.uv_rise[2] * q.y;

    vec3 gradient_texture = gradient_metric * scale;
    float g1 = t_q1.x * gradient_texture.x + t_q1.y * gradient_texture.y;
    float g2 = t_q2.x * gradient_texture.x + t_q2.y * gradient_texture.y;
    float g3 = t_w.x * gradient_texture.x + t_w.y * gradient_texture.y + gradient_texture.z;

    vec3 carried = cross(p_q2, p_w) * g1 + cross(p_w, p_q1) * g2 + cross(p_q1, p_q2) * g3;
    return dot(p_q1, cross(p_q2, p_w)) < 0.0f ? -carried : carried;
}

#endif
