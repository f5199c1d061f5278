// Texture on prisms whose tops have other UVs than their bases, and on mirrored ones: gradients, hits and pictures.
#include <cmath>

#include "camera.h"
#include "check.h"
#include "mesoshell/render.h"
#include "meshes.h"
#include "prism_truth.h"
#include "render_with.h"
#include "shell_table.h"

namespace mesoshell {
namespace {

PrismTexels sheared_prism(Random& random)
{
    const bool mirrored = random.below(2) == 1;
    const glm::dvec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.9, 0}};
    PrismTexels texels{};
    for (std::size_t i = 0; i < 3; ++i) {
        glm::dvec3 base = corners[i] + random.in_box(glm::dvec3(-0.1), glm::dvec3(0.1));
        glm::dvec3 top = base + glm::dvec3(0.0, 0.0, 0.6) + random.in_box(glm::dvec3(-0.15), glm::dvec3(0.15));
        base.x *= mirrored ? -1.0 : 1.0;
        top.x *= mirrored ? -1.0 : 1.0;
        const glm::dvec3 uv = 2.0 * corners[i] + random.in_box(glm::dvec3(-0.3), glm::dvec3(0.3));
        const glm::dvec3 uv_top = uv + random.in_box(glm::dvec3(-0.4), glm::dvec3(0.4));
        texels[i] = glm::vec4(glm::vec3(base), uv.x);
        texels[i + 3] = glm::vec4(glm::vec3(top), uv_top.x);
        texels[6][static_cast<int>(i)] = static_cast<float>(uv.y);
        (i == 0 ? texels[6].w : texels[7][static_cast<int>(i) - 1]) = static_cast<float>(uv_top.y);
    }
    return texels;
}

TEST(PrismTexture, GradientsAreThoseOfFiniteDifferences)
{
    // A linear field of metric texture space, seen from object space through the inverse map in double precision.
    Random random(41);
    for (int i = 0; i < 2000; ++i) {
        const PrismTexels prism = sheared_prism(random);
        const PrismTruth truth(prism);
        const glm::vec3 scale(1.0f, random.uniform(0.5, 2.0), random.uniform(0.2, 1.0));
        const glm::dvec3 gradient = random.direction();
        const auto field = [&](const glm::dvec3& point) {
            const glm::dvec3 q = truth.locate(point).q;
            return glm::dot(gradient, glm::dvec3(texture_at(prism, q), q.z) * glm::dvec3(scale));
        };
        const double a = random.uniform(0.1, 0.4);
        const glm::vec3 q(a, random.uniform(0.1, 0.4), random.uniform(0.1, 0.9));
        const glm::dvec3 point = truth.position(glm::dvec3(q));
        constexpr double step = 1e-5;
        glm::dvec3 expected;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 offset(0.0);
            offset[axis] = step;
            expected[axis] = (field(point + offset) - field(point - offset)) / (2.0 * step);
        }
        const glm::dvec3 carried(prism_normal(prism, q, scale, glm::vec3(gradient)));
        ASSERT_LE(glm::length(glm::normalize(carried) - glm::normalize(expected)), 1e-5) << "prism " << i;
    }
}

// A ball off the middle of a tile as high as half its width, so that every mirror image of it is another tile.
constexpr float tile_height = 0.5f;

Map ball_at(const glm::vec3& center)
{
    return sdf_map(sphere(center, 0.17f, 24, 48).sample(tile_height), {48, 48, 25});
}

TEST(PrismTexture, TopUvsShearThePattern)
{
    // Over the unit square the tile is object space but for a shear: at height z its u is x + 0.3 z / h, its v y - 0.2 z / h.
    Shell shell = flat_grid(2, 2, 1.0f, 1.0f).shell(tile_height);
    for (const glm::vec2& uv : shell.topology->uvs) {
        shell.top_uvs.push_back(uv + glm::vec2(0.3f, -0.2f));
    }
    Job job;
    make_table(shell, job);
    const glm::vec3 center(0.55f, 0.4f, 0.25f);
    const Camera camera(true, {1.6, -1.4, 1.9}, {0.5, 0.5, 0.2}, 0.17, {120, 120});
    const Rendering picture = render_with(shell, ball_at(center), camera.view(), sdf_traversal);
    int hits = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 120; ++x) {
            const auto pixel = static_cast<std::size_t>(y * 120 + x);
            if (picture.hit[pixel] == 0) {
                continue;
            }
            const CameraRay ray = camera.ray(x, y);
            const glm::dvec3 point = ray.origin + ray.dir * double(picture.distance[pixel]);
            const double w = point.z / tile_height;
            const glm::dvec3 expected(point.x + 0.3 * w, point.y - 0.2 * w, w);
            ASSERT_LE(glm::length(glm::dvec3(picture.texture[pixel]) - expected), 2e-5) << "pixel " << x << " " << y;
            // The ball's outward gradient, through the shear's transpose; away from the rim, where a voxel's gradient tells.
            const glm::dvec3 metric = expected * glm::dvec3(1.0, 1.0, tile_height);
            const glm::dvec3 away = metric - glm::dvec3(center);
            const glm::dvec3 out = away - glm::floor(away + 0.5) * glm::dvec3(1, 1, 0);
            const glm::dvec3 normal(out.x, out.y, (0.3 * out.x - 0.2 * out.y) / tile_height + out.z);
            ASSERT_GE(glm::dot(glm::normalize(normal), glm::dvec3(picture.normal[pixel])), 0.995)
                << "pixel " << x << " " << y;
            hits += 1;
        }
    }
    EXPECT_GT(hits, 1500);
}

