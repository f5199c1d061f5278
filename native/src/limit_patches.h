// OpenSubdiv's patches of single faces (Bfr), as exact as this code asks for.
#pragma once

#include <cstdint>
#include <mutex>
#include <shared_mutex>

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyLevel.h>

namespace mesoshell {

using Patch = OpenSubdiv::Bfr::Surface<float>;
using PatchFactory = OpenSubdiv::Bfr::RefinerSurfaceFactory<OpenSubdiv::Bfr::SurfaceFactoryCacheThreaded<
    std::shared_mutex, std::shared_lock<std::shared_mutex>, std::unique_lock<std::shared_mutex>>>;

// Sharpness that patches resolve: a sharper crease is infinitely sharp to them.
constexpr int sharp_levels = 6;

// Patches around n faces are fitted to all points around them: n patches cost the cube of n, a second at 300.
constexpr std::int32_t most_patch_faces = 256;

// Whether a face's patch can be made. Bfr 3.5 writes beyond its memory where more edges around a face are sharp than
// vertices are around it, or than 8: not around quads, which have more vertices than edges. Nor may too many faces be around
// it.
bool patches_take(const OpenSubdiv::Far::TopologyLevel& mesh, int face);

inline PatchFactory::Options patch_options()
{
    // Bfr's own choice of 2 levels errs by some thousandths of an edge around extraordinary points.
    return PatchFactory::Options().SetDefaultFVarID(0).SetApproxLevelSmooth(5).SetApproxLevelSharp(sharp_levels);
}

}  // namespace mesoshell
