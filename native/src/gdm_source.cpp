#include "gdm_source.h"

#include <algorithm>

#include "gdm_baker.h"

namespace mesoshell {

std::size_t azimuth_size(const GdmResolution& r)
{
    return static_cast<std::size_t>(r.nodes.x) * r.nodes.y * r.nodes.z * r.ntheta;
}

void GdmInMemory::walk(Job& job, float begin, float end, float, const Use& use)
{
    job.stage(begin, end);
    use(0, gdm_.resolution.nphi, gdm_.values.data());
}

GdmBakedInBlocks::GdmBakedInBlocks(const GdmBaker& baker, const GdmResolution& resolution, float height, float aspect, int block)
    : baker_(baker), resolution_(resolution), height_(height), aspect_(aspect), block_(block)
{
}

void GdmBakedInBlocks::walk(Job& job, float begin, float end, float share, const Use& use)
{
    if (kept_) {
        job.stage(begin, end);
        use(0, resolution_.nphi, values_.data());
        return;
    }
    values_.resize(azimuth_size(resolution_) * static_cast<std::size_t>(block_));
    for (int first = 0; first < resolution_.nphi; first += block_) {
        const int count = std::min(block_, resolution_.nphi - first);
        const auto at = [&](double azimuth) {
            return begin + (end - begin) * static_cast<float>(azimuth / resolution_.nphi);
        };
        job.stage(at(first), at(first + count * share));
        baker_.bake(first, count, values_.data(), job);
        job.stage(at(first + count * share), at(first + count));
        use(first, count, values_.data());
    }
    kept_ = block_ == resolution_.nphi;
}

}  // namespace mesoshell
