#include "mesoshell/realize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <glm/gtc/matrix_access.hpp>

#include "embree_scene.h"
#include "parallel.h"
#include "view_rays.h"

namespace mesoshell {
namespace {

// A triangle is split while an edge spans more than this share of the prism sideways times the share in height: the bilinear
// map bends it by a quarter of that share of the prism's change of width.
constexpr double most_bend = 0.01;

// Where the top has other UVs than the base, a straight edge in texture space is bent in the prism's weights: it is split
// until its middle is off by no more than this.
constexpr double most_off = 1e-3;

// Copies of the tile in one prism; more would take memory without end.
constexpr double most_copies = 4096.0;

// Barycentric weights in the prism's triangle, and height.
struct Point {
    std::array<double, 3> weight;
    double w;
};

Point between(const Point& a, const Point& b, double share)
{
    Point p;
    for (int i = 0; i < 3; ++i) {
        p.weight[i] = a.weight[i] + (b.weight[i] - a.weight[i]) * share;
    }
    p.w = a.w + (b.w - a.w) * share;
    return p;
}

using Polygon = std::vector<Point>;

// The part where weight `i` is not negative.
Polygon clip(const Polygon& polygon, int i)
{
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point& a = polygon[k];
        const Point& b = polygon[(k + 1) % polygon.size()];
        if (a.weight[i] >= 0.0) {
            kept.push_back(a);
        }
        if ((a.weight[i] >= 0.0) != (b.weight[i] >= 0.0)) {
            kept.push_back(between(a, b, a.weight[i] / (a.weight[i] - b.weight[i])));
        }
    }
    return kept;
}

double cross(const glm::dvec2& a, const glm::dvec2& b)
{
    return a.x * b.y - a.y * b.x;
}

class PrismWarp {
public:
    PrismWarp(const PrismTexels& texels, std::vector<glm::vec3>& out) : out_(out)
    {
        for (int i = 0; i < 3; ++i) {
            base_[i] = glm::dvec3(texels[i]);
            top_[i] = glm::dvec3(texels[i + 3]);
            uv_[i] = glm::dvec2(texels[i].w, texels[6][i]);
            uv_top_[i] = glm::dvec2(texels[i + 3].w, texels[6 + (i + 3) / 4][(i + 3) % 4]);
        }
        const glm::dvec2 e1 = uv_[1] - uv_[0];
        const glm::dvec2 e2 = uv_[2] - uv_[0];
        area_ = e1.x * e2.y - e1.y * e2.x;
        upright_ = uv_ == uv_top_;
    }

    bool covers_texture() const { return area_ != 0.0 || !upright_; }
    glm::dvec2 lower() const
    {
        const glm::dvec2 base = glm::min(uv_[0], glm::min(uv_[1], uv_[2]));
        return upright_ ? base : glm::min(base, glm::min(uv_top_[0], glm::min(uv_top_[1], uv_top_[2])));
    }
    glm::dvec2 upper() const
    {
        const glm::dvec2 base = glm::max(uv_[0], glm::max(uv_[1], uv_[2]));
        return upright_ ? base : glm::max(base, glm::max(uv_top_[0], glm::max(uv_top_[1], uv_top_[2])));
    }

    // Whether the UVs turn over or lose their area between base and top: twice their signed area is quadratic in the height.
    bool turns_over() const
    {
        if (upright_) {
            return false;
        }
        const double top = cross(uv_top_[1] - uv_top_[0], uv_top_[2] - uv_top_[0]);
        const double middle = cross(uv_at(1, 0.5) - uv_at(0, 0.5), uv_at(2, 0.5) - uv_at(0, 0.5));
        const double square = 2.0 * (area_ + top) - 4.0 * middle;
        const double linear = top - area_ - square;
        const double extreme = -linear / (2.0 * square);
        const bool inside = extreme > 0.0 && extreme < 1.0;
        return !(area_ * top > 0.0) || (inside && !(area_ * (area_ + (linear + square * extreme) * extreme) > 0.0));
    }

