"""Paths as a user writes them in Blender."""

import os

import bpy


def absolute(path, owner=None, what="map"):
    """An absolute path; "//" starts at the .blend file (of the library that `owner` is linked from, if it is).

    Raises ValueError in a sentence when there is no .blend file yet for "//" to start at.
    """
    if not path.strip():
        raise ValueError(f"The path of the {what} is empty: choose a file")
    library = getattr(owner, "library", None)
    if path.startswith("//") and not bpy.data.filepath and library is None:
        raise ValueError(f'The path "{path}" starts at the .blend file, which is not saved yet: '
                         "save it first, or give an absolute path")
    return os.path.abspath(bpy.path.abspath(path, library=library))
