"""The picture of Worley noise with its cells and points laid over it.

A pixel meets the point of its own cell and those of the eight around it: nine in the
plane and 27 in space, where document D counts 8 and 26 (E32).
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.image import srgb_decode
from refcloud.noise import worley_grid, worley_points
from refcloud.raster import line_pixels

ACROSS = 8  # cells along the longer side
PIXEL = (0.62, 0.47)  # the pixel that is looked at, as shares of the cells' grid
GRID, POINT, MARK = (0.02, 0.18, 0.60), (0.75, 0.05, 0.02), (1.0, 0.32, 0.02)
INSIDE = 0.35  # how far the nine cells are tinted


def cells_overlay(width: int, height: int, *, seed: int, across: int = ACROSS) -> Array:
    """Draw noise, cells, points, and the nine cells that one pixel looks into.

    Parameters
    ----------
    width, height
        Size of the picture, pixels.
    seed
        Which points.
    across
        Cells along the longer side.

    Returns
    -------
    Linear RGB, shape (height, width, 3).
    """
    # 1. The noise, black at the points, a picture of whole pixels per cell.
    edge = max(width, height) / across
    x: Array = np.asarray((np.arange(width) + 0.5) / edge, np.float64)
    y: Array = np.asarray((np.arange(height) + 0.5) / edge, np.float64)
    grey = worley_grid(x, y, seed=seed, normalize="clip")
    light = np.repeat(srgb_decode(grey)[..., None], 3, axis=-1)

    # 2. The cell of one pixel and those around it.
    columns, rows = -(-width // edge), -(-height // edge)
    px, py = PIXEL[0] * columns, PIXEL[1] * rows
    near_x = np.abs(np.floor(x) - np.floor(px)) <= 1
    near_y = np.abs(np.floor(y) - np.floor(py)) <= 1
    nine = near_y[:, None] & near_x
    light[nine] += INSIDE * (np.array(MARK) - light[nine])

    # 3. The borders of the cells.
    size = {"width": width, "height": height}
    thick = max(1, round(width / 512))
    for k in range(1, across):
        at = k * edge
        for start, end in (([at, 0], [at, height]), ([0, at], [width, at])):
            line = line_pixels(np.array(start), np.array(end), thickness=thick, **size)
            light[line] = GRID

    # 4. The point of every cell, and the way from the pixel to the nearest.
    i, j = np.meshgrid(np.arange(across + 1), np.arange(across + 1))
    points = np.stack([i, j], axis=-1) + worley_points(i, j, seed=seed)
    points = points.reshape(-1, 2)
    pixel = np.array([px, py])
    nearest = points[np.square(points - pixel).sum(axis=1).argmin()]
    way = line_pixels(pixel * edge, nearest * edge, thickness=2 * thick, **size)
    light[way] = MARK
    radius = max(1.5, 0.07 * edge)
    for center, color in (*((p, POINT) for p in points), (pixel, MARK)):
        dx, dy = (x - center[0]) * edge, (y - center[1]) * edge
        light[dx * dx + dy[:, None] ** 2 <= radius * radius] = color
    return light
