// A surface as OpenSubdiv's topology: UVs shared, creases and corners, boundaries and UV rules by its own names.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <opensubdiv/far/topologyRefiner.h>

#include "limit_surface.h"

namespace mesoshell {

// Corners of a vertex with equal UVs share one UV value, so that islands are what OpenSubdiv thinks they are.
struct UvTopology {
    std::vector<std::int32_t> indices;  // one a corner
    std::vector<glm::vec2> values;
};
UvTopology share_uvs(const Surface& surface);

// Throws Error where more faces than `most` are around a vertex, or more corners around a face; `limit` says why and what to
// do.
void check_valences(const Surface& surface, std::int32_t most, const std::string& limit);

// Level 0 of a surface, with its UVs as face-varying channel 0. Of several creases for one edge, or corners for one vertex,
// the last counts; a crease where no face has an edge (Blender's loose edges) is left out, as nothing is there to be
// creased. Throws Error for a mesh that OpenSubdiv refuses.
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> make_refiner(const Surface& surface, const UvTopology& uvs,
                                                               const Refinement& refinement);

// The kinds of refinement (LimitSurface).
Refined refine_uniformly(const Surface& surface, const Refinement& refinement, Job& job);
Refined refine_adaptively(const Surface& surface, const Refinement& refinement, Job& job);

}  // namespace mesoshell
