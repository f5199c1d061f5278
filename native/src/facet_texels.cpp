#include "facet_texels.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mesoshell {
namespace shader_facets {

using namespace glm;  // NOLINT: the shader text speaks GLSL
#include "../../shaders/lib/facets.glsl"

}  // namespace shader_facets

namespace {

// 29 bits of each word are free. Its sign is a bit of the kind; the exponent's upper two bits are 01, which makes it a normal
// number whatever the rest is.
FacetTexel texel_of(int kind, const std::array<std::uint32_t, 4>& payloads)
{
    FacetTexel texel;
    for (int i = 0; i < 4; ++i) {
        const std::uint32_t sign = static_cast<std::uint32_t>(kind >> i & 1) << 31;
        texel[i] = std::bit_cast<float>(sign | std::uint32_t(1) << 29 | payloads[i]);
    }
    return texel;
}

std::uint32_t steps(double value, int count)
{
    return static_cast<std::uint32_t>(std::clamp(std::lround((0.5 + 0.5 * value) * count), 0l, static_cast<long>(count)));
}

int cells_along(double length, double side)
{
    return std::clamp(static_cast<int>(std::lround(length / side)), 1, 128);
}

}  // namespace

glm::ivec3 facet_cells(int cells, float height, float aspect)
{
    return glm::ivec3(cells, cells_along(aspect, 1.0 / cells), cells_along(height, 1.0 / cells));
}

FacetTexel empty_texel(const EmptyBoxes& boxes)
{
    std::array<std::uint32_t, 4> payloads{};
    for (int octant = 0; octant < 8; ++octant) {
        const glm::u8vec3& box = boxes[octant];
        const std::uint32_t codes = std::uint32_t(box.x) | std::uint32_t(box.y) << 3 | std::uint32_t(box.z) << 6;
        payloads[octant / 3] |= codes << 9 * (octant % 3);
    }
    return texel_of(shader_facets::FACET_EMPTY, payloads);
}

FacetTexel plane_texel(const FacetFit& fit, const FacetReach& reach)
{
    std::array<std::uint32_t, 4> payloads{};
    for (int i = 0; i < 4; ++i) {
        const glm::vec2 place = shader_facets::octahedral_place(glm::vec3(fit.planes[i]));
        payloads[i] = steps(place.x, 1023) | steps(place.y, 511) << 10 | steps(fit.planes[i].w, 255) << 19;
    }
    for (int axis = 0; axis < 3; ++axis) {
        payloads[axis] |= static_cast<std::uint32_t>(reach.back[axis]) << 27;
        payloads[axis] |= static_cast<std::uint32_t>(reach.forward[axis]) << 28;
    }
    return texel_of(shader_facets::FACET_ALL + fit.form, payloads);
}

FacetTexel solid_texel()
{
    return texel_of(shader_facets::FACET_SOLID, {});
}

FacetTexel split_texel(std::uint64_t parts, std::uint32_t first)
{
    std::array<std::uint32_t, 4> payloads{};
    for (int layer = 0; layer < 4; ++layer) {
        payloads[layer] = static_cast<std::uint32_t>(parts >> 16 * layer & 0xffff);
    }
    payloads[0] |= (first & 0x1fff) << 16;
    payloads[1] |= first >> 13 << 16;
    return texel_of(shader_facets::FACET_SPLIT, payloads);
}

bool facets_make_sense(const Facets& facets)
{
    const std::size_t cells = static_cast<std::size_t>(facets.cells.x) * facets.cells.y * facets.cells.z;
    if (facets.texel_count() < cells) {
        return false;
    }
    for (std::size_t i = 0; i < cells; ++i) {
        const float* const words = facets.texels.data() + 4 * i;
        const glm::vec4 texel(words[0], words[1], words[2], words[3]);
        for (int bit = 0; bit < 64 && shader_facets::facet_kind(texel) == shader_facets::FACET_SPLIT; ++bit) {
            const int number = shader_facets::part_texel(texel, glm::vec3(bit % 4, bit / 4 % 4, bit / 16));
            if (number >= 0 && static_cast<std::size_t>(number) >= facets.texel_count()) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace mesoshell
