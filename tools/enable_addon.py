"""Runs inside Blender (`./dev blender`): enables the add-on from the source tree, for this session only."""

import sys
from pathlib import Path

import addon_utils

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "addon"))
if addon_utils.enable("mesoshell", default_set=False) is None:
    print("mesoshell: the add-on could not be enabled; the lines above say why", file=sys.stderr)
