"""What is wrong with a shell: folds, stretch and cut seams, found when asked for and kept with the shell's version."""

from typing import NamedTuple

import numpy as np

from ..core import native
from . import versions

_SMALLEST_AREA = 1e-12  # of a prism's base in tiles: less is none


class Report(NamedTuple):
    """What mesoshell.check_shell found of one version of a shell."""

    shell_version: int
    prisms: int
    folds: int  # prisms that are inverted or cross another one
    base_folds: int  # of those, where the surface itself is folded or crosses itself
    cut_seams: int  # edges
    without_area: int  # prisms whose UVs have none
    worst_stretch: float  # the largest RMS stretch or its reciprocal
    worst_angle: float  # radians by which texture axes are farthest from a right angle

    def sentence(self, name):
        """One sentence for the status bar."""
        parts = [_count(self.folds, "fold"), _count(self.cut_seams, "cut seam")]
        if self.base_folds:
            parts[0] += f" ({self.base_folds} of the surface itself)"
        if self.without_area:
            parts.append(f"{self.without_area} without UV area")
        parts.append(f"stretch up to {self.worst_stretch:.2g}")
        return f'"{name}": {_count(self.prisms, "prism")}, {", ".join(parts)}'


_reports = {}  # object key -> Report


def folds(instance):
    """find_folds' dict of a ShellInstance's shell."""
    return _found(instance, "folds", "find_folds")


def stretch(instance):
    """stretch's dict of a ShellInstance's shell."""
    return _found(instance, "stretch", "stretch")


def seams(instance):
    """seams' dict of a ShellInstance's shell."""
    return _found(instance, "seams", "seams")


def folded(found):
    """(bool [p] of prisms that fold or cross by the shell's doing, bool [p] where the surface itself does) of folds()."""
    base = np.asarray(found["base"]) != 0
    return ((np.asarray(found["inverted"]) != 0) | (np.asarray(found["intersecting"]) != 0)) & ~base, base


def without_area(shell):
    """bool [p]: prisms whose base has no area in the UVs."""
    a, b, c = np.moveaxis(np.asarray(shell.uvs, np.float64)[np.asarray(shell.uv_triangles)], 1, 0)
    return np.abs((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])) < _SMALLEST_AREA


def check(obj, instance):
    """The Report of an object's ShellInstance, kept for last_report()."""
    own, base = folded(folds(instance))
    flat = without_area(instance.shell)
    stretched = stretch(instance)
    rms, angle = (np.asarray(stretched[name], np.float64)[~flat] for name in ("rms", "angle"))
    rms = rms[np.isfinite(rms) & (rms > 0.0)]
    angle = angle[np.isfinite(angle)]
    report = Report(
        instance.shell_version, instance.shell.prism_count, int((own | base).sum()), int(base.sum()),
        int(seams(instance)["count"]), int(flat.sum()), float(np.maximum(rms, 1.0 / rms).max()) if len(rms) else 1.0,
        float(np.abs(angle - 0.5 * np.pi).max()) if len(angle) else 0.0)
    _reports[versions.object_key(obj)] = report
    return report


def last_report(obj):
    """The Report of an object as it was last checked, or None."""
    return _reports.get(versions.object_key(obj))


def forget():
    """Drops all reports."""
    _reports.clear()


def _found(instance, name, function):
    if name not in instance.found:
        instance.found[name] = getattr(native.module(), function)(instance.shell)
    return instance.found[name]


def _count(number, noun):
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
