#include "mesoshell/sample.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "border_walls.h"
#include "cap_surface.h"
#include "columns.h"
#include "holes.h"
#include "mesoshell/error.h"
#include "periodic_mesh.h"
#include "repair.h"
#include "sheets.h"
#include "slab_clip.h"

namespace mesoshell {
namespace {

// "1 face was", "3 faces were".
std::string counted(std::size_t count, const std::string& thing, const std::string& verb_one, const std::string& verb_many)
{
    return std::to_string(count) + " " + thing + (count == 1 ? " " + verb_one : "s " + verb_many);
}

// Of the faces before, which come first in what they became.
std::size_t count_differing(const std::vector<glm::uvec3>& before, const std::vector<glm::uvec3>& after)
{
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        count += before[i] != after[i] ? 1 : 0;
    }
    return count;
}

}  // namespace

Sample::Sample(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, float height, float aspect,
               const SampleOptions& options)
    : input_positions_(std::move(positions)), input_triangles_(std::move(triangles)), height_(height), aspect_(aspect)
{
    check_values(options);
    repair(options);
    clip_to_slab();
}

void Sample::check_values(const SampleOptions& options) const
{
    if (!(height_ > 0.0f) || !std::isfinite(height_)) {
        throw InvalidArgument("height is " + std::to_string(height_) + "; give the tile a positive height, in tile widths");
    }
    if (!(aspect_ > 0.0f) || !std::isfinite(aspect_)) {
        throw InvalidArgument("aspect is " + std::to_string(aspect_) + "; give the tile positive periods");
    }
    if (!(options.thickness >= 0.0f) || !std::isfinite(options.thickness)) {
        throw InvalidArgument("the sheets' thickness is " + std::to_string(options.thickness) +
                              "; give zero or more, in tile widths");
    }
    if (input_positions_.empty() || input_triangles_.empty()) {
        throw InvalidArgument("the tile is empty; give it a mesh with at least one triangle");
    }
    for (std::size_t i = 0; i < input_positions_.size(); ++i) {
        const glm::vec3& p = input_positions_[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            throw InvalidArgument("vertex " + std::to_string(i) +
                                  " of the tile is not finite; remove it or repair the modifier that makes it");
        }
        if (std::abs(p.x) > most_periods || std::abs(p.y) > most_periods * aspect_ || std::abs(p.z) > most_height) {
            throw InvalidArgument("vertex " + std::to_string(i) + " of the tile is more than " +
                                  std::to_string(static_cast<int>(most_periods)) +
                                  " periods away; move the mesh to the tile box, or make the period larger");
        }
    }
    for (std::size_t i = 0; i < input_triangles_.size(); ++i) {
        const glm::uvec3& t = input_triangles_[i];
        if (std::max(t.x, std::max(t.y, t.z)) >= input_positions_.size()) {
            throw InvalidArgument("triangle " + std::to_string(i) + " of the tile uses vertex " +
                                  std::to_string(std::max(t.x, std::max(t.y, t.z))) + ", but there are only " +
                                  std::to_string(input_positions_.size()) + " vertices; remove it or export the mesh again");
        }
    }
}

