#include "crowded.h"

#include <algorithm>

namespace mesoshell {

namespace Far = OpenSubdiv::Far;

int missing_valence(const Far::TopologyRefiner& refiner)
{
    int missing = 0;
    for (int level = 0; level <= refiner.GetMaxLevel(); ++level) {
        const Far::TopologyLevel& topology = refiner.GetLevel(level);
        int most_edges = 0;
        int most_faces = 0;
        for (int vertex = 0; vertex < topology.GetNumVertices(); ++vertex) {
            most_edges = std::max(most_edges, topology.GetVertexEdges(vertex).size());
            most_faces = std::max(most_faces, topology.GetVertexFaces(vertex).size());
        }
        if (most_faces > most_edges) {
            missing = std::max(missing, most_faces);
        }
    }
    return missing;
}

SurfaceWithFan::SurfaceWithFan(const Surface& surface, int valence)
    : given_(surface), positions_(surface.positions.begin(), surface.positions.end()),
      face_sizes_(surface.face_sizes.begin(), surface.face_sizes.end()), corners_(surface.corners.begin(), surface.corners.end()),
      uvs_(surface.uvs.begin(), surface.uvs.end())
{
    const auto center = static_cast<std::int32_t>(positions_.size());
    positions_.resize(positions_.size() + static_cast<std::size_t>(valence) + 1, glm::vec3(0.0f));
    for (std::int32_t i = 0; i < valence; ++i) {
        face_sizes_.push_back(3);
        corners_.insert(corners_.end(), {center, center + 1 + i, center + 1 + (i + 1) % valence});
    }
    uvs_.resize(corners_.size(), glm::vec2(0.0f));
}

Surface SurfaceWithFan::surface() const
{
    Surface with = given_;
    with.positions = positions_;
    with.face_sizes = face_sizes_;
    with.corners = corners_;
    with.uvs = uvs_;
    return with;
}

}  // namespace mesoshell
