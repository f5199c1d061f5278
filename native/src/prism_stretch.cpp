#include "prism_stretch.h"

#include <algorithm>
#include <cmath>

namespace mesoshell {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b)
{
    return a.x * b.y - a.y * b.x;
}

// Gauss-Legendre on [0, 1], exact to the fifth degree.
const double far_node = 0.5 * std::sqrt(0.6);
const std::array<std::array<double, 2>, 3> nodes{
    {{0.5 - far_node, 5.0 / 18.0}, {0.5, 8.0 / 18.0}, {0.5 + far_node, 5.0 / 18.0}}};

}  // namespace

// All that a prism has at one height. dP/du and dP/dv are the same all over it; dP/dw is linear in the barycentric weights,
// and so is the volume that a step in them spans: integrals of weights over a triangle, products of three of them at most,
// are known.
struct PrismStretch::Level {
    double w;
    glm::dmat2x3 axes;                      // dP/du, dP/dv
    std::array<glm::dvec2, 3> gradients;    // of the barycentric weights, by (u, v)
    std::array<glm::dvec3, 3> up;           // dP/dw at the corners
    std::array<double, 3> spans;            // |dP/dq1 x dP/dq2 . dP/dw| at the corners
    double area;                            // twice that of the UVs, signed

    double span() const { return spans[0] + spans[1] + spans[2]; }
    double volume() const { return span() / 6.0; }
    glm::dvec3 up_sum() const { return up[0] + up[1] + up[2]; }

    // The integral over the triangle of |dP/dw|^2: that of a product of three weights i, j, k is
    // (1 + [i = j] + [j = k] + [i = k] + 2 [i = j = k]) / 120.
    double squared_up() const
    {
        const glm::dvec3 sum = up_sum();
        double squares = glm::dot(sum, sum);
        double rest = 0.0;
        for (int i = 0; i < 3; ++i) {
            squares += glm::dot(up[i], up[i]);
            rest += 2.0 * spans[i] * (glm::dot(sum, up[i]) + glm::dot(up[i], up[i]));
        }
        return (squares * span() + rest) / 120.0;
    }

    // Its derivative by up[j].
    std::array<glm::dvec3, 3> squared_up_slope() const
    {
        const glm::dvec3 sum = up_sum();
        const glm::dvec3 weighted = up[0] * spans[0] + up[1] * spans[1] + up[2] * spans[2];
        std::array<glm::dvec3, 3> slope;
        for (int j = 0; j < 3; ++j) {
            slope[j] = (sum * span() + up[j] * span() + weighted + sum * spans[j] + up[j] * (2.0 * spans[j])) / 60.0;
        }
        return slope;
    }
};

PrismStretch::PrismStretch(const Shell& shell, std::size_t prism)
{
    const glm::uvec3& vertices = shell.topology->triangles[prism];
    const glm::uvec3& uvs = shell.topology->uv_triangles[prism];
    const std::vector<glm::vec2>& top_uvs = shell.top_uvs.empty() ? shell.topology->uvs : shell.top_uvs;
    for (int i = 0; i < 3; ++i) {
        base_[i] = glm::dvec3(shell.base(vertices[i]));
        rise_[i] = glm::dvec3(shell.top(vertices[i])) - base_[i];
        uv_base_[i] = glm::dvec2(shell.topology->uvs[uvs[i]]);
        uv_rise_[i] = glm::dvec2(top_uvs[uvs[i]]) - uv_base_[i];
    }
}

void PrismStretch::set_top(const std::array<glm::vec2, 3>& top)
{
    for (int i = 0; i < 3; ++i) {
        uv_rise_[i] = glm::dvec2(top[i]) - uv_base_[i];
    }
}

double PrismStretch::area(double w) const
{
    const glm::dvec2 origin = uv_base_[0] + uv_rise_[0] * w;
    return cross(uv_base_[1] + uv_rise_[1] * w - origin, uv_base_[2] + uv_rise_[2] * w - origin);
}

bool PrismStretch::keeps_winding() const
{
    const glm::dvec2 e1 = uv_base_[1] - uv_base_[0];
    const glm::dvec2 e2 = uv_base_[2] - uv_base_[0];
    const glm::dvec2 f1 = uv_rise_[1] - uv_rise_[0];
    const glm::dvec2 f2 = uv_rise_[2] - uv_rise_[0];
    const double at_base = cross(e1, e2);
    const double at_top = area(1.0);
    if (!(at_base * at_top > 0.0)) {
        return false;
    }
    const double square = cross(f1, f2);
    const double linear = cross(e1, f2) + cross(f1, e2);
    const double extreme = -linear / (2.0 * square);
    return !(extreme > 0.0 && extreme < 1.0) || (at_base + (linear + square * extreme) * extreme) * at_base > 0.0;
}

