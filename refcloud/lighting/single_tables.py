"""Tables in single precision: noise at the centres of cells, light at nodes.

A noise lies in [0, 1], and linear steps keep it there: its error is absolute. A mean of
light divides two sums that may both be small: there every term is a product of numbers
that are not negative, so that both sums, and the mean, are right to a few roundings of
themselves.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.lightfield import OWN
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import Whole

ROW = 8  # channels of a light's field lie in rows of whole such pieces, 32 bytes each


def _cells(place: Array) -> tuple[Whole, Array]:
    """Split a coordinate from 0 on into its cell and its place in that."""
    cell = place.astype(np.intp)
    return cell, place - cell


class Table:
    """Values at the centres of cells, in a row; every place lies between centres.

    Parameters
    ----------
    values
        Shape (D, H, W) as ``[z, y, x]``, in [0, 1].
    """

    def __init__(self, values: Floats) -> None:
        _, height, width = values.shape
        self.steps = 1, width, width * height
        self.row = values.ravel()

    def at(self, places: list[Array]) -> Floats:
        """Interpolate at x, y and z, in cells."""
        first, parts = np.zeros(1, np.intp), []
        for place, step in zip(places, self.steps, strict=True):
            cell, part = _cells(place)
            parts.append(part.astype(np.float32))
            cell *= step
            first = first + cell
        x, y, z = self.steps
        # Along x on four edges, then y, then z. On a table's last centre the part is 0:
        # what stands further on, or at the other end, does not count.
        edges = []
        for offset in (0, y, z, y + z):
            near = self.row.take(first + offset if offset else first, mode="wrap")
            far = self.row.take(first + (offset + x), mode="wrap")
            far -= near
            far *= parts[0]
            far += near
            edges.append(far)
        for a, b, part in ((0, 1, parts[1]), (2, 3, parts[1]), (0, 2, parts[2])):
            edges[b] -= edges[a]
            edges[b] *= part
            edges[a] += edges[b]
        return edges[0]


class Rows:
    """Sums of light at the nodes of a field: weighted values, weights last.

    Parameters
    ----------
    sums
        Of `light_field`.
    own
        Each ball's own values, shape (N, C).
    """

    def __init__(self, sums: Array, own: Array) -> None:
        self.shape = sums.shape[2::-1]
        self.channels = sums.shape[3] - 1
        self.rows = in_rows(sums.reshape(-1, self.channels + 1))
        self.own = in_rows(OWN * own)
        self.own[:, self.channels] = OWN

    def at(self, places: list[Array], ball: Whole) -> Floats:
        """Give the mean light at x, y and z, in nodes, as each ball sees it."""
        wide = self.rows.shape[1]
        first, parts, rests, steps, step = np.zeros(1, np.intp), [], [], [], 1
        for place, size in zip(places, self.shape, strict=True):
            cell, part = _cells(place)
            # As many times as there are channels: rows are worked on as one row.
            parts.append(part.astype(np.float32).repeat(wide))
            rests.append((1.0 - part).astype(np.float32).repeat(wide))
            cell *= step
            first = first + cell
            steps.append(step)
            step *= size
        x, y, z = steps
        edges = []
        for offset in (0, y, z, y + z):
            near, far = (
                self.rows.take(first + more, axis=0, mode="wrap").reshape(-1)
                for more in (offset, offset + x)
            )
            near *= rests[0]
            far *= parts[0]
            far += near
            edges.append(far)
        for a, b, axis in ((0, 1, 1), (2, 3, 1), (0, 2, 2)):
            edges[a] *= rests[axis]
            edges[b] *= parts[axis]
            edges[a] += edges[b]
        value = edges[0].reshape(-1, wide)
        value += self.own.take(ball, axis=0)
        value /= value[:, self.channels].repeat(wide).reshape(-1, wide)
        return value


def in_rows(values: Array) -> Floats:
    """Write rows of channels in float32, filled up to whole pieces."""
    wide = -(-values.shape[1] // ROW) * ROW
    rows = np.zeros((len(values), wide), np.float32)
    rows[:, : values.shape[1]] = values
    return rows
