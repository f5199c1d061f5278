// Lamps, shadows, sky and film of a scene against closed forms.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "check.h"
#include "mesoshell/bake.h"
#include "mesoshell/facets.h"
#include "mesoshell/traversal.h"
#include "scene_film.h"
#include "scene_with.h"

namespace mesoshell {
namespace {

constexpr double pi = std::numbers::pi;

// A white floor, seen straight from above by a parallel camera without a filter: pixel centers are places.
const Mesh& floor_mesh()
{
    static const Mesh mesh = level_rectangle({-40.0f, -40.0f}, {40.0f, 40.0f}, 0.0f);
    return mesh;
}

const Camera& above()
{
    static const Camera camera(false, {0.0, 0.0, 9.0}, {0.0, 0.0, 0.0}, 3.0, {33, 33});
    return camera;
}

Scene floor_under(const SceneLight& light)
{
    Scene scene;
    scene.meshes.push_back(placed(floor_mesh()));
    scene.meshes[0].base_color = glm::vec3(1.0f);
    scene.lights.push_back(light);
    return scene;
}

// `expected` is the radiance of a white floor at a place.
template <typename Expected>
void check_floor(const SceneLight& light, const Expected& expected, double tolerance, int samples = 1)
{
    Film film = film_of(above(), samples);
    film.filter_width = 0.0f;
    const ScenePicture picture = render_scene_with(floor_under(light), film);
    double largest = 0.0;
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            const glm::dvec3 place(glm::dvec2(above().ray(x, y).origin), 0.0);
            const double value = expected(place);
            largest = std::max(largest, value);
            ASSERT_NEAR(picture.color[y * 33 + x].r, value, tolerance) << x << " " << y;
        }
    }
    EXPECT_GT(largest, 20.0 * tolerance);
}

SceneLight lamp(LightType type, const glm::dvec3& position, float power)
{
    SceneLight light;
    light.type = type;
    light.position = position;
    light.color = glm::vec3(power);
    return light;
}

TEST(SceneLight, SunOverPi)
{
    const glm::dvec3 shine(0.3, -0.4, -0.6);
    check_floor(sun(shine, 5.0f), [&](const glm::dvec3&) { return 5.0 / pi * 0.6 / glm::length(shine); }, 1e-5);
    // From below: nothing.
    for (const glm::vec4& color : render_scene_with(floor_under(sun({0.3, -0.4, 0.6}, 5.0f)), film_of(above())).color) {
        ASSERT_EQ(color, glm::vec4(0, 0, 0, 1));
    }
}

TEST(SceneLight, PointsFallWithTheSquareOfDistance)
{
    const glm::dvec3 position(0.5, -0.3, 2.0);
    check_floor(
        lamp(LightType::point, position, 100.0f),
        [&](const glm::dvec3& place) {
            const double d = glm::length(position - place);
            return 100.0 / (4.0 * pi * pi * d * d) * position.z / d;
        },
        1e-5);
}

TEST(SceneLight, SpotsHaveASmoothRim)
{
    const glm::dvec3 position(0.2, 0.1, 2.5);
    SceneLight spot = lamp(LightType::spot, position, 100.0f);
    spot.direction = glm::dvec3(0.2, -0.1, -1.0);
    spot.spot_size = 1.4f;
    spot.spot_blend = 0.5f;
    for (const bool cosine : {false, true}) {
        spot.spot_cosine = cosine;
        check_floor(
            spot,
            [&](const glm::dvec3& place) {
                const glm::dvec3 across = place - position;
                const double d = glm::length(across);
                const double along = glm::dot(across / d, glm::normalize(spot.direction));
                const double rim = std::cos(0.7);
                const double t = std::clamp((along - rim) / ((1.0 - rim) * 0.5), 0.0, 1.0);
                return 100.0 / (4.0 * pi * pi * d * d) * position.z / d * t * t * (3.0 - 2.0 * t) * (cosine ? along : 1.0);
            },
            1e-5);
    }
}

