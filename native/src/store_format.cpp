#include "store_format.h"

#include <cstdio>
#include <utility>

namespace mesoshell::store {

std::string Shape::text() const
{
    return std::to_string(rows) + " " + std::to_string(columns) + " " + std::to_string(height) + " " + std::to_string(width);
}

std::vector<Part> parts_of(const Map& map)
{
    const GdmResolution& r = map.resolution;
    std::vector<Part> parts{
        {"gdm.weights", "Y", "tile widths", {map.terms, map.weight_azimuths(), r.nodes.y, r.nodes.x}, map.weights},
        {"gdm.eigenmaps", "Y", "tile widths", {map.terms, map.eigen_azimuths(), r.ntheta, r.nodes.z}, map.eigenmaps}};
    if (map.layout != Layout::nodes) {
        std::swap(parts[1].shape.rows, parts[1].shape.columns);
    }
    if (!map.sdf.empty()) {
        parts.push_back({"sdf", "Y", "tile widths", {1, map.sdf_nodes.z, map.sdf_nodes.y, map.sdf_nodes.x},
                         map.sdf});
    }
    if (const Facets& f = map.facets; !f.texels.empty()) {
        parts.push_back({"facets", "RGBA", "bits", {1, f.depth(), f.cells.y, f.cells.x}, f.texels, true});
    }
    if (const Attributes& a = map.attributes; !a.color.empty()) {
        const Shape shape{1, a.nodes.z, a.nodes.y, a.nodes.x};
        parts.push_back({"color", "RGB", "linear reflectance", shape, a.color});
        parts.push_back({"surface", "RM", "roughness and metallic, 0 to 1", shape, a.surface});
        parts.push_back({"normal", "XYZ", "unit vectors", shape, a.normal});
    }
    return parts;
}

std::string checksum(const Map& map, const std::vector<float>& values)
{
    std::uint64_t hash = 0xCBF29CE484222325u;
    const auto add = [&](const float* numbers, std::size_t count) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(numbers);
        for (std::size_t i = 0; i < count * sizeof(float); ++i) {
            hash = (hash ^ bytes[i]) * 0x100000001B3u;
        }
    };
    const float settings[4] = {map.height, map.aspect, map.rmse, map.max_error};
    add(settings, 4);
    add(values.data(), values.size());
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

}  // namespace mesoshell::store
