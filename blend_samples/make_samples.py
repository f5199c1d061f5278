"""Makes the sample scenes: chain_torus.blend, lizard.blend and tiles.blend.

    blender --background --factory-startup --python blend_samples/make_samples.py -- [--out DIR] [--detail N]

Everything is built from numbers; nothing is downloaded. Blender 3.4 to 5.2. Save the committed files with 3.4: later
versions open them, and carry the tiles' settings over (see scene_parts.set_tile_settings).
"""

import argparse
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))  # Blender runs a script without its folder on the path
import chain_torus_scene  # noqa: E402
import lizard_scene  # noqa: E402
import tiles_scene  # noqa: E402
from scene_parts import save  # noqa: E402

SCENES = {"chain_torus.blend": chain_torus_scene, "lizard.blend": lizard_scene, "tiles.blend": tiles_scene}


def main(arguments):
    parser = argparse.ArgumentParser(prog="make_samples.py", description=f"Makes {' and '.join(SCENES)}.")
    parser.add_argument("--out", type=Path, default=HERE, help="the folder to write to; by default, the script's own")
    parser.add_argument("--detail", type=float, default=1.0,
                        help="fineness; a tile's triangles, about 10 000 at 1, grow with its square")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)

    for name, scene in SCENES.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene.build(options.detail)
        save(options.out.resolve() / name)
        print(f"{name}: {sum(len(mesh.polygons) for mesh in bpy.data.meshes)} faces")


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