// The share of the hemisphere of a floor's point, weighted by cosine, that a level rectangle fills, one of whose corners is
// above the point (x, y and h from it): Howell's catalog of configuration factors, B-3.
double corner_factor(double x, double y, double h)
{
    const double a = x / h;
    const double b = y / h;
    return (a / std::sqrt(1.0 + a * a) * std::atan(b / std::sqrt(1.0 + a * a)) +
            b / std::sqrt(1.0 + b * b) * std::atan(a / std::sqrt(1.0 + b * b))) /
           (2.0 * pi);
}

TEST(SceneLight, AreasFillTheirShareOfTheHemisphere)
{
    SceneLight area = lamp(LightType::area, {0.2, -0.1, 1.5}, 100.0f);
    area.size = glm::vec2(2.0f, 1.0f);
    check_floor(
        area,
        [&](const glm::dvec3& place) {
            const glm::dvec2 low = glm::dvec2(-0.8, -0.6) - glm::dvec2(place);
            const glm::dvec2 high = glm::dvec2(1.2, 0.4) - glm::dvec2(place);
            const double share = corner_factor(high.x, high.y, 1.5) - corner_factor(low.x, high.y, 1.5) -
                                 corner_factor(high.x, low.y, 1.5) + corner_factor(low.x, low.y, 1.5);
            return 100.0 / (4.0 * 2.0) * share;
        },
        // Of up to 3, and the pixel's filter averages over a sixth of a unit.
        0.03, 256);
    // Nothing behind it.
    area.direction = glm::dvec3(0.0, 0.0, 1.0);
    Film film = film_of(above());
    for (const glm::vec4& color : render_scene_with(floor_under(area), film).color) {
        ASSERT_EQ(color, glm::vec4(0, 0, 0, 1));
    }
}

TEST(SceneLight, SoftLampsShineAsTheirCentersDo)
{
    // Far from a lamp and over a wide disk as well: the mean over a small disk differs by its square over the distance's.
    SceneLight disk = lamp(LightType::area, {0.0, 0.0, 6.0}, 1000.0f);
    disk.shape = AreaShape::ellipse;
    disk.size = glm::vec2(0.2f, 0.1f);
    const auto as_area = [](const glm::dvec3& place) {
        const double d = glm::length(glm::dvec3(0.0, 0.0, 6.0) - place);
        return 1000.0 / (4.0 * pi * d * d) * 36.0 / (d * d);
    };
    check_floor(disk, as_area, 0.005, 64);
    SceneLight bulb = lamp(LightType::point, {0.0, 0.0, 6.0}, 1000.0f);
    bulb.radius = 0.1f;
    const auto as_point = [](const glm::dvec3& place) {
        const double d = glm::length(glm::dvec3(0.0, 0.0, 6.0) - place);
        return 1000.0 / (4.0 * pi * pi * d * d) * 6.0 / d;
    };
    check_floor(bulb, as_point, 0.002, 64);
    SceneLight wide = sun({0.0, 0.0, -1.0}, 3.0f);
    wide.angle = 1.0f;
    // Over a disk of radius r = tan(angle / 2) at distance 1 the mean cosine is 2 (sqrt(1 + r^2) - 1) / r^2.
    const double r = std::tan(0.5);
    check_floor(
        wide, [&](const glm::dvec3&) { return 3.0 / pi * 2.0 * (std::sqrt(1.0 + r * r) - 1.0) / (r * r); }, 2e-3, 256);
}

