// A long call: it works on a thread of its own while the calling thread, 20 times a second, takes the GIL for signals and for
// the progress callback.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "errors.h"
#include "mesoshell/job.h"

namespace mesoshell::python {

// False with a Python error set where the call should end.
inline bool report(PyObject* progress, float fraction, Job& job)
{
    if (PyErr_CheckSignals() != 0) {
        return false;
    }
    if (progress == nullptr || progress == Py_None) {
        return true;
    }
    PyObject* answer = PyObject_CallFunction(progress, "(d)", static_cast<double>(fraction));
    if (answer == nullptr) {
        return false;
    }
    const int go_on = PyObject_IsTrue(answer);
    Py_DECREF(answer);
    if (go_on == 0) {
        job.cancel();
    }
    return go_on >= 0;
}

// Returns work()'s result; throws what it throws, or PythonError. `meanwhile` is called as often as progress, and once more when the
// work is done, with the GIL; false with a Python error set ends the call.
template <typename Work, typename Meanwhile>
auto run(Job& job, PyObject* progress, const Work& work, const Meanwhile& meanwhile)
{
    using Result = decltype(work());
    std::optional<Result> result;
    std::exception_ptr problem;
    std::mutex lock;
    std::condition_variable ended;
    bool done = false;
    std::thread worker([&] {
        try {
            result.emplace(work());
        } catch (...) {
            problem = std::current_exception();
        }
        const std::lock_guard guard(lock);
        done = true;
        ended.notify_one();
    });

    bool python_error = false;
    PyThreadState* thread_state = PyEval_SaveThread();
    {
        std::unique_lock guard(lock);
        while (!ended.wait_for(guard, std::chrono::milliseconds(50), [&] { return done; })) {
            if (python_error) {
                continue;
            }
            guard.unlock();
            PyEval_RestoreThread(thread_state);
            if (!meanwhile() || !report(progress, job.fraction(), job)) {
                python_error = true;
                job.cancel();
            }
            thread_state = PyEval_SaveThread();
            guard.lock();
        }
    }
    worker.join();
    PyEval_RestoreThread(thread_state);
    if (python_error) {
        throw PythonError();
    }
    if (problem) {
        std::rethrow_exception(problem);
    }
    if (!meanwhile() || !report(progress, 1.0f, job)) {
        throw PythonError();
    }
    job.throw_if_cancelled();
    return std::move(*result);
}

template <typename Work>
auto run(Job& job, PyObject* progress, const Work& work)
{
    return run(job, progress, work, [] { return true; });
}

}  // namespace mesoshell::python
