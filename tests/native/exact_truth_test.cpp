// The traversal `exact` against the tile's triangles mapped forward into the shell, with which it shares no code.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "camera.h"
#include "check.h"
#include "embree_scene.h"
#include "exact_tracer.h"
#include "mesoshell/realize.h"
#include "meshes.h"
#include "prism_truth.h"
#include "render_with.h"
#include "shell_tracer.h"

namespace mesoshell {
namespace {

// The same surface of four triangles for each.
Mesh split(const Mesh& mesh)
{
    Mesh finer;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3& a = mesh.positions[t.x];
        const glm::vec3& b = mesh.positions[t.y];
        const glm::vec3& c = mesh.positions[t.z];
        const auto first = static_cast<std::uint32_t>(finer.positions.size());
        finer.positions.insert(finer.positions.end(), {a, b, c, (a + b) * 0.5f, (b + c) * 0.5f, (c + a) * 0.5f});
        for (const glm::uvec3 part : {glm::uvec3(0, 3, 5), {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
            finer.triangles.push_back(part + first);
        }
    }
    return finer;
}

Mesh split(Mesh mesh, int times)
{
    for (int i = 0; i < times; ++i) {
        mesh = split(mesh);
    }
    return mesh;
}

// Two balls with few edges, of triangles so small that mapping their corners maps them: one lies across the tile's borders
// unless `inside`.
Sample two_balls(bool inside = false, int splits = 2)
{
    const glm::vec3 second = inside ? glm::vec3(0.8f, 0.8f, 0.2f) : glm::vec3(0.95f, 0.1f, 0.2f);
    return split(merged(sphere({0.4f, 0.4f, 0.32f}, 0.26f, 6, 8), sphere(second, 0.15f, 5, 6)), splits).sample(0.6f);
}

// --- One prism: triangles mapped corner by corner ---

// Texture space, (u, v) and height, to prism coordinates: at one height UVs are linear in the weights.
glm::dvec3 place_of(const PrismTexels& prism, const glm::dvec3& texture)
{
    const glm::dvec2 origin = texture_at(prism, {0.0, 0.0, texture.z});
    const glm::dmat2 edges(texture_at(prism, {1.0, 0.0, texture.z}) - origin,
                           texture_at(prism, {0.0, 1.0, texture.z}) - origin);
    return glm::dvec3(glm::inverse(edges) * (glm::dvec2(texture) - origin), texture.z);
}

TEST(ExactTruth, MappedTrianglesConvergeToIt)
{
    // Twisted, tapered, with a top whose UVs are others, and so large that it holds one ball.
    PrismTexels prism = prism_of({glm::vec3(0.0f), {2.0f, 0.1f, 0.2f}, {0.1f, 2.2f, -0.1f}},
                                 {glm::vec3(0.4f, -0.2f, 1.0f), {1.8f, 0.5f, 1.1f}, {-0.3f, 1.7f, 1.4f}});
    const glm::vec2 uvs[6] = {{-0.2f, -0.15f}, {1.35f, -0.1f}, {-0.1f, 1.4f},
                              {-0.15f, -0.2f}, {1.3f, -0.05f}, {-0.1f, 1.35f}};
    float* const v[6] = {&prism[6].x, &prism[6].y, &prism[6].z, &prism[6].w, &prism[7].x, &prism[7].y};
    for (std::size_t i = 0; i < 6; ++i) {
        prism[i].w = uvs[i].x;
        *v[i] = uvs[i].y;
    }
    const PrismTruth map(prism);
    const double height = 0.6;
    const Mesh ball = sphere({0.4f, 0.4f, 0.3f}, 0.22f, 6, 8);
    const ExactTracer tracer(ball.sample(static_cast<float>(height)));
    const glm::dvec3 middle = map.position({0.35, 0.35, 0.5});
    double before = 0.0;
    for (int splits = 0; splits < 5; ++splits) {
        Mesh mapped = split(ball, splits);
        for (glm::vec3& p : mapped.positions) {
            p = glm::vec3(map.position(place_of(prism, glm::dvec3(p.x, p.y, p.z / height))));
        }
        const TriangleScene scene(mapped.positions, mapped.triangles);
        Random random(60);
        std::vector<double> errors;
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 dir(random.direction());
            const glm::vec3 origin(middle + 0.3 * random.direction() - 4.0 * glm::dvec3(dir));
            const ExactHit found = tracer.nearest(prism, {glm::dvec3(origin), glm::dvec3(dir)}, 0.0, 100.0);
            const TriangleHit wanted = scene.intersect1(origin, dir, 0.0f, 100.0f);
            if (found.hit && wanted.hit) {
                errors.push_back(std::abs(found.t - wanted.t));
                EXPECT_LT(glm::length(glm::dvec3(origin) + glm::dvec3(dir) * found.t - map.position(found.q)), 1e-6);
            }
        }
        ASSERT_GT(errors.size(), 1000u);
        std::sort(errors.begin(), errors.end());
        const double median = errors[errors.size() / 2];
        if (splits > 0) {
            EXPECT_LT(median, 0.4 * before);
        }
        before = median;
    }
    EXPECT_LT(before, 1e-5);
}

// --- Pictures: the realized mesh ---

// The law of the project, on tiles of about half a unit of object space, whose prisms are about as large.
void check_law(const Shell& shell, const Sample& sample, const glm::dvec3& eye)
{
    Job job;
    RealizeOptions options;
    options.error = 2.5e-4f;
    const RealizedMesh mesh = realize(shell, sample, options, job);
    const Camera camera(true, eye, {0, 0, 0}, 0.55, {256, 256});
    const Rendering drawn = render_exactly(shell, sample, camera.view());
    const Trace truth = trace(mesh.positions, mesh.triangles, camera.view(), job);
    int either = 0;
    std::vector<double> errors;
    std::vector<double> angles;
    for (std::size_t i = 0; i < drawn.hit.size(); ++i) {
        either += drawn.hit[i] | truth.hit[i];
        if ((drawn.hit[i] & truth.hit[i]) != 0) {
            errors.push_back(std::abs(drawn.distance[i] - truth.distance[i]));
            const double cosine = glm::dot(glm::dvec3(drawn.normal[i]), glm::dvec3(truth.normal[i]));
            angles.push_back(glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))));
        }
    }
    ASSERT_GT(errors.size(), 6000u);
    std::sort(errors.begin(), errors.end());
    std::sort(angles.begin(), angles.end());
    EXPECT_GE(static_cast<double>(errors.size()) / either, 0.998);
    // The realized mesh is flat between its corners: where they are half as far apart, depth is off by a quarter of this.
    EXPECT_LT(errors[errors.size() * 99 / 100], 4e-4);
    EXPECT_LT(angles[angles.size() * 99 / 100], 1.0);
}