TEST(SceneLight, ShadowOfAMeshOnAMesh)
{
    // A square in the air, its shadow moved by the sun and, under a point, grown from it.
    const Mesh square = level_rectangle({-0.5f, -0.7f}, {0.9f, 0.6f}, 1.0f);
    const auto check = [&](SceneLight light, const glm::dvec2& middle, double scale, const glm::dvec2& shift) {
        Scene scene = floor_under(light);
        scene.meshes.push_back(placed(square));
        scene.meshes[1].visible_camera = false;
        const ScenePicture shadowed = render_scene_with(scene, film_of(above()));
        scene.lights[0].cast_shadow = false;
        const ScenePicture lit = render_scene_with(scene, film_of(above()));
        scene.lights[0].cast_shadow = true;
        scene.meshes[1].visible_shadow = false;
        EXPECT_EQ(render_scene_with(scene, film_of(above())).color, lit.color);
        int dark = 0;
        for (int y = 0; y < 33; ++y) {
            for (int x = 0; x < 33; ++x) {
                const glm::dvec2 place = (glm::dvec2(above().ray(x, y).origin) - shift - middle) / scale + middle;
                const bool inside = place.x > -0.5 && place.x < 0.9 && place.y > -0.7 && place.y < 0.6;
                dark += inside ? 1 : 0;
                ASSERT_EQ(shadowed.color[y * 33 + x].r, inside ? 0.0f : lit.color[y * 33 + x].r) << x << " " << y;
            }
        }
        EXPECT_GT(dark, 30);
    };
    check(sun({0.61, -0.37, -1.0}, 3.0f), {0.0, 0.0}, 1.0, {0.61, -0.37});
    check(lamp(LightType::point, {0.13, -0.21, 3.1}, 300.0f), {0.13, -0.21}, 3.1 / 2.1, {0.0, 0.0});
    // A lamp below the square: nothing between.
    Scene scene = floor_under(lamp(LightType::point, {0.13, -0.21, 0.9}, 10.0f));
    const ScenePicture alone = render_scene_with(scene, film_of(above()));
    scene.meshes.push_back(placed(square));
    scene.meshes[1].visible_camera = false;
    EXPECT_EQ(render_scene_with(scene, film_of(above())).color, alone.color);
}

TEST(SceneLight, FacetsDoNotShadeWhatTheirNormalsMakeRound)
{
    const Mesh ball = sphere({0.1f, 0.2f, -0.3f}, 1.0f, 6, 8);
    std::vector<glm::vec3> normals;
    for (const glm::vec3& position : ball.positions) {
        normals.push_back(position - glm::vec3(0.1f, 0.2f, -0.3f));
    }
    std::vector<glm::vec3> inward(normals);
    for (glm::vec3& normal : inward) {
        normal *= -2.0f;
    }
    Scene scene;
    scene.meshes.push_back(placed(ball));
    scene.lights.push_back(sun({-0.9, 0.4, -0.5}, 3.0f));
    const Film film = film_of(Camera(true, {2.0, -2.5, 1.5}, {0, 0, 0}, 0.5, {96, 96}));
    const auto dark = [&](const std::vector<glm::vec3>& given) {
        scene.meshes[0].normals = given;
        scene.lights[0].cast_shadow = true;
        const ScenePicture shadowed = render_scene_with(scene, film);
        scene.lights[0].cast_shadow = false;
        const ScenePicture lit = render_scene_with(scene, film);
        int count = 0;
        for (std::size_t i = 0; i < lit.color.size(); ++i) {
            count += lit.color[i].r > 0.02f && shadowed.color[i].r == 0.0f ? 1 : 0;
        }
        return count;
    };
    EXPECT_EQ(dark(normals), 0);
    // Normals toward the other side are those of the side that is seen.
    EXPECT_EQ(dark(inward), 0);
}

// --- Shells ---

constexpr float slab_below = 0.15f;
constexpr float slab_above = 0.35f;

const Map& slab_map()
{
    static const Map map = sdf_map(slab(slab_below, slab_above).sample(0.5f), {16, 16, 11});
    return map;
}

const Shell& square_shell()
{
    static const Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(0.5f);
    return shell;
}

// Whether the way to the sun from a place crosses the box of the square shell's slab.
bool behind_box(const glm::dvec3& place, const glm::dvec3& shine, double grown)
{
    const glm::dvec3 low = glm::dvec3(0.0, 0.0, slab_below) - grown;
    const glm::dvec3 high = glm::dvec3(1.0, 1.0, slab_above) + grown;
    const glm::dvec3 a = (low - place) / -shine;
    const glm::dvec3 b = (high - place) / -shine;
    const glm::dvec3 enter = glm::min(a, b);
    const glm::dvec3 leave = glm::max(a, b);
    return std::max({enter.x, enter.y, enter.z}) < std::min({leave.x, leave.y, leave.z});
}

