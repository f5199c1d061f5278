// The reference renderer against closed forms.
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera.h"
#include "check.h"
#include "mesoshell/bake.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "render_with.h"

namespace mesoshell {
namespace {

// --- A slab tile on a flat square: a box ---

// Tiles are 1 wide on the unit square, so with a thickness of the tile's height texture space is object space.
constexpr float slab_height = 0.5f;
constexpr float slab_below = 0.15f;
constexpr float slab_above = 0.35f;

// Where a ray enters the box that the slab fills; infinite where it misses.
double box_entry(const CameraRay& ray, const glm::dvec3& low, const glm::dvec3& high, bool* through_top)
{
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    int axis_in = 0;
    for (int axis = 0; axis < 3; ++axis) {
        double a = (low[axis] - ray.origin[axis]) / ray.dir[axis];
        double b = (high[axis] - ray.origin[axis]) / ray.dir[axis];
        if (a > b) {
            std::swap(a, b);
        }
        if (a > enter) {
            enter = a;
            axis_in = axis;
        }
        leave = std::min(leave, b);
    }
    *through_top = axis_in == 2 && ray.dir.z < 0.0;
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
}

Map bake_slab_map()
{
    const Sample sample = slab(slab_below, slab_above).sample(slab_height);
    GdmResolution r;
    r.nodes = glm::ivec3(2, 2, 11);
    r.ntheta = 64;
    r.nphi = 2;
    Job job;
    const Gdm gdm = bake_gdm(sample, r, job);
    const Sdf sdf = bake_sdf(sample, {16, 16, 11}, job);
    CompressOptions options;
    options.layout = Layout::paper;
    options.terms = r.ntheta * r.nodes.z;
    options.precision = Precision::single;
    return compress(gdm, &sdf, options, job);
}

const Map& slab_map()
{
    static const Map map = bake_slab_map();
    return map;
}

void check_slab(int traversal, const Camera& camera)
{
    const Shell shell = flat_grid(3, 2, 1.0f, 1.0f).shell(slab_height);
    const View view = camera.view();
    const Rendering picture = render_with(shell, slab_map(), view, traversal);
    int hits = 0;
    int doubtful = 0;
    for (int y = 0; y < view.size.y; ++y) {
        for (int x = 0; x < view.size.x; ++x) {
            const CameraRay ray = camera.ray(x, y);
            const std::size_t pixel = static_cast<std::size_t>(y) * view.size.x + x;
            bool top = false;
            bool ignored = false;
            const double exact = box_entry(ray, {0, 0, slab_below}, {1, 1, slab_above}, &top);
            // Whether a ray so close to the box's outline hits it is a matter of rounding and of the hit tolerance.
            const bool wide = std::isfinite(
                box_entry(ray, {-1e-4, -1e-4, slab_below - 2e-3}, {1.0001, 1.0001, slab_above + 2e-3}, &ignored));
            const bool narrow = (traversal != gdm_traversal || top) &&
                                std::isfinite(box_entry(ray, {1e-4, 1e-4, slab_below + 1e-4},
                                                        {0.9999, 0.9999, slab_above - 1e-4}, &ignored));
            if (traversal == gdm_traversal) {
                // One lookup at the entry of the shell is only as good as the grid there: linear in the height above
                // the solid, where the shell's top is, and not beside or below it.
                bool from_above = false;
                box_entry(ray, {0, 0, 0}, {1, 1, slab_height}, &from_above);
                if (!from_above) {
                    continue;
                }
            }
            if (!wide) {
                ASSERT_EQ(picture.hit[pixel], 0) << x << " " << y;
                ASSERT_TRUE(std::isinf(picture.distance[pixel]));
                ASSERT_EQ(picture.normal[pixel], glm::vec3(0.0f));
                ASSERT_EQ(picture.color[pixel], glm::vec4(0.0f));
                ASSERT_EQ(picture.prism[pixel], -1);
                continue;
            }
            if (!narrow) {
                doubtful += 1;
                continue;
            }
            hits += 1;
            ASSERT_EQ(picture.hit[pixel], 1) << x << " " << y;
            ASSERT_EQ(picture.color[pixel].a, 1.0f);
            const double cosine = -ray.dir.z;
            double allowed = 1e-5;  // single precision, at distances of some units
            if (traversal == sdf_traversal) {
                // Sphere tracing ends 0.02 voxels before the surface; the field of the slab is linear there.
                allowed += top ? 0.02 / 16 / cosine : 1e-4;
            } else {
                // Interpolating D / cos(theta) between polar nodes errs by D step^2 / 8 times the second derivative; D
                // is the height that the ray falls from the top of the shell.
                const double step = 3.14159265358979 / 63;
                const double flattest = std::cos(std::acos(cosine) + step);
                allowed += (slab_height - slab_above) * step * step / 8 * (2.0 - flattest * flattest) /
                           std::pow(flattest, 3.0);
            }
            ASSERT_NEAR(picture.distance[pixel], exact, allowed) << x << " " << y;
            if (top) {
                ASSERT_LT(glm::length(picture.normal[pixel] - glm::vec3(0, 0, 1)), 1e-3f) << x << " " << y;
                const glm::dvec3 place = ray.origin + ray.dir * exact;
                ASSERT_LT(glm::length(glm::dvec2(picture.texture[pixel]) - glm::dvec2(place)), allowed);
                ASSERT_NEAR(picture.texture[pixel].z, slab_above / slab_height, allowed / slab_height);
            }
            ASSERT_GE(picture.prism[pixel], 0);
            ASSERT_LT(picture.prism[pixel], static_cast<int>(shell.prisms.size()));
            ASSERT_GT(picture.fetches[pixel], 0);
        }
    }
    EXPECT_GT(hits, view.size.x * view.size.y / 25);
    EXPECT_LT(doubtful, view.size.x * view.size.y / 20);
}

const glm::dvec3 middle(0.47, 0.52, 0.3);

TEST(Render, SlabInPerspectiveBySphereTracing)
{
    check_slab(sdf_traversal, Camera(true, {1.9, -1.1, 1.6}, middle, 0.45, {96, 72}));
    check_slab(sdf_traversal, Camera(true, {0.4, 0.6, 2.0}, middle, 0.45, {65, 65}));
}

TEST(Render, SlabInPerspectiveByGdm)
{
    check_slab(gdm_traversal, Camera(true, {1.9, -1.1, 1.6}, middle, 0.45, {96, 72}));
    check_slab(gdm_traversal, Camera(true, {0.4, 0.6, 2.0}, middle, 0.45, {65, 65}));
}

TEST(Render, SlabInAParallelViewBySphereTracing)
{
    check_slab(sdf_traversal, Camera(false, {1.9, -1.1, 1.6}, middle, 0.8, {96, 72}));
    check_slab(sdf_traversal, Camera(false, {0.47, 0.52, 3.0}, middle, 0.8, {64, 64}));
}

TEST(Render, SlabInAParallelViewByGdm)
{
    check_slab(gdm_traversal, Camera(false, {1.9, -1.1, 1.6}, middle, 0.8, {96, 72}));
    check_slab(gdm_traversal, Camera(false, {0.47, 0.52, 3.0}, middle, 0.8, {64, 64}));
}

TEST(Render, SymmetricViewOntoTheEdgesOfAMeshHasNoHoles)
{
    // Odd pictures have pixel centers exactly on the middle lines and diagonals of the square, where prisms meet.
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(slab_height);
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, perspective ? 0.25 : 0.45, {33, 33});
        const Rendering picture = render_with(shell, slab_map(), camera.view(), sdf_traversal);
        EXPECT_EQ(std::count(picture.hit.begin(), picture.hit.end(), 1), 33 * 33)
            << (perspective ? "perspective" : "parallel");
    }
}

