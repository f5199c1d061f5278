// The one home of Embree: every ray and every closest-point query goes through these classes.
// Embree 3 and Embree 4 differ only inside embree_scene_api.h.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// Sixteen rays side by side, in the layout Embree reads and writes; embree_scene.cpp asserts that.
struct alignas(64) RayPacket16 {
    float org_x[16], org_y[16], org_z[16], tnear[16];
    float dir_x[16], dir_y[16], dir_z[16], time[16];
    float tfar[16];
    std::uint32_t mask[16], id[16], flags[16];
    float normal_x[16], normal_y[16], normal_z[16];
    float u[16], v[16];
    std::uint32_t primitive[16], geometry[16], instance[16];
    std::uint32_t instance_primitive[16];  // Embree 4 alone has it
};

struct TriangleHit {
    bool hit = false;
    float t = 0.0f;
    glm::vec3 normal{0.0f};  // not normalized, by the triangle's winding
    std::uint32_t triangle = ~0u;
    glm::vec2 weights{0.0f};  // of its second and third corner
};

struct NearestPoint {
    std::uint32_t triangle = ~0u;  // all ones: none
    glm::vec2 weights{0.0f};       // of its second and third corner; the first has the rest
    float squared = 0.0f;          // distance
};

struct EmbreeHandles;

// A triangle mesh, alone or repeated on a lattice of instances.
class TriangleScene {
public:
    // How the mesh repeats: instances at (i period.x, j period.y, 0) for first <= (i, j) <= last.
    struct Lattice {
        glm::vec2 period{0.0f};
        glm::ivec2 first{0};
        glm::ivec2 last{0};
    };

    enum class Use { rays, crossings };  // count_crossings needs a scene made for it

    TriangleScene(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, Use use = Use::rays);
    TriangleScene(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles, const Lattice& lattice,
                  Use use = Use::rays);
    ~TriangleScene();
    TriangleScene(const TriangleScene&) = delete;
    TriangleScene& operator=(const TriangleScene&) = delete;

    // Nearest hits of sixteen coherent rays; tfar and geometry (all ones: none) are updated where valid[i] is -1, others stay.
    void intersect16(const std::int32_t* valid, RayPacket16& rays) const;
    TriangleHit intersect1(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar) const;
    // Whether the ray meets any triangle.
    bool occluded1(const glm::vec3& origin, const glm::vec3& dir, float tnear, float tfar) const;

    struct Crossings {
        int count = 0;    // surfaces crossed
        int winding = 0;  // those left minus those entered
    };
    // Every surface that the ray crosses.
    Crossings count_crossings(const glm::vec3& origin, const glm::vec3& dir) const;

    // Nearest of all triangles not farther away than `limit`. Of equally near ones it is the first, and of one triangle's copies
    // the first: no matter in which order they are visited.
    NearestPoint nearest(const glm::vec3& point, float limit) const;

    // Distance to the nearest triangle, at most `limit`.
    float distance(const glm::vec3& point, float limit) const;

private:
    std::unique_ptr<EmbreeHandles> handles_;
    std::vector<glm::vec3> corners_;  // three a triangle: what closest-point queries read
    std::vector<glm::vec3> offsets_;  // of every instance
};

// Boxes whose content the caller intersects: a BVH over prisms.
class BoxScene {
public:
    struct Box {
        glm::vec3 lower;
        glm::vec3 upper;
    };
    // Given the index of a box and the nearest hit so far, returns a nearer t or the same.
    using Visit = std::function<float(std::uint32_t box, float tfar)>;

    explicit BoxScene(std::span<const Box> boxes);
    ~BoxScene();
    BoxScene(const BoxScene&) = delete;
    BoxScene& operator=(const BoxScene&) = delete;

    // Calls `visit` for every box the ray meets before tfar and its nearest hit so far, in no fixed order; an infinitely negative
    // answer ends it.
    void visit_along(const glm::vec3& origin, const glm::vec3& dir, float tnear, const Visit& visit,
                     float tfar = std::numeric_limits<float>::infinity()) const;

private:
    std::unique_ptr<EmbreeHandles> handles_;
    std::vector<Box> boxes_;
};

// The address of an Embree function, as this code calls it.
const void* embree_function();

}  // namespace mesoshell