TEST(SceneLight, ShadowOfAShellOnAMesh)
{
    const glm::dvec3 shine(0.4, -0.3, -1.0);
    const Mesh below = level_rectangle({-3.0f, -3.0f}, {4.0f, 4.0f}, -0.5f);
    Scene scene = floor_under(sun(shine, 3.0f));
    scene.meshes[0] = placed(below);
    scene.shells.push_back(placed(square_shell(), slab_map()));
    scene.shells[0].visible_camera = false;
    const Camera camera(false, {0.8, 0.2, 5.0}, {0.8, 0.2, 0.0}, 1.0, {80, 80});
    const ScenePicture picture = render_scene_with(scene, film_of(camera));
    int dark = 0;
    int doubtful = 0;
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 80; ++x) {
            const glm::dvec3 place(glm::dvec2(camera.ray(x, y).origin), -0.5);
            if (behind_box(place, shine, 2e-3) != behind_box(place, shine, -2e-3)) {
                doubtful += 1;
                continue;
            }
            const bool expected = behind_box(place, shine, 0.0);
            dark += expected ? 1 : 0;
            ASSERT_EQ(picture.color[y * 80 + x].r == 0.0f, expected) << x << " " << y;
        }
    }
    // The box's top and its sides, 1 by 1 and 0.2 tall, in the sun's direction: 1 + 0.2 (0.4 + 0.3).
    EXPECT_NEAR(dark + 0.5 * doubtful, 1.14 * 1600, 50);
    EXPECT_LT(doubtful, 100);
}

TEST(SceneLight, ShadowOfAMeshOnAShell)
{
    const glm::dvec3 shine(0.4, -0.3, -1.0);
    const Mesh square = level_rectangle({0.0f, 0.3f}, {0.5f, 0.9f}, 0.85f);
    Scene scene;
    scene.shells.push_back(placed(square_shell(), slab_map()));
    scene.meshes.push_back(placed(square));
    scene.meshes[0].visible_camera = false;
    scene.lights.push_back(sun(shine, 3.0f));
    const Camera camera(false, {0.5, 0.5, 5.0}, {0.5, 0.5, 0.0}, 0.45, {64, 64});
    const ScenePicture picture = render_scene_with(scene, film_of(camera));
    int dark = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            // Half a voxel, by which the ray starts too high, is a thirtieth of the height: half a pixel.
            const glm::dvec2 place = glm::dvec2(camera.ray(x, y).origin) - glm::dvec2(0.2, -0.15);
            const glm::dvec2 inside = glm::min(place - glm::dvec2(0.0, 0.3), glm::dvec2(0.5, 0.9) - place);
            const double margin = std::min(inside.x, inside.y);
            if (std::abs(margin) < 0.5 / 16 * 0.4 + 1e-3) {
                continue;
            }
            dark += margin > 0.0 ? 1 : 0;
            ASSERT_EQ(picture.color[y * 64 + x].r == 0.0f, margin > 0.0) << x << " " << y;
        }
    }
    EXPECT_GT(dark, 800);
}

TEST(SceneLight, ConvexShellsCastNoShadowOnThemselves)
{
    // A round layer: every place that faces the sun is lit, by whatever traversal, however small the cosine.
    const Shell shell = round_octahedron(4).shell(0.3f);
    const Camera camera(true, {2.0, -2.5, 1.5}, {0, 0, 0}, 0.5, {96, 96});
    GdmResolution r;
    r.nodes = glm::ivec3(2, 2, 11);
    r.ntheta = 16;
    r.nphi = 2;
    Job job;
    const Sample sample = slab(slab_below, slab_above).sample(0.5f);
    const Gdm gdm = bake_gdm(sample, r, job);
    const Sdf sdf = bake_sdf(sample, {16, 16, 11}, job);
    Map map = compress(gdm, &sdf, CompressOptions{}, job);
    map.facets = bake_facets(sample, 32, job);
    for (const Traversal traversal :
         {Traversal::refined, Traversal::gdm, Traversal::sdf, Traversal::march, Traversal::slices, Traversal::exact}) {
        Scene scene;
        scene.shells.push_back(placed(shell, map));
        scene.shells[0].sample = &sample;
        scene.shells[0].settings = settings(static_cast<int>(traversal));
        scene.lights.push_back(sun({0.9, 0.3, -0.5}, 3.0f));
        const ScenePicture shadowed = render_scene_with(scene, film_of(camera));
        scene.lights[0].cast_shadow = false;
        const ScenePicture lit = render_scene_with(scene, film_of(camera));
        const auto bright = [](const ScenePicture& picture) {
            return std::count_if(picture.color.begin(), picture.color.end(), [](const glm::vec4& c) { return c.r > 0.01f; });
        };
        EXPECT_GT(bright(lit), 1500);
        EXPECT_EQ(bright(shadowed), bright(lit)) << "traversal " << static_cast<int>(traversal);
    }
}

