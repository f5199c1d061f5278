"""The surface of a periodic solid that a function gives: surface nets (Gibson 1998), in NumPy."""

import numpy as np


def disambiguated(inside):
    """Nodes [nx, ny, nz], periodic in x and y, with more of them inside: until no cell's face has only its two diagonal
    corners inside. Then no edge of the net lies in more than two of its quads."""
    inside = inside.copy()
    while True:
        before = inside.sum()
        for first, second in ((0, 1), (0, 2), (1, 2)):
            def moved(array, steps_first, steps_second, back=1):
                return np.roll(array, (-back * steps_first, -back * steps_second), axis=(first, second))
            a, b, c, d = (moved(inside, *steps) for steps in ((0, 0), (1, 0), (0, 1), (1, 1)))
            crossed = (a & d & ~b & ~c) | (b & c & ~a & ~d)
            inside |= crossed | moved(crossed, 1, 1, back=-1) | moved(crossed, 1, 0, back=-1)
        if inside.sum() == before:
            return inside


def contour(relief, cells, low, high):
    """The surface of the solid in which relief(places [n, 2]).solid(z [n]) -> [n] is positive.

    It repeats with the periods high - low along x and y, and has one sign all over z = low[2], as all over z = high[2]: the surface
    stays between. What does not depend on z is asked once a place. Gives positions float64 [n, 3] and triangles,
    counter-clockwise from outside; at the far borders, vertices of the near ones plus the period.
    """
    cells, low, high = np.asarray(cells), np.asarray(low, float), np.asarray(high, float)
    step = (high - low) / cells
    nodes = np.stack(np.meshgrid(np.arange(cells[0]), np.arange(cells[1]), indexing="ij"), -1).reshape(-1, 2)
    columns = relief(low[:2] + nodes * step[:2])
    values = np.stack([columns.solid(np.full(len(nodes), low[2] + k * step[2])) for k in range(cells[2] + 1)], -1)
    values = values.reshape(cells[0], cells[1], -1)
    inside = disambiguated(values > 0.0)
    if any(level.any() != level.all() for level in (inside[..., 0], inside[..., -1])):
        raise ValueError("the surface leaves the box through its top or bottom; make the box higher")
    values = np.where(inside, np.maximum(values, 1e-6), np.minimum(values, -1e-6))

    # One vertex in each cell that the surface crosses: the mean of the crossings of its edges.
    corner = {index: np.roll(values, (-index[0], -index[1]), axis=(0, 1))[:, :, index[2]:cells[2] + index[2]]
              for index in np.ndindex(2, 2, 2)}
    total, count = np.zeros((*cells, 3)), np.zeros(cells)
    for axis in range(3):
        for index in (index for index in np.ndindex(2, 2, 2) if index[axis] == 0):
            a, b = corner[index], corner[index[:axis] + (1,) + index[axis + 1:]]
            crossed = (a > 0.0) != (b > 0.0)
            place = np.broadcast_to(np.array(index, float), total.shape).copy()
            place[..., axis] = np.where(crossed, a / np.where(crossed, a - b, 1.0), 0.0)
            total += place * crossed[..., None]
            count += crossed
    where = np.argwhere(count > 0)
    in_cell = total[tuple(where.T)] / count[tuple(where.T)][:, None]
    positions = low + (where + drawn_to(relief, low + where * step, in_cell, step)) * step

    # Cells at the far borders are those at the near ones, a period on.
    number = np.full(cells, -1)
    number[tuple(where.T)] = np.arange(len(where))
    wrapped = np.full((cells[0] + 1, cells[1] + 1, cells[2]), -1)
    wrapped[:-1, :-1] = number
    for axis in (0, 1):
        near, far = (tuple(at if k == axis else slice(None) for k in range(3)) for at in (0, cells[axis]))
        copied = wrapped[near][wrapped[near] >= 0]
        new = np.full(wrapped[near].shape, -1)
        new[wrapped[near] >= 0] = len(positions) + np.arange(len(copied))
        wrapped[far] = new
        shift = np.zeros(3)
        shift[axis] = high[axis] - low[axis]
        positions = np.concatenate([positions, positions[copied] + shift])

    # One quad for each edge of the lattice that the surface crosses, between the four cells around the edge.
    triangles = []
    periodic = np.pad(inside, ((0, 1), (0, 1), (0, 0)), mode="wrap")
    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        start = periodic[tuple(slice(0, cells[k]) if k == axis else slice(1, cells[k] + 1) for k in range(3))]
        end = periodic[tuple(slice(1, cells[k] + 1) for k in range(3))]
        edges = np.argwhere(start != end)
        outward = start[tuple(edges.T)]  # the surface faces along the axis
        # An edge at node (.., i, j, ..) across a and b lies between cells i - 1 and i, j - 1 and j.
        corners = []
        for steps in ((0, 0), (1, 0), (1, 1), (0, 1)):
            cell = edges.copy()
            cell[:, a] += steps[0]
            cell[:, b] += steps[1]
            corners.append(cell)
        valid = np.all([(cell < wrapped.shape).all(axis=1) for cell in corners], axis=0)
        quads = np.stack([wrapped[tuple(cell[valid].T)] for cell in corners], -1)
        quads = np.where(outward[valid, None], quads, quads[:, ::-1])
        diagonal = np.linalg.norm(positions[quads[:, 0]] - positions[quads[:, 2]], axis=1) <= np.linalg.norm(
            positions[quads[:, 1]] - positions[quads[:, 3]], axis=1)
        quads = np.where(diagonal[:, None], quads, np.roll(quads, -1, axis=1))
        triangles.append(quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3))
    triangles = np.concatenate(triangles)
    used, compact = np.unique(triangles, return_inverse=True)
    return positions[used], compact.reshape(-1, 3)


def drawn_to(relief, corners, in_cell, step, rounds=3):
    """Places within cells [n, 3], moved along the gradient found there toward the surface, but not out of their cells."""
    points = corners + in_cell * step
    here, z = relief(points[:, :2]), points[:, 2]
    offset = 0.05 * step
    gradient = np.empty_like(points)
    for axis in (0, 1):
        aside = np.eye(3)[axis, :2] * offset[:2]
        gradient[:, axis] = relief(points[:, :2] + aside).solid(z) - relief(points[:, :2] - aside).solid(z)
    gradient[:, 2] = here.solid(z + offset[2]) - here.solid(z - offset[2])
    gradient /= 2.0 * offset
    along = gradient / np.maximum((gradient**2).sum(axis=1, keepdims=True), 0.1)
    value = here.solid(z)
    for _ in range(rounds):
        in_cell = np.clip(in_cell - 0.9 * value[:, None] * along / step, 0.04, 0.96)
        points = corners + in_cell * step
        value = relief(points[:, :2]).solid(points[:, 2])
    return in_cell
