#include "meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace mesoshell {
namespace {

// Quads (columns x rows) over vertices (columns + 1) x (rows + 1), the first at `first`, facing the side from which
// column to row turns counterclockwise.
void add_sheet(Mesh& mesh, std::uint32_t first, int columns, int rows, bool reversed)
{
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const std::uint32_t a = first + static_cast<std::uint32_t>(j * (columns + 1) + i);
            const std::uint32_t b = a + 1;
            const std::uint32_t c = b + static_cast<std::uint32_t>(columns + 1);
            const std::uint32_t d = c - 1;
            if (reversed) {
                mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {a, d, c}});
            } else {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
            }
        }
    }
}

// A sheet z = z_at(share of the period along x).
template <typename Height>
void add_height_sheet(Mesh& mesh, float start, float aspect, int columns, int rows, bool faces_down, const Height& z_at)
{
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const float share = static_cast<float>(i) / static_cast<float>(columns);
            mesh.positions.emplace_back(start + share, aspect * static_cast<float>(j) / static_cast<float>(rows),
                                        z_at(share));
        }
    }
    add_sheet(mesh, first, columns, rows, faces_down);
}

}  // namespace

Mesh merged(const Mesh& a, const Mesh& b)
{
    Mesh both = a;
    const auto offset = static_cast<std::uint32_t>(a.positions.size());
    both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
    for (const glm::uvec3& t : b.triangles) {
        both.triangles.push_back(t + offset);
    }
    return both;
}

Mesh moved(Mesh mesh, const glm::vec3& offset)
{
    for (glm::vec3& p : mesh.positions) {
        p += offset;
    }
    return mesh;
}

Mesh flipped(Mesh mesh)
{
    for (glm::uvec3& t : mesh.triangles) {
        std::swap(t.y, t.z);
    }
    return mesh;
}

Mesh snapped(Mesh mesh)
{
    for (glm::vec3& p : mesh.positions) {
        p = glm::round(p * 4096.0f) / 4096.0f;
    }
    return mesh;
}

Mesh sphere(const glm::vec3& center, float radius, int rings, int segments)
{
    Mesh mesh;
    mesh.positions.push_back(center + glm::vec3(0.0f, 0.0f, radius));
    for (int ring = 1; ring < rings; ++ring) {
        const double polar = std::numbers::pi * ring / rings;
        for (int segment = 0; segment < segments; ++segment) {
            const double azimuth = 2.0 * std::numbers::pi * segment / segments;
            const glm::dvec3 out(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                 std::cos(polar));
            mesh.positions.push_back(glm::vec3(glm::dvec3(center) + static_cast<double>(radius) * out));
        }
    }
    mesh.positions.push_back(center - glm::vec3(0.0f, 0.0f, radius));
    const auto south = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    const auto at = [&](int ring, int segment) {
        return static_cast<std::uint32_t>(1 + (ring - 1) * segments + segment % segments);
    };
    for (int segment = 0; segment < segments; ++segment) {
        mesh.triangles.emplace_back(0u, at(1, segment), at(1, segment + 1));
        for (int ring = 1; ring < rings - 1; ++ring) {
            mesh.triangles.emplace_back(at(ring, segment), at(ring + 1, segment), at(ring + 1, segment + 1));
            mesh.triangles.emplace_back(at(ring, segment), at(ring + 1, segment + 1), at(ring, segment + 1));
        }
        mesh.triangles.emplace_back(south, at(rings - 1, segment + 1), at(rings - 1, segment));
    }
    return mesh;
}

double inner_radius(const Mesh& mesh, const glm::dvec3& center)
{
    double radius = std::numeric_limits<double>::infinity();
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]);
        const glm::dvec3 normal = glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
        radius = std::min(radius, glm::dot(a - center, normal) / glm::length(normal));
    }
    return radius;
}

double outer_radius(const Mesh& mesh, const glm::dvec3& center)
{
    double radius = 0.0;
    for (const glm::vec3& p : mesh.positions) {
        radius = std::max(radius, glm::length(glm::dvec3(p) - center));
    }
    return radius;
}

Mesh slab(float below, float above, float aspect, int columns, int rows)
{
    Mesh mesh;
    add_height_sheet(mesh, 0.0f, aspect, columns, rows, true, [&](float) { return below; });
    add_height_sheet(mesh, 0.0f, aspect, columns, rows, false, [&](float) { return above; });
    return mesh;
}

