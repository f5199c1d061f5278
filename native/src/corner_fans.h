// Normals of chosen vertices from the faces around them, computed again whenever positions change.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace mesoshell {

// For each chosen vertex the corners of faces at it, in the order of the faces.
class CornerFans {
public:
    CornerFans() = default;
    // `chosen` has one a vertex.
    CornerFans(std::span<const std::int32_t> face_sizes, std::span<const std::int32_t> corners,
               const std::vector<bool>& chosen);

    std::size_t size() const { return vertices_.size(); }
    std::uint32_t vertex(std::size_t fan) const { return vertices_[fan]; }
    // Face normals weighted by the angle at the vertex, so that triangulation does not matter. Unit length; zero where no
    // face at the vertex has an area, or where they cancel.
    glm::vec3 normal(std::size_t fan, std::span<const glm::vec3> positions) const;

    std::size_t bytes() const
    {
        return (vertices_.capacity() + firsts_.capacity()) * sizeof(std::uint32_t) + sides_.capacity() * sizeof(Sides);
    }

private:
    struct Sides {
        std::uint32_t next;
        std::uint32_t before;
    };
    std::vector<std::uint32_t> vertices_;
    std::vector<std::uint32_t> firsts_{0};
    std::vector<Sides> sides_;
};

}  // namespace mesoshell
