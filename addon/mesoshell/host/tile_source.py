"""Reads a tile out of Blender: what some objects show, evaluated, in the space of a tile box."""

import numpy as np

from ..core import mirrored_tile
from ..core.tile_options import TileOptions
from ..core.tile_surface import TileSurface, check_finite
from . import instances, materials, mesh_corners, volumes

# Geometry reaches over its borders by right; what spans this many periods is rather a box of the wrong size.
_MANY_PERIODS = 4.0


def read(objects, box, depsgraph, name, options=TileOptions()):
    """The TileSurface that `objects` (originals) show in a TileBox; raises ValueError in a sentence that names the thing."""
    pieces = _Pieces(box)
    left_out = _visit(depsgraph, objects, pieces.add, options)
    if left_out:
        pieces.notices.append(f"{left_out} objects drawn as wires or bounds were left out")
    return _finished(pieces, name, options)


def read_file(path, box, scene, options):
    """The TileSurface of a file of OpenVDB grids, in a TileBox or, without one, in the surface's bounds; ValueError."""
    with volumes.from_file(path) as obj:
        name = obj.name
        with volumes.as_meshes({obj: volumes.grid_of(obj, options)}, scene, options) as meshes:
            pieces = _Pieces(volumes.box_around(name, meshes[obj]) if box is None else box)
            pieces.add(meshes[obj], np.eye(4))
    return _finished(pieces, name, options)


def _finished(pieces, name, options):
    surface = pieces.surface(name, options)
    if options.periodic == 'BLEND':
        raise ValueError(f'Tile "{name}" is made of faces, which can not be blended across a border as images and arrays '
                         "can: choose Mirror")
    return mirrored_tile.mirrored(surface) if options.periodic == 'MIRROR' else surface


def bounds(objects, axes, depsgraph, options=TileOptions()):
    """(low, high), float64 [3] each, of what `objects` show, along the columns of `axes` (world space); None if nothing."""
    lows, highs = [], []

    def see(obj, matrix):
        with instances.mesh_of(obj) as mesh:
            if mesh is None or len(mesh.vertices) == 0:
                return
            positions = np.empty(len(mesh.vertices) * 3, np.float32)
            mesh.vertices.foreach_get("co", positions)
        along = (positions.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]) @ axes
        check_finite(along, f'"{obj.name}"')
        lows.append(along.min(axis=0))
        highs.append(along.max(axis=0))

    _visit(depsgraph, objects, see, options)
    return (np.min(lows, axis=0), np.max(highs, axis=0)) if lows else None


def _visit(depsgraph, objects, see, options):
    """instances.visit, with the meshes of volumes; those get the threshold and the grid of `options`."""
    seen = []

    def see_volume(obj, matrix):
        if obj.original.type != 'VOLUME':
            raise ValueError(f'The volume that the nodes of "{obj.name}" make can not be read: end them with Volume to Mesh')
        seen.append((obj.original, volumes.grid_of(obj, options), matrix))

    left_out = instances.visit(depsgraph, objects, see, see_volume)
    # Only now: their meshes come from another depsgraph, and this one must not change while it is walked.
    if seen:
        with volumes.as_meshes({obj: grid for obj, grid, _ in seen}, depsgraph.scene, options) as meshes:
            for obj, _, matrix in seen:
                see(meshes[obj], matrix)
    return left_out