Mesh sawtooth(float floor, float low, float high, float start, float aspect, int columns, int rows)
{
    Mesh mesh;
    add_height_sheet(mesh, start, aspect, columns, rows, true, [&](float) { return floor; });
    add_height_sheet(mesh, start, aspect, columns, rows, false,
                     [&](float share) { return low + (high - low) * share; });
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int j = 0; j <= rows; ++j) {
        for (const float z : {high, low}) {
            mesh.positions.emplace_back(start + 1.0f, aspect * static_cast<float>(j) / static_cast<float>(rows), z);
        }
    }
    add_sheet(mesh, first, 1, rows, false);
    return mesh;
}

SurfaceMesh flat_grid(int columns, int rows, float width, float depth)
{
    SurfaceMesh mesh;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            mesh.positions.emplace_back(width * static_cast<float>(i) / static_cast<float>(columns),
                                        depth * static_cast<float>(j) / static_cast<float>(rows), 0.0f);
        }
    }
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const int a = j * (columns + 1) + i;
            mesh.face_sizes.push_back(4);
            for (const int corner : {a, a + 1, a + columns + 2, a + columns + 1}) {
                mesh.corners.push_back(corner);
                mesh.uvs.emplace_back(mesh.positions[static_cast<std::size_t>(corner)]);
            }
        }
    }
    return mesh;
}

SurfaceMesh torus(float major, float minor, int around, int along, float tiles_u, float tiles_v)
{
    SurfaceMesh mesh;
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            const double a = 2.0 * std::numbers::pi * i / around;
            const double b = 2.0 * std::numbers::pi * j / along;
            const glm::dvec3 out(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
            mesh.positions.push_back(
                glm::vec3(glm::dvec3(std::cos(a), std::sin(a), 0.0) * double(major) + out * double(minor)));
            mesh.normals.push_back(glm::vec3(out));
        }
    }
    for (int j = 0; j < along; ++j) {
        for (int i = 0; i < around; ++i) {
            mesh.face_sizes.push_back(4);
            for (const glm::ivec2 c : {glm::ivec2(i, j), {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
                mesh.corners.push_back(c.y % along * around + c.x % around);
                mesh.uvs.emplace_back(tiles_u * static_cast<float>(c.x) / static_cast<float>(around),
                                      tiles_v * static_cast<float>(c.y) / static_cast<float>(along));
            }
        }
    }
    return mesh;
}

SurfaceMesh one_triangle()
{
    SurfaceMesh mesh;
    mesh.positions = {{1, 0, 0}, {0, 2, 0}, {0, 0, 0}};
    mesh.face_sizes = {3};
    mesh.corners = {2, 0, 1};
    mesh.uvs = {{0.125f, 0.25f}, {0.5f, 0.625f}, {0.75f, 0.875f}};
    mesh.normals = {{0, 0, 2}, {0, 0, 1}, {0, 0, 0.5f}};
    return mesh;
}

SurfaceMesh cube()
{
    SurfaceMesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f);
    }
    mesh.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 1, 3, 7, 5, 3, 2, 6, 7, 2, 0, 4, 6};
    mesh.face_sizes.assign(6, 4);
    for (int face = 0; face < 6; ++face) {
        mesh.uvs.insert(mesh.uvs.end(), {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}});
    }
    return mesh;
}

SurfaceMesh octahedron()
{
    SurfaceMesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.corners = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    mesh.face_sizes.assign(8, 3);
    for (int face = 0; face < 8; ++face) {
        mesh.uvs.insert(mesh.uvs.end(), {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}});
    }
    return mesh;
}

SurfaceMesh round_octahedron(int levels)
{
    SurfaceMesh mesh = octahedron();
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [found, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.positions.size()));
            if (added) {
                mesh.positions.push_back(glm::normalize(mesh.positions[static_cast<std::size_t>(a)] +
                                                        mesh.positions[static_cast<std::size_t>(b)]));
            }
            return found->second;
        };
        std::vector<std::int32_t> finer;
        for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
            const int a = mesh.corners[i];
            const int b = mesh.corners[i + 1];
            const int c = mesh.corners[i + 2];
            const int ab = middle(a, b);
            const int bc = middle(b, c);
            const int ca = middle(c, a);
            finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
        }
        mesh.corners = finer;
    }
    mesh.face_sizes.assign(mesh.corners.size() / 3, 3);
    mesh.uvs.clear();
    for (const int corner : mesh.corners) {
        mesh.uvs.emplace_back(mesh.positions[static_cast<std::size_t>(corner)]);
    }
    return mesh;
}

}  // namespace mesoshell
