#include "facet_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace mesoshell {
namespace {

using Mask = std::vector<std::uint64_t>;  // a bit a point

constexpr double other_side = 0.25;     // sides of a box: what turning a normal away counts, times 1 - cosine
constexpr double good_enough = 0.01;    // sides of a box: polygons of one plane
constexpr double small_cost = 0.004;    // a fit that more planes to choose from need not improve
constexpr double miss_weight = 0.5;     // of a mean miss by one side of the box, against all points wrong

struct Plane {
    glm::dvec3 normal;
    glm::dvec3 center;
};

// Polygons that are nearly in one plane become one: Lloyd's algorithm, from the polygons that fit worst.
class Planes {
public:
    Planes(std::span<const FacetPolygon> polygons, double side)
        : polygons_(polygons), side_(side), nearest_(polygons.size(), 0)
    {
        const auto largest = std::max_element(polygons.begin(), polygons.end(),
                                              [](const FacetPolygon& a, const FacetPolygon& b) { return a.area < b.area; });
        planes_.push_back({largest->normal, largest->center});
    }

    const std::vector<Plane>& grow(std::size_t most)
    {
        for (;;) {
            for (int round = 0; round < 3; ++round) {
                assign();
                average();
            }
            if (planes_.size() >= most) {
                return planes_;
            }
            std::size_t worst = 0;
            double farthest = 0.0;
            for (std::size_t i = 0; i < polygons_.size(); ++i) {
                const double share = std::min(1.0, 20.0 * polygons_[i].area / (side_ * side_));
                const double distance = share * apart(planes_[nearest_[i]], polygons_[i]);
                if (distance > farthest) {
                    farthest = distance;
                    worst = i;
                }
            }
            if (farthest < good_enough) {
                return planes_;
            }
            planes_.push_back({polygons_[worst].normal, polygons_[worst].center});
        }
    }

private:
    double apart(const Plane& plane, const FacetPolygon& polygon) const
    {
        double farthest = 0.0;
        for (const glm::dvec3& corner : polygon.corners) {
            farthest = std::max(farthest, std::abs(glm::dot(plane.normal, corner - plane.center)));
        }
        return farthest / side_ + other_side * (1.0 - glm::dot(plane.normal, polygon.normal));
    }

    void assign()
    {
        for (std::size_t i = 0; i < polygons_.size(); ++i) {
            double least = apart(planes_[nearest_[i]], polygons_[i]);
            for (std::size_t j = 0; j < planes_.size(); ++j) {
                const double distance = apart(planes_[j], polygons_[i]);
                if (distance < least) {
                    least = distance;
                    nearest_[i] = j;
                }
            }
        }
    }

    void average()
    {
        for (std::size_t j = 0; j < planes_.size(); ++j) {
            glm::dvec3 normal(0.0);
            glm::dvec3 center(0.0);
            double area = 0.0;
            for (std::size_t i = 0; i < polygons_.size(); ++i) {
                if (nearest_[i] == j) {
                    normal += polygons_[i].normal * polygons_[i].area;
                    center += polygons_[i].center * polygons_[i].area;
                    area += polygons_[i].area;
                }
            }
            if (area > 0.0 && glm::length(normal) > 1e-9 * area) {
                planes_[j] = {glm::normalize(normal), center / area};
            }
        }
    }

    std::span<const FacetPolygon> polygons_;
    double side_;
    std::vector<std::size_t> nearest_;
    std::vector<Plane> planes_;
};

// Tries ways to put planes together, and keeps the best.
class Search {
public:
    Search(std::span<const FacetPolygon> polygons, const FacetBox& box, std::span<const std::uint8_t> inside, int side)
        : polygons_(polygons), box_(box), middle_(box.lower + 0.5 * box.side), side_(side),
          truth_(mask_of([&](int i, const glm::dvec3&) { return inside[i] != 0; }))
    {
        for (const FacetPolygon& polygon : polygons) {
            area_ += polygon.area;
        }
    }

    // Forms of every four of the planes, repeated ones included: fewer planes are forms of four.
    void try_all(const std::vector<Plane>& planes)
    {
        planes_ = planes;
        masks_.clear();
        for (const Plane& plane : planes) {
            masks_.push_back(mask_of([&](int, const glm::dvec3& point) {
                return glm::dot(plane.normal, point - plane.center) < 0.0;
            }));
        }
        const int count = static_cast<int>(planes.size());
        for (int a = 0; a < count; ++a) {
            for (int b = a; b < count; ++b) {
                for (int c = b; c < count; ++c) {
                    for (int d = c; d < count; ++d) {
                        try_orders({a, b, c, d});
                    }
                }
            }
        }
    }

    double cost() const { return cost_; }
    FacetFit best() const { return best_; }

private:
    using Four = std::array<int, 4>;

