#include "mesoshell/compress.h"

#include <algorithm>
#include <string>

#include "compress_nodes.h"
#include "compress_rows.h"
#include "gdm_baker.h"
#include "gdm_source.h"
#include "gdm_task.h"
#include "half.h"

namespace mesoshell {
namespace {

void check_options(const GdmResolution& r, float height, float aspect, const Sdf* sdf, const CompressOptions& options)
{
    const std::int64_t nodes = std::int64_t(r.nodes.x) * r.nodes.y;
    const std::int64_t columns = std::int64_t(r.ntheta) * r.nodes.z;
    const bool by_nodes = options.layout == Layout::nodes;
    const std::int64_t most = by_nodes ? std::min(nodes, columns * r.nphi) : columns;
    if (!(options.max_rmse >= 0.0f)) {
        throw InvalidArgument("max_rmse is " + std::to_string(options.max_rmse) +
                              "; give a positive length in tile widths, or 0 to choose the number of terms");
    }
    if (!(options.max_rmse > 0.0f) && (options.terms < 1 || options.terms > most)) {
        throw InvalidArgument("terms is " + std::to_string(options.terms) + "; give 1 to " + std::to_string(most) + ", the number of " +
                              (by_nodes ? "rows or columns" : "columns") + " of this GDM");
    }
    if (sdf != nullptr && (sdf->height != height || sdf->aspect != aspect)) {
        throw InvalidArgument("the SDF and the GDM are of tiles with different height or aspect; bake both from one sample");
    }
}

// What the caller left open, decided.
CompressOptions complete(CompressOptions options, const GdmResolution& resolution, bool holds_all)
{
    if (options.layout == Layout::automatic) {
        options.layout = holds_all ? Layout::nodes : Layout::paper;
    }
    if (options.terms == 0) {
        options.terms = default_terms(resolution, options.layout, options.precision);
    }
    return options;
}

Map empty_map(const GdmResolution& resolution, float height, float aspect, const CompressOptions& options)
{
    Map map;
    map.resolution = resolution;
    map.height = height;
    map.aspect = aspect;
    map.layout = options.layout;
    map.precision = options.precision;
    return map;
}

void add_sdf(const Sdf* sdf, Map& map)
{
    if (sdf != nullptr) {
        map.sdf_nodes = sdf->nodes;
        map.sdf = sdf->values;
        if (map.precision != Precision::single) {
            round_to_half(map.sdf);
        }
    }
}

// Bytes of what bake_map allocates beside blocks of azimuths.
double bytes_beside(const GdmResolution& r, const CompressOptions& options)
{
    const double nodes = static_cast<double>(r.nodes.x) * r.nodes.y;
    const double columns = static_cast<double>(r.ntheta) * r.nodes.z;
    const double inside = 2.0 * nodes * r.nodes.z;
    const double slices = 16.0 * sizeof(float) * nodes * r.nodes.z;  // a layer of distances a thread
    if (options.layout == Layout::nodes) {
        return inside + slices + 5.0 * sizeof(float) * (options.terms + 12) * (nodes + columns * r.nphi);
    }
    const double gram = sizeof(double) * columns * columns * (columns <= 1024 ? 18 : 7);  // lanes of sums, matrix, vectors
    const double weights = 2.0 * sizeof(float) * options.terms * nodes * r.nphi;
    return gram + weights + inside + slices;
}

}  // namespace

Map compress(const Gdm& gdm, const Sdf* sdf, const CompressOptions& given, Job& job)
{
    const CompressOptions options = complete(given, gdm.resolution, true);
    check_options(gdm.resolution, gdm.height, gdm.aspect, sdf, options);
    Map map = empty_map(gdm.resolution, gdm.height, gdm.aspect, options);
    if (options.layout == Layout::nodes) {
        compress_nodes(gdm, options, map, job, 0.0f, 1.0f);
    } else {
        GdmInMemory source(gdm);
        compress_rows(source, options, map, job, 0.0f, 1.0f);
    }
    add_sdf(sdf, map);
    return map;
}

BakePlan plan_bake(const GdmResolution& resolution, const CompressOptions& given, double memory)
{
    check_resolution(resolution);
    const double azimuth = sizeof(float) * static_cast<double>(azimuth_size(resolution));
    const double whole = azimuth * resolution.nphi;
    const CompressOptions by_nodes = complete(given, resolution, true);
    BakePlan plan;
    plan.options = complete(given, resolution, memory - bytes_beside(resolution, by_nodes) >= whole);
    const double beside = bytes_beside(resolution, plan.options);
    const double least = plan.options.layout == Layout::nodes ? whole : azimuth;
    plan.needed = beside + least;
    if (memory >= plan.needed) {
        const int most = static_cast<int>(std::min((memory - beside) / azimuth, static_cast<double>(resolution.nphi)));
        // Blocks of one size, as far as that goes: an odd small one at the end would bake the poles for little.
        plan.blocks = (resolution.nphi + most - 1) / most;
        plan.azimuths = (resolution.nphi + plan.blocks - 1) / plan.blocks;
        plan.used = beside + azimuth * plan.azimuths;
    }
    return plan;
}

Map bake_map(const Sample& sample, const GdmResolution& resolution, Engine engine, const Sdf* sdf, const CompressOptions& given,
             double memory, Job& job)
{
    const BakePlan plan = plan_bake(resolution, given, memory);
    const CompressOptions& options = plan.options;
    check_options(resolution, sample.height(), sample.aspect(), sdf, options);
    if (plan.blocks == 0) {
        throw InvalidArgument("this bake needs " + std::to_string(static_cast<long long>(plan.needed / 1e6) + 1) +
                              " MB of memory, and its limit is " + std::to_string(static_cast<long long>(memory / 1e6)) +
                              "; raise the limit, or lower the resolution" +
                              (options.layout == Layout::nodes ? ", or choose the paper's layout" : ""));
    }
    Map map = empty_map(resolution, sample.height(), sample.aspect(), options);
    if (options.layout == Layout::nodes) {
        const Gdm gdm = bake_gdm(sample, resolution, engine, job, 0.5f);
        compress_nodes(gdm, options, map, job, 0.5f, 1.0f);
    } else {
        job.stage(0.0f, 0.02f);
        const GdmBaker baker(sample, resolution, engine, job);
        GdmBakedInBlocks source(baker, resolution, sample.height(), sample.aspect(), plan.azimuths);
        compress_rows(source, options, map, job, 0.02f, 1.0f);
    }
    add_sdf(sdf, map);
    return map;
}

}  // namespace mesoshell
