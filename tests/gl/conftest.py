"""Paths and the one context of these tests."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# The add-on's core imports without Blender, its package does not.
sys.path[:0] = [str(ROOT / "addon" / "mesoshell"), str(ROOT / "tests"), str(Path(__file__).parent)]


@pytest.fixture(scope="session")
def native():
    from core import native

    return native.module()


@pytest.fixture(scope="session")
def gl():
    """The helpers of egl.py with a context current."""
    import egl

    context = egl.make_context()
    yield egl
    del context
