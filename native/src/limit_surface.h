// A mesh as a limit surface: refined once, then evaluated for every set of positions its vertices take.
// limit_refiner, limit_uniform and limit_adaptive are the sole homes of OpenSubdiv.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "corner_fans.h"
#include "mesoshell/job.h"
#include "mesoshell/surface.h"

namespace mesoshell {

// What does not depend on positions.
struct RefinedTopology {
    std::vector<std::int32_t> face_sizes;
    std::vector<std::int32_t> corners;     // vertices
    std::vector<std::int32_t> uv_corners;  // one a corner: an entry of uvs; corners of a vertex with equal UVs share one
    std::vector<glm::vec2> uvs;
    std::vector<std::int32_t> faces;  // one a face: the face of the surface it comes from
};

// One a vertex of the refined surface.
struct LimitPoints {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit length; zero where the surface has none
    // Two independent directions in the surface's tangent plane, their lengths as OpenSubdiv's masks have them; none at
    // level 0.
    std::vector<glm::mat2x3> tangents;
};

struct RefinedSurface : RefinedTopology, LimitPoints {};

// How one kind of refinement turns positions into limit points; normals are the surface's business.
class LimitEvaluator {
public:
    virtual ~LimitEvaluator() = default;
    // Positions and tangents; normals are left empty.
    virtual LimitPoints evaluate(std::span<const glm::vec3> positions, Job& job) const = 0;
    // As LimitSurface has it.
    virtual std::vector<float> interpolate(std::span<const float> values, Job& job) const = 0;
    virtual std::size_t bytes() const = 0;
};

// What a kind of refinement makes of a surface.
struct Refined {
    RefinedTopology topology;
    std::unique_ptr<const LimitEvaluator> evaluator;
    // Vertices without one tangent plane, or none that tangents tell: on creases, sharp corners and non-manifold edges.
    std::vector<bool> sharp;
};

// Immutable and free of references to the surface it was made of; may be evaluated by several threads at once.
//
// At level 0 the mesh as it is, with its own normals: those given or, without, its faces' weighted by angle. Else points,
// tangents and normals of the limit surface, exact where it is smooth. Where it has several tangent planes, as on a crease,
// or where the tangents vanish or are parallel, as around a collapsed edge, the normal is that of the refined faces around
// the vertex, weighted by angle, and the tangents are two unit vectors perpendicular to it; if those faces have no area
// either, both are zero.
class LimitSurface {
public:
    // Throws Error for a surface that OpenSubdiv refuses.
    LimitSurface(const Surface& surface, const Refinement& refinement, Job& job);

    // To be taken once; evaluating does not need it.
    RefinedTopology take_topology() { return std::move(topology_); }

    std::size_t vertices() const { return vertices_; }  // of the mesh

    // `positions` and, at level 0, `normals` (none: computed) are one a vertex of the mesh. The result does not depend on
    // the number of threads.
    LimitPoints evaluate(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals, Job& job) const;

    // Numbers at the vertices of the mesh, carried to those of the refined surface as positions are. No weight is negative,
    // so that no value leaves the range of those it comes from, but for rounding.
    std::vector<float> interpolate(std::span<const float> values, Job& job) const;

    // Memory held, without the topology.
    std::size_t bytes() const;

private:
    void mend_normals(LimitPoints& points, const CornerFans& fans, Job& job) const;

    std::size_t vertices_;
    RefinedTopology topology_;
    std::unique_ptr<const LimitEvaluator> evaluator_;  // none at level 0
    CornerFans sharp_;
    // Kept for normals that only positions ask for: around what they make degenerate, or at level 0.
    std::vector<std::int32_t> face_sizes_;
    std::vector<std::int32_t> corners_;
    mutable std::once_flag fans_made_;
    mutable CornerFans fans_;  // of all vertices, at level 0 when first asked for
};

// The address of an OpenSubdiv function, as this code calls it.
const void* opensubdiv_function();

}  // namespace mesoshell
