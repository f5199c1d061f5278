"""What a bake will cost, before it starts: time, memory, the size of the file. Knows no Blender."""

import os
from dataclasses import dataclass

import numpy as np

from . import native

# Nanoseconds on one thread, for a tile of some 10,000 triangles on a processor of 2023 with AVX-512. A session corrects them by
# what its own bakes took.
_BAKE_A_SAMPLE = 12.0
_GRAM_A_PRODUCT = 0.0105  # paper, share: a sample times a column
_TERM_A_PRODUCT = 0.085  # nodes: a sample times a term
_SDF_A_NODE = 2200.0
_FACETS_A_CELL = 25000.0
_ATTRIBUTES_A_NODE = 3500.0
_SAVE_A_BYTE = 60.0
_EACH_BAKE = 0.1  # seconds, whatever the resolution
# Bytes in a file for each byte of an array, as ZIP packs those of the samples.
_PACKED = {"byte": 0.95, "half": 0.7, "float": 0.9}
_SDF_BYTES, _FACET_BYTES, _ATTRIBUTE_BYTES = 1.9, 5.0, 3.0


@dataclass(frozen=True)
class Estimate:
    """`seconds`; `memory` in bytes, of the bake itself; `file_bytes`; `plan` is what native.plan_bake said."""

    seconds: float
    memory: float
    file_bytes: float
    plan: dict

    def sentence(self):
        """For the panel; names the remedy where the memory limit is too low."""
        if not self.plan["blocks"]:
            return (f"Needs {_bytes(self.plan['needed'])} of memory, the limit is {_bytes(self.plan['limit'])}: "
                    "raise it, or choose a smaller preset")
        return f"About {_time(self.seconds)}, {_bytes(self.memory)} RAM, a file of {_bytes(self.file_bytes)}"


def estimate(resolution, directions, sdf_resolution, facet_cells, attribute_resolution, terms=0, layout="auto", precision="byte",
             memory=0.0, threads=0, correction=1.0):
    """The Estimate of a bake; arguments as in BakeRequest, `correction` multiplies the time. Raises ValueError."""
    plan = native.module().plan_bake(resolution=resolution, directions=directions, terms=terms or None, layout=layout,
                                     precision=precision, memory=memory)
    sdf, attribute = (float(np.prod(nodes)) for nodes in (sdf_resolution, attribute_resolution))
    cells = 0.4 * facet_cells ** 3  # a tile as high as most
    samples = float(np.prod(resolution)) * float(np.prod(directions))
    packed = plan["term_bytes"] * _PACKED[precision]
    nanoseconds = samples * _BAKE_A_SAMPLE
    if plan["layout"] == "nodes":
        nanoseconds += samples * (plan["terms"] + 12) * _TERM_A_PRODUCT * 2
    else:
        passes = 1 if plan["blocks"] == 1 else 3
        nanoseconds += samples * (_BAKE_A_SAMPLE * (passes - 1) + directions[0] * resolution[2] * _GRAM_A_PRODUCT)
    nanoseconds += sdf * _SDF_A_NODE + cells * _FACETS_A_CELL + attribute * _ATTRIBUTES_A_NODE
    file_bytes = packed + sdf * _SDF_BYTES + cells * _FACET_BYTES + attribute * _ATTRIBUTE_BYTES
    seconds = correction * 1e-9 * nanoseconds / (threads or os.cpu_count() or 1) + _EACH_BAKE + 1e-9 * file_bytes * _SAVE_A_BYTE
    return Estimate(seconds, plan["used"], file_bytes, plan)


def _time(seconds):
    if seconds < 1.0:
        return "a second"
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def _bytes(count):
    return f"{count / 1e6:.1f} MB" if count < 1e8 else f"{count / 1e6:.0f} MB" if count < 1e9 else f"{count / 1e9:.1f} GB"
