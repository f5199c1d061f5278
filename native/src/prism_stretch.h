// The stretch of one prism, in integrals, and their derivatives by the UVs of its top.
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "mesoshell/shell.h"

namespace mesoshell {

// Over the prism's volume in object space. With U = (dP/du, dP/dv) and N = dP/dw the columns of the map's derivative from
// texture to object space: the squares of the stretch are |U_u|^2, |U_v|^2 / aspect^2 and |N|^2 / height^2.
struct StretchIntegrals {
    double u = 0.0;       // of |dP/du|^2
    double v = 0.0;       // of |dP/dv|^2
    double w = 0.0;       // of |dP/dw|^2
    double volume = 0.0;  // object units^3
    double tiles = 0.0;   // volume in texture space, tiles times height

    StretchIntegrals& operator+=(const StretchIntegrals& other)
    {
        u += other.u;
        v += other.v;
        w += other.w;
        volume += other.volume;
        tiles += other.tiles;
        return *this;
    }
};

// How the integrals' sum u + v * inverse_aspect_2 + w * inverse_height_2 and `tiles` depend on the top's UVs.
struct StretchSlope {
    std::array<glm::dvec2, 3> sum{};    // derivative by each corner's top UV
    std::array<glm::dvec2, 3> tiles{};
    // About the second derivatives of the sum, positive semidefinite as a whole: by corners i and i, then by i and i + 1.
    std::array<glm::mat2, 3> bend{};
    std::array<glm::mat2, 3> bend_next{};
};

class PrismStretch {
public:
    PrismStretch(const Shell& shell, std::size_t prism);

    // The UVs of the top, one a corner, instead of the shell's own.
    void set_top(const std::array<glm::vec2, 3>& top);

    // Whether the UVs have an area at every height: their signed area is quadratic in the height, and has its sign at both
    // ends and where it is extreme between them.
    bool keeps_winding() const;

    // Twice the signed area of the UVs at a height.
    double area(double w) const;
    // dP/du and dP/dv at a height, where they do not depend on the place.
    glm::dmat2x3 axes(double w) const;

    StretchIntegrals integrals() const;
    StretchSlope slope(double inverse_aspect_2, double inverse_height_2) const;

private:
    struct Level;
    Level level(double w) const;

    std::array<glm::dvec3, 3> base_;
    std::array<glm::dvec3, 3> rise_;  // from base to top
    std::array<glm::dvec2, 3> uv_base_;
    std::array<glm::dvec2, 3> uv_rise_;
};

}  // namespace mesoshell
