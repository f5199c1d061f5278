// A shell that is updated is the shell that would be built.
#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "check.h"
#include "surface_builders.h"

namespace mesoshell {
namespace {

std::vector<CreasedMesh> meshes()
{
    std::vector<CreasedMesh> all{cube(), torus(1.0f, 0.4f, 9, 6, 2.0f, 1.0f), cone(9), flat_grid(4, 3, 1.0f, 1.0f)};
    all.push_back(all[0]);
    all.back().crease(0, 1, 10.0f);
    all.back().corner(7, 2.5f);
    for (CreasedMesh& mesh : all) {
        mesh.normals.clear();
    }
    return all;
}

std::vector<Refinement> refinements(const CreasedMesh& mesh)
{
    std::vector<Refinement> all{to_level(1), to_level(3), to_level(2, Scheme::bilinear), to_length(0.2f)};
    if (std::all_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](int size) { return size <= 4; })) {
        all.push_back(to_level(0));
    }
    return all;
}

TEST(ShellUpdate, WhereNothingMovesNothingChanges)
{
    for (const CreasedMesh& mesh : meshes()) {
        for (const Refinement& refinement : refinements(mesh)) {
            const Shell shell = shell_of(mesh.surface(), refinement);
            const Shell same = update_shell(shell, {mesh.positions, mesh.normals, {}});
            EXPECT_EQ(same.prisms, shell.prisms);
            EXPECT_EQ(same.indices, shell.indices);
            EXPECT_EQ(same.topology, shell.topology);
            EXPECT_EQ(same.tangents, shell.tangents);
            EXPECT_EQ(same.lower, shell.lower);
            EXPECT_EQ(same.upper, shell.upper);
        }
    }
}

TEST(ShellUpdate, IsBitByBitWhatABuildGives)
{
    for (CreasedMesh mesh : meshes()) {
        for (Refinement refinement : refinements(mesh)) {
            const Shell shell = shell_of(mesh.surface(), refinement);
            CreasedMesh moved = mesh;
            Random random(7);
            for (glm::vec3& p : moved.positions) {
                p += glm::vec3(random.in_box(glm::dvec3(-0.2), glm::dvec3(0.2)));
            }
            const Shell updated = update_shell(shell, {moved.positions, moved.normals, {}});
            if (refinement.edge_length > 0.0f) {
                continue;  // a build elsewhere splits other edges; LimitTruth holds what it evaluates
            }
            const Shell built = shell_of(moved.surface(), refinement);
            EXPECT_EQ(updated.positions, built.positions);
            EXPECT_EQ(updated.directors, built.directors);
            EXPECT_EQ(updated.tangents, built.tangents);
            EXPECT_EQ(updated.thickness, built.thickness);
            EXPECT_EQ(updated.topology->uvs, built.topology->uvs);
        }
    }
}

TEST(ShellUpdate, ARigidMotionMovesTheShellAlong)
{
    // A quarter turn about z and a step of powers of two: exact, so that even the choice of diagonals stays.
    const auto turn = [](const glm::vec3& p) { return glm::vec3(-p.y, p.x, p.z); };
    for (const CreasedMesh& mesh : meshes()) {
        for (const Refinement& refinement : refinements(mesh)) {
            const Shell shell = shell_of(mesh.surface(), refinement);
            CreasedMesh moved = mesh;
            for (glm::vec3& p : moved.positions) {
                p = turn(p);
            }
            const Shell updated = update_shell(shell, {moved.positions, {}, {}});
            for (std::size_t i = 0; i < shell.positions.size(); ++i) {
                ASSERT_EQ(updated.positions[i], turn(shell.positions[i]));
                ASSERT_LT(glm::length(updated.directors[i] - turn(shell.directors[i])), 1e-6f);
            }
        }
    }
}

TEST(ShellUpdate, ABuildElsewhereHasTheSameTriangles)
{
    // A torus, both diagonals of whose quads are equally long but for roundings, which turn with it: a farm's machine that
    // begins at a later frame builds what the others have updated.
    const CreasedMesh mesh = torus(1.0f, 0.4f, 24, 12, 2.0f, 1.0f);
    const glm::mat3 turn(glm::rotate(glm::dmat4(1.0), 1.0, glm::dvec3(0.3, 0.5, 0.8)));
    CreasedMesh moved = mesh;
    for (glm::vec3& p : moved.positions) {
        p = turn * p + glm::vec3(3.0f, -1.0f, 2.0f);
    }
    for (const int levels : {0, 1}) {
        EXPECT_EQ(shell_of(moved.surface(), to_level(levels)).topology->triangles,
                  shell_of(mesh.surface(), to_level(levels)).topology->triangles);
    }
}