// --- Sky and film ---

TEST(SceneLight, SkyImageIsWhereBlenderHasItAndLightsByItsHarmonics)
{
    // Functions of direction of degree 0, 1 and 2, of which a cosine leaves 1, 2/3 and 1/4.
    const auto sky = [](const glm::dvec3& d, double first, double second) {
        return glm::dvec3(1.0 + first * (0.5 * d.x - 0.25 * d.y), 1.0 + first * 0.5 * d.z, 1.0 + second * d.x * d.y);
    };
    constexpr int rows = 128;
    std::vector<glm::vec3> image;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < 2 * rows; ++x) {
            const double elevation = ((y + 0.5) / rows - 0.5) * pi;
            const double azimuth = (0.5 - (x + 0.5) / (2 * rows)) * 2.0 * pi;
            image.emplace_back(
                sky({std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)},
                    1.0, 1.0));
        }
    }
    Scene scene;
    scene.world.image = image;
    scene.world.image_size = glm::ivec2(2 * rows, rows);
    for (const glm::dvec3& eye : {glm::dvec3(1.5, -2.4, 2.2), glm::dvec3(-2.0, 1.0, -1.8), glm::dvec3(0.4, 3.0, 0.1)}) {
        const Camera camera(true, eye, {0, 0, 0}, 0.7, {24, 24});
        const ScenePicture background = render_scene_with(scene, film_of(camera));
        for (int i = 0; i < 24 * 24; ++i) {
            const glm::dvec3 expected = sky(camera.ray(i % 24, i / 24).dir, 1.0, 1.0);
            ASSERT_LT(glm::length(glm::dvec3(background.color[i]) - expected), 2e-3) << i;
        }
        const Mesh ball = sphere({0, 0, 0}, 0.8f, 24, 32);
        Scene lit = scene;
        lit.meshes.push_back(placed(ball));
        lit.meshes[0].base_color = glm::vec3(1.0f);
        const ScenePicture picture = render_scene_with(lit, film_of(camera));
        int hits = 0;
        for (int i = 0; i < 24 * 24; ++i) {
            if (picture.index[i] == 0) {
                hits += 1;
                const glm::dvec3 expected = sky(glm::dvec3(picture.normal[i]), 2.0 / 3.0, 0.25);
                ASSERT_LT(glm::length(glm::dvec3(picture.color[i]) - expected), 2e-3) << i;
            }
        }
        EXPECT_GT(hits, 30);
    }
}

// Root of the mean square of how far alpha is from the true share of each pixel that half a plane covers.
double coverage_error(int samples, std::uint32_t seed)
{
    const Mesh half{{{-40.0f, -10.0f, 0.0f}, {40.0f, 15.0f, 0.0f}, {-40.0f, 40.0f, 0.0f}}, {{0, 1, 2}}};
    Scene scene;
    scene.meshes.push_back(placed(half));
    Film film = film_of(Camera(false, {0.0, 2.0, 5.0}, {0.0, 2.0, 0.0}, 3.0, {32, 32}), samples);
    film.filter_width = 0.0f;
    film.transparent = true;
    film.seed = seed;
    const ScenePicture picture = render_scene_with(scene, film);
    double squared = 0.0;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            int inside = 0;
            for (int i = 0; i < 32 * 32; ++i) {
                const double px = (x + (i % 32 + 0.5) / 32) / 32 * 6.0 - 3.0;
                const double py = (y + (i / 32 + 0.5) / 32) / 32 * 6.0 - 1.0;
                inside += py > 2.5 + px * 25.0 / 80.0 ? 1 : 0;
            }
            squared += std::pow(picture.color[y * 32 + x].a - inside / 1024.0, 2);
        }
    }
    return std::sqrt(squared / (32 * 32));
}