// Every second face has the tile mirrored.
SurfaceMesh mirrored_islands(SurfaceMesh mesh)
{
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
        for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
            mesh.uvs[corner].x *= face % 2 == 0 ? 1.0f : -1.0f;
        }
    }
    return mesh;
}

SurfaceMesh saddle(int columns, float width)
{
    SurfaceMesh mesh = flat_grid(columns, columns, width, width);
    for (glm::vec3& p : mesh.positions) {
        const glm::vec2 q = glm::vec2(p) - 0.5f * width;
        p = glm::vec3(q, 0.25f * (q.x * q.x - q.y * q.y));
        mesh.normals.push_back(glm::normalize(glm::vec3(-0.5f * q.x, 0.5f * q.y, 1.0f)));
    }
    for (glm::vec2& uv : mesh.uvs) {
        uv *= 2.0f;
    }
    return mesh;
}

TEST(ExactTruth, Torus)
{
    check_law(torus(1.0f, 0.4f, 36, 20, 9.0f, 6.0f).shell(0.3f), two_balls(), {1.5, -2.4, 2.2});
}

TEST(ExactTruth, TorusOfMirroredIslands)
{
    check_law(mirrored_islands(torus(1.0f, 0.4f, 14, 8, 14.0f, 8.0f)).shell(0.3f), two_balls(true), {1.5, -2.4, 2.2});
}

TEST(ExactTruth, TorusWhoseTopHasUvsOfItsOwn)
{
    ShellOptions options;
    options.thickness = 0.3f;
    options.relax_steps = 30;
    check_law(build_shell(torus(1.0f, 0.4f, 36, 20, 9.0f, 6.0f).surface(), options), two_balls(), {1.5, -2.4, 2.2});
}

TEST(ExactTruth, Saddle)
{
    check_law(saddle(5, 2.0f).shell(0.3f), two_balls(true), {1.2, -1.6, 1.8});
}

