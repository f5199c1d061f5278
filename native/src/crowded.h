// Surfaces with more faces around a vertex or an edge than OpenSubdiv has room for.
#pragma once

#include <vector>

#include <opensubdiv/far/topologyRefiner.h>

#include "mesoshell/surface.h"

namespace mesoshell {

// OpenSubdiv gives the faces around a vertex as much room in its masks as the greatest number of edges at any vertex of the level.
// Where sheets meet at an edge a vertex may have more faces than edges, and a mask would be written beyond its buffer. Returns the
// most faces around any vertex, if that is more than the edges at any of its level; else 0.
int missing_valence(const OpenSubdiv::Far::TopologyRefiner& refiner);

// A surface with a fan of triangles beside it, around a vertex with so many edges: room for the others' masks, at every level. Its
// faces and vertices come last.
class SurfaceWithFan {
public:
    SurfaceWithFan(const Surface& surface, int valence);
    Surface surface() const;

private:
    Surface given_;
    std::vector<glm::vec3> positions_;
    std::vector<std::int32_t> face_sizes_;
    std::vector<std::int32_t> corners_;
    std::vector<glm::vec2> uvs_;
};

}  // namespace mesoshell
