"""Paths of these tests, and what several of them ask of a surface."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
# The add-on's core imports without Blender, its package does not.
sys.path[:0] = [str(ROOT / "addon" / "mesoshell"), str(ROOT / "blend_samples"), str(Path(__file__).parent)]


@pytest.fixture(scope="session")
def native():
    from core import native

    return native.module()


@pytest.fixture
def rng():
    return np.random.default_rng(5)