TEST(ExactTruth, TwistedAndTaperedPrisms)
{
    SurfaceMesh mesh = saddle(6, 2.0f);
    std::vector<float> factors;
    Random random(61);
    for (glm::vec3& normal : mesh.normals) {
        normal = glm::normalize(normal + glm::vec3(random.direction()) * 0.3f);
        factors.push_back(static_cast<float>(random.uniform(0.5, 1.0)));
    }
    ShellOptions options;
    options.thickness = 0.3f;
    options.thickness_factors = factors;
    check_law(build_shell(mesh.surface(), options), two_balls(true, 3), {1.2, -1.6, 1.8});
}

// --- Rays of all kinds: none is lost ---

TEST(ExactTruth, NoRayIsLost)
{
    const Sample sample = two_balls();
    const Shell shell = torus(1.0f, 0.4f, 36, 20, 9.0f, 6.0f).shell(0.3f);
    Job job;
    const RealizedMesh mesh = realize(shell, sample, job);
    const TriangleScene truth(mesh.positions, mesh.triangles);
    Map map;
    map.height = sample.height();
    map.aspect = sample.aspect();
    const ShellTracer tracer(shell, map, settings(exact_traversal), &sample);
    std::vector<PrismTruth> prisms(shell.prisms.begin(), shell.prisms.end());
    constexpr float far = 20.0f;
    Random random(62);
    int hits = 0;
    int doubtful = 0;
    for (int i = 0; i < 200000; ++i) {
        // Through a point of a prism, a fin or a column; in any direction, along the triangle there, or along the fin.
        const PrismTruth& prism = prisms[static_cast<std::size_t>(random.below(static_cast<int>(prisms.size())))];
        const double q1 = i % 5 == 0 ? 0.0 : random.uniform(0.0, 1.0);
        const double q2 = i % 5 <= 1 ? 0.0 : random.uniform(0.0, 1.0 - q1);
        const glm::dvec3 q(q1, q2, random.uniform(0.0, 1.0));
        const glm::dvec3 point = prism.position(q);
        const glm::dvec3 edge = prism.column(1, q.z) - prism.column(0, q.z);
        const glm::dvec3 normal = glm::normalize(glm::cross(edge, prism.column(2, q.z) - prism.column(0, q.z)));
        glm::dvec3 dir = random.direction();
        if (i % 3 == 1) {
            dir = glm::normalize(dir - glm::dot(dir, normal) * normal);
        } else if (i % 3 == 2) {
            const glm::dvec3 rise = prism.position({q1, q2, 1.0}) - prism.position({q1, q2, 0.0});
            dir = glm::normalize(edge * random.uniform(-1.0, 1.0) + rise * random.uniform(-1.0, 1.0));
        }
        const glm::vec3 origin(point - 5.0 * dir);
        const glm::vec3 along(dir);
        const ShellTraceHit found = tracer.nearest(origin, along, 0.0f, far);
        const TriangleHit wanted = truth.intersect1(origin, along, 0.0f, far);
        hits += wanted.hit ? 1 : 0;
        const float reached = found.hit ? found.t : far;
        float nearest = wanted.hit ? wanted.t : far;
        float farthest = nearest;
        if (std::abs(reached - nearest) < 1e-3f) {
            continue;
        }
        // At an outline or where a ray grazes, the realized mesh's error decides: it lies between what rays beside it meet.
        doubtful += 1;
        const glm::dvec3 helper = std::abs(dir.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
        const glm::dvec3 side = glm::normalize(glm::cross(dir, helper));
        const glm::dvec3 up = glm::cross(dir, side);
        for (int k = 0; k < 8; ++k) {
            const double angle = 0.7853981633974483 * k;
            const glm::vec3 beside(point - 5.0 * dir + 2e-3 * (std::cos(angle) * side + std::sin(angle) * up));
            const TriangleHit other = truth.intersect1(beside, along, 0.0f, far);
            nearest = std::min(nearest, other.hit ? other.t : far);
            farthest = std::max(farthest, other.hit ? other.t : far);
        }
        ASSERT_TRUE(nearest - 1e-3f <= reached && reached <= farthest + 1e-3f)
            << "ray " << i << " reaches " << reached << ", those beside it " << nearest << " to " << farthest;
    }
    EXPECT_GT(hits, 60000);
    EXPECT_LT(doubtful, hits / 100);
}

}  // namespace
}  // namespace mesoshell
