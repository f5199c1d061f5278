#include "triangulation.h"

#include <string>

namespace mesoshell {
namespace {

// Diagonals whose squared lengths differ by less of them count as equal, and the first is taken: on symmetric meshes they
// differ by roundings, which change as the mesh turns.
constexpr float tie = 1e-3f;

class Triangulation {
public:
    Triangulation(const RefinedSurface& surface, std::span<const std::uint8_t> covered) : surface_(surface), covered_(covered) {}

    ShellTopology run()
    {
        topology_.uvs = surface_.uvs;
        const std::size_t most = surface_.corners.size() - 2 * surface_.face_sizes.size();
        topology_.triangles.reserve(most);
        topology_.uv_triangles.reserve(most);
        topology_.faces.reserve(most);
        std::size_t first = 0;
        for (std::size_t face = 0; face < surface_.face_sizes.size(); ++face) {
            const std::int32_t size = surface_.face_sizes[face];
            if (!covered_.empty() && covered_[surface_.faces[face]] == 0) {
                first += static_cast<std::size_t>(size);
                continue;
            }
            if (size > 4) {
                throw Error("face " + std::to_string(face) + " of the surface has " + std::to_string(size) +
                            " corners; use levels = 1 or more, or triangulate it");
            }
            const glm::vec3 diagonal_02 = at(first + 2) - at(first);
            const glm::vec3 diagonal_13 = size == 4 ? at(first + 3) - at(first + 1) : glm::vec3(0.0f);
            if (size == 3) {
                add(face, first, first + 1, first + 2);
            } else if (glm::dot(diagonal_02, diagonal_02) <= (1.0f + tie) * glm::dot(diagonal_13, diagonal_13)) {
                add(face, first, first + 1, first + 2);
                add(face, first, first + 2, first + 3);
            } else {
                add(face, first, first + 1, first + 3);
                add(face, first + 1, first + 2, first + 3);
            }
            first += static_cast<std::size_t>(size);
        }
        return std::move(topology_);
    }

private:
    const glm::vec3& at(std::size_t corner) const { return surface_.positions[surface_.corners[corner]]; }

    void add(std::size_t face, std::size_t a, std::size_t b, std::size_t c)
    {
        if (glm::cross(at(b) - at(a), at(c) - at(a)) == glm::vec3(0.0f)) {
            return;
        }
        topology_.triangles.emplace_back(surface_.corners[a], surface_.corners[b], surface_.corners[c]);
        topology_.uv_triangles.emplace_back(surface_.uv_corners[a], surface_.uv_corners[b], surface_.uv_corners[c]);
        topology_.faces.push_back(surface_.faces[face]);
    }

    const RefinedSurface& surface_;
    std::span<const std::uint8_t> covered_;
    ShellTopology topology_;
};

}  // namespace

ShellTopology triangulate(const RefinedSurface& surface, std::span<const std::uint8_t> covered)
{
    ShellTopology topology = Triangulation(surface, covered).run();
    if (topology.triangles.empty()) {
        throw Error(std::string("every ") + (covered.empty() ? "" : "covered ") +
                    "face of the surface has zero area; choose a mesh with visible faces");
    }
    return topology;
}

}  // namespace mesoshell
