// Where compression reads a raw GDM: from memory, or, where that would not fit, baked anew on every walk.
#pragma once

#include <functional>

#include "mesoshell/bake.h"
#include "mesoshell/job.h"

namespace mesoshell {

class GdmBaker;

class GdmSource {
public:
    // `count` azimuths from `first` on, [count, ny, nx, ntheta, nz].
    using Use = std::function<void(int first, int count, const float* values)>;

    virtual ~GdmSource() = default;
    virtual const GdmResolution& resolution() const = 0;
    virtual float height() const = 0;
    virtual float aspect() const = 0;
    // Whether the next walk bakes, and whether every walk does.
    virtual bool bakes() const = 0;
    virtual bool always_bakes() const = 0;
    // Calls `use` for blocks of azimuths, in order, each within a stage of the job, all of them within [begin, end]; `share` of a
    // block's time goes to baking it where it is not in memory.
    virtual void walk(Job& job, float begin, float end, float share, const Use& use) = 0;
};

class GdmInMemory : public GdmSource {
public:
    explicit GdmInMemory(const Gdm& gdm) : gdm_(gdm) {}
    const GdmResolution& resolution() const override { return gdm_.resolution; }
    float height() const override { return gdm_.height; }
    float aspect() const override { return gdm_.aspect; }
    bool bakes() const override { return false; }
    bool always_bakes() const override { return false; }
    void walk(Job& job, float begin, float end, float share, const Use& use) override;

private:
    const Gdm& gdm_;
};

// Bakes `block` azimuths at a time, at least one. If those are all, they are baked once and kept.
class GdmBakedInBlocks : public GdmSource {
public:
    GdmBakedInBlocks(const GdmBaker& baker, const GdmResolution& resolution, float height, float aspect, int block);
    const GdmResolution& resolution() const override { return resolution_; }
    float height() const override { return height_; }
    float aspect() const override { return aspect_; }
    bool bakes() const override { return !kept_; }
    bool always_bakes() const override { return block_ < resolution_.nphi; }
    void walk(Job& job, float begin, float end, float share, const Use& use) override;

private:
    const GdmBaker& baker_;
    GdmResolution resolution_;
    float height_;
    float aspect_;
    int block_;  // azimuths
    UninitializedVector<float> values_;
    bool kept_ = false;
};

// Numbers of one azimuth.
std::size_t azimuth_size(const GdmResolution& resolution);

}  // namespace mesoshell
