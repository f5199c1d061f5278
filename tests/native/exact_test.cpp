// The traversal `exact` against closed forms and against Embree on copies of the tile, where texture space is object space.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera.h"
#include "check.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

// Tiles are 1 wide on the flat grid, so with a thickness of the tile's height texture space is object space.
constexpr float height = 0.5f;

// Single precision of distances of some units.
constexpr double rounding = 1e-5;

const glm::dvec3 middle(0.47, 0.52, 0.3);

// From above, from below, from the side level with the shell, from between its planes, and straight down.
std::vector<Camera> cameras(const glm::ivec2& size)
{
    return {Camera(true, {1.9, -1.1, 1.6}, middle, 0.45, size),       Camera(true, {0.4, 0.6, -2.0}, middle, 0.45, size),
            Camera(false, {1.9, -1.1, 0.3}, middle, 0.8, size),       Camera(false, {1.9, -1.1, 1.6}, middle, 0.8, size),
            Camera(true, {-1.7, 0.5203, 0.2501}, middle, 0.4, size),  Camera(false, {0.47, 0.52, 3.0}, middle, 0.8, size),
            Camera(false, {-2.0, 0.52, 0.3}, {0.47, 0.52, 0.3}, 0.8, size)};
}

// Where a ray enters a box, infinite where it misses, and through which side.
double box_entry(const CameraRay& ray, const glm::dvec3& low, const glm::dvec3& high, glm::dvec3& normal)
{
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        double a = (low[axis] - ray.origin[axis]) / ray.dir[axis];
        double b = (high[axis] - ray.origin[axis]) / ray.dir[axis];
        if (a > b) {
            std::swap(a, b);
        }
        if (a > enter) {
            enter = a;
            normal = glm::dvec3(0.0);
            normal[axis] = ray.dir[axis] < 0.0 ? 1.0 : -1.0;
        }
        leave = std::min(leave, b);
    }
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
}

// A solid that fills a box of a shell over the unit square is that box: its sides are the shell's border.
void check_box(const Sample& sample, double below, double above)
{
    const Shell shell = flat_grid(3, 2, 1.0f, 1.0f).shell(height);
    for (const Camera& camera : cameras({64, 64})) {
        const Rendering picture = render_exactly(shell, sample, camera.view());
        int hits = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const std::size_t pixel = static_cast<std::size_t>(y) * 64 + x;
                const CameraRay ray = camera.ray(x, y);
                const glm::dvec3 low(0, 0, below);
                const glm::dvec3 high(1, 1, above);
                glm::dvec3 normal;
                glm::dvec3 ignored;
                const double truth = box_entry(ray, low, high, normal);
                if (std::isinf(box_entry(ray, low - rounding, high + rounding, ignored))) {
                    ASSERT_EQ(picture.hit[pixel], 0) << x << " " << y;
                } else if (std::isfinite(box_entry(ray, low + rounding, high - rounding, ignored))) {
                    hits += 1;
                    ASSERT_EQ(picture.hit[pixel], 1) << x << " " << y;
                    ASSERT_NEAR(picture.distance[pixel], truth, rounding / std::abs(glm::dot(ray.dir, normal)))
                        << x << " " << y;
                    const glm::dvec3 place = ray.origin + ray.dir * truth;
                    const glm::dvec3 from_side = glm::min(place - low, high - place);
                    const double second = std::max(std::min(from_side.x, from_side.y),
                                                   std::min(std::max(from_side.x, from_side.y), from_side.z));
                    if (second > 1e-3) {  // not on an edge of the box
                        ASSERT_LT(glm::length(glm::dvec3(picture.normal[pixel]) - normal), 1e-4) << x << " " << y;
                    }
                    ASSERT_LT(glm::length(glm::dvec2(picture.texture[pixel]) - glm::dvec2(place)), 1e-4);
                    ASSERT_NEAR(picture.texture[pixel].z, place.z / height, 1e-4);
                    ASSERT_EQ(picture.fetches[pixel], 0);
                }
            }
        }
        EXPECT_GT(hits, 300);
    }
}

TEST(Exact, SlabThatTheBorderCuts)
{
    check_box(slab(0.15f, 0.35f).sample(height), 0.15, 0.35);
}

TEST(Exact, SlabThatFillsTheShellFromItsFloor)
{
    check_box(slab(0.0f, 0.35f).sample(height), 0.0, 0.35);
}

TEST(Exact, SlabThatTheShellsTopCuts)
{
    check_box(slab(0.15f, 0.9f).sample(height), 0.15, height);
}

TEST(Exact, OverlappingSlabsAreOne)
{
    const Sample sample = merged(slab(0.1f, 0.3f), slab(0.2f, 0.4f)).sample(height);
    EXPECT_TRUE(sample.overlaps());
    check_box(sample, 0.1, 0.4);
}

// Copies of a tile that lie within the shell, for Embree alone.
Mesh copies(const Mesh& tile, int columns, int rows, float aspect)
{
    Mesh all;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            all = merged(all, moved(tile, {static_cast<float>(i), static_cast<float>(j) * aspect, 0.0f}));
        }
    }
    return all;
}

TEST(Exact, PlanarShellIsTheTiledTriangles)
{
    const Mesh tile = merged(sphere({0.3f, 0.4f, 0.25f}, 0.2f, 10, 14), sphere({0.7f, 0.75f, 0.2f}, 0.17f, 7, 9));
    const Sample sample = tile.sample(height);
    const Mesh all = copies(tile, 3, 2, 1.0f);
    // Prisms that cut tiles anywhere, some of them several tiles wide.
    for (const glm::ivec2 grid : {glm::ivec2(1, 1), {7, 3}}) {
        const Shell shell = flat_grid(grid.x, grid.y, 3.0f, 2.0f).shell(height);
        for (const Camera& camera : cameras({96, 96})) {
            Job job;
            const Rendering picture = render_exactly(shell, sample, camera.view());
            const Trace truth = trace(all.positions, all.triangles, camera.view(), job);
            int hits = 0;
            int apart = 0;
            for (std::size_t i = 0; i < truth.hit.size(); ++i) {
                hits += truth.hit[i];
                if (truth.hit[i] != picture.hit[i]) {
                    apart += 1;
                } else if (truth.hit[i] == 1) {
                    const glm::dvec3 dir = camera.ray(static_cast<int>(i) % 96, static_cast<int>(i) / 96).dir;
                    const double cosine = std::abs(glm::dot(dir, glm::dvec3(truth.normal[i])));
                    const double off = std::abs(picture.distance[i] - truth.distance[i]);
                    const bool same = off <= rounding / std::max(cosine, 0.1);
                    apart += same && glm::length(picture.normal[i] - truth.normal[i]) <= 1e-4f ? 0 : 1;
                }
            }
            EXPECT_GT(hits, 800);
            // Where a ray meets an outline or an edge, a rounding decides.
            EXPECT_LE(apart, 3);
        }
    }
}

TEST(Exact, EyeInsideTheSolidSeesItAtTheNearPlane)
{
    const Sample sample = slab(0.1f, 0.4f).sample(height);
    const Shell shell = flat_grid(3, 2, 1.0f, 1.0f).shell(height);
    const Rendering picture = render_exactly(shell, sample, Camera(true, middle, {0.6, 0.9, 0.2}, 0.4, {32, 32}).view());
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        ASSERT_EQ(picture.hit[i], 1);
        ASSERT_NEAR(picture.distance[i], Camera::near, 0.2 * Camera::near);  // at the picture's corners it is farther
    }
}

}  // namespace
}  // namespace mesoshell
