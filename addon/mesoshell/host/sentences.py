"""Which exceptions are a user's to read, and how they read."""

from ..core import native


def expected():
    """A tuple of exception types for `except`: everything that a wrong input or a full disk can raise."""
    known = (ValueError, OSError, MemoryError, native.NativeMissing)
    try:
        return known + (native.module().Error,)
    except native.NativeMissing:
        return known


def of(error):
    """The sentence of an exception."""
    return str(error) or f"{type(error).__name__}: not enough memory, try a smaller resolution"


def poll_message(cls, condition, message):
    """For poll(): sets the tooltip that explains a grayed-out button; returns `condition`."""
    if not condition:
        cls.poll_message_set(message)
    return condition
