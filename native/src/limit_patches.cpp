#include "limit_patches.h"

#include <algorithm>
#include <vector>

namespace mesoshell {

bool patches_take(const OpenSubdiv::Far::TopologyLevel& mesh, int face)
{
    constexpr std::size_t most_creases = 8;
    std::int32_t most = 0;
    bool only_quads = true;
    std::vector<int> creases;
    for (const int vertex : mesh.GetFaceVertices(face)) {
        most = std::max<std::int32_t>(most, mesh.GetVertexFaces(vertex).size());
        for (const int beside : mesh.GetVertexFaces(vertex)) {
            const std::int32_t size = mesh.GetFaceVertices(beside).size();
            most = std::max(most, size);
            only_quads = only_quads && size == 4;
        }
        for (const int edge : mesh.GetVertexEdges(vertex)) {
            if (mesh.GetEdgeSharpness(edge) > 0.0f && std::find(creases.begin(), creases.end(), edge) == creases.end()) {
                creases.push_back(edge);
            }
        }
        if (most > most_patch_faces || (creases.size() > most_creases && !only_quads)) {
            return false;
        }
    }
    return only_quads || creases.size() <= most_creases;
}

}  // namespace mesoshell
