"""A grid of values from a file of NumPy's (.npy)."""

import os

import numpy as np


def load(path):
    """The array [nz, ny, nx] of a .npy file, copied; nothing in it is unpickled. OSError or ValueError in a sentence."""
    try:
        # Mapped, so that a header which promises more than the file holds is found out before memory is asked for.
        values = np.load(path, mmap_mode="r", allow_pickle=False)
    except OSError as error:
        raise OSError(f"The grid {path} can not be read ({error.strerror or error}): choose another file") from error
    except (ValueError, EOFError, SyntaxError, TypeError, KeyError, OverflowError) as error:
        raise ValueError(f"{path} is no array of numbers that NumPy saved ({_first_line(error)}): "
                         "save it with numpy.save") from error
    if not isinstance(values, np.ndarray):
        values.close()
        raise ValueError(f"{path} holds several arrays: save the one grid with numpy.save")
    name = os.path.basename(path)
    if values.dtype.kind not in "biuf" or values.ndim != 3:
        raise ValueError(f"{name} holds {values.dtype} of shape {values.shape}: save a grid [nz, ny, nx] of real numbers")
    return np.array(values, np.float32)


def _first_line(error):
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
