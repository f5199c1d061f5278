// One parallel loop for every stage: threads, progress and cancellation of a Job.
#pragma once

#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "mesoshell/job.h"

namespace mesoshell {

// The job whose arena this thread works in.
inline thread_local const Job* arena_job = nullptr;

// Runs work() in one arena of the job's threads. Loops inside share it: threads that change from one short loop's arena to the
// next one's would come too late.
template <typename Work>
void in_arena(const Job& job, const Work& work)
{
    oneapi::tbb::task_arena arena(job.threads() > 0 ? job.threads() : oneapi::tbb::task_arena::automatic);
    arena.execute([&] {
        struct Entered {
            explicit Entered(const Job& job) : before(std::exchange(arena_job, &job)) {}
            ~Entered() { arena_job = before; }
            const Job* before;
        } entered(job);
        work();
    });
}

// Runs work(i) for every i in [0, count) and throws Cancelled if the job was cancelled meanwhile. The loop is this part of the
// job's stage: 0 for a quick one among several.
template <typename Work>
void parallel_for(Job& job, int count, const Work& work, float part = 1.0f)
{
    job.throw_if_cancelled();
    const float share = count > 0 ? part / static_cast<float>(count) : 0.0f;
    const auto loop = [&] {
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, count, 1), [&](const auto& range) {
            for (int i = range.begin(); i < range.end() && !job.cancelled(); ++i) {
                work(i);
                job.advance(share);
            }
        });
    };
    if (arena_job == &job) {
        loop();
    } else {
        in_arena(job, loop);
    }
    job.throw_if_cancelled();
}

}  // namespace mesoshell
