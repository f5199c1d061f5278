"""Adding functions to bpy.app.handlers, and taking them out again."""

import bpy


def add(pairs):
    """Append each function of (name of a list in bpy.app.handlers, function)."""
    for name, function in pairs:
        getattr(bpy.app.handlers, name).append(function)


def remove(pairs):
    """Remove each function that add() appended; those that are gone already are left alone."""
    for name, function in pairs:
        handlers = getattr(bpy.app.handlers, name)
        if function in handlers:
            handlers.remove(function)