TEST(Render, EyeInsideTheShellSeesOnlyWhatIsAhead)
{
    // Above the solid but below the offset surface, looking down: the distance to the slab, not to what lies behind the
    // eye.
    const Camera camera(true, {0.5, 0.5, 0.45}, {0.5, 0.51, 0.0}, 0.3, {16, 16});
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(slab_height);
    const Rendering picture = render_with(shell, slab_map(), camera.view(), sdf_traversal);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const CameraRay ray = camera.ray(x, y);
            const std::size_t pixel = static_cast<std::size_t>(y) * 16 + x;
            ASSERT_EQ(picture.hit[pixel], 1);
            ASSERT_NEAR(picture.distance[pixel], (0.45 - slab_above) / -ray.dir.z, 0.02 / 16 / -ray.dir.z + 1e-5);
        }
    }
}

TEST(Render, MirroredUvsGiveTheMirrorImage)
{
    // u runs from right to left: the ball off the middle of its tile appears on the other side, lit as a mirror shows
    // it.
    const Map map = sdf_map(sphere({0.34f, 0.6f, 0.25f}, 0.2f, 16, 24).sample(0.5f), {32, 32, 17});
    const SurfaceMesh mesh = flat_grid(1, 1, 1.0f, 1.0f);
    SurfaceMesh mirrored = mesh;
    for (glm::vec2& uv : mirrored.uvs) {
        uv.x = 1.0f - uv.x;
    }
    const Camera camera(false, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, 0.5, {64, 64});
    const Rendering a = render_with(mesh.shell(0.5f), map, camera.view(), sdf_traversal);
    const Rendering b = render_with(mirrored.shell(0.5f), map, camera.view(), sdf_traversal);
    int hits = 0;
    int differing = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const std::size_t here = static_cast<std::size_t>(y) * 64 + x;
            const std::size_t there = static_cast<std::size_t>(y) * 64 + (63 - x);
            hits += a.hit[here];
            differing += a.hit[here] != b.hit[there] ? 1 : 0;
            if ((a.hit[here] & b.hit[there]) != 0) {
                ASSERT_NEAR(a.distance[here], b.distance[there], 1e-4);
                const glm::vec3 n = b.normal[there];
                ASSERT_LT(glm::length(a.normal[here] - glm::vec3(-n.x, n.y, n.z)), 1e-2f) << x << " " << y;
            }
        }
    }
    // pi 0.2^2 of 64^2 pixels, but for the rim.
    EXPECT_NEAR(hits, 515, 30);
    EXPECT_LE(differing, 2);
    // It is not its own mirror image.
    EXPECT_NE(a.hit, b.hit);
}

