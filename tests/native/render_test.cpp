// The reference renderer against closed forms, and its `sdf` traversal against Embree on the realized mesh.
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera.h"
#include "check.h"
#include "mesoshell/bake.h"
#include "mesoshell/realize.h"
#include "mesoshell/render.h"
#include "meshes.h"

namespace mesoshell {
namespace {

constexpr int gdm_traversal = 0;
constexpr int sdf_traversal = 1;

ShellParams settings(int traversal)
{
    ShellParams params;
    params.mode.x = traversal;
    return params;
}

Rendering render_with(const Shell& shell, const Map& map, const View& view, int traversal)
{
    Job job;
    return render(shell, map, view, settings(traversal), job);
}

// A field alone: all that the traversal `sdf` asks.
Map sdf_map(const Sample& sample, const glm::ivec3& nodes)
{
    Job job;
    const Sdf sdf = bake_sdf(sample, nodes, job);
    Map map;
    map.height = sdf.height;
    map.aspect = sdf.aspect;
    map.sdf_nodes = sdf.nodes;
    map.sdf = sdf.values;
    map.precision = Precision::single;
    return map;
}

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

Map slab_map()
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
    options.max_rmse = 1e-6f;
    options.precision = Precision::single;
    return compress(gdm, &sdf, options, job);
}

void check_slab(int traversal, const Camera& camera, bool perspective)
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
            // Whether a ray within 1e-4 of the box's outline hits it is a matter of rounding and of the hit tolerance.
            const bool wide = std::isfinite(box_entry(ray, {-1e-4, -1e-4, slab_below - 2e-3}, {1.0001, 1.0001, slab_above + 2e-3}, &ignored));
            const bool narrow = std::isfinite(box_entry(ray, {1e-4, 1e-4, slab_below + 1e-4}, {0.9999, 0.9999, slab_above - 1e-4}, &ignored));
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
            if (traversal == gdm_traversal && !top) {
                continue;  // through the side: one lookup from inside the slab's heights
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
                // Interpolating D / cos(theta) between polar nodes errs by D step^2 / 8 times the second derivative; D is the
                // height that the ray falls from the top of the shell.
                const double step = 3.14159265358979 / 63;
                const double flattest = std::cos(std::acos(cosine) + step);
                allowed += (slab_height - slab_above) * step * step / 8 * (2.0 - flattest * flattest) / std::pow(flattest, 3.0);
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
    EXPECT_GT(hits, view.size.x * view.size.y / 10);
    EXPECT_LT(doubtful, view.size.x * view.size.y / 20);
    static_cast<void>(perspective);
}

const glm::dvec3 middle(0.47, 0.52, 0.3);

TEST(Render, SlabInPerspectiveBySphereTracing)
{
    check_slab(sdf_traversal, Camera(true, {1.9, -1.1, 1.6}, middle, 0.45, {96, 72}), true);
    check_slab(sdf_traversal, Camera(true, {0.4, 0.6, 2.0}, middle, 0.45, {65, 65}), true);
}

TEST(Render, SlabInPerspectiveByGdm)
{
    check_slab(gdm_traversal, Camera(true, {1.9, -1.1, 1.6}, middle, 0.45, {96, 72}), true);
    check_slab(gdm_traversal, Camera(true, {0.4, 0.6, 2.0}, middle, 0.45, {65, 65}), true);
}

TEST(Render, SlabInAParallelViewBySphereTracing)
{
    check_slab(sdf_traversal, Camera(false, {1.9, -1.1, 1.6}, middle, 0.8, {96, 72}), false);
    check_slab(sdf_traversal, Camera(false, {0.47, 0.52, 3.0}, middle, 0.8, {64, 64}), false);
}

TEST(Render, SlabInAParallelViewByGdm)
{
    check_slab(gdm_traversal, Camera(false, {1.9, -1.1, 1.6}, middle, 0.8, {96, 72}), false);
    check_slab(gdm_traversal, Camera(false, {0.47, 0.52, 3.0}, middle, 0.8, {64, 64}), false);
}

TEST(Render, SymmetricViewOntoTheEdgesOfAMeshHasNoHoles)
{
    // Odd pictures have pixel centers exactly on the middle lines and diagonals of the square, where prisms meet.
    const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(slab_height);
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, perspective ? 0.25 : 0.45, {33, 33});
        const Rendering picture = render_with(shell, slab_map(), camera.view(), sdf_traversal);
        EXPECT_EQ(std::count(picture.hit.begin(), picture.hit.end(), 1), 33 * 33) << (perspective ? "perspective" : "parallel");
    }
}

