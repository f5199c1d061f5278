"""The ordinary geometry of a scene as a render sees it: evaluated, in world space, with one color a triangle.

Curves, text, surfaces and metaballs come as the meshes that Blender makes of them, copies (collections, particles, Geometry
Nodes) one by one.
"""

import bpy
import numpy as np

from . import images, instances, materials, mesh_corners, versions

# Drawn so, the base of a shell is left out: the viewport shows its edges at most, and the shell itself all the same.
_NO_SURFACE = {'WIRE', 'BOUNDS'}


def read(depsgraph, notices):
    """The list of dicts that the native render_scene takes as `meshes`, one for each visible object or copy with faces.

    What is hidden from renders, or in no collection of the view layer, is left out; objects that are seen by the camera or
    by shadow rays only say so. What can not be rendered goes to `notices`, in sentences.
    """
    meshes, pieces, converted, shown = [], _Pieces(notices), [], set()
    for instance in depsgraph.object_instances:
        obj = instance.object
        if not instance.show_self or obj.type not in instances.MESH_TYPES:
            continue
        owner = instance.parent if instance.is_instance else obj
        if not isinstance(obj.data, bpy.types.Mesh):
            # A curve is there twice: as it is edited, and as an instance of the mesh that it becomes.
            converted.append(owner.original)
            continue
        shown.add(owner.original)
        _add(meshes, pieces, obj, np.array(instance.matrix_world, np.float64), (obj, owner))
    for owner in dict.fromkeys(converted):
        if owner not in shown:  # one that Blender evaluates to a mesh only when asked
            obj = owner.evaluated_get(depsgraph)
            _add(meshes, pieces, obj, np.array(obj.matrix_world, np.float64), (obj,))
    return meshes


def visibility(*owners):
    """The dict of the ray visibility that a thing has if each of some objects (a copy and who makes it) must have it."""
    return {"visible_camera": all(obj.visible_camera for obj in owners),
            "visible_shadow": all(obj.visible_shadow for obj in owners)}


class _Pieces:
    """What meshes are in their own space, kept for their copies."""

    def __init__(self, notices):
        self._notices = notices
        self._read = {}

    def of(self, obj):
        """(MeshCorners, colors as _read has them) of an evaluated object, or None."""
        # A node-made instance has the original of the object whose nodes made it, and data of its own.
        key = versions.object_key(obj.original), obj.data.as_pointer()
        if key not in self._read:
            with instances.mesh_of(obj) as mesh:
                piece = None if mesh is None or len(mesh.polygons) == 0 else _read(mesh, obj)
            if piece is not None and not np.all(np.isfinite(piece[0].positions)):
                self._notices.append(f'"{obj.name}" is not rendered: its vertices are not all finite numbers; delete those')
                piece = None
            self._read[key] = piece
        return self._read[key]


def _add(meshes, pieces, obj, matrix, owners):
    """Appends an object at `matrix` if there is something to see."""
    seen = visibility(*owners)
    if not any(seen.values()) or obj.original.mesoshell.enabled and obj.display_type in _NO_SURFACE:
        return
    piece = pieces.of(obj)
    if piece is not None:
        meshes.append(_placed(*piece, matrix) | seen | {"object_index": obj.pass_index})


def _placed(corners, colors, matrix):
    linear = matrix[:3, :3]
    positions = corners.positions.astype(np.float64) @ linear.T + matrix[:3, 3]
    triangles, normals = corners.triangles, corners.normals
    determinant = np.linalg.det(linear)
    if determinant != 0.0:
        # Planes map by the inverse transpose, which keeps what is outside outside in a mirrored copy too.
        normals = normals @ np.linalg.inv(linear).astype(np.float32)
    if determinant < 0.0:
        triangles, normals = triangles[:, ::-1], normals[:, ::-1]
    return {"positions": np.ascontiguousarray(positions, np.float32), "triangles": np.ascontiguousarray(triangles),
            "normals": np.ascontiguousarray(normals, np.float32).reshape(-1, 3)} | colors


def _read(mesh, obj):
    """(MeshCorners, {"base_color": ...} or {"colors": float32 [m, 3]})."""
    corners = mesh_corners.read(mesh)
    count = max(1, len(obj.material_slots), len(obj.data.materials) if isinstance(obj.data, bpy.types.Mesh) else 0)
    surfaces = [materials.read(instances.slot_material(obj, index), []) for index in range(count)]
    slots = np.clip(corners.slots, 0, count - 1)
    used = np.unique(slots)
    if len(used) == 1 and not surfaces[used[0]].follows:
        return corners, {"base_color": surfaces[used[0]].color}
    colors = np.array([surface.color for surface in surfaces], np.float32)[slots]
    for slot in used:
        if surfaces[slot].follows:
            followed = _followed(mesh, corners, surfaces[slot])
            if followed is not None:
                colors[slots == slot] = followed[slots == slot]
    return corners, {"colors": np.ascontiguousarray(colors)}


def _followed(mesh, corners, surface):
    """What a base color is linked to, float32 [m, 3]: the mean of an attribute, or an image at a triangle's middle."""
    if surface.image is None:
        painted = mesh_corners.colors(mesh, corners, surface.attribute or "")
        return None if painted is None else painted.mean(axis=1)
    uvs = mesh_corners.uvs(mesh, corners, surface.uv_map)
    if uvs is None:
        return None
    pixels = images.linear_pixels(surface.image)
    height, width = pixels.shape[:2]
    u, v = np.nan_to_num(uvs.mean(axis=1)).T % 1.0
    return pixels[np.minimum((v * height).astype(int), height - 1), np.minimum((u * width).astype(int), width - 1)]
