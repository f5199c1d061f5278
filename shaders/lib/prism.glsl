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

// From the eight texels of a row of the prism table (docs/architecture.md).
Prism make_prism(vec4 base_0, vec4 base_1, vec4 base_2, vec4 top_0, vec4 top_1, vec4 top_2, vec4 v_first, vec4 v_last)
{
    Prism prism;
    prism.base[0] = vec3(base_0.x, base_0.y, base_0.z);
    prism.base[1] = vec3(base_1.x, base_1.y, base_1.z);
    prism.base[2] = vec3(base_2.x, base_2.y, base_2.z);
    prism.director[0] = vec3(top_0.x, top_0.y, top_0.z) - prism.base[0];
    prism.director[1] = vec3(top_1.x, top_1.y, top_1.z) - prism.base[1];
    prism.director[2] = vec3(top_2.x, top_2.y, top_2.z) - prism.base[2];
    prism.uv_base[0] = vec2(base_0.w, v_first.x);
    prism.uv_base[1] = vec2(base_1.w, v_first.y);
    prism.uv_base[2] = vec2(base_2.w, v_first.z);
    prism.uv_rise[0] = vec2(top_0.w, v_first.w) - prism.uv_base[0];
    prism.uv_rise[1] = vec2(top_1.w, v_last.x) - prism.uv_base[1];
    prism.uv_rise[2] = vec2(top_2.w, v_last.y) - prism.uv_base[2];
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

// The nearest place inside: what rounding took out comes back.
vec3 clamp_place(vec3 q)
{
    float q1 = max(q.x, 0.0f);
    float q2 = max(q.y, 0.0f);
    float sum = max(q1 + q2, 1.0f);
    return vec3(q1 / sum, q2 / sum, clamp(q.z, 0.0f, 1.0f));
}

// How prism coordinates change with position: rows of the inverse of the map's Jacobian, `q0` for the weight of column 0.
// All zero where the Jacobian is singular.
struct PlaceSlopes {
    vec3 q0;
    vec3 q1;
    vec3 q2;
    vec3 w;
};

PlaceSlopes place_slopes(Prism prism, vec3 q)
{
    vec3 p_q1 = (prism.base[1] - prism.base[0]) + (prism.director[1] - prism.director[0]) * q.z;
    vec3 p_q2 = (prism.base[2] - prism.base[0]) + (prism.director[2] - prism.director[0]) * q.z;
    vec3 p_w = prism.director[0] * (1.0f - q.x - q.y) + prism.director[1] * q.x + prism.director[2] * q.y;
    float volume = dot(p_q1, cross(p_q2, p_w));
    float scale = volume != 0.0f ? 1.0f / volume : 0.0f;
    PlaceSlopes slopes;
    slopes.q1 = cross(p_q2, p_w) * scale;
    slopes.q2 = cross(p_w, p_q1) * scale;
    slopes.q0 = -slopes.q1 - slopes.q2;
    slopes.w = cross(p_q1, p_q2) * scale;
    return slopes;
}

vec3 newton_step(PlaceSlopes slopes, vec3 q, vec3 residual)
{
    return q - vec3(dot(slopes.q1, residual), dot(slopes.q2, residual), dot(slopes.w, residual));
}

// The place of a point, from one nearby.
vec3 nearer_place(Prism prism, vec3 q, vec3 pos_object)
{
    return clamp_place(newton_step(place_slopes(prism, q), q, prism_position(prism, q) - pos_object));
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