void Sample::repair(const SampleOptions& options)
{
    PeriodicMesh mesh = weld(input_positions_, input_triangles_, aspect_);
    if (const std::size_t dropped = drop_degenerate(mesh); dropped > 0) {
        notices_.push_back(counted(dropped, "face", "has", "have") + " no area and " + (dropped == 1 ? "was" : "were") +
                           " left out.");
    }
    if (const std::size_t dropped = drop_duplicates(mesh); dropped > 0) {
        notices_.push_back(counted(dropped, "duplicate face", "was", "were") + " dropped.");
    }
    double area = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        area += glm::length(area_vector(mesh, t));
    }
    if (!(area > 0.0)) {
        throw InvalidArgument("the tile's mesh has no area; give it a face whose corners do not lie on one line");
    }
    if (options.thickness == 0.0f) {
        if (const std::size_t gone = close_cracks(mesh); gone > 0) {
            drop_degenerate(mesh);
            drop_duplicates(mesh);
            notices_.push_back(counted(gone, "corner", "was", "were") +
                               " moved by up to a thousandth of a tile width to close cracks.");
        }
    }
    const std::vector<glm::uvec3> before = mesh.triangles;
    Components components = make_coherent(mesh);
    std::size_t turned = count_differing(before, mesh.triangles);
    std::size_t sheets = 0;
    if (options.thickness > 0.0f) {
        sheets = thicken(mesh, components, options.thickness);
    }
    if (sheets > 0) {
        mesh = weld(std::move(mesh.positions), std::move(mesh.triangles), aspect_);
        drop_degenerate(mesh);
    }
    const std::size_t walls = options.thickness == 0.0f ? add_border_walls(mesh) : 0;
    if (walls > 0) {
        notices_.push_back("The mesh does not fit its copies at " + counted(walls, "edge", "of", "of") +
                           " the tile's border, where a wall was added.");
    }
    // What is open has a volume, and with it an outside, only when it is closed.
    Caps caps = span_holes(mesh);
    if (sheets > 0 || walls > 0 || caps.count > 0) {
        components = make_coherent(mesh);
    }
    turn_outward(mesh, components);
    if (sheets == 0) {
        turned = count_differing(before, mesh.triangles);
    }
    if (turned > 0) {
        notices_.push_back(counted(turned, "face", "was", "were") + " turned over, so that the outside is out.");
    }
    if (sheets > 0) {
        notices_.push_back(counted(sheets, "open part", "became a sheet", "became sheets") + " of the given thickness.");
    }
    if (const std::size_t dropped = leave_out_sheets(mesh, caps); dropped > 0) {
        notices_.push_back(counted(dropped, "face", "encloses", "enclose") + " nothing and " +
                           (dropped == 1 ? "was" : "were") + " left out; give a thickness to keep sheets.");
    }
    if (mesh.triangles.empty()) {
        throw InvalidArgument("the tile's mesh is open and encloses nothing; give a thickness, or close it, so that it has "
                              "an inside");
    }
    Job job;
    if (caps.count > 0) {
        join_caps(mesh, caps, shape_caps(mesh, caps, job));
        notices_.push_back(counted(caps.count, "hole", "was", "were") + " closed.");
    }
    winding_range_ = winding_range(mesh, job);
    positions_ = mesh.positions;
    triangles_ = mesh.triangles;
    winding_mesh_ = std::make_shared<const PeriodicMesh>(std::move(mesh));
}

void Sample::clip_to_slab()
{
    for (const glm::uvec3& t : triangles_) {
        bool inside = true;
        for (int i = 0; i < 3; ++i) {
            const float z = positions_[t[i]].z;
            inside = inside && z >= 0.0f && z <= height_;
        }
        clipped_ += inside ? 0 : 1;
    }
    if (clipped_ == 0) {
        return;
    }
    notices_.push_back(counted(clipped_, "triangle", "reaches", "reach") + " out of the tile's height and " +
                       (clipped_ == 1 ? "was" : "were") + " clipped.");
    slab_positions_ = positions_;
    for (const glm::uvec3& t : triangles_) {
        const std::vector<glm::vec3> polygon = part_in_slab({positions_[t.x], positions_[t.y], positions_[t.z]}, height_);
        const auto first = static_cast<std::uint32_t>(slab_positions_.size());
        slab_positions_.insert(slab_positions_.end(), polygon.begin(), polygon.end());
        for (std::uint32_t i = 2; i < polygon.size(); ++i) {
            slab_triangles_.emplace_back(first, first + i - 1, first + i);
        }
    }
    if (slab_triangles_.empty()) {
        throw InvalidArgument("the tile has no geometry between w = 0 and its height; move it into the tile box or raise the "
                              "height");
    }
}

}  // namespace mesoshell