    // A triangle of texture space.
    void add(const std::array<glm::dvec3, 3>& corners)
    {
        if (!upright_) {
            add_bent(corners);
            return;
        }
        Polygon polygon;
        for (const glm::dvec3& c : corners) {
            const glm::dvec2 e1 = uv_[1] - uv_[0];
            const glm::dvec2 e2 = uv_[2] - uv_[0];
            const glm::dvec2 p = glm::dvec2(c) - uv_[0];
            const double b1 = (p.x * e2.y - p.y * e2.x) / area_;
            const double b2 = (e1.x * p.y - e1.y * p.x) / area_;
            polygon.push_back({{1.0 - b1 - b2, b1, b2}, c.z});
        }
        clip_and_emit(polygon);
    }

private:
    void clip_and_emit(Polygon polygon)
    {
        for (int i = 0; i < 3 && !polygon.empty(); ++i) {
            polygon = clip(polygon, i);
        }
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            emit(polygon[0], polygon[k - 1], polygon[k], 0);
        }
    }

    // Clipped to the rectangle of the prism's UVs at all heights, outside of which weights may be without bounds.
    void add_bent(const std::array<glm::dvec3, 3>& corners)
    {
        std::vector<glm::dvec3> polygon(corners.begin(), corners.end());
        for (int side = 0; side < 4; ++side) {
            const int axis = side / 2;
            const double sign = side % 2 == 0 ? 1.0 : -1.0;
            const double bound = side % 2 == 0 ? lower()[axis] : upper()[axis];
            std::vector<glm::dvec3> kept;
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                const glm::dvec3& a = polygon[k];
                const glm::dvec3& b = polygon[(k + 1) % polygon.size()];
                const double inside_a = sign * (a[axis] - bound);
                const double inside_b = sign * (b[axis] - bound);
                if (inside_a >= 0.0) {
                    kept.push_back(a);
                }
                if ((inside_a >= 0.0) != (inside_b >= 0.0)) {
                    kept.push_back(glm::mix(a, b, inside_a / (inside_a - inside_b)));
                }
            }
            polygon.swap(kept);
        }
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            straighten({polygon[0], polygon[k - 1], polygon[k]}, 0);
        }
    }

    glm::dvec2 uv_at(int corner, double w) const { return uv_[corner] * (1.0 - w) + uv_top_[corner] * w; }

    // The prism coordinates of a texture position: at its height, UVs are linear in the weights.
    Point point_of(const glm::dvec3& texture) const
    {
        const glm::dvec2 origin = uv_at(0, texture.z);
        const glm::dvec2 e1 = uv_at(1, texture.z) - origin;
        const glm::dvec2 e2 = uv_at(2, texture.z) - origin;
        const glm::dvec2 p = glm::dvec2(texture) - origin;
        const double area = cross(e1, e2);
        const double b1 = cross(p, e2) / area;
        const double b2 = cross(e1, p) / area;
        return {{1.0 - b1 - b2, b1, b2}, texture.z};
    }

    void straighten(const std::array<glm::dvec3, 3>& corners, int depth)
    {
        const Polygon points{point_of(corners[0]), point_of(corners[1]), point_of(corners[2])};
        double worst = 0.0;
        int split = 0;
        for (int i = 0; i < 3; ++i) {
            const Point exact = point_of((corners[i] + corners[(i + 1) % 3]) * 0.5);
            const Point straight = between(points[i], points[(i + 1) % 3], 0.5);
            for (int k = 0; k < 3; ++k) {
                const double off = std::abs(exact.weight[k] - straight.weight[k]);
                if (off > worst) {
                    worst = off;
                    split = i;
                }
            }
        }
        for (int k = 0; k < 3; ++k) {
            const double most = std::max(points[0].weight[k], std::max(points[1].weight[k], points[2].weight[k]));
            if (most < -2.0 * worst) {  // bent as it is, it stays beyond this fin
                return;
            }
        }
        if (worst <= most_off || depth == 16) {
            clip_and_emit(points);
            return;
        }
        const glm::dvec3& a = corners[split];
        const glm::dvec3& b = corners[(split + 1) % 3];
        const glm::dvec3& c = corners[(split + 2) % 3];
        const glm::dvec3 middle = (a + b) * 0.5;
        straighten({a, middle, c}, depth + 1);
        straighten({middle, b, c}, depth + 1);
    }

    static double bend(const Point& a, const Point& b)
    {
        double sideways = 0.0;
        for (int i = 0; i < 3; ++i) {
            sideways = std::max(sideways, std::abs(a.weight[i] - b.weight[i]));
        }
        return sideways * std::abs(a.w - b.w);
    }

    glm::vec3 map(const Point& p) const
    {
        glm::dvec3 position(0.0);
        for (int i = 0; i < 3; ++i) {
            position += (base_[i] * (1.0 - p.w) + top_[i] * p.w) * p.weight[i];
        }
        return glm::vec3(position);
    }

    void emit(const Point& a, const Point& b, const Point& c, int depth)
    {
        const double ab = bend(a, b);
        const double bc = bend(b, c);
        const double ca = bend(c, a);
        const double most = std::max(ab, std::max(bc, ca));
        if (most <= most_bend || depth == 16) {
            // Mirrored UVs turn the triangles over.
            out_.insert(out_.end(), {map(a), map(area_ > 0.0 ? b : c), map(area_ > 0.0 ? c : b)});
        } else if (most == ab) {
            const Point middle = between(a, b, 0.5);
            emit(a, middle, c, depth + 1);
            emit(middle, b, c, depth + 1);
        } else if (most == bc) {
            const Point middle = between(b, c, 0.5);
            emit(a, b, middle, depth + 1);
            emit(a, middle, c, depth + 1);
        } else {
            const Point middle = between(c, a, 0.5);
            emit(a, b, middle, depth + 1);
            emit(middle, b, c, depth + 1);
        }
    }

    std::vector<glm::vec3>& out_;
    std::array<glm::dvec3, 3> base_;
    std::array<glm::dvec3, 3> top_;
    std::array<glm::dvec2, 3> uv_;
    std::array<glm::dvec2, 3> uv_top_;
    double area_;   // twice that of the base's UVs, signed
    bool upright_;  // base and top have the same UVs
};

