"""Background jobs: one Python thread each, polled by whoever started it.

The thread never touches Blender: what it needs is copied in before it starts. It is no daemon, because a daemon would be
killed inside native code when Python ends; instead cancel_all() runs before that, and the native code answers within a
tenth of a second.
"""

import threading

_running = set()
_running_lock = threading.Lock()


class Job:
    """Runs `work(progress)` in a thread, at once.

    `progress(fraction) -> bool` records a fraction in [0, 1] and answers False once cancel() was called, upon which the
    work raises. After `done`: `result` (None if it failed), `error` (the exception, or None) and `cancelled`.
    """

    def __init__(self, work, name="mesoshell job"):
        self.fraction = 0.0
        self.result = None
        self.error = None
        self._cancel = threading.Event()
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(work,), name=name, daemon=False)
        with _running_lock:
            _running.add(self)
        self._thread.start()

    @property
    def done(self):
        return self._done.is_set()

    @property
    def cancelled(self):
        """True if it ended because of cancel(): work that was already finished keeps its result."""
        return self.done and self.error is not None and self._cancel.is_set()

    def cancel(self):
        """Asks the work to end; returns at once."""
        self._cancel.set()

    def join(self, timeout=None):
        """Waits for the end; returns `done`."""
        self._thread.join(timeout)
        return self.done

    def _progress(self, fraction):
        self.fraction = min(max(float(fraction), 0.0), 1.0)
        return not self._cancel.is_set()

    def _run(self, work):
        try:
            self.result = work(self._progress)
            self.fraction = 1.0
        except BaseException as error:  # whoever polls decides; a thread has nobody above it to raise to
            self.error = error
        finally:
            with _running_lock:
                _running.discard(self)
            self._done.set()


def cancel_all(timeout=10.0):
    """Cancels every job and waits for each; returns whether all ended within `timeout` seconds each."""
    with _running_lock:
        jobs = list(_running)
    for job in jobs:
        job.cancel()
    return all([job.join(timeout) for job in jobs])
