"""Runs in a Blender of its own: makes a shell, saves, loads, and writes what it found.

    blender --background --python reload.py -- MAP FOLDER RESULT
"""

import json
import os
import shutil
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import scenes  # noqa: E402
import session  # noqa: E402

session.module_name = session.enable(os.environ["MESOSHELL_TEST_PACKAGE"])
map_file, folder, result = sys.argv[sys.argv.index("--") + 1:]
shells = session.part("host.shells")


def visible():
    return shells.visible(bpy.context.evaluated_depsgraph_get())


shutil.copy(map_file, os.path.join(folder, "mail.gdm.exr"))
blend = os.path.join(folder, "mail.blend")
bpy.ops.wm.save_as_mainfile(filepath=blend)

tile, torus = scenes.make_tile("SphereTile"), scenes.make_torus("MailTorus")
bpy.context.view_layer.update()
bpy.ops.mesoshell.add_shell(object="MailTorus", filepath="//mail.gdm.exr", thickness=0.125, levels=2, scheme="bilinear",
                            tiles_u=6.0, tiles_v=3.0, traversal="gdm")
torus.mesoshell.base_color = (0.25, 0.5, 0.75)
OPTIONS = dict(surface='CAGE', subdivision='OWN', refine='LENGTH', most_levels=3, edge_length=0.5, edge_pixels=8.0,
               boundary="edges", uv_rule="linear", use_creases=False, part='ATTRIBUTE', part_name="mark", offset="inward",
               fit_thickness=True, thickness_group="Thick", smooth_directors=2, repair=True, relax=3, fins="paper",
               placement='METER', uv_rotation=0.5)
other = scenes.make_plane("Other")
for name, value in OPTIONS.items():
    setattr(other.mesoshell, name, value)
other.mesoshell.uv_offset = (0.25, 0.5)
other.mesoshell.thickness_image = bpy.data.images.new("Thick", 4, 4)
bpy.context.scene.mesoshell_overlays.show_folds = True
bake = bpy.context.scene.mesoshell
bake.tile, bake.resolution, bake.directions, bake.sdf_resolution = tile, (8, 9, 10), (4, 6), (12, 13, 14)
bake.terms, bake.precision, bake.output_path = 5, "float", "//mail.gdm.exr"
found = {"prisms_before": visible()[0].shell.prism_count}
bpy.ops.wm.save_mainfile()

bpy.ops.wm.read_homefile(use_empty=True)
found["after_new_file"] = [instance.object_name for instance in visible()]
bpy.ops.wm.open_mainfile(filepath=blend)
instances = visible()
found["after_load"] = [instance.object_name for instance in instances]
found["prisms_after"] = instances[0].shell.prism_count if instances else None
tile, torus = bpy.data.objects["SphereTile"].mesoshell_tile, bpy.data.objects["MailTorus"].mesoshell
found["problem"] = shells.problem(bpy.data.objects["MailTorus"])
found["tile"] = [tile.is_tile, tile.period_u, tile.period_v, tile.height]
found["shell"] = [torus.enabled, torus.map_path, torus.thickness, torus.levels, torus.scheme, torus.tiles_u,
                  torus.tiles_v, torus.traversal, list(torus.base_color)]
other = bpy.data.objects["Other"].mesoshell
found["options"] = [name for name, value in OPTIONS.items() if getattr(other, name) != value]
found["others"] = [list(other.uv_offset), other.thickness_image.name, bpy.context.scene.mesoshell_overlays.show_folds]
bake = bpy.context.scene.mesoshell
found["bake"] = [bake.tile.name, list(bake.resolution), list(bake.directions), list(bake.sdf_resolution), bake.terms,
                 bake.precision, bake.output_path]
Path(result).write_text(json.dumps(found))
