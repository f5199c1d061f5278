// One parallel loop for every stage: threads, progress and cancellation of a Job.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "mesoshell/job.h"

namespace mesoshell {

// Runs work(i) for every i in [0, count) and throws Cancelled if the job was cancelled meanwhile. The loop is this part of the
// job's stage: 0 for a quick one among several.
template <typename Work>
void parallel_for(Job& job, int count, const Work& work, float part = 1.0f)
{
    job.throw_if_cancelled();
    const float share = count > 0 ? part / static_cast<float>(count) : 0.0f;
    oneapi::tbb::task_arena arena(job.threads() > 0 ? job.threads() : oneapi::tbb::task_arena::automatic);
    arena.execute([&] {
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, count, 1), [&](const auto& range) {
            for (int i = range.begin(); i < range.end() && !job.cancelled(); ++i) {
                work(i);
                job.advance(share);
            }
        });
    });
    job.throw_if_cancelled();
}

}  // namespace mesoshell
