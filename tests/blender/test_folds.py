"""Laws of the repair of folds, on every mesh that Blender offers: no fold is left, and most of the thickness is."""

import bpy
import numpy as np
import pytest

PRIMITIVES = {
    "plane": lambda: bpy.ops.mesh.primitive_plane_add(calc_uvs=True),
    "cube": lambda: bpy.ops.mesh.primitive_cube_add(calc_uvs=True),
    "circle": lambda: bpy.ops.mesh.primitive_circle_add(fill_type='TRIFAN', calc_uvs=True),
    "n-gon": lambda: bpy.ops.mesh.primitive_circle_add(fill_type='NGON', calc_uvs=True),
    "UV sphere": lambda: bpy.ops.mesh.primitive_uv_sphere_add(calc_uvs=True),
    "ico sphere": lambda: bpy.ops.mesh.primitive_ico_sphere_add(calc_uvs=True),
    "cylinder": lambda: bpy.ops.mesh.primitive_cylinder_add(calc_uvs=True),
    "cone": lambda: bpy.ops.mesh.primitive_cone_add(calc_uvs=True),
    "torus": lambda: bpy.ops.mesh.primitive_torus_add(generate_uvs=True),
    "grid": lambda: bpy.ops.mesh.primitive_grid_add(calc_uvs=True),
    "monkey": lambda: bpy.ops.mesh.primitive_monkey_add(calc_uvs=True),
}
MODERATE, THICK = 0.04, 0.2  # of primitives about 2 wide


@pytest.fixture
def build(native, part, fresh):
    def build(name, **options):
        PRIMITIVES[name]()
        obj = bpy.context.active_object
        depsgraph = bpy.context.evaluated_depsgraph_get()
        meshes = part("host.meshes")
        # At level 0 with Blender's own normals: around a vertex of the monkey, faces are folded onto each other.
        reading = meshes.Reading(polygons=options["levels"] > 0, normals=options["levels"] == 0)
        surface = meshes.read_surface(obj, depsgraph, reading)
        arguments = part("host.shell_building").surface_arguments(surface)
        return lambda repair: native.build_shell(*arguments, normals=surface.normals, repair=repair, **options)
    return build


@pytest.mark.parametrize("thickness", [MODERATE, THICK])
@pytest.mark.parametrize("offset", ["outward", "centered", "inward"])
@pytest.mark.parametrize("levels", [0, 2])
@pytest.mark.parametrize("name", PRIMITIVES)
def test_repair_leaves_no_fold(native, build, name, levels, offset, thickness):
    make = build(name, levels=levels, offset=offset, thickness=thickness)
    shell = make(True)
    before, after = native.find_folds(make(False)), native.find_folds(shell)
    share = np.median(np.asarray(shell.thickness)) / thickness
    count = {key: int(np.sum(before[key])) for key in ("inverted", "intersecting", "base")}
    print(f"\n{name:10} level {levels} {offset:8} {thickness}: {shell.prism_count:6} prisms, before {count}, after "
          f"{int(np.sum(after['base']))} of the base, median {share:.3f}", end="")
    mended = np.asarray(after["base"]) == 0
    assert not np.any(after["inverted"])
    assert not np.any(np.asarray(after["intersecting"])[mended])
    if name != "monkey":
        assert np.all(mended)
    if thickness == MODERATE:
        assert share >= 0.8


def test_thickness_that_folds_nowhere_stays(native, build):
    make = build("torus", levels=1, thickness=MODERATE)
    np.testing.assert_array_equal(make(True).prisms, make(False).prisms)
