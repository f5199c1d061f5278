// The traversal `exact`: a ray's true path in texture space against the tile's own triangles. Reads no map.
#pragma once

#include <glm/glm.hpp>

#include "embree_scene.h"
#include "exact_path.h"
#include "mesoshell/sample.h"

namespace mesoshell {

struct ExactHit {
    bool hit = false;
    double t = 0.0;               // ray parameter
    glm::dvec3 q{0.0};            // prism coordinates
    glm::dvec3 pos_texture{0.0};  // texture space
    glm::dvec3 normal{0.0};       // object space, unit length, out of the solid: the triangle's own, not smoothed
};

class ExactTracer {
public:
    // The path is replaced by chords that lie within this of it, in tile widths; a hit is then moved back onto it.
    static constexpr double most_bulge = 1e-4;

    explicit ExactTracer(const Sample& sample);

    // The nearest hit in one prism with t >= t_near, of stretches that begin before t_far; the ray is in object space. What
    // begins in the solid hits where it begins: at the slab's ends, at the shell's border, at a seam of its UVs. Any thread.
    ExactHit nearest(const PrismTexels& prism, const ExactRay& ray, double t_near, double t_far) const;

private:
    struct Meeting {
        enum class Kind { nothing, surface, inside } kind = Kind::nothing;
        double along = 0.0;      // share of the chord
        glm::dvec3 normal{0.0};  // of the surface, metric texture space, out of the solid
    };

    ExactHit nearest_in_span(const PrismTexels& prism, const ExactRay& ray, const ExactPath& path,
                             const ExactSpan& span) const;
    Meeting meet(const glm::dvec3& start, const glm::dvec3& end) const;
    double on_curve(const ExactPath& path, double a, double b, const glm::dvec3& start, const glm::dvec3& end,
                    const Meeting& meeting) const;
    bool is_inside(const glm::dvec3& point) const;
    glm::dvec3 near_tile(const glm::dvec3& point) const;

    glm::dvec3 scale_;   // metric texture space = texture space * scale
    bool plain_;         // faces tell what is inside: solids do not overlap, and face out
    glm::dvec3 upward_;  // a direction in which rays pass all that is above them within the scene's copies
    TriangleScene scene_;
};

}  // namespace mesoshell