TEST(Render, ShellOnTheBackOfItsFaces)
{
    // Normals given against the winding: the shell hangs below the square, and so do the solid's normals.
    SurfaceMesh mesh = flat_grid(1, 1, 1.0f, 1.0f);
    mesh.normals.assign(4, glm::vec3(0, 0, -1));
    const Camera camera(false, {0.5, 0.5, -2.0}, {0.5, 0.5, 0.0}, 0.25, {5, 5});
    const Rendering picture = render_with(mesh.shell(slab_height), slab_map(), camera.view(), sdf_traversal);
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        ASSERT_EQ(picture.hit[i], 1);
        EXPECT_NEAR(picture.distance[i], 2.0 - Camera::near - slab_above, 0.02 / 16 + 1e-5);
        EXPECT_LT(glm::length(picture.normal[i] - glm::vec3(0, 0, -1)), 1e-3f);
    }
}

TEST(Render, SettingsLightTheHits)
{
    ShellParams params = settings(sdf_traversal);
    params.base_color = glm::vec4(0.5f, 0.25f, 1.0f, 1.0f);
    params.light_world = glm::vec4(0.0f, 3.0f, 4.0f, 0.0f);  // 4/5 of the sun falls onto a level surface
    params.light_color = glm::vec4(2.0f, 1.0f, 0.5f, 0.0f);
    params.ambient_color = glm::vec4(0.1f, 0.2f, 0.3f, 0.0f);
    const Camera camera(false, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, 0.25, {4, 4});
    Job job;
    const Rendering picture =
        render(flat_grid(1, 1, 1.0f, 1.0f).shell(slab_height), slab_map(), camera.view(), params, job);
    for (const glm::vec4& color : picture.color) {
        EXPECT_LT(glm::length(color - glm::vec4(0.5f * (0.1f + 1.6f), 0.25f * (0.2f + 0.8f), 0.3f + 0.4f, 1.0f)),
                  1e-5f);
    }
}

}  // namespace
}  // namespace mesoshell
