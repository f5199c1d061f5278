"""Every mesh that Blender's Add menu offers carries a shell, at level 0 and subdivided."""

import bpy
import numpy as np
import pytest
import scenes

PRIMITIVES = {
    "plane": {}, "cube": {}, "circle": {"fill_type": 'NGON'}, "uv_sphere": {"segments": 12, "ring_count": 8},
    "ico_sphere": {"subdivisions": 2}, "cylinder": {"vertices": 12}, "cone": {"vertices": 12}, "torus": {}, "grid": {},
    "monkey": {},
}


@pytest.mark.parametrize("levels", [0, 2])
@pytest.mark.parametrize("name", PRIMITIVES)
def test_primitive(part, fresh, map_file, name, levels):
    shells = part("host.shells")
    shells.forget()
    make = getattr(bpy.ops.mesh, "primitive_torus_add" if name == "torus" else f"primitive_{name}_add")
    if name == "torus":
        make(major_segments=16, minor_segments=8)
    else:
        make(calc_uvs=True, **PRIMITIVES[name])
    obj = bpy.context.view_layer.objects.active
    bpy.context.view_layer.update()
    if not obj.data.uv_layers:
        assert bpy.ops.mesoshell.unwrap(object=obj.name) == {'FINISHED'}
    sizes = np.array([len(face.vertices) for face in obj.data.polygons])
    scenes.add_shell(obj, map_file, thickness=0.05, levels=levels)
    shell = shells.visible(bpy.context.evaluated_depsgraph_get())[0].shell
    assert shell.prism_count == (np.sum(sizes - 2) if levels == 0 else 2 * np.sum(sizes) * 4 ** (levels - 1))
    corners = np.asarray(shell.prisms)[:, :6, :3]
    assert np.isfinite(corners).all()
    np.testing.assert_allclose(np.linalg.norm(corners[:, 3:] - corners[:, :3], axis=2), 0.05, rtol=1e-3)
    bpy.data.meshes.remove(obj.data)
