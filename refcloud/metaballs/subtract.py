"""Place and subtract: a ball where most is missing, again and again (Dobashi)."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape
from refcloud.metaballs.kernels import Kernel, profile_of
from refcloud.metaballs.pairs import Work
from refcloud.metaballs.refine import Fit, Listed
from refcloud.metaballs.settings import Settings
from refcloud.metaballs.sizes import sizes_for
from refcloud.metaballs.solve import with_heights

# Less than this share of the largest density is rounding.
NOTHING = 1e-9


@checked
def place_and_subtract(
    density: Annotated[Array, Shape("D", "H", "W"), Range(0.0)],
    edges: Annotated[Array, Shape(3), Positive],
    radii: Annotated[Array, Shape("S"), Positive],
    *,
    count: Annotated[int, Range(1)],
    kernel: Kernel = "wyvill",
) -> Array:
    """Put balls where most density is missing, each time taking the ball away.

    Formula: at the voxel of the largest r, the radius with the largest
    (r . k)^2 / (k . k); r -= (r . k) / (k . k) k

    Parameters
    ----------
    density
        What r is at first, shape (D, H, W) as ``[z, y, x]``. The sums run over these
        voxels alone: a cloud needs empty ones around it.
    edges
        Edges of a voxel along x, y, z.
    radii
        Those that a ball may have, in the unit of the edges, shape (S,).
    count
        How many balls are wanted. It ends before where nothing is missing.
    kernel
        How a ball's density falls.

    Returns
    -------
    Shape (N, 5): x, y, z of the voxel's centre counted from the first one's, radius,
    and height of each ball.

    Source: paper M, section 3 (A13): Dobashi's fit of satellite pictures, in 3-D.

    Examples
    --------
    >>> place_and_subtract(np.ones((1, 1, 1)), [1, 1, 1], [0.9], count=3)
    array([[0. , 0. , 0. , 0.9, 1. ]])
    """
    left, least = density.copy(), NOTHING * float(density.max(initial=0.0))
    stencils = [_Stencil(edges, float(radius), kernel) for radius in radii]
    balls: list[tuple[float, ...]] = []
    while len(balls) < count:
        # 1. The voxel where most is missing.
        flat = int(left.argmax())
        if left.flat[flat] <= least:
            break
        place = np.unravel_index(flat, left.shape)
        # 2. The ball there that lowers the squares most.
        best = (0.0, 0.0, 0.0, left[:0], left[:0])
        for radius, stencil in zip(radii, stencils, strict=True):
            part, ball = stencil.at(left, place)
            product = float((part * ball).sum())
            power = float((ball * ball).sum())
            if product > least * power and product**2 / power > best[0]:
                gain, height = product**2 / power, product / power
                best = (gain, float(radius), height, part, ball)
        gain, radius, height, part, ball = best
        if gain == 0.0:  # no ball lowers them: the voxel is given up
            left[place] = 0.0
            continue
        # 3. Take it away.
        part -= height * ball
        x, y, z = (float(p) * float(e) for p, e in zip(place[::-1], edges, strict=True))
        balls.append((x, y, z, radius, height))
    return np.array(balls).reshape(-1, 5)


class _Stencil:
    """A ball of one radius, sampled around a voxel."""

    def __init__(self, edges: Array, radius: float, kernel: Kernel) -> None:
        self.reach = [int(radius / edge) for edge in edges[::-1]]
        z, y, x = (
            (np.arange(-m, m + 1) * edge / radius) ** 2
            for m, edge in zip(self.reach, edges[::-1], strict=True)
        )
        self.values = profile_of(z[:, None, None] + y[:, None] + x, kernel)

    def at(self, left: Array, place: tuple[np.intp, ...]) -> tuple[Array, Array]:
        """Give the part of a grid that the ball covers, and the ball there."""
        inside, own = [], []
        for p, m, n in zip(place, self.reach, left.shape, strict=True):
            low, high = max(int(p) - m, 0), min(int(p) + m + 1, n)
            inside.append(slice(low, high))
            own.append(slice(low - int(p) + m, high - int(p) + m))
        return left[tuple(inside)], self.values[tuple(own)]


def subtract(work: Work, count: int, settings: Settings) -> Listed:
    """Place balls and subtract them; then give all their best heights."""
    radii = sizes_for(work, count, settings.least_radius)
    room = [int(float(radii.max()) / edge) + 1 for edge in work.edges[::-1]]
    density = np.pad(work.density, [(n, n) for n in room])
    found = place_and_subtract(
        density, work.edges, radii, count=count, kernel=settings.kernel
    )
    start = np.array(room[::-1]) * work.edges
    fit = Fit(found[:, :3] - start, found[:, 3], found[:, 4])
    return with_heights(work, fit, settings.kernel)
