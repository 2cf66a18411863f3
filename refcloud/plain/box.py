"""The box and the cloud in it, one corner, one line, one voxel at a time.

Each function is the twin of the one of the same name in `refcloud.cloudmap`.
"""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.plain.smooth import worley_smooth

Point = Sequence[float]  # x, y, z
Corner = tuple[float, float, float]

# Corners of each wall, counterclockwise as seen from outside.
WALLS = ("0462", "1375", "0154", "2673", "0231", "4576")


def spanned(first: Point, second: Point) -> tuple[list[float], list[float]]:
    """Give the lower and the upper corner."""
    lower = [min(a, b) for a, b in zip(first, second, strict=True)]
    upper = [max(a, b) for a, b in zip(first, second, strict=True)]
    return lower, upper


def box_corners(first: Point, second: Point) -> list[Corner]:
    """List the corners: z slowest, x fastest, the lower end first."""
    (x0, y0, z0), (x1, y1, z1) = spanned(first, second)
    return [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]


def box_lines(first: Point, second: Point) -> list[list[Corner]]:
    """Join corners that differ along one axis."""
    corners = box_corners(first, second)
    lines = []
    for step in (1, 2, 4):
        for k in range(8):
            if k // step % 2 == 0:
                lines.append([corners[k], corners[k + step]])
    return lines


def box_triangles(first: Point, second: Point) -> list[list[Corner]]:
    """Cut each wall along its diagonal."""
    corners = box_corners(first, second)
    triangles = []
    for wall in WALLS:
        a, b, c, d = (corners[int(k)] for k in wall)
        triangles += [[a, b, c], [a, c, d]]
    return triangles


def resized_box(
    first: Point, second: Point, lengths: Point
) -> tuple[list[float], list[float]]:
    """Give a box other lengths about its middle."""
    middle = [0.5 * a + 0.5 * b for a, b in zip(first, second, strict=True)]
    lower = [m - 0.5 * n for m, n in zip(middle, lengths, strict=True)]
    upper = [m + 0.5 * n for m, n in zip(middle, lengths, strict=True)]
    return lower, upper


def placed_texture(texture: list, repeats: tuple[int, int, int]) -> list:
    """Lay a texture [z][y][x] side by side."""
    D, H, W = len(texture), len(texture[0]), len(texture[0][0])
    across, up, along = repeats
    return [
        [
            [texture[k % D][j % H][i % W] for i in range(W * across)]
            for j in range(H * up)
        ]
        for k in range(D * along)
    ]


def box_coverage(point: Point, lower: Point, upper: Point, edge: Point) -> float:
    """Give how much cloud there may be at one place."""
    cover = 1.0
    for p, low, high, reach in zip(point, lower, upper, edge, strict=True):
        inside = min(p - low, high - p)
        if inside < 0.0:
            return 0.0
        if reach > 0.0:
            t = min(inside / reach, 1.0)
            cover *= t * t * (3.0 - 2.0 * t)
    return cover


def box_cloud(
    first: Point,
    second: Point,
    *,
    voxel: float,
    cell: float,
    seed: int = 0,
    octaves: int = 3,
    threshold: float = 0.65,
    edge: Point = (0.0, 0.0, 0.0),
    detail: str = "smooth",
) -> list:
    """Give the densities of a box of cloud, as [z][y][x]."""
    lower, upper = spanned(first, second)
    axes = []
    for low, high in zip(lower, upper, strict=True):
        n = max(round((high - low) / voxel), 1)
        axes.append([low + (i + 0.5) * (high - low) / n for i in range(n)])

    def density(x: float, y: float, z: float) -> float:
        place = (x / cell, y / cell, z / cell)
        noise = worley_smooth(place, seed=seed, octaves=octaves, detail=detail)
        cover = box_coverage((x, y, z), lower, upper, edge)
        return max(cover - (1.0 - noise) / (1.0 - threshold), 0.0)

    x, y, z = axes
    return [[[density(a, b, c) for a in x] for b in y] for c in z]
