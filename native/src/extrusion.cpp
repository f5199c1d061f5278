#include "extrusion.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mesoshell {
namespace {

void check_covered(const Surface& surface, std::span<const std::uint8_t> covered)
{
    if (covered.empty()) {
        return;
    }
    if (covered.size() != surface.face_sizes.size()) {
        throw InvalidArgument("covered has " + std::to_string(covered.size()) + " marks for " +
                              std::to_string(surface.face_sizes.size()) + " faces; give one a face");
    }
    if (std::all_of(covered.begin(), covered.end(), [](std::uint8_t mark) { return mark == 0; })) {
        throw InvalidArgument("no face of the surface is covered; mark the faces that the shell is to lie on");
    }
}

void check_factors(const Surface& surface, std::span<const float> factors)
{
    if (!factors.empty() && factors.size() != surface.positions.size()) {
        throw InvalidArgument("there are " + std::to_string(factors.size()) + " thickness factors for " +
                              std::to_string(surface.positions.size()) + " vertices; give one a vertex");
    }
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (!(factors[i] >= 0.0f && factors[i] <= 1.0f)) {
            throw InvalidArgument("the thickness factor of vertex " + std::to_string(i) + " is " +
                                  std::to_string(factors[i]) + "; give 0 to 1");
        }
    }
}

void check_image(const FactorImage& image)
{
    if (image.values.empty() && image.size == glm::ivec2(0)) {
        return;
    }
    if (image.size.x < 1 || image.size.y < 1 ||
        image.values.size() != static_cast<std::size_t>(image.size.x) * static_cast<std::size_t>(image.size.y)) {
        throw InvalidArgument("the thickness image has " + std::to_string(image.values.size()) + " values for " +
                              std::to_string(image.size.x) + " x " + std::to_string(image.size.y) +
                              " pixels; give one a pixel, and at least one");
    }
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (!(image.values[i] >= 0.0f) || !std::isfinite(image.values[i])) {
            const std::size_t width = static_cast<std::size_t>(image.size.x);
            throw InvalidArgument("pixel (" + std::to_string(i % width) + ", " + std::to_string(i / width) +
                                  ") of the thickness image is " + std::to_string(image.values[i]) +
                                  "; give an image without negative pixels");
        }
    }
}

void check_steps(const char* name, int steps)
{
    if (steps < 0 || steps > 100) {
        throw InvalidArgument(std::string(name) + " is " + std::to_string(steps) + " steps; give 0 to 100");
    }
}

void check_placement(const Placement& placement)
{
    if (!std::isfinite(placement.scale.x) || !std::isfinite(placement.scale.y) || placement.scale.x == 0.0f ||
        placement.scale.y == 0.0f) {
        throw InvalidArgument("the UV scale is " + std::to_string(placement.scale.x) + ", " +
                              std::to_string(placement.scale.y) + "; give numbers other than 0");
    }
    if (!std::isfinite(placement.rotation)) {
        throw InvalidArgument("the UV rotation is not finite; give an angle");
    }
    if (!std::isfinite(placement.offset.x) || !std::isfinite(placement.offset.y)) {
        throw InvalidArgument("the UV offset is not finite; give a number of tiles for u and for v");
    }
}

}  // namespace

void check_extrusion(const Surface& surface, const ShellOptions& options)
{
    check_covered(surface, options.covered);
    check_factors(surface, options.thickness_factors);
    check_image(options.thickness_image);
    if (!(options.shift >= -1.0f && options.shift <= 0.0f)) {
        throw InvalidArgument("the shell's shift is " + std::to_string(options.shift) +
                              "; give 0 for outward, -1 for inward, or between");
    }
    check_steps("the smoothing of directors", options.director_smoothing);
    check_steps("the relaxation of UVs", options.relax_steps);
    check_placement(options.placement);
}

void leave_out_flat_prisms(ShellTopology& topology, std::span<const float> thickness)
{
    std::size_t kept = 0;
    for (std::size_t p = 0; p < topology.triangles.size(); ++p) {
        const glm::uvec3& triangle = topology.triangles[p];
        if (thickness[triangle.x] == 0.0f && thickness[triangle.y] == 0.0f && thickness[triangle.z] == 0.0f) {
            continue;
        }
        topology.triangles[kept] = triangle;
        topology.uv_triangles[kept] = topology.uv_triangles[p];
        topology.faces[kept] = topology.faces[p];
        ++kept;
    }
    if (kept == 0) {
        throw Error("the thickness is 0 everywhere; paint the vertex group or the image where the shell is to be");
    }
    topology.triangles.resize(kept);
    topology.uv_triangles.resize(kept);
    topology.faces.resize(kept);
}

}  // namespace mesoshell