struct TextureTriangle {
    std::array<glm::dvec3, 3> corners;
    glm::dvec2 lower;
    glm::dvec2 upper;
};

std::vector<TextureTriangle> texture_triangles(const Sample& sample)
{
    std::vector<TextureTriangle> triangles;
    const glm::dvec3 scale(1.0, 1.0 / sample.aspect(), 1.0 / sample.height());
    for (const glm::uvec3& t : sample.slab_triangles()) {
        TextureTriangle triangle;
        for (int i = 0; i < 3; ++i) {
            triangle.corners[i] = glm::dvec3(sample.slab_positions()[t[i]]) * scale;
        }
        triangle.lower = glm::min(glm::dvec2(triangle.corners[0]),
                                  glm::min(glm::dvec2(triangle.corners[1]), glm::dvec2(triangle.corners[2])));
        triangle.upper = glm::max(glm::dvec2(triangle.corners[0]),
                                  glm::max(glm::dvec2(triangle.corners[1]), glm::dvec2(triangle.corners[2])));
        triangles.push_back(triangle);
    }
    return triangles;
}

void warp_into_prism(const std::vector<TextureTriangle>& triangles, const glm::dvec2& lower, const glm::dvec2& upper,
                     PrismWarp& warp, const Job& job)
{
    const glm::dvec2 first = glm::floor(warp.lower() - upper);
    const glm::dvec2 last = glm::ceil(warp.upper() - lower);
    const glm::dvec2 count = last - first + 1.0;
    if (count.x * count.y > most_copies) {
        throw InvalidArgument("the UVs of a prism span " + std::to_string(count.x) + " by " + std::to_string(count.y) +
                              " tiles; use smaller UVs or more subdivision levels");
    }
    for (int row = 0; row < static_cast<int>(count.y); ++row) {
        for (int column = 0; column < static_cast<int>(count.x) && !job.cancelled(); ++column) {
            const glm::dvec2 copy = first + glm::dvec2(column, row);
            const glm::dvec2 wanted_lower = warp.lower() - copy;
            const glm::dvec2 wanted_upper = warp.upper() - copy;
            for (const TextureTriangle& t : triangles) {
                if (t.upper.x < wanted_lower.x || t.lower.x > wanted_upper.x || t.upper.y < wanted_lower.y ||
                    t.lower.y > wanted_upper.y) {
                    continue;
                }
                const glm::dvec3 offset(copy, 0.0);
                warp.add({t.corners[0] + offset, t.corners[1] + offset, t.corners[2] + offset});
            }
        }
    }
}

}  // namespace

