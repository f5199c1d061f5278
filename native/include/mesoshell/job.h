// How a long call is watched and stopped from another thread.
#pragma once

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
    float fraction() const { return begin_ + (end_ - begin_) * done_.load(std::memory_order_relaxed); }

    // The next stage covers the fractions [begin, end].
    void stage(float begin, float end)
    {
        done_ = 0.0f;
        begin_ = begin;
        end_ = end;
    }

    void advance(float share)
    {
        float seen = done_.load(std::memory_order_relaxed);
        while (!done_.compare_exchange_weak(seen, seen + share, std::memory_order_relaxed)) {
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
    int threads_;
    std::atomic<float> begin_{0.0f};
    std::atomic<float> end_{1.0f};
    std::atomic<float> done_{0.0f};
    std::atomic<bool> cancelled_{false};
};

}  // namespace mesoshell
