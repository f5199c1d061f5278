"""Laws of the background job."""

import threading
import time

import pytest


@pytest.fixture
def jobs(part):
    return part("core.jobs")


def test_a_job_runs_beside_the_caller_and_keeps_its_result(jobs):
    go = threading.Event()
    job = jobs.Job(lambda progress: go.wait(5.0) and 42)
    assert not job.done and job.result is None
    go.set()
    assert job.join(5.0)
    assert (job.result, job.error, job.fraction, job.cancelled) == (42, None, 1.0, False)


def test_progress_is_seen_and_kept_within_bounds(jobs):
    steps = [threading.Event(), threading.Event()]
    seen = threading.Event()

    def work(progress):
        for fraction in (0.25, 7.0):
            assert progress(fraction)
            seen.set()
            steps.pop(0).wait(5.0)

    first, second = steps
    job = jobs.Job(work)
    seen.wait(5.0)
    assert job.fraction == 0.25
    seen.clear()
    first.set()
    seen.wait(5.0)
    assert job.fraction == 1.0
    second.set()
    assert job.join(5.0) and job.error is None


def until_cancelled(progress):
    while progress(0.5):
        time.sleep(0.005)
    raise InterruptedError("cancelled")


def test_cancelling_is_told_to_the_work(jobs):
    job = jobs.Job(until_cancelled)
    job.cancel()
    assert job.join(5.0)
    assert job.cancelled and isinstance(job.error, InterruptedError) and job.result is None


def test_cancelling_what_is_done_changes_nothing(jobs):
    job = jobs.Job(lambda progress: 7)
    job.join(5.0)
    job.cancel()
    assert job.result == 7 and not job.cancelled


def test_an_exception_is_kept_not_raised(jobs):
    def work(progress):
        raise ValueError("no")
    job = jobs.Job(work)
    assert job.join(5.0)
    assert isinstance(job.error, ValueError) and not job.cancelled


def test_all_are_cancelled_at_once(jobs):
    running = [jobs.Job(until_cancelled) for _ in range(3)]
    assert jobs.cancel_all(5.0)
    assert all(job.done and job.cancelled for job in running)
    assert jobs.cancel_all(5.0), "nothing left to cancel"