RealizedMesh realize(const Shell& shell, const Sample& sample, Job& job)
{
    const std::vector<TextureTriangle> triangles = texture_triangles(sample);
    glm::dvec2 lower(std::numeric_limits<double>::max());
    glm::dvec2 upper(std::numeric_limits<double>::lowest());
    for (const TextureTriangle& t : triangles) {
        lower = glm::min(lower, t.lower);
        upper = glm::max(upper, t.upper);
    }

    constexpr int prisms_per_task = 64;
    const int count = static_cast<int>(shell.prisms.size());
    const int tasks = (count + prisms_per_task - 1) / prisms_per_task;
    std::vector<std::vector<glm::vec3>> parts(static_cast<std::size_t>(tasks));
    parallel_for(job, tasks, [&](int task) {
        for (int i = task * prisms_per_task; i < std::min(count, (task + 1) * prisms_per_task); ++i) {
            PrismWarp warp(shell.prisms[static_cast<std::size_t>(i)], parts[static_cast<std::size_t>(task)]);
            if (warp.turns_over()) {
                throw InvalidArgument("the UVs of prism " + std::to_string(i) +
                                      " turn over between its base and its top; move those of the top less");
            }
            if (warp.covers_texture()) {
                warp_into_prism(triangles, lower, upper, warp, job);
            }
        }
    });
    RealizedMesh mesh;
    for (std::vector<glm::vec3>& part : parts) {
        mesh.positions.insert(mesh.positions.end(), part.begin(), part.end());
        part = {};
    }
    mesh.triangles.resize(mesh.positions.size() / 3);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        mesh.triangles[i] = glm::uvec3(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

Trace trace(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const View& view, Job& job)
{
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (std::max(triangles[i].x, std::max(triangles[i].y, triangles[i].z)) >= positions.size()) {
            throw InvalidArgument("triangle " + std::to_string(i) + " uses a vertex that does not exist; there are " +
                                  std::to_string(positions.size()));
        }
    }
    const ViewRays rays(view);
    const TriangleScene scene(positions, triangles);
    const std::size_t pixels = static_cast<std::size_t>(view.size.x) * view.size.y;
    Trace picture;
    picture.size = view.size;
    picture.hit.assign(pixels, 0);
    picture.distance.assign(pixels, std::numeric_limits<float>::infinity());
    picture.normal.assign(pixels, glm::vec3(0.0f));
    const glm::dvec4 near_row = glm::row(view.clip_from_object, 2) + glm::row(view.clip_from_object, 3);
    parallel_for(job, view.size.y, [&](int y) {
        for (int x = 0; x < view.size.x; ++x) {
            const PixelRay ray = rays.at(x, y);
            // The near plane is where clip z + w is 0.
            const double at_origin = glm::dot(near_row, glm::dvec4(ray.origin, 1.0));
            const double along = glm::dot(near_row, glm::dvec4(ray.dir, 0.0));
            const float tnear = static_cast<float>(std::max(-at_origin / along, 0.0));
            const TriangleHit hit =
                scene.intersect1(ray.origin, ray.dir, tnear, std::numeric_limits<float>::infinity());
            if (hit.hit) {
                const std::size_t pixel = static_cast<std::size_t>(y) * view.size.x + x;
                picture.hit[pixel] = 1;
                picture.distance[pixel] = hit.t;
                picture.normal[pixel] = glm::normalize(hit.normal);
            }
        }
    });
    return picture;
}

}  // namespace mesoshell
