// How far a map is from the tile it was made of: random rays, Embree against the shader text's lookup.
#pragma once

#include <cstdint>

#include "mesoshell/compress.h"
#include "mesoshell/job.h"
#include "mesoshell/sample.h"

namespace mesoshell {

// Where rays start and point: at nodes of the bake along its directions, or anywhere in the slab along any direction, uniformly.
enum class RaySet { on_grid, off_grid };

// Of rays that start outside the solid and point into the slab. Lengths in tile widths.
struct ErrorReport {
    std::int64_t rays = 0;
    double rmse = 0.0;           // of distances to the first surface, or to the end of the slab where there is none
    double median = 0.0;         // of absolute errors
    double percentile_95 = 0.0;
    double percentile_99 = 0.0;
    double largest = 0.0;
    double hits = 0.0;           // share of the rays that meet a surface
    double false_hits = 0.0;     // share of the rays that meet none, and the map says they do
    double false_misses = 0.0;   // share of the rays that meet one, and the map says they do not
};

// What the map says of a hit is what a shell of it would show: the distance ends before the slab does, at a place where the
// distance field is small (shaders/lib/traverse.glsl); without a distance field, that far before the slab's end.
// The same rays for the same seed, whatever the number of threads. count: at least 1.
// Throws InvalidArgument for a map of a tile with another height or aspect, or a sample that leaves hardly any room for rays;
// Cancelled.
ErrorReport measure(const Map& map, const Sample& sample, RaySet rays, int count, std::uint32_t seed, Job& job);

}  // namespace mesoshell