TEST(ShellUpdate, GoesOnFromAnUpdate)
{
    const CreasedMesh mesh = torus(1.0f, 0.4f, 9, 6, 2.0f, 1.0f);
    const Shell shell = shell_of(mesh.surface(), to_level(2));
    std::vector<glm::vec3> positions = mesh.positions;
    Shell moved = shell;
    for (int frame = 0; frame < 20; ++frame) {
        for (glm::vec3& p : positions) {
            p.z += 0.125f * p.x;
        }
        moved = update_shell(moved, {positions, {}, {}});
    }
    EXPECT_EQ(moved.prisms, update_shell(shell, {positions, {}, {}}).prisms);
    EXPECT_EQ(update_shell(moved, {mesh.positions, {}, {}}).prisms, shell.prisms);
}

TEST(ShellUpdate, ThreadsDoNotMatter)
{
    const CreasedMesh mesh = torus(1.0f, 0.4f, 40, 30, 2.0f, 1.0f);
    for (const Refinement& refinement : refinements(mesh)) {
        const Shell shell = shell_of(mesh.surface(), refinement, 1);
        EXPECT_EQ(shell.prisms, shell_of(mesh.surface(), refinement, 2).prisms);
        std::vector<glm::vec3> positions = mesh.positions;
        positions[0] *= 2.0f;
        Job one(1);
        Job two(2);
        EXPECT_EQ(update_shell(shell, {positions, {}, {}}, one).prisms, update_shell(shell, {positions, {}, {}},
                                                                                     two).prisms);
    }
}

TEST(ShellUpdate, GivenNormalsCountAtLevelZero)
{
    const SurfaceMesh mesh = torus(1.0f, 0.4f, 9, 6, 2.0f, 1.0f);
    const Shell shell = shell_of(mesh.surface(), to_level(0));
    std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0.0f, 0.0f, 3.0f));
    for (const glm::vec3& director : update_shell(shell, {mesh.positions, normals, {}}).directors) {
        EXPECT_EQ(director, glm::vec3(0.0f, 0.0f, 1.0f));
    }
    SurfaceMesh plain = mesh;
    plain.normals.clear();
    EXPECT_EQ(update_shell(shell, {mesh.positions, {}, {}}).directors, shell_of(plain.surface(), to_level(0)).directors);
}

TEST(ShellUpdate, WhatIsRefused)
{
    const SurfaceMesh mesh = cube();
    const Shell shell = shell_of(mesh.surface(), to_level(1));
    const auto refused = [&](const Pose& pose, std::initializer_list<const char*> words) {
        expect_refusal<InvalidArgument>([&] { update_shell(shell, pose); }, words);
    };
    std::vector<glm::vec3> positions = mesh.positions;
    positions.pop_back();
    refused({positions, {}, {}}, {"8 vertices", "7 positions", "build it again"});
    refused({{}, {}, {}}, {"8 vertices", "0 positions"});
    positions.emplace_back(NAN);
    refused({positions, {}, {}}, {"vertex 7", "not finite"});
    const std::vector<float> factors(7, 1.0f);
    refused({mesh.positions, {}, factors}, {"7 thickness factors", "8 vertices"});
    const std::vector<float> beyond(8, 1.5f);
    refused({mesh.positions, {}, beyond}, {"thickness factor of vertex 0", "0 to 1"});
    refused({mesh.positions, std::vector<glm::vec3>(3), {}}, {"3 normals"});
    // All in one point: no face has an area.
    const std::vector<glm::vec3> point(8, glm::vec3(1.0f));
    expect_refusal<Error>([&] { update_shell(shell, {point, {}, {}}); }, {"no normal"});
}

TEST(LimitInterpolation, KeepsConstantsAndFollowsPositions)
{
    Random random(3);
    for (const CreasedMesh& mesh : meshes()) {
        for (const Refinement& refinement : refinements(mesh)) {
            Job job;
            LimitSurface limit(mesh.surface(), refinement, job);
            const std::vector<float> ones = limit.interpolate(std::vector<float>(mesh.positions.size(), 1.0f), job);
            std::vector<float> x;
            std::vector<float> any;
            for (const glm::vec3& p : mesh.positions) {
                x.push_back(p.x);
                any.push_back(static_cast<float>(random.below(2)));
            }
            const std::vector<float> along = limit.interpolate(x, job);
            const std::vector<float> between = limit.interpolate(any, job);
            const LimitPoints points = limit.evaluate(mesh.positions, mesh.normals, job);
            ASSERT_EQ(ones.size(), points.positions.size());
            for (std::size_t i = 0; i < ones.size(); ++i) {
                ASSERT_NEAR(ones[i], 1.0f, 1e-6f);
                ASSERT_NEAR(along[i], points.positions[i].x, refinement.edge_length > 0.0f ? 1e-2f : 1e-6f);
                ASSERT_GE(between[i], -1e-6f);
                ASSERT_LE(between[i], 1.0f + 1e-6f);
            }
        }
    }
}

}  // namespace
}  // namespace mesoshell