class _Pieces:
    """Meshes as they are visited, and their copies in the tile's space."""

    def __init__(self, box):
        self._box = box
        self._meshes = {}  # what copies share: (evaluated data, slots of the object) -> (MeshCorners, colors, uvs, materials, slots)
        self._copies = []  # (key of the above, affine [3, 4])
        self._table, self._indices = [], {}  # of materials
        self._slots = {}  # numbers of materials by name
        self._color_name = self._uv_name = ""
        self._surfaces = {}  # materials that were read, by name
        self.notices = []

    def add(self, obj, matrix):
        count = max(1, len(obj.material_slots), len(obj.data.materials))
        slots = [self._material(obj, index) for index in range(count)]
        key = (obj.data.as_pointer(), obj.original.name_full, tuple(slots))
        if key not in self._meshes:
            with instances.mesh_of(obj) as mesh:
                self._meshes[key] = None if mesh is None or len(mesh.polygons) == 0 else self._read(mesh, obj, slots)
        if self._meshes[key] is not None:
            self._copies.append((key, self._box.metric_from(matrix)))

    def surface(self, name, options):
        if not self._copies:
            raise ValueError(f'Tile "{name}" has no faces: model the tile\'s geometry, or pick another source')
        box, parts = self._box, [self._placed(key, affine) for key, affine in self._copies]
        counts = [len(part[0]) for part in parts]
        starts = np.cumsum([0, *counts[:-1]])
        positions = np.concatenate([part[0] for part in parts])
        self._check_place(positions, name, options)
        triangles = np.concatenate([part[1] + start for part, start in zip(parts, starts)]).astype(np.int32)
        normals, colors, uvs, indices, slots = (np.concatenate([part[column] for part in parts]) for column in range(2, 7))
        return TileSurface(
            name, positions, triangles, box.height, box.aspect, options.thickness / float(box.size[0]), normals=normals,
            colors=None if np.all(colors == 1.0) else colors, uvs=uvs if np.any(uvs) else None,
            material_indices=indices, materials=tuple(materials.table_entry(surface) for surface in self._table),
            slots=slots, slot_names=tuple(self._slots), color_name=self._color_name, uv_name=self._uv_name,
            notices=tuple(dict.fromkeys(self.notices)))

    def _material(self, obj, index):
        """Name of the material of a slot, for keys; the material itself is kept aside."""
        original = instances.slot_material(obj, index)
        name = None if original is None else original.name_full
        if name not in self._surfaces:
            self._surfaces[name] = materials.read(original, self.notices)
        return name

    def _read(self, mesh, obj, slots):
        corners = mesh_corners.read(mesh)
        check_finite(corners.positions, f'Tile "{obj.name}"')
        count = len(corners.triangles)
        colors = np.ones((count, 3, 3), np.float32)
        uvs = np.zeros((count, 3, 2), np.float32)
        indices, numbers = np.zeros(count, np.int32), np.zeros(count, np.int32)
        slot_of = np.clip(corners.slots, 0, len(slots) - 1)
        for slot in np.unique(slot_of):
            own = slot_of == slot
            numbers[own] = self._slots.setdefault(slots[slot], len(self._slots))
            surface = self._surfaces[slots[slot]]
            painted = None
            found = mesh_corners.uvs(mesh, corners, surface.uv_map)
            if found is not None:
                uvs[own] = found[own]
                self._uv_name = self._uv_name or surface.uv_map or mesh_corners.uv_name(mesh)
            elif surface.image is not None:
                self.notices.append(f'"{obj.name}" has no UVs for the image "{surface.image.name}": unwrap it')
            if surface.image is None and (surface.attribute is not None or not surface.follows):
                # A plain color leaves the word to what was painted on the mesh.
                painted = mesh_corners.colors(mesh, corners, surface.attribute or "")
                if painted is None and surface.attribute:
                    self.notices.append(f'"{obj.name}" has no color attribute "{surface.attribute}"')
            if painted is not None:
                colors[own] = painted[own]
                self._color_name = self._color_name or surface.attribute or mesh_corners.color_name(mesh)
                surface = surface._replace(color=(1.0, 1.0, 1.0))
            indices[own] = self._index(surface)
        return corners, colors, uvs, indices, numbers

    def _index(self, surface):
        if surface not in self._indices:
            self._indices[surface] = len(self._table)
            self._table.append(surface)
        return self._indices[surface]

    def _placed(self, key, affine):
        """positions, triangles, normals, colors, uvs, material indices, slots of one copy."""
        corners, colors, uvs, indices, slots = self._meshes[key]
        linear = affine[:, :3]
        positions = corners.positions.astype(np.float64) @ linear.T + affine[:, 3]
        triangles = corners.triangles
        determinant = np.linalg.det(linear)
        if determinant == 0.0:
            normals = corners.normals
        else:
            # Planes map by the inverse transpose, which keeps what is outside outside in a mirrored copy too.
            normals = corners.normals @ np.linalg.inv(linear).astype(np.float32)
            normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
        if determinant < 0.0:
            triangles, normals, colors, uvs = (array[:, ::-1] for array in (triangles, normals, colors, uvs))
        return positions, triangles, normals, colors, uvs, indices, slots

    def _check_place(self, positions, name, options):
        box = self._box
        low, high = positions.min(axis=0), positions.max(axis=0)
        if low[2] >= box.height or high[2] <= 0.0:
            side = "above" if low[2] >= box.height else "below"
            raise ValueError(f'Tile "{name}" lies wholly {side} its box "{box.name}": snap the box to it, or move the box')
        if low[0] >= 1.0 or high[0] <= 0.0 or low[1] >= box.aspect or high[1] <= 0.0:
            raise ValueError(f'Tile "{name}" lies wholly beside its box "{box.name}": snap the box to it, or move the box')
        periods = (high - low)[:2] / [1.0, box.aspect]
        if periods.max() > _MANY_PERIODS and options.periodic == 'NONE':
            self.notices.append(f'Tile "{name}" spans {periods[0]:.1f} × {periods[1]:.1f} of its periods, all of which fall '
                                "into one: make the box larger if that is not meant")
