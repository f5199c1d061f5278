#include "broken_meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <map>
#include <tuple>

namespace mesoshell {
namespace {

float within(Random& random, double low, double high)
{
    return static_cast<float>(random.uniform(low, high));
}

// A surface of columns x rows quads over (u, v) in [0, 1)^2 that closes around u, and around v if `rows_close`. Where u or v
// closes a period away, place(u + 1, v) is its copy.
template <typename Place>
Mesh closed_grid(int columns, int rows, bool rows_close, bool periodic, const Place& place)
{
    Mesh mesh;
    const int last_row = rows_close && !periodic ? rows - 1 : rows;
    const int last_column = periodic ? columns : columns - 1;
    for (int j = 0; j <= last_row; ++j) {
        for (int i = 0; i <= last_column; ++i) {
            mesh.positions.push_back(place(double(i) / columns, double(j) / rows));
        }
    }
    const auto at = [&](int i, int j) {
        return static_cast<std::uint32_t>((rows_close && !periodic ? j % rows : j) * (last_column + 1) +
                                          (periodic ? i : i % columns));
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return mesh;
}

// A box whose sides are grids of n x n quads.
Mesh fine_box(const glm::vec3& low, const glm::vec3& high, int n)
{
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (int end = 0; end < 2; ++end) {
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            for (int j = 0; j <= n; ++j) {
                for (int i = 0; i <= n; ++i) {
                    glm::vec3 share;
                    share[axis] = static_cast<float>(end);
                    share[(axis + 1) % 3] = static_cast<float>(i) / static_cast<float>(n);
                    share[(axis + 2) % 3] = static_cast<float>(j) / static_cast<float>(n);
                    mesh.positions.push_back(glm::mix(low, high, share));
                }
            }
            for (int j = 0; j < n; ++j) {
                for (int i = 0; i < n; ++i) {
                    const std::uint32_t a = first + static_cast<std::uint32_t>(j * (n + 1) + i);
                    const std::uint32_t d = a + static_cast<std::uint32_t>(n + 1);
                    glm::uvec3 t(a, a + 1, d + 1);
                    glm::uvec3 s(a, d + 1, d);
                    if (end == 0) {
                        std::swap(t.y, t.z);
                        std::swap(s.y, s.z);
                    }
                    mesh.triangles.insert(mesh.triangles.end(), {t, s});
                }
            }
        }
    }
    return mesh;
}

Mesh ring(const glm::vec3& center, float major, float minor)
{
    return closed_grid(16, 9, true, false, [&](double u, double v) {
        const double a = 2.0 * std::numbers::pi * u;
        const double b = 2.0 * std::numbers::pi * v;
        return center + glm::vec3((major + minor * std::cos(b)) * std::cos(a), (major + minor * std::cos(b)) * std::sin(a),
                                  minor * std::sin(b));
    });
}

// A strand along x (axis 0) or y (axis 1) that goes on in the next tile.
Mesh strand(int axis, float aspect, const glm::vec3& center, float radius, float wave)
{
    const double length = axis == 0 ? 1.0 : aspect;
    Mesh mesh = closed_grid(7, 12, false, false, [&](double u, double v) {
        const double a = 2.0 * std::numbers::pi * u;
        glm::vec3 p = center;
        p[axis] += static_cast<float>(length * v);
        p[1 - axis] += static_cast<float>(radius * std::cos(a));
        p.z += static_cast<float>(radius * std::sin(a) + wave * std::sin(2.0 * std::numbers::pi * v));
        return p;
    });
    return axis == 1 ? flipped(mesh) : mesh;
}

Mesh terrain(float height, float aspect, Random& random)
{
    constexpr int n = 9;
    float values[n][n];
    for (auto& row : values) {
        for (float& value : row) {
            value = height * within(random, 0.3, 0.75);
        }
    }
    return closed_grid(n, n, true, true, [&](double u, double v) {
        const int i = static_cast<int>(std::lround(u * n));
        const int j = static_cast<int>(std::lround(v * n));
        return glm::vec3(u, aspect * v, values[j % n][i % n]);
    });
}

glm::vec3 middle_of(const Mesh& mesh, const glm::uvec3& t)
{
    return (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
}

glm::uvec3 any_face(const Mesh& mesh, Random& random)
{
    return mesh.triangles[static_cast<std::size_t>(random.below(static_cast<int>(mesh.triangles.size())))];
}

template <typename Kept>
void keep_faces(Mesh& mesh, const Kept& kept)
{
    std::vector<glm::uvec3> triangles;
    for (const glm::uvec3& t : mesh.triangles) {
        if (kept(t)) {
            triangles.push_back(t);
        }
    }
    mesh.triangles = std::move(triangles);
}

void flip_some(Mesh& mesh, double share, Random& random)
{
    for (glm::uvec3& t : mesh.triangles) {
        if (random.uniform(0.0, 1.0) < share) {
            std::swap(t.y, t.z);
        }
    }
}

void double_some(Mesh& mesh, double share, Random& random)
{
    const std::size_t count = mesh.triangles.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (random.uniform(0.0, 1.0) < share) {
            glm::uvec3 t = mesh.triangles[i];
            if (random.below(2) == 0) {
                std::swap(t.y, t.z);
            }
            mesh.triangles.emplace_back(t.y, t.z, t.x);
        }
    }
}

void add_slivers(Mesh& mesh, int count, Random& random)
{
    for (int i = 0; i < count; ++i) {
        const glm::uvec3 t = any_face(mesh, random);
        if (i % 2 == 0) {
            mesh.triangles.emplace_back(t.x, t.x, t.y);
        } else {
            // A copy of a corner, too close to be another place.
            mesh.triangles.emplace_back(t.x, t.y, static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(mesh.positions[t.y] + glm::vec3(2e-6f, -2e-6f, 1e-6f));
        }
    }
}

void add_fins(Mesh& mesh, int count, double size, Random& random)
{
    for (int i = 0; i < count; ++i) {
        const glm::uvec3 t = any_face(mesh, random);
        const glm::vec3 out(glm::normalize(random.direction()));
        mesh.positions.push_back(middle_of(mesh, t) + out * within(random, 0.3 * size, size));
        mesh.triangles.emplace_back(t.y, t.x, static_cast<std::uint32_t>(mesh.positions.size() - 1));
    }
}

void add_huge_triangles(Mesh& mesh, int count, Random& random)
{
    for (int i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(glm::vec3(random.in_box({-2.0, -2.0, -1.0}, {3.0, 3.0, 2.0})));
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
}

void unweld(Mesh& mesh)
{
    Mesh soup;
    for (const glm::uvec3& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.positions.size());
        for (int i = 0; i < 3; ++i) {
            soup.positions.push_back(mesh.positions[t[i]]);
        }
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    mesh = std::move(soup);
}

double mean_edge(const Mesh& mesh)
{
    double sum = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        sum += glm::distance(mesh.positions[t.x], mesh.positions[t.y]);
    }
    return sum / static_cast<double>(mesh.triangles.size());
}

// Vertices at the same place modulo the periods move alike.
void crumple(BrokenMesh& broken, double distance, Random& random)
{
    std::map<std::tuple<long, long, long>, glm::vec3> moves;
    for (glm::vec3& p : broken.mesh.positions) {
        const double x = p.x - std::floor(p.x + 1e-4);
        const double y = p.y - std::floor(p.y / broken.aspect + 1e-4) * broken.aspect;
        const auto key = std::make_tuple(std::lround(x * 1e4), std::lround(y * 1e4), std::lround(p.z * 1e4));
        const auto [found, added] = moves.try_emplace(key, glm::vec3(0.0f));
        if (added) {
            found->second = glm::vec3(random.direction()) * within(random, 0.0, distance);
        }
        p += found->second;
    }
    broken.truth = broken.mesh;
}

}  // namespace

std::string name_of(Solid solid)
{
    const char* const names[] = {"ball",        "box",               "torus",   "strands",
                                 "hollow ball", "overlapping balls", "terrain", "ball at corner"};
    return names[static_cast<int>(solid)];
}

std::string name_of(Damage damage)
{
    const char* const names[] = {"scattered holes", "torn off", "flips", "inside out", "duplicates", "crumpled",
                                 "unwelded", "cracked", "slivers", "fins", "huge triangles", "all of it"};
    return names[static_cast<int>(damage)];
}

BrokenMesh random_solid(Solid solid, Random& random)
{
    BrokenMesh result;
    result.height = within(random, 0.6, 0.9);
    result.aspect = within(random, 0.8, 1.3);
    const float radius = within(random, 0.2, 0.28);
    const glm::vec3 center(within(random, 0.4, 0.6), within(random, 0.35, 0.45), 0.5f * result.height);
    switch (solid) {
    case Solid::ball:
        result.mesh = sphere(center, radius, 10, 13);
        break;
    case Solid::box: {
        const glm::vec3 half(within(random, 0.12, 0.3), within(random, 0.12, 0.3), within(random, 0.1, 0.25));
        result.mesh = fine_box(center - half, center + half, 4);
        break;
    }
    case Solid::torus:
        result.mesh = ring(center, within(random, 0.2, 0.26), within(random, 0.08, 0.13));
        break;
    case Solid::strands:
        for (const int axis : {0, 1}) {
            const glm::vec3 above(0.0f, 0.0f, axis == 0 ? 0.1f : -0.1f);
            const float thickness = within(random, 0.08, 0.14);
            result.mesh = merged(result.mesh, strand(axis, result.aspect, center + above, thickness, 0.05f));
        }
        break;
    case Solid::hollow_ball:
        result.mesh = merged(sphere(center, radius, 9, 12), flipped(sphere(center, 0.5f * radius, 6, 9)));
        break;
    case Solid::overlapping_balls:
        result.mesh = merged(sphere(center, radius, 8, 11), sphere(center + 0.6f * radius, 0.8f * radius, 7, 10));
        break;
    case Solid::terrain:
        result.mesh = terrain(result.height, result.aspect, random);
        result.covering = 1;
        break;
    case Solid::ball_at_corner:
        result.mesh = sphere({within(random, -0.1, 0.1), within(random, -0.1, 0.1), center.z}, radius, 10, 13);
        break;
    }
    result.truth = result.mesh;
    return result;
}

BrokenMesh broken(BrokenMesh solid, Damage damage, Random& random)
{
    const double edge = mean_edge(solid.mesh);
    const auto tear = [&](double share) {
        // The faces nearest to one of them.
        const glm::vec3 center = middle_of(solid.mesh, any_face(solid.mesh, random));
        std::vector<float> distances;
        for (const glm::uvec3& other : solid.mesh.triangles) {
            distances.push_back(glm::distance(middle_of(solid.mesh, other), center));
        }
        std::sort(distances.begin(), distances.end());
        const float limit = distances[static_cast<std::size_t>(share * static_cast<double>(distances.size()))];
        keep_faces(solid.mesh, [&](const glm::uvec3& other) {
            return glm::distance(middle_of(solid.mesh, other), center) > limit;
        });
        solid.truth = solid.mesh;
    };
    switch (damage) {
    case Damage::scattered_holes: {
        const double share = random.uniform(0.02, 0.3);
        keep_faces(solid.mesh, [&](const glm::uvec3&) { return random.uniform(0.0, 1.0) >= share; });
        solid.truth = solid.mesh;
        break;
    }
    case Damage::torn_off:
        tear(random.uniform(0.02, 0.3));
        break;
    case Damage::flips:
        flip_some(solid.mesh, random.uniform(0.05, 0.5), random);
        break;
    case Damage::inside_out:
        solid.mesh = flipped(solid.mesh);
        break;
    case Damage::duplicates:
        double_some(solid.mesh, random.uniform(0.05, 1.0), random);
        break;
    case Damage::crumpled:
        crumple(solid, random.uniform(0.2, 0.6) * edge, random);
        break;
    case Damage::unwelded:
        unweld(solid.mesh);
        break;
    case Damage::cracked:
        unweld(solid.mesh);
        for (glm::vec3& p : solid.mesh.positions) {
            p += glm::vec3(random.direction() * random.uniform(0.0, 2e-4));
        }
        solid.moved = 1e-3;
        break;
    case Damage::slivers:
        add_slivers(solid.mesh, 20, random);
        break;
    case Damage::fins:
        add_fins(solid.mesh, 8, 2.0 * edge, random);
        solid.truth = solid.mesh;
        break;
    case Damage::huge_triangles:
        // Vertices astray, and faces that have nothing to do with the rest: a lattice of those covers the tile some times
        // over, and its winding number says nothing.
        for (int i = 0; i < 2; ++i) {
            solid.mesh.positions[static_cast<std::size_t>(random.below(static_cast<int>(solid.mesh.positions.size())))] =
                glm::vec3(random.in_box({-2.0, -2.0, -1.0}, {3.0, 3.0, 2.0}));
        }
        solid.truth = solid.mesh;
        add_huge_triangles(solid.mesh, 2, random);
        break;
    case Damage::all:
        crumple(solid, random.uniform(0.05, 0.2) * edge, random);
        tear(random.uniform(0.02, 0.15));
        add_fins(solid.mesh, 2, edge, random);
        solid.truth = solid.mesh;
        flip_some(solid.mesh, random.uniform(0.05, 0.5), random);
        double_some(solid.mesh, 0.1, random);
        add_slivers(solid.mesh, 4, random);
        unweld(solid.mesh);
        break;
    }
    return solid;
}

Mesh triangle_soup(int count, double size, float height, float aspect, Random& random)
{
    Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 middle = random.in_box({0.0, 0.0, 0.1 * height}, {1.0, aspect, 0.9 * height});
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(glm::vec3(middle + random.direction() * random.uniform(0.5 * size, size)));
        }
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

}  // namespace mesoshell