PrismStretch::Level PrismStretch::level(double w) const
{
    const glm::dvec3 p0 = base_[0] + rise_[0] * w;
    const glm::dvec3 p1 = base_[1] + rise_[1] * w - p0;
    const glm::dvec3 p2 = base_[2] + rise_[2] * w - p0;
    const glm::dvec2 t0 = uv_base_[0] + uv_rise_[0] * w;
    const glm::dvec2 t1 = uv_base_[1] + uv_rise_[1] * w - t0;
    const glm::dvec2 t2 = uv_base_[2] + uv_rise_[2] * w - t0;
    Level level;
    level.w = w;
    level.area = cross(t1, t2);
    level.gradients[1] = glm::dvec2(t2.y, -t2.x) / level.area;
    level.gradients[2] = glm::dvec2(-t1.y, t1.x) / level.area;
    level.gradients[0] = -level.gradients[1] - level.gradients[2];
    level.axes[0] = p1 * level.gradients[1].x + p2 * level.gradients[2].x;
    level.axes[1] = p1 * level.gradients[1].y + p2 * level.gradients[2].y;
    const glm::dvec3 normal = glm::cross(p1, p2);
    for (int i = 0; i < 3; ++i) {
        level.up[i] = rise_[i] - level.axes * uv_rise_[i];
        level.spans[i] = std::abs(glm::dot(normal, rise_[i]));
    }
    return level;
}

glm::dmat2x3 PrismStretch::axes(double w) const
{
    return level(w).axes;
}

StretchIntegrals PrismStretch::integrals() const
{
    StretchIntegrals sums;
    for (const auto& [w, weight] : nodes) {
        const Level here = level(w);
        const double volume = weight * here.volume();
        sums.u += volume * glm::dot(here.axes[0], here.axes[0]);
        sums.v += volume * glm::dot(here.axes[1], here.axes[1]);
        sums.w += weight * here.squared_up();
        sums.volume += volume;
        sums.tiles += weight * 0.5 * std::abs(here.area);
    }
    return sums;
}

StretchSlope PrismStretch::slope(double inverse_aspect_2, double inverse_height_2) const
{
    StretchSlope slope;
    for (const auto& [w, weight] : nodes) {
        const Level here = level(w);
        const glm::dmat2 gram = glm::transpose(here.axes) * here.axes;
        const glm::dmat2 metric(1.0, 0.0, 0.0, inverse_aspect_2);
        const std::array<glm::dvec3, 3> by_up = here.squared_up_slope();
        // A rise r_i turns the axes U by -w (U r_i) g_i^T, g_i the gradient of weight i, and dP/dw at corner j by minus that
        // times r_j, less U r_i at j = i.
        glm::dmat2x3 all_up(0.0);  // the sum over j of the slope by dP/dw at corner j, times r_j^T
        for (int j = 0; j < 3; ++j) {
            all_up += glm::outerProduct(by_up[j], uv_rise_[j]);
        }
        const double volume = here.volume();
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 flat = gram * (metric * here.gradients[i]) * (-2.0 * w * volume);
            const glm::dvec3 along = all_up * here.gradients[i] * w - by_up[i];
            const glm::dvec2 tall = glm::transpose(here.axes) * along;
            slope.sum[i] += weight * (flat + tall * inverse_height_2);
            slope.tiles[i] += weight * 0.5 * std::abs(here.area) * w * here.gradients[i];
            // Gauss and Newton: what the changes of axes and of dP/dw, squared, add. The axes also bend themselves, twice as
            // much.
            const int next = (i + 1) % 3;
            const auto bend = [&](int j) {
                const double steep = 4.0 * w * w * volume * glm::dot(here.gradients[i], metric * here.gradients[j]);
                const double alike = i == j ? here.span() + 2.0 * here.spans[i] : 0.0;
                const double upright = here.span() + here.spans[i] + here.spans[j] + alike;
                return glm::mat2(gram * (weight * (steep + upright * inverse_height_2 / 60.0)));
            };
            slope.bend[i] += bend(i);
            slope.bend_next[i] += bend(next);
        }
    }
    return slope;
}

}  // namespace mesoshell