    template <typename Inside>
    Mask mask_of(const Inside& is_inside) const
    {
        const int nodes = side_ + 1;
        Mask mask((nodes * nodes * nodes + 63) / 64, 0);
        int i = 0;
        for (int z = 0; z < nodes; ++z) {
            for (int y = 0; y < nodes; ++y) {
                for (int x = 0; x < nodes; ++x, ++i) {
                    if (is_inside(i, box_.lower + box_.side * glm::dvec3(x, y, z) / double(side_))) {
                        mask[i / 64] |= std::uint64_t(1) << i % 64;
                    }
                }
            }
        }
        return mask;
    }

    void try_orders(const Four& p)
    {
        constexpr int pairs[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
        try_form(0, p);
        if (p[0] == p[3]) {
            return;
        }
        try_form(1, p);
        for (int i = 0; i < 6; ++i) {
            const Four order = {p[pairs[i][0]], p[pairs[i][1]], p[pairs[i][2]], p[pairs[i][3]]};
            for (int form = i < 3 ? 2 : 4; form < 6; ++form) {  // pairs are alike in forms 2 and 3
                try_form(form, order);
            }
        }
        for (int i = 0; i < 4; ++i) {
            const Four order = {p[i], p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]};
            try_form(6, order);
            try_form(7, order);
        }
    }

    void try_form(int form, const Four& four)
    {
        const double points = (side_ + 1) * (side_ + 1) * (side_ + 1);
        int wrong = 0;
        for (std::size_t word = 0; word < truth_.size() && wrong < cost_ * points; ++word) {
            std::uint64_t solid = 0;
            for (const int group : facet_forms[form]) {
                std::uint64_t common = ~std::uint64_t(0);
                for (int i = 0; i < 4; ++i) {
                    common &= (group >> i & 1) != 0 ? masks_[four[i]][word] : ~std::uint64_t(0);
                }
                solid |= common;
            }
            wrong += std::popcount(solid ^ truth_[word]);
        }
        if (wrong / points >= cost_) {
            return;
        }
        double miss = 0.0;
        for (const FacetPolygon& polygon : polygons_) {
            miss += polygon.area * std::min(1.0, std::abs(distance(form, four, polygon.center)) / box_.side.x);
        }
        miss /= area_;
        const double cost = wrong / points + miss_weight * miss;
        if (cost >= cost_) {
            return;
        }
        cost_ = cost;
        best_ = {true, form, {}, wrong, miss};
        for (int i = 0; i < 4; ++i) {
            const Plane& plane = planes_[four[i]];
            const double level = glm::dot(plane.normal, plane.center - middle_);
            best_.planes[i] = glm::dvec4(plane.normal, level / (0.5 * glm::length(box_.side)));
        }
    }

    double distance(int form, const Four& four, const glm::dvec3& point) const
    {
        double least = 1e9;
        for (const int group : facet_forms[form]) {
            double most = -1e9;
            for (int i = 0; i < 4; ++i) {
                if ((group >> i & 1) != 0) {
                    most = std::max(most, glm::dot(planes_[four[i]].normal, point - planes_[four[i]].center));
                }
            }
            least = std::min(least, most);
        }
        return least;
    }

    std::span<const FacetPolygon> polygons_;
    FacetBox box_;
    glm::dvec3 middle_;
    int side_;
    Mask truth_;
    double area_ = 0.0;
    std::vector<Plane> planes_;
    std::vector<Mask> masks_;
    double cost_ = 1e9;
    FacetFit best_;
};

}  // namespace

double distance_of(const FacetFit& fit, const glm::dvec3& from_middle, double radius)
{
    double least = 1e9;
    for (const int group : facet_forms[fit.form]) {
        double most = -1e9;
        for (int i = 0; i < 4; ++i) {
            if ((group >> i & 1) != 0) {
                most = std::max(most, glm::dot(glm::dvec3(fit.planes[i]), from_middle) - fit.planes[i].w * radius);
            }
        }
        least = std::min(least, most);
    }
    return least;
}

FacetFit fit_facets(std::span<const FacetPolygon> polygons, const FacetBox& box, std::span<const std::uint8_t> inside, int side)
{
    std::vector<FacetPolygon> parts;
    for (const FacetPolygon& polygon : polygons) {
        FacetPolygon part = clipped_to(polygon, box);
        if (!part.corners.empty()) {
            parts.push_back(std::move(part));
        }
    }
    if (parts.empty()) {
        return {};
    }
    Planes planes(parts, box.side.x);
    Search search(parts, box, inside, side);
    // Few planes do nearly everywhere; the number of ways grows with its fourth power.
    for (const std::size_t most : {3, 4, 7}) {
        const std::vector<Plane>& grown = planes.grow(most);
        search.try_all(grown);
        if (search.cost() < small_cost || grown.size() < most) {
            break;
        }
    }
    return search.best();
}

}  // namespace mesoshell
