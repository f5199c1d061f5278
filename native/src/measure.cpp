#include "mesoshell/measure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "embree_scene.h"
#include "mesoshell/interface.h"
#include "mesoshell/render.h"
#include "parallel.h"
#include "periodic_mesh.h"
#include "tile_space.h"

namespace mesoshell {
namespace {

constexpr int rays_per_block = 1024;
// Tries for a ray that starts outside the solid.
constexpr int most_tries = 1000;

class Random {
public:
    Random(std::uint32_t seed, std::uint32_t block) : sequence_{seed, block}, engine_(sequence_) {}
    double uniform() { return engine_() * 0x1p-32; }
    int below(int count) { return std::min(static_cast<int>(uniform() * count), count - 1); }

private:
    std::seed_seq sequence_;
    std::mt19937 engine_;
};

struct Ray {
    glm::dvec3 pos_texture;
    glm::dvec3 dir_metric;
    float exit;  // distance to the end of the slab
};

class Comparison {
public:
    Comparison(const Map& map, const Sample& sample, RaySet rays)
        : map_(map), sample_(sample), rays_(rays), scale_(1.0, sample.aspect(), sample.height()),
          scene_(sample.positions(), sample.triangles(), lattice_within(sample, horizon_distance)),
          solid_(sample.winding_mesh().positions, sample.winding_mesh().triangles, lattice_within(sample, 0.0f),
                 TriangleScene::Use::crossings),
          tolerance_(ShellParams{}.tolerance.x / static_cast<float>(map.sdf.empty() ? map.resolution.nodes.x : map.sdf_nodes.x))
    {
    }

    struct Block {
        std::vector<float> errors;
        double squared = 0.0;
        int hits = 0;
        int false_hits = 0;
        int false_misses = 0;
    };

    Block compare(int count, std::uint32_t seed, std::uint32_t block) const
    {
        Random random(seed, block);
        std::vector<glm::vec3> starts, dirs, ends;
        std::vector<float> exits;
        for (int i = 0; i < count; ++i) {
            const Ray ray = next_ray(random);
            starts.emplace_back(ray.pos_texture);
            dirs.emplace_back(ray.dir_metric);
            exits.push_back(ray.exit);
        }
        const std::vector<float> said = lookup_gdm(map_, starts, dirs);
        Block result;
        std::vector<bool> may_hit(said.size());
        for (std::size_t i = 0; i < said.size(); ++i) {
            ends.push_back(starts[i] + dirs[i] * said[i] / glm::vec3(scale_));
            may_hit[i] = said[i] < exits[i];
        }
        const std::vector<float> left = map_.sdf.empty() ? std::vector<float>() : lookup_sdf(map_, ends);
        for (std::size_t i = 0; i < said.size(); ++i) {
            const TriangleHit hit = scene_.intersect1(starts[i] * glm::vec3(scale_), dirs[i], 0.0f, exits[i]);
            const float error = std::abs(said[i] - (hit.hit ? hit.t : exits[i]));
            const bool says_hit = may_hit[i] && (left.empty() ? said[i] < exits[i] - tolerance_ : left[i] < tolerance_);
            result.errors.push_back(error);
            result.squared += static_cast<double>(error) * error;
            result.hits += hit.hit ? 1 : 0;
            result.false_hits += says_hit && !hit.hit ? 1 : 0;
            result.false_misses += hit.hit && !says_hit ? 1 : 0;
        }
        return result;
    }

private:
    Ray next_ray(Random& random) const
    {
        for (int i = 0; i < most_tries; ++i) {
            Ray ray = rays_ == RaySet::on_grid ? node_ray(random) : any_ray(random);
            ray.exit = slab_exit(static_cast<float>(ray.pos_texture.z * scale_.z), static_cast<float>(ray.dir_metric.z),
                                 sample_.height());
            if (ray.exit > 0.0f && solid_.count_crossings(glm::vec3(ray.pos_texture * scale_), glm::vec3(0.0f, 0.0f, 1.0f)).winding == 0) {
                return ray;
            }
        }
        throw InvalidArgument("the tile is solid nearly everywhere; there is nothing to compare a map with");
    }

    Ray node_ray(Random& random) const
    {
        const GdmResolution& r = map_.resolution;
        const double x = static_cast<double>(random.below(r.nodes.x)) / r.nodes.x;
        const double y = static_cast<double>(random.below(r.nodes.y)) / r.nodes.y;
        const double z = static_cast<double>(random.below(r.nodes.z)) / (r.nodes.z - 1);
        const int theta = random.below(r.ntheta);
        return {{x, y, z}, gdm_direction(r, theta, random.below(r.nphi)), 0.0f};
    }

    Ray any_ray(Random& random) const
    {
        const double x = random.uniform();
        const double y = random.uniform();
        const double z = random.uniform();
        const double up = 2.0 * random.uniform() - 1.0;
        const double azimuth = 2.0 * std::numbers::pi * random.uniform();
        const double across = std::sqrt(1.0 - up * up);
        return {{x, y, z}, {across * std::cos(azimuth), across * std::sin(azimuth), up}, 0.0f};
    }

    const Map& map_;
    const Sample& sample_;
    RaySet rays_;
    glm::dvec3 scale_;
    TriangleScene scene_;
    TriangleScene solid_;
    float tolerance_;  // tile widths
};

float percentile(std::vector<float>& values, double share)
{
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

ErrorReport measure(const Map& map, const Sample& sample, RaySet rays, int count, std::uint32_t seed, Job& job)
{
    if (map.height != sample.height() || map.aspect != sample.aspect()) {
        throw InvalidArgument("the map and the sample are of tiles with different height or aspect; compare a map with the sample "
                              "it was baked from");
    }
    if (count < 1) {
        throw InvalidArgument("the number of rays is " + std::to_string(count) + "; give at least 1");
    }
    const Comparison comparison(map, sample, rays);
    std::vector<Comparison::Block> blocks(static_cast<std::size_t>((count + rays_per_block - 1) / rays_per_block));
    parallel_for(job, static_cast<int>(blocks.size()), [&](int block) {
        blocks[static_cast<std::size_t>(block)] = comparison.compare(std::min(rays_per_block, count - block * rays_per_block), seed,
                                                                     static_cast<std::uint32_t>(block));
    });
    ErrorReport report;
    report.rays = count;
    std::vector<float> errors;
    double squared = 0.0;
    for (const Comparison::Block& block : blocks) {
        errors.insert(errors.end(), block.errors.begin(), block.errors.end());
        squared += block.squared;
        report.hits += static_cast<double>(block.hits) / count;
        report.false_hits += static_cast<double>(block.false_hits) / count;
        report.false_misses += static_cast<double>(block.false_misses) / count;
    }
    report.rmse = std::sqrt(squared / count);
    report.median = percentile(errors, 0.5);
    report.percentile_95 = percentile(errors, 0.95);
    report.percentile_99 = percentile(errors, 0.99);
    report.largest = *std::max_element(errors.begin(), errors.end());
    return report;
}

}  // namespace mesoshell
