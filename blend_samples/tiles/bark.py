"""A tile of cracked bark, as pure geometry: plates that broaden upward, ledge upon ledge, and hang over the cracks between them.

The solid is what Relief.solid() says: plates, the cells of a warped Voronoi diagram, stand on a floor. A plate's outline depends
on the height: from the bottom of each ledge to its top it grows, then falls back to the next one. So cracks are narrower above than
below, and no height field holds them.

Lengths are in tile widths; the trunk runs along y.
"""

import numpy as np

from .contour import contour
from .tile import chance, make_tile, mix, noise, scaled, sheet

HEIGHT = 0.29
CELLS = (4, 2)  # plates across and along
STRETCH = 0.42  # of lengths along the trunk, where plates are told apart
BOTTOM, FLOOR, TOP = 0.012, 0.07, 0.235
LEDGES = 2.2
WIDEST, NARROWEST = 0.040, 0.010  # half of a crack's width, at the bottom and at the top of a ledge
LIP = 0.14  # share of a ledge in which it falls back

WEATHERED, ASH, RUSSET, PITH, LICHEN = (
    (0.105, 0.070, 0.046), (0.31, 0.255, 0.20), (0.23, 0.080, 0.028), (0.045, 0.017, 0.009), (0.25, 0.29, 0.15))


def seeds_near(places):
    """Of warped places [n, 2]: the seeds of the plates around, [12, n, 2] with lengths along the trunk stretched, and a chance [12, n]
    of each plate's own."""
    home = np.floor(places * CELLS).astype(int)
    columns, rows = np.indices(CELLS)
    # Every other column is half a plate further on: no crack runs straight across.
    jitters = np.stack([0.5 + 0.45 * (chance(columns, rows, 25) - 0.5),
                        0.5 + 0.5 * (columns % 2) + 0.45 * (chance(columns, rows, 26) - 0.5)], -1)
    chances = chance(columns, rows, 27)
    seeds, own = [], []
    for i in (-1, 0, 1):
        for j in (-2, -1, 0, 1):
            cell = home + (i, j)
            plate = np.mod(cell[:, 0], CELLS[0]), np.mod(cell[:, 1], CELLS[1])
            seeds.append((cell + jitters[plate]) / CELLS * [1.0, STRETCH])
            own.append(chances[plate])
    return np.stack(seeds), np.stack(own)


def plate_at(places):
    """Of places [n, 2]: the distance to the border of the plate there, how far that border runs along the trunk, in [0, 1], and
    the plate's chance."""
    warped = places + [0.075, 0.05] * np.stack([noise(places, (3, 4), 21), noise(places, (3, 3), 22)], -1)
    warped = warped + [0.016, 0.02] * np.stack([noise(places, (9, 11), 23), noise(places, (11, 7), 24)], -1)
    seeds, own = seeds_near(warped)
    warped = warped * [1.0, STRETCH]
    nearest = np.linalg.norm(seeds - warped, axis=-1).argmin(axis=0)
    plate = np.arange(len(places))
    first = seeds[nearest, plate]
    # A border lies halfway to another seed; the nearest of these planes is the border.
    toward = seeds - first
    length = np.maximum(np.linalg.norm(toward, axis=-1), 1e-9)
    border = (((seeds + first) / 2 - warped) * toward).sum(-1) / length
    border[nearest, plate] = np.inf
    other = border.argmin(axis=0)
    along_trunk = np.abs(toward[other, plate, 0]) / length[other, plate]
    return border[other, plate], along_trunk, own[nearest, plate]


class Relief:
    """All about the bark over places [n, 2] that does not depend on the height."""

    def __init__(self, places):
        self.border, along_trunk, self.own = plate_at(places)
        self.border = self.border / (0.45 + 0.55 * along_trunk)  # cracks across the trunk are finer
        self.furrow = np.abs(noise(places, (13, 3), 38)) + 0.4 * np.abs(noise(places, (23, 6), 39))
        self.grain = noise(places, (24, 5), 35)
        rough = noise(places, (9, 5), 31) + 0.6 * noise(places, (18, 8), 32)
        edge = np.exp(-np.maximum(self.border, 0.0) / 0.03)
        self.floor = FLOOR + 0.015 * noise(places, (6, 4), 33)
        # Flakes: layers of the plate's top that have come off in patches, with sharp borders.
        flake = 2.6 * (noise(places, (7, 4), 40) + 0.35 * noise(places, (15, 11), 41)) + self.own
        layer = np.floor(flake) + np.clip((flake - np.floor(flake)) / 0.25, 0.0, 1.0)
        self.top = (TOP + 0.03 * (self.own - 0.5) + 0.020 * (np.clip(layer, -1.0, 2.0) - 0.5) + 0.006 * rough - 0.040 * edge
                    - 0.034 * np.exp(-self.furrow / 0.10))
        self.fresh = 1.0 - np.clip(np.abs(flake - np.floor(flake) - 0.12) / 0.14, 0.0, 1.0)
        self.step = 1.7 * self.own + 0.4 * noise(places, (5, 3), 34)
        self.rough = rough

    def solid(self, z):
        """Positive within the bark, about the distance to its surface: [n]."""
        rise = np.clip((z - FLOOR) / (TOP - FLOOR), 0.0, 1.2)
        ledge = rise * LEDGES + self.step
        climb = ledge - np.floor(ledge)
        climb = np.minimum(climb / (1.0 - LIP), (1.0 - climb) / LIP)
        crack = WIDEST + (NARROWEST - WIDEST) * climb - 0.005 * self.rough
        plate = np.minimum(self.border - crack, 0.8 * (self.top - z))
        return np.maximum(plate, 0.8 * (self.floor - z))

    def colors(self, z, places):
        """Linear RGB of surface points: [n, 3]."""
        old = mix(WEATHERED, ASH, np.clip(0.2 + 0.35 * self.rough + 0.5 * self.grain + 0.3 * self.own, 0.0, 1.0))
        old = old * (0.35 + 0.65 * np.clip(self.furrow / 0.2, 0.0, 1.0))[:, None]
        patch = np.clip(3.0 * (noise(places, (5, 4), 36) + 0.5 * noise(places, (16, 13), 37)) - 1.7, 0.0, 0.6)
        old = old * (1.0 - patch[:, None]) + np.asarray(LICHEN) * patch[:, None]
        height = (z - FLOOR) / (TOP - FLOOR)
        fresh = mix(PITH, RUSSET, np.clip(1.15 * height + 0.2 * self.grain, 0.0, 1.0))
        weather = np.clip(1.1 - (self.top - z) / 0.045 + 0.25 * self.grain, 0.0, 1.0) * (1.0 - 0.65 * self.fresh)
        return fresh * (1.0 - weather[:, None]) + old * weather[:, None]


def make(detail=1.0):
    """The bark; triangles grow with the square of `detail`."""
    across, up = scaled(36, detail, 12), scaled(12, detail, 5)
    positions, triangles = contour(Relief, (across, across, up), (0.0, 0.0, 0.03), (1.0, 1.0, HEIGHT - 0.004))
    colors = Relief(positions[:, :2]).colors(positions[:, 2], positions[:, :2])
    bottom, down = sheet(lambda p: np.full(len(p), BOTTOM), 4, 4, 1.0, facing=-1)
    return make_tile("bark", [(positions, triangles, colors), (bottom, down, PITH)], height=HEIGHT, roughness=0.9)
