#include "direction_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mesoshell {
namespace {

// The largest component along unit vector `axis` on the arc of a great circle from a to b.
double most_on_arc(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& axis)
{
    double most = std::max(glm::dot(a, axis), glm::dot(b, axis));
    const glm::dvec3 normal = glm::cross(a, b);
    const double length = glm::length(normal);
    if (length > 0.0) {
        // The circle's own summit, where the arc reaches it.
        const glm::dvec3 summit = axis - normal * (glm::dot(axis, normal) / (length * length));
        if (glm::dot(glm::cross(a, summit), normal) > 0.0 && glm::dot(glm::cross(summit, b), normal) > 0.0) {
            most = std::max(most, glm::length(summit));
        }
    }
    return most;
}

}  // namespace

glm::dvec3 octahedral_node(int column, int row, int side)
{
    const glm::dvec2 place(2.0 * column / side - 1.0, 2.0 * row / side - 1.0);
    glm::dvec3 dir(place, 1.0 - std::abs(place.x) - std::abs(place.y));
    if (dir.z < 0.0) {
        dir.x = std::copysign(1.0 - std::abs(place.y), place.x);
        dir.y = std::copysign(1.0 - std::abs(place.x), place.y);
    }
    return glm::normalize(dir);
}

BinCone::BinCone(int bin, int side)
{
    const int column = bin % side;
    const int row = bin / side;
    // Around the bin's square. The octahedron's lower half is unfolded, not mirrored, so that all bins turn alike.
    corners_ = {octahedral_node(column, row, side), octahedral_node(column + 1, row, side),
                octahedral_node(column + 1, row + 1, side), octahedral_node(column, row + 1, side)};
    const glm::dvec3 center = corners_[0] + corners_[1] + corners_[2] + corners_[3];
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 normal = glm::normalize(glm::cross(corners_[i], corners_[(i + 1) % 4]));
        inward_[i] = glm::dot(normal, center) < 0.0 ? -normal : normal;
    }
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 up(0.0);
        up[axis] = 1.0;
        // Within the cone, away from its border, no component has an extremum: the axes themselves are corners of bins.
        most_[axis] = -1.0;
        least_[axis] = 1.0;
        for (int i = 0; i < 4; ++i) {
            most_[axis] = std::max(most_[axis], most_on_arc(corners_[i], corners_[(i + 1) % 4], up));
            least_[axis] = std::min(least_[axis], -most_on_arc(corners_[i], corners_[(i + 1) % 4], -up));
        }
        most_[axis] += bin_slack;
        least_[axis] -= bin_slack;
    }
}

bool BinCone::misses(const Bounds& box) const
{
    for (const glm::dvec3& n : inward_) {
        const double most = n.x * (n.x > 0.0 ? box.upper.x : box.lower.x) + n.y * (n.y > 0.0 ? box.upper.y : box.lower.y) +
                            n.z * (n.z > 0.0 ? box.upper.z : box.lower.z);
        if (most < -2.0 * bin_slack) {
            return true;
        }
    }
    return false;
}

double BinCone::distance(const Bounds& box, double limit) const
{
    if (misses(box)) {
        return limit;
    }
    double squared = 0.0;
    double least = 0.0;
    double most = limit;
    for (int axis = 0; axis < 3; ++axis) {
        // Along one axis a vector of length t has gone between t least_ and t most_.
        const double lower = box.lower[axis];
        const double upper = box.upper[axis];
        if (lower > 0.0) {
            squared += lower * lower;
            least = std::max(least, most_[axis] > 0.0 ? lower / most_[axis] : limit);
        } else if (upper < 0.0) {
            squared += upper * upper;
            least = std::max(least, least_[axis] < 0.0 ? upper / least_[axis] : limit);
        }
        if (least_[axis] > 0.0) {
            most = std::min(most, upper / least_[axis]);
        }
        if (most_[axis] < 0.0) {
            most = std::min(most, lower / most_[axis]);
        }
    }
    least = std::max(least, std::sqrt(squared));
    return least > most ? limit : least;
}

FacingBins::FacingBins(int side) : side_(side)
{
    for (int row = 0; row <= side; ++row) {
        for (int column = 0; column <= side; ++column) {
            nodes_.push_back(octahedral_node(column, row, side));
        }
    }
}

void FacingBins::facing(const glm::dvec3& area_vector, BinSet& bins) const
{
    std::fill(bins.words.begin(), bins.words.end(), 0);
    const bool all = area_vector == glm::dvec3(0.0);
    // Directions of a bin are sums of its corners: where one is negative, so is a corner. No slack here: what rounding puts
    // into another bin, so near to parallel, meets the front only from a place on it.
    std::vector<std::uint8_t> faces(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        faces[i] = all || glm::dot(area_vector, nodes_[i]) < 0.0 ? 1 : 0;
    }
    for (int row = 0; row < side_; ++row) {
        for (int column = 0; column < side_; ++column) {
            const std::size_t corner = static_cast<std::size_t>(row) * (side_ + 1) + column;
            if ((faces[corner] | faces[corner + 1] | faces[corner + side_ + 1] | faces[corner + side_ + 2]) != 0) {
                bins.add(row * side_ + column);
            }
        }
    }
}

}  // namespace mesoshell
