// Compression of a GDM by a truncated singular value decomposition (GDM paper, section 4.1), and the map it becomes part of.
#pragma once

#include <string>
#include <vector>

#include "mesoshell/attributes.h"
#include "mesoshell/bake.h"
#include "mesoshell/job.h"
#include "mesoshell/leaps.h"

namespace mesoshell {

enum class Precision { half, single };

// A baked tile, as it is stored, drawn and rendered.
struct Map {
    GdmResolution resolution;
    float height = 0.0f;
    float aspect = 1.0f;
    int terms = 0;
    std::vector<float> weights;    // [terms, nphi, ny, nx]
    std::vector<float> eigenmaps;  // [terms, ntheta, nz]
    glm::ivec3 sdf_nodes{0};       // (mx, my, mz); all 0 without a distance field
    std::vector<float> sdf;        // [mz, my, mx], tile widths, negative inside
    Leaps leaps;                   // without cells where there is no leap table
    Attributes attributes;         // without nodes where there are none
    float rmse = 0.0f;             // of the terms as stored against the raw GDM, over the grid, tile widths
    float max_error = 0.0f;        // the largest of them, tile widths
    // Half: every value above is one that a 16-bit float holds, so that storing and drawing change nothing.
    Precision precision = Precision::half;
};

struct CompressOptions {
    int terms = 16;         // 1 to the number of columns, ntheta times nz
    float max_rmse = 0.0f;  // tile widths; positive: the fewest terms that reach it, `terms` unused
    Precision precision = Precision::half;
};

// Rows are (phi, y, x), columns (theta, z); exact eigenvectors of the Gram matrix, no sampling.
// `sdf` may be null. Throws InvalidArgument for options out of range, a max_rmse that rounding alone exceeds, or an SDF of
// another tile; Cancelled.
Map compress(const Gdm& gdm, const Sdf* sdf, const CompressOptions& options, Job& job);

// Makes a leap table and attributes parts of a map, the latter in its precision; either may be null. Throws InvalidArgument
// for a table of another tile, and for attributes whose arrays do not fit their nodes or hold what is not finite in that
// precision.
void attach(Map& map, const Leaps* leaps, const Attributes* attributes);

}  // namespace mesoshell
