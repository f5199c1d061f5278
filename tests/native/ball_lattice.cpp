#include "ball_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesoshell/bake.h"

namespace mesoshell {

double slab_end(double z, double dir_z, double height)
{
    // A direction of the grid is horizontal or far from it; only the rounding of its cosine must not count.
    if (std::abs(dir_z) < 1e-9) {
        return horizon_distance;
    }
    return std::min(dir_z > 0.0 ? (height - z) / dir_z : -z / dir_z, static_cast<double>(horizon_distance));
}

double BallLattice::cast(const glm::dvec3& origin, const glm::dvec3& dir) const
{
    double nearest = slab_end(origin.z, dir.z, height);
    const glm::dvec3 end = origin + dir * nearest;
    const glm::dvec3 low = glm::min(origin, end) - radius;
    const glm::dvec3 high = glm::max(origin, end) + radius;
    for (double j = std::ceil((low.y - center.y) / aspect); j <= (high.y - center.y) / aspect; ++j) {
        for (double i = std::ceil(low.x - center.x); i <= high.x - center.x; ++i) {
            const glm::dvec3 offset = center + glm::dvec3(i, j * aspect, 0.0) - origin;
            const double behind = glm::dot(offset, offset) - radius * radius;
            if (behind <= 0.0) {
                return 0.0;
            }
            const double along = glm::dot(offset, dir);
            const double discriminant = along * along - behind;
            if (along > 0.0 && discriminant > 0.0) {
                nearest = std::min(nearest, along - std::sqrt(discriminant));
            }
        }
    }
    return nearest;
}

double BallLattice::signed_distance(const glm::dvec3& point) const
{
    double nearest = std::numeric_limits<double>::infinity();
    for (int j = -3; j <= 3; ++j) {
        for (int i = -3; i <= 3; ++i) {
            const glm::dvec3 ball = center + glm::dvec3(i, j * aspect, 0.0);
            const double to_center = glm::length(point - ball);
            if (to_center <= radius) {
                // Inside, the planes that cut the ball off bound it too.
                return -std::min(radius - to_center, std::min(point.z, height - point.z));
            }
            const glm::dvec3 foot = ball + (point - ball) * (radius / to_center);
            double distance = to_center - radius;
            for (const double plane : {0.0, height}) {
                if (plane == 0.0 ? foot.z < 0.0 : foot.z > height) {
                    // The nearest point of the whole ball is cut off: what is left ends at a circle in the plane.
                    const double rise = plane - ball.z;
                    const double rim = std::sqrt(radius * radius - rise * rise);
                    const double sideways = glm::length(glm::dvec2(point) - glm::dvec2(ball)) - rim;
                    distance = std::hypot(std::max(sideways, 0.0), point.z - plane);
                }
            }
            nearest = std::min(nearest, distance);
        }
    }
    return nearest;
}

}  // namespace mesoshell