TEST(SceneLight, SamplesConverge)
{
    // Noise falls by half with four times the samples; where they are spread evenly, as an edge's area is, faster.
    const double four = coverage_error(4, 1);
    const double sixteen = coverage_error(16, 1);
    const double many = coverage_error(64, 1);
    EXPECT_GT(four, 0.01);
    EXPECT_LT(sixteen, four / 2.0);
    EXPECT_LT(many, sixteen / 2.0);
}

TEST(SceneFilm, NumbersOfDifferentSeedsAreIndependent)
{
    // Sums of products of numbers about zero: correlations, of variance 1/n where there are none.
    constexpr int count = 1024;
    double worst = 0.0;
    double squared = 0.0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        const std::uint32_t seed = mixed(pixel, 0);
        glm::dmat2 sum(0.0);
        for (int i = 0; i < count; ++i) {
            const auto index = static_cast<std::uint32_t>(i);
            sum += glm::outerProduct(spread_point(index, seed) - 0.5, spread_point(index, mixed(seed, 1)) - 0.5) *
                   (12.0 / count);
        }
        for (int i = 0; i < 4; ++i) {
            worst = std::max(worst, std::abs(sum[i / 2][i % 2]));
            squared += sum[i / 2][i % 2] * sum[i / 2][i % 2] / (64 * 4);
        }
    }
    EXPECT_LT(worst, 5.0 / std::sqrt(count));
    EXPECT_LT(std::sqrt(squared), 1.5 / std::sqrt(count));
}

TEST(SceneFilm, NumbersAreSpreadEvenly)
{
    // A (0, 2) sequence: of the first 64 points, one lies in each of 64 boxes, whatever their shape.
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        for (int wide = 0; wide <= 6; ++wide) {
            std::vector<int> boxes(64, 0);
            for (std::uint32_t i = 0; i < 64; ++i) {
                const glm::dvec2 point = spread_point(i, seed);
                const int x = static_cast<int>(point.x * (1 << wide));
                const int y = static_cast<int>(point.y * (1 << (6 - wide)));
                boxes[(x << (6 - wide)) + y] += 1;
            }
            ASSERT_EQ(std::count(boxes.begin(), boxes.end(), 1), 64) << seed << " " << wide;
        }
    }
}

TEST(SceneFilm, OffsetsHaveTheWindowsMoments)
{
    // The Blackman-Harris window's variance over [-w, w]: with a_k cos(k pi x / w), 1/3 + 2 / pi^2 sum (-1)^k' a_k / (a_0
    // k^2) times w^2, signs alternating from the middle, where all terms add up.
    const double a[4] = {0.35875, 0.48829, 0.14128, 0.01168};
    double variance = 1.0 / 3.0;
    for (int k = 1; k <= 3; ++k) {
        variance += 2.0 / (pi * pi * k * k) * (k % 2 == 1 ? -1.0 : 1.0) * a[k] / a[0];
    }
    const FilmFilter filter(1.5f);
    double sum = 0.0;
    double squared = 0.0;
    double farthest = 0.0;
    constexpr int count = 10000;
    for (int i = 0; i < count; ++i) {
        const double x = filter.offset({(i + 0.5) / count, 0.5}).x;
        sum += x / count;
        squared += x * x / count;
        farthest = std::max(farthest, std::abs(x));
    }
    EXPECT_NEAR(sum, 0.0, 1e-9);
    EXPECT_NEAR(squared, variance * 1.5 * 1.5, 1e-3 * variance);
    EXPECT_LE(farthest, 1.5);
    EXPECT_DOUBLE_EQ(FilmFilter(0.0f).offset({0.25, 0.75}).x, -0.25);
}

}  // namespace
}  // namespace mesoshell