TEST(Render, EyeInsideTheShellSeesOnlyWhatIsAhead)
{
    // Above the solid but below the offset surface, looking down: the distance to the slab, not to what lies behind the eye.
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

// --- Balls ---

TEST(Render, SdfAgreesWithTheRealizedTorus)
{
    // Thickness and tiles keep proportions about: a tile is 2 pi / 9 wide at the middle circle, 0.42 around the tube.
    const Sample sample = sphere({0.5f, 0.5f, 0.32f}, 0.24f, 24, 32).sample(0.6f);
    const Shell shell = torus(1.0f, 0.4f, 36, 24, 9.0f, 6.0f).shell(0.3f);
    const Map map = sdf_map(sample, {40, 40, 25});
    Job job;
    const RealizedMesh mesh = realize(shell, sample, job);
    for (const bool perspective : {true, false}) {
        const Camera camera(perspective, {1.5, -2.4, 2.2}, {0, 0, 0}, perspective ? 0.55 : 1.9, {160, 128});
        const Rendering drawn = render_with(shell, map, camera.view(), sdf_traversal);
        const Trace truth = trace(mesh.positions, mesh.triangles, camera.view(), job);
        int both = 0;
        int either = 0;
        std::vector<double> errors;
        std::vector<double> angles;
        for (std::size_t i = 0; i < drawn.hit.size(); ++i) {
            both += drawn.hit[i] & truth.hit[i];
            either += drawn.hit[i] | truth.hit[i];
            if ((drawn.hit[i] & truth.hit[i]) != 0) {
                errors.push_back(std::abs(drawn.distance[i] - truth.distance[i]));
                angles.push_back(glm::dot(drawn.normal[i], truth.normal[i]));
            }
        }
        ASSERT_GT(both, 3000);
        // The law of the project: 99 % of the silhouette.
        EXPECT_GE(static_cast<double>(both) / either, 0.99);
        // A voxel is 1/40 of a tile, about 0.5 / 40 in space. Sphere tracing ends 0.02 voxels early, interpolation of a distance
        // at radius r errs by 3 h^2 / (8 r) = 0.04 voxels, the inscribed ball by r (pi/32)^2 / 2 = 0.05: a tenth, seen aslant.
        std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
        EXPECT_LT(errors[errors.size() / 2], 0.2 * 0.5 / 40);
        // Facets of 6 to 11 degrees: at the median, normals differ by less than one.
        std::nth_element(angles.begin(), angles.begin() + angles.size() / 2, angles.end());
        EXPECT_GT(angles[angles.size() / 2], std::cos(0.19));
    }
}

TEST(Render, MirroredUvsGiveTheMirrorImage)
{
    // u runs from right to left: the ball off the middle of its tile appears on the other side, lit as a mirror shows it.
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

TEST(Render, SettingsLightTheHits)
{
    ShellParams params = settings(sdf_traversal);
    params.base_color = glm::vec4(0.5f, 0.25f, 1.0f, 1.0f);
    params.light_world = glm::vec4(0.0f, 3.0f, 4.0f, 0.0f);  // 4/5 of the sun falls onto a level surface
    params.light_color = glm::vec4(2.0f, 1.0f, 0.5f, 0.0f);
    params.ambient_color = glm::vec4(0.1f, 0.2f, 0.3f, 0.0f);
    const Camera camera(false, {0.5, 0.5, 2.0}, {0.5, 0.5, 0.0}, 0.25, {4, 4});
    Job job;
    const Rendering picture = render(flat_grid(1, 1, 1.0f, 1.0f).shell(slab_height), slab_map(), camera.view(), params, job);
    for (const glm::vec4& color : picture.color) {
        EXPECT_LT(glm::length(color - glm::vec4(0.5f * (0.1f + 1.6f), 0.25f * (0.2f + 0.8f), 0.3f + 0.4f, 1.0f)), 1e-5f);
    }
}

// --- Views ---

TEST(EyeOf, PerspectiveAndParallelViews)
{
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 eye = random.in_box(glm::dvec3(-5.0), glm::dvec3(5.0));
        const glm::dvec3 target = random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0));
        const Camera near_camera(true, eye, target, random.uniform(0.2, 2.0), {40, 30});
        EXPECT_LT(glm::length(eye_of(near_camera.view().clip_from_object) - glm::dvec4(eye, 1.0)), 1e-8);
        const Camera parallel(false, eye, target, random.uniform(0.2, 2.0), {40, 30});
        EXPECT_LT(glm::length(eye_of(parallel.view().clip_from_object) - glm::dvec4(-parallel.forward(), 0.0)), 1e-8);
    }
}

TEST(RenderInput, MatricesThatAreNoView)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const Map map = slab_map();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    View flat;
    flat.clip_from_object[2] = glm::dvec4(0.0);
    for (const glm::dmat4& matrix : {glm::dmat4(0.0), glm::dmat4(nan), glm::dmat4(std::numeric_limits<double>::infinity()),
                                     flat.clip_from_object}) {
        View view;
        view.clip_from_object = matrix;
        view.size = glm::ivec2(4);
        expect_refusal<InvalidArgument>([&] { eye_of(matrix); }, {"clip_from_object"});
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, sdf_traversal); }, {"clip_from_object"});
    }
}

TEST(RenderInput, SizesOutOfRange)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const Map map = slab_map();
    for (const glm::ivec2 size : {glm::ivec2(0, 4), {4, 0}, {-4, 4}, {4, 16385}}) {
        View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
        view.size = size;
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, sdf_traversal); }, {"pixels", "1 to 16384"});
        Job job;
        expect_refusal<InvalidArgument>([&] { trace({}, {}, view, job); }, {"pixels", "1 to 16384"});
    }
}

TEST(RenderInput, TraversalThatDoesNotExist)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    for (const int traversal : {-1, 2, 1000}) {
        expect_refusal<InvalidArgument>([&] { render_with(shell, slab_map(), view, traversal); },
                                        {"traversal", std::to_string(traversal).c_str()});
    }
}

TEST(RenderInput, MapWithoutADistanceField)
{
    const Shell shell = flat_grid(1, 1, 1.0f, 1.0f).shell(0.5f);
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    Map map = slab_map();
    map.sdf.clear();
    map.sdf_nodes = glm::ivec3(0);
    for (const int traversal : {gdm_traversal, sdf_traversal}) {
        expect_refusal<InvalidArgument>([&] { render_with(shell, map, view, traversal); }, {"no distance field"});
    }
}

TEST(RenderInput, EmptyShellIsAnEmptyPicture)
{
    const View view = Camera(true, {0, 0, 2}, {0, 0, 0}, 0.5, {4, 4}).view();
    const Rendering picture = render_with(Shell{}, slab_map(), view, sdf_traversal);
    EXPECT_EQ(std::count(picture.hit.begin(), picture.hit.end(), 1), 0);
}

}  // namespace
}  // namespace mesoshell
