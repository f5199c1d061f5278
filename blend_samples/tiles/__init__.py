"""The six tiles that everything is measured on, each a module of its own with `make(detail) -> Tile`; NumPy only.

`detail` is 1 for about 10 000 triangles; their number grows with its square: 0.33 gives some 1 000, 10 a million.
"""

from importlib import import_module

from .tile import Tile

NAMES = ("weave", "grid", "chain", "squama", "bark", "fur")


def make(name, detail=1.0):
    """The tile of that name, one of NAMES."""
    if name not in NAMES:
        raise ValueError(f"there is no tile {name!r}; there are {', '.join(NAMES)}")
    return import_module(f".{name}", __name__).make(detail)


__all__ = ["NAMES", "Tile", "make"]
