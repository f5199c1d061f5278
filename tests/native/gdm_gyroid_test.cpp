// A bake against a surface that no mesh repeats: the gyroid, sin X cos Y + sin Y cos Z + sin Z cos X = 0 for X = 2 pi x and so on.
// Its mesh comes from a grid, linear in every tetrahedron; how far that can be from the function is known, so that the baked
// distance of every ray lies between those to two level sets, which Lipschitz steps bracket without a grid.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mesoshell/bake.h"
#include "mesoshell/contour.h"

namespace mesoshell {
namespace {

constexpr int cells = 96;
// Linear interpolation over a tetrahedron is off by at most 3/8 of the largest second derivative times the longest edge squared;
// the gyroid's Hessian is at most 2 (2 pi)^2 in any direction, the longest edge a cell's diagonal.
const double interpolation_error = 0.375 * 2.0 * std::pow(2.0 * std::numbers::pi, 2) * 3.0 / (cells * cells);
const double lipschitz = 2.0 * std::numbers::pi * std::sqrt(6.0);
// Rounding of positions and distances to single precision.
constexpr double rounding = 2e-5;

double gyroid(const glm::dvec3& p)
{
    const glm::dvec3 s = glm::sin(2.0 * std::numbers::pi * p);
    const glm::dvec3 c = glm::cos(2.0 * std::numbers::pi * p);
    return s.x * c.y + s.y * c.z + s.z * c.x;
}

// A distance at which the gyroid is within 1e-6 of `level`, before which it stays below it; or the limit.
double first_at(double level, const glm::dvec3& origin, const glm::dvec3& dir, double limit)
{
    double t = 0.0;
    while (t < limit) {
        const double below = level - gyroid(origin + t * dir);
        if (below < 1e-6) {
            return t;
        }
        t += below / lipschitz;
    }
    return limit;
}

class GdmGyroid : public testing::TestWithParam<Engine> {};

TEST_P(GdmGyroid, EveryRayEndsBetweenTwoLevelSets)
{
    const glm::ivec3 nodes(cells, cells, cells + 1);
    std::vector<float> values;
    for (int z = 0; z < nodes.z; ++z) {
        for (int y = 0; y < nodes.y; ++y) {
            for (int x = 0; x < nodes.x; ++x) {
                values.push_back(static_cast<float>(gyroid(glm::dvec3(x, y, z) / double(cells))));
            }
        }
    }
    Job job;
    const Contour mesh = contour(values, nodes, 0.0f, 1.0f, 1.0f, job);
    GdmResolution r;
    r.nodes = glm::ivec3(14, 10, 9);
    r.ntheta = 8;
    r.nphi = 7;
    const Gdm gdm = bake_gdm(Sample(mesh.positions, mesh.triangles, 1.0f, 1.0f), r, GetParam(), job);
    double widest = 0.0;
    for (int phi = 0; phi < r.nphi; ++phi) {
        for (int y = 0; y < r.nodes.y; ++y) {
            for (int x = 0; x < r.nodes.x; ++x) {
                for (int theta = 0; theta < r.ntheta; ++theta) {
                    for (int z = 0; z < r.nodes.z; ++z) {
                        const glm::dvec3 dir = gdm_direction(r, theta, phi);
                        const glm::dvec3 origin(double(x) / r.nodes.x, double(y) / r.nodes.y, double(z) / (r.nodes.z - 1));
                        const double limit = dir.z > 0.0 ? (1.0 - origin.z) / dir.z : -origin.z / dir.z;
                        const double nearest = first_at(-interpolation_error, origin, dir, limit);
                        const double farthest = first_at(interpolation_error + 1e-6, origin, dir, limit);
                        const double value = gdm.values[gdm.index(phi, y, x, theta, z)];
                        // Nodes at w = 0 and w = 1 that lie on the caps are inside or out as rounding has it.
                        ASSERT_GE(value, std::min(nearest, limit) - rounding) << origin.x << " " << origin.y << " " << origin.z;
                        ASSERT_LE(value, farthest + rounding) << origin.x << " " << origin.y << " " << origin.z;
                        widest += farthest - nearest;
                    }
                }
            }
        }
    }
    // The bracket says something: on the average it is narrower than a quarter of a voxel.
    EXPECT_LT(widest / static_cast<double>(gdm.values.size()), 0.25 / r.nodes.x);
}

INSTANTIATE_TEST_SUITE_P(Engines, GdmGyroid, testing::Values(Engine::embree, Engine::slices));

}  // namespace
}  // namespace mesoshell
