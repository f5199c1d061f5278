// Compression of a GDM by a truncated singular value decomposition (GDM paper, section 4.1), and the map it becomes part of.
#pragma once

#include <string>
#include <vector>

#include "mesoshell/attributes.h"
#include "mesoshell/bake.h"
#include "mesoshell/facets.h"
#include "mesoshell/job.h"

namespace mesoshell {

// Every value of a `half` map is one that a 16-bit float holds, so that storing and drawing change nothing. In a `byte` map the
// larger factor of the SVD holds whole numbers from -127 to 127 besides, and its scale is with the other factor.
enum class Precision { byte, half, single };

// Which matrix is decomposed.
enum class Layout {
    paper,  // rows (phi, y, x), columns (theta, z)
    share,  // likewise; eigenmaps hold shares of the distance to the end of the slab, which a lookup knows exactly
    nodes,  // rows (y, x), columns (phi, theta, z)
    automatic,  // of options only: the one with the smallest errors at equal bytes, which is `nodes` where memory holds a raw GDM
};

// A baked tile, as it is stored, drawn and rendered.
struct Map {
    GdmResolution resolution;
    float height = 0.0f;
    float aspect = 1.0f;
    int terms = 0;
    Layout layout = Layout::paper;
    std::vector<float> weights;    // [terms, weight_azimuths, ny, nx]
    std::vector<float> eigenmaps;  // [terms, eigen_azimuths, ntheta, nz]
    glm::ivec3 sdf_nodes{0};       // (mx, my, mz); all 0 without a distance field
    std::vector<float> sdf;        // [mz, my, mx], tile widths, negative inside
    Facets facets;                 // without cells where there are none
    Attributes attributes;         // without nodes where there are none
    float rmse = 0.0f;             // of the terms as stored against the raw GDM, over the grid, tile widths
    float max_error = 0.0f;        // the largest of them, tile widths
    Precision precision = Precision::half;

    int weight_azimuths() const { return layout == Layout::nodes ? 1 : resolution.nphi; }
    int eigen_azimuths() const { return layout == Layout::nodes ? resolution.nphi : 1; }
};

struct CompressOptions {
    int terms = 0;          // 1 to the number of columns or, if there are fewer, rows; 0: default_terms
    float max_rmse = 0.0f;  // tile widths; positive: the fewest terms that reach it, `terms` unused
    Precision precision = Precision::byte;
    Layout layout = Layout::automatic;
};

// The paper's 16 terms, or as many of another layout as have the bytes of those, and fit textures of 2048 layers.
int default_terms(const GdmResolution& resolution, Layout layout, Precision precision);

// Bytes of the terms of a map, each number in its own precision: 1, 2 or 4 bytes.
double term_bytes(const GdmResolution& resolution, const CompressOptions& options);

// The layouts `paper` and `share` take the exact eigenvectors of the Gram matrix, `nodes` those of a subspace iteration (Halko et
// al. 2011, algorithm 4.4). `share` weighs errors by the inverse of the distance to the end of the slab.
// `sdf` may be null. Throws InvalidArgument for options out of range, a max_rmse that rounding alone exceeds, or an SDF of another
// tile; Cancelled.
Map compress(const Gdm& gdm, const Sdf* sdf, const CompressOptions& options, Job& job);

// What bake_map would do.
struct BakePlan {
    CompressOptions options;  // nothing left open
    double needed = 0.0;      // bytes that it allocates at least
    double used = 0.0;        // bytes that it allocates: at most the limit where that is enough
    int azimuths = 0;         // of a block; 0 where the limit is too low
    int blocks = 0;           // 1: the raw GDM is kept in memory
};
BakePlan plan_bake(const GdmResolution& resolution, const CompressOptions& options, double memory);

// bake_gdm and compress without the raw GDM ever being whole in memory: blocks of azimuths stream through both, and are baked
// again for every pass where `memory` (bytes, over all that the call allocates) does not hold them all. The layout `nodes`
// needs them all. Throws as bake_gdm and compress do, and InvalidArgument where `memory` is too little.
Map bake_map(const Sample& sample, const GdmResolution& resolution, Engine engine, const Sdf* sdf, const CompressOptions& options,
             double memory, Job& job);

// Makes facets and attributes parts of a map, the latter in its precision; either may be null. Throws InvalidArgument
// for facets of another tile, and for attributes whose arrays do not fit their nodes or hold what is not finite in that
// precision.
void attach(Map& map, const Facets* facets, const Attributes* attributes);

}  // namespace mesoshell
