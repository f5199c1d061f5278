// How a long call is watched and stopped from another thread.
#pragma once

#include <algorithm>
#include <atomic>

#include "mesoshell/error.h"

namespace mesoshell {

// Shared by the thread that works and the thread that watches. Every stage takes one by reference; a default-made Job
// is a call that nobody watches.
class Job {
public:
    explicit Job(int threads = 0) : threads_(threads) {}

    // Worker threads to use; 0 means all cores.
    int threads() const { return threads_; }

    // Share done, 0 to 1. A call of several stages gives each its own part with `stage`.
    float fraction() const { return std::min(fraction_.load(std::memory_order_relaxed), 1.0f); }

    // The next stage covers the fractions [begin, end]. Called by the thread that works, between its parallel loops.
    void stage(float begin, float end)
    {
        length_ = end - begin;
        // The shares of a long loop sum to more than its part by roundings, and what is watched never goes back.
        const float seen = fraction_.load(std::memory_order_relaxed);
        fraction_ = seen > begin && seen < begin + rounding ? seen : begin;
    }

    // `share` of the stage is done.
    void advance(float share)
    {
        float seen = fraction_.load(std::memory_order_relaxed);
        while (!fraction_.compare_exchange_weak(seen, seen + share * length_, std::memory_order_relaxed)) {
        }
    }

    void cancel() { cancelled_ = true; }
    bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
    void throw_if_cancelled() const
    {
        if (cancelled()) {
            throw Cancelled();
        }
    }

private:
    static constexpr float rounding = 1e-3f;

    int threads_;
    // One number, so that whoever watches never sees a new stage's beginning with the old one's share.
    std::atomic<float> fraction_{0.0f};
    float length_ = 1.0f;  // of the stage
    std::atomic<bool> cancelled_{false};
};

}  // namespace mesoshell
