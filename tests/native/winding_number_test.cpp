// The fast winding number against the sum over all triangles and many copies.
#include "winding_number.h"

#include <algorithm>
#include <cmath>

#include "check.h"
#include "meshes.h"
#include "winding_oracle.h"

namespace mesoshell {
namespace {

// Every third face is missing, so that nothing far away cancels.
Mesh with_holes(Mesh mesh)
{
    std::vector<glm::uvec3> kept;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (i % 3 != 0) {
            kept.push_back(mesh.triangles[i]);
        }
    }
    mesh.triangles = std::move(kept);
    return mesh;
}

double worst_error(const Mesh& mesh, float aspect, std::uint32_t seed)
{
    const PeriodicMesh welded = weld(mesh.positions, mesh.triangles, aspect);
    const WindingNumber winding(welded, welded.triangles);
    Random random(seed);
    double worst = 0.0;
    for (int i = 0; i < 60; ++i) {
        const glm::dvec3 p = random.in_box({-1.0, -1.0, -0.5}, {2.0, 2.0, 1.2});
        const double exact = balanced_winding(welded.positions, welded.triangles, aspect, p, 12);
        worst = std::max(worst, std::abs(winding.at(p) - exact));
    }
    return worst;
}

TEST(WindingNumber, MatchesTheSumOverAllTriangles)
{
    EXPECT_LT(worst_error(with_holes(sphere({0.5f, 0.45f, 0.3f}, 0.3f, 12, 16)), 1.0f, 1), winding_accuracy);
    EXPECT_LT(worst_error(with_holes(sphere({0.0f, 0.9f, 0.3f}, 0.25f, 10, 12)), 0.7f, 2), winding_accuracy);
    EXPECT_LT(worst_error(with_holes(sawtooth(0.1f, 0.2f, 0.5f, 0.3f, 1.3f, 6, 5)), 1.3f, 3), winding_accuracy);
    const Mesh far = moved(sphere({0.5f, 0.45f, 0.3f}, 0.3f, 9, 11), {-3.0f, 5.0f, 0.0f});
    EXPECT_LT(worst_error(with_holes(far), 1.0f, 4), winding_accuracy);
}

TEST(WindingNumber, OfAClosedMeshIsWhole)
{
    const Mesh ball = sphere({0.5f, 0.45f, 0.3f}, 0.3f, 24, 32);
    const PeriodicMesh welded = weld(ball.positions, ball.triangles, 1.0f);
    const WindingNumber winding(welded, welded.triangles);
    EXPECT_NEAR(winding.at({0.5, 0.45, 0.3}), 1.0, winding_accuracy);
    EXPECT_NEAR(winding.at({3.5, -1.55, 0.3}), 1.0, winding_accuracy);  // in a copy
    EXPECT_NEAR(winding.at({0.05, 0.95, 0.3}), 0.0, winding_accuracy);
    EXPECT_NEAR(winding.at({0.5, 0.45, 1.5}), 0.0, winding_accuracy);
}

TEST(WindingNumber, OfASheetThatSpansTheTileIsOneHalf)
{
    Mesh sheet = slab(0.3f, 0.9f, 0.7f);
    sheet.triangles.resize(18);  // the lower one, which faces down
    const PeriodicMesh welded = weld(sheet.positions, sheet.triangles, 0.7f);
    const WindingNumber winding(welded, welded.triangles);
    for (const double away : {0.001, 0.1, 2.0, 50.0}) {
        EXPECT_NEAR(winding.at({0.21, 0.33, 0.3 + away}), 0.5, winding_accuracy) << away;
        EXPECT_NEAR(winding.at({0.21, 0.33, 0.3 - away}), -0.5, winding_accuracy) << away;
    }
}

TEST(WindingNumber, OfNothingIsZero)
{
    const PeriodicMesh nothing = weld({}, {}, 1.0f);
    EXPECT_EQ(WindingNumber(nothing, nothing.triangles).at({0.1, 0.2, 0.3}), 0.0);
}

}  // namespace
}  // namespace mesoshell
