"""What a tile's surface looks like, as volumes: base color, roughness, metallic and smooth normals at the nodes of a grid.

Every node has the attributes of the nearest point of the surface (the native closest_points), so that no background bleeds
in where a volume is interpolated. Lengths are tile widths, normals are in metric texture space, colors linear.
"""

import numpy as np

# What a surface without materials is: that of Blender's own default material.
_DEFAULT = {"color": (0.8, 0.8, 0.8), "roughness": 0.5, "metallic": 0.0, "image": None}

_WIDTHS = {"color": 3, "surface": 2, "normal": 3}
_NODES_AT_ONCE = 1 << 16  # some hundredths of a second


def volumes(surface, points, check=None):
    """A dict of float32 arrays, as the native compress takes it: color [nz, ny, nx, 3], surface [nz, ny, nx, 2] (roughness,
    metallic) and normal [nz, ny, nx, 3].

    surface  a TileSurface
    points   what closest_points says of the nodes, of a Sample made of that surface
    check    called some 20 times a second or more; what it raises ends the work

    A material's image is its base color, in place of its plain one; both are multiplied with the corners' colors. Pixels
    much finer than a voxel are averaged first.
    """
    shape = points["triangles"].shape
    looks = _Looks(surface, 1.0 / shape[2])
    triangles, weights, outward = (points[name].reshape(-1, *points[name].shape[3:])
                                   for name in ("triangles", "weights", "outward"))
    made = {name: np.empty((len(triangles), width), np.float32) for name, width in _WIDTHS.items()}
    for start in range(0, len(triangles), _NODES_AT_ONCE):
        if check is not None:
            check()
        own = slice(start, start + _NODES_AT_ONCE)
        corners = np.column_stack([1.0 - weights[own].sum(axis=1), weights[own]])
        made["color"][own] = looks.color(triangles[own], corners)
        made["surface"][own] = looks.shine[looks.indices[triangles[own]]]
        made["normal"][own] = looks.normal(triangles[own], corners, outward[own])
    return {name: values.reshape(*shape, -1) for name, values in made.items()}


class _Looks:
    """What a surface says of points of some triangles [n] at barycentric weights [n, 3]."""

    def __init__(self, surface, voxel):
        self._surface = surface
        materials, self.indices = surface.materials, surface.material_indices
        if self.indices is None or not materials:
            materials, self.indices = (_DEFAULT,), np.zeros(len(surface.triangles), np.int32)
        self._plain = np.array([material["color"] for material in materials], np.float32)
        self.shine = np.array([(material["roughness"], material["metallic"]) for material in materials], np.float32)
        self._images = {number: _as_coarse_as_voxels(material["image"], surface, self.indices == number, voxel)
                        for number, material in enumerate(materials) if material["image"] is not None}

    def color(self, triangles, weights):
        index = self.indices[triangles]
        color = self._plain[index]
        for number, image in self._images.items():
            own = np.flatnonzero(index == number)
            if self._surface.uvs is None:
                color[own] = image.mean(axis=(0, 1))
            elif len(own):
                color[own] = _sampled(image, _interpolated(self._surface.uvs, triangles[own], weights[own]))
        return color if self._surface.colors is None else color * _interpolated(self._surface.colors, triangles, weights)

    def normal(self, triangles, weights, outward):
        """On the side of `outward` [n, 3], which stands in where there is none."""
        surface = self._surface
        if surface.normals is None:
            a, b, c = np.moveaxis(surface.positions[surface.triangles[triangles]], 1, 0)
            normal = np.cross(b - a, c - a)
        else:
            normal = _interpolated(surface.normals, triangles, weights)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), outward)
        # Faces may be turned over in repair, and their normals not.
        return np.where((normal * outward).sum(axis=1, keepdims=True) < 0.0, -normal, normal)


def _interpolated(corner_values, triangles, weights):
    """[n, k] of values at corners [m, 3, k], in some triangles [n] at barycentric weights [n, 3]."""
    return np.einsum("ni,nik->nk", weights, corner_values[triangles])


def _sampled(image, uvs):
    """Colors [n, 3] of an image [h, w, 3] at UVs [n, 2], bilinear and repeating; row 0 is at v = 0."""
    height, width = image.shape[:2]
    x, y = uvs[:, 0] * width - 0.5, uvs[:, 1] * height - 0.5
    left, low = np.floor(x), np.floor(y)
    across, up = (x - left)[:, None], (y - low)[:, None]
    columns = [((left + step) % width).astype(np.intp) for step in (0, 1)]
    rows = [((low + step) % height).astype(np.intp) for step in (0, 1)]
    lower, upper = (image[row, columns[0]] * (1.0 - across) + image[row, columns[1]] * across for row in rows)
    return lower * (1.0 - up) + upper * up


def _as_coarse_as_voxels(image, surface, own, voxel):
    """An image [h, w, 3] with blocks of pixels averaged, so that a voxel on the triangles `own` [m] spans about one of them.

    Blocks are alike everywhere, by the area of all: where little of the image is spread far, it becomes coarser than voxels.
    """
    if surface.uvs is None or not own.any():
        return image
    a, b, c = np.moveaxis(surface.positions[surface.triangles[own]], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    edges = surface.uvs[own, 1:].astype(float) - surface.uvs[own, :1]
    uv_area = np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]).sum()
    if not (area > 0.0 and uv_area > 0.0):
        return image
    pixels = voxel * np.sqrt(uv_area * image.shape[0] * image.shape[1] / area)  # a side, under a voxel
    return image if pixels < 2.0 else _averaged(_averaged(image, 0, pixels), 1, pixels)


def _averaged(image, axis, pixels):
    """The means of blocks of about `pixels` along an axis."""
    size = image.shape[axis]
    count = max(1, round(size / pixels))
    first = np.arange(count) * size // count
    lengths = np.diff([*first, size])
    sums = np.add.reduceat(image.astype(float), first, axis=axis)
    return sums / (lengths[:, None, None] if axis == 0 else lengths[None, :, None])