// A torus of no symmetry.
SurfaceMesh bumpy_torus()
{
    SurfaceMesh mesh = torus(1.0f, 0.42f, 16, 10, 7.0f, 3.0f);
    Random random(42);
    for (glm::vec3& position : mesh.positions) {
        position += glm::vec3(random.in_box(glm::dvec3(-0.04), glm::dvec3(0.04)));
    }
    return mesh;
}

// Its mirror image in the plane x = 0, still facing outward: each face is turned over about the diagonal that divides it.
SurfaceMesh mirrored(SurfaceMesh mesh)
{
    for (glm::vec3& position : mesh.positions) {
        position.x = -position.x;
    }
    mesh.normals.clear();
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
        std::swap(mesh.corners[4 * face + 1], mesh.corners[4 * face + 3]);
        std::swap(mesh.uvs[4 * face + 1], mesh.uvs[4 * face + 3]);
    }
    return mesh;
}

SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b, const glm::vec3& a_offset, const glm::vec3& b_offset)
{
    SurfaceMesh both = a;
    both.normals.clear();
    for (glm::vec3& position : both.positions) {
        position += a_offset;
    }
    for (const glm::vec3& position : b.positions) {
        both.positions.push_back(position + b_offset);
    }
    for (const std::int32_t corner : b.corners) {
        both.corners.push_back(corner + static_cast<std::int32_t>(a.positions.size()));
    }
    both.face_sizes.insert(both.face_sizes.end(), b.face_sizes.begin(), b.face_sizes.end());
    both.uvs.insert(both.uvs.end(), b.uvs.begin(), b.uvs.end());
    return both;
}

// The picture is the other's mirror image, hit for hit: distances, normals and texture coordinates.
void expect_mirror_image(const Rendering& picture, const Rendering& image)
{
    const glm::ivec2 size = picture.size;
    int hits = 0;
    int apart = 0;
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const auto here = static_cast<std::size_t>(y * size.x + x);
            const auto there = static_cast<std::size_t>(y * size.x + size.x - 1 - x);
            hits += picture.hit[here];
            const glm::vec3 turned = picture.normal[here] * glm::vec3(-1.0f, 1.0f, 1.0f);
            const bool same = picture.hit[here] == image.hit[there] &&
                              (picture.hit[here] == 0 || (std::abs(picture.distance[here] - image.distance[there]) < 1e-4f &&
                                                          glm::length(turned - image.normal[there]) < 1e-2f &&
                                                          glm::length(picture.texture[here] - image.texture[there]) < 1e-3f));
            apart += same ? 0 : 1;
        }
    }
    EXPECT_GT(hits, size.x * size.y / 30);
    // At the rim of a ball a rounding decides.
    EXPECT_LE(apart, hits / 500);
}

TEST(PrismTexture, MirroredIslandGivesTheMirrorImage)
{
    const Map map = ball_at({0.35f, 0.6f, 0.2f});
    const SurfaceMesh mesh = bumpy_torus();
    const glm::ivec2 size(140, 140);
    const View view = Camera(true, {2.1, -2.4, 1.9}, {0.1, 0.0, 0.0}, 0.4, size).view();
    View mirror = view;
    const glm::dmat4 flip(glm::dvec4(-1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, 0, 0, 1));
    mirror.clip_from_object = flip * view.clip_from_object * flip;
    for (const int level : {1, 2}) {
        SCOPED_TRACE(level);
        const Rendering picture = render_with(mesh.shell(0.2f, level), map, view, sdf_traversal);
        expect_mirror_image(picture, render_with(mirrored(mesh).shell(0.2f, level), map, mirror, sdf_traversal));
    }
    // Both islands in one mesh, seen from the plane between them: a picture that is its own mirror image.
    const Shell both = joined(mesh, mirrored(mesh), {1.9f, 0.0f, 0.0f}, {-1.9f, 0.0f, 0.0f}).shell(0.2f, 1);
    const View between = Camera(true, {0.0, -4.0, 3.0}, {0, 0, 0}, 0.75, size).view();
    const Rendering pair = render_with(both, map, between, sdf_traversal);
    expect_mirror_image(pair, pair);
}

TEST(PrismTexture, MirroredUvsOfAMirroredTileAreTheSamePicture)
{
    SurfaceMesh mesh = bumpy_torus();
    const glm::ivec2 size(140, 140);
    const View view = Camera(true, {2.1, -2.4, 1.9}, {0.1, 0.0, 0.0}, 0.4, size).view();
    const Rendering picture = render_with(mesh.shell(0.2f, 1), ball_at({0.35f, 0.6f, 0.2f}), view, sdf_traversal);
    for (glm::vec2& uv : mesh.uvs) {
        uv.x = -uv.x;
    }
    const Rendering image = render_with(mesh.shell(0.2f, 1), ball_at({0.65f, 0.6f, 0.2f}), view, sdf_traversal);
    int hits = 0;
    int apart = 0;
    for (std::size_t i = 0; i < picture.hit.size(); ++i) {
        hits += picture.hit[i];
        const bool same = picture.hit[i] == image.hit[i] &&
                          (picture.hit[i] == 0 || (std::abs(picture.distance[i] - image.distance[i]) < 1e-3f &&
                                                   glm::length(picture.normal[i] - image.normal[i]) < 2e-2f));
        apart += same ? 0 : 1;
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LE(apart, hits / 500);
}

}  // namespace
}  // namespace mesoshell
