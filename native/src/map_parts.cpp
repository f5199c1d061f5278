#include <algorithm>
#include <cmath>
#include <string>

#include "half.h"
#include "mesoshell/compress.h"

namespace mesoshell {
namespace {

void check_array(const std::vector<float>& values, const glm::ivec3& nodes, int channels, const std::string& name)
{
    const std::size_t count = static_cast<std::size_t>(nodes.x) * nodes.y * nodes.z * channels;
    if (values.size() != count) {
        throw InvalidArgument("the attribute " + name + " has " + std::to_string(values.size()) + " values; give " +
                              std::to_string(count) + ", " + std::to_string(channels) + " for each node");
    }
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) {
        throw InvalidArgument("the attribute " + name + " holds values that are not finite, or too large for a 16-bit "
                              "float; correct the material that they come from");
    }
}

}  // namespace

void attach(Map& map, const Facets* facets, const Attributes* attributes)
{
    if (facets != nullptr) {
        if (facets->height != map.height || facets->aspect != map.aspect) {
            throw InvalidArgument("the facets and the GDM are of tiles with different height or aspect; bake both from "
                                  "one sample");
        }
        map.facets = *facets;
    }
    if (attributes != nullptr) {
        Attributes attached = *attributes;
        if (std::min(attached.nodes.x, std::min(attached.nodes.y, attached.nodes.z)) < 2) {
            throw InvalidArgument("the attributes have fewer than 2 nodes on a side; give them more");
        }
        if (map.precision != Precision::single) {
            for (std::vector<float>* values : {&attached.color, &attached.surface, &attached.normal}) {
                round_to_half(*values);
            }
        }
        check_array(attached.color, attached.nodes, 3, "color");
        check_array(attached.surface, attached.nodes, 2, "surface");
        check_array(attached.normal, attached.nodes, 3, "normal");
        map.attributes = std::move(attached);
    }
}

}  // namespace mesoshell
