"""Pictures of a fit: the voxels, the balls that stand for them, and the difference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Range
from refcloud.image import Picture, difference_picture
from refcloud.lighting import Look
from refcloud.metaballs import Metaballs, voxel_balls
from refcloud.render import default_medium, framed, render

# One sun, balls of one colour each and smooth edges: what differs is the fit.
PLAIN = Look(
    light_reach=0.0,
    erosion=0.0,
    relief=0.0,
    sky_light=np.zeros(3),
    ground_light=np.zeros(3),
)
GAP = 2  # pixels between the panels


@dataclass(frozen=True)
class FitPictures:
    """The pictures of a cloud map and of its balls, before black.

    Attributes
    ----------
    voxels, balls
        Drawn with the same camera, medium and sun.
    error
        Relative root mean square error of the linear picture; 0 is exact, 1 as bad as
        no balls.
    """

    voxels: Picture
    balls: Picture
    error: float

    def side_by_side(self) -> Picture:
        """Put voxels, balls and their difference in one row."""
        off = difference_picture(self.voxels, self.balls, gain=1.0)
        gap = np.ones((len(off.linear), GAP, 3))
        parts = [self.voxels.linear, gap, self.balls.linear, gap, off.linear]
        return Picture(np.concatenate(parts, axis=1))


@checked
def fit_pictures(
    grid: VoxelGrid,
    balls: Metaballs,
    *,
    voxels: Picture | None = None,
    width: Annotated[int, Range(1, 4096, "pixels")] = 160,
    height: Annotated[int, Range(1, 4096, "pixels")] = 120,
) -> FitPictures:
    """Draw a cloud map and its balls alike, and compare.

    Formula: sqrt(sum (a - b)^2 / sum a^2) over pixels and channels

    Parameters
    ----------
    grid
        The cloud map; it is drawn as one ball for each occupied voxel.
    balls
        What stands for it.
    voxels
        The picture of the same map, where it was drawn before for other balls.
    width, height
        Size of each picture.

    Returns
    -------
    Both pictures and the error; of an empty map 0 or infinity, as the balls are.

    Source: paper M, figures 7 to 10 (X03).

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [2, 2, 2])
    >>> fit_pictures(grid, voxel_balls(grid), width=8, height=6).error
    0.0
    """
    every = voxel_balls(grid)
    both = every if len(every) else balls
    camera = framed(both, width, height)
    medium, _ = default_medium(both, PLAIN)

    def drawn(cloud: Metaballs) -> Picture:
        return render(
            cloud, camera=camera, medium=medium, look=PLAIN, background=np.zeros(3)
        )

    a, b = voxels or drawn(every), drawn(balls)
    size = float(np.sqrt(np.square(a.linear).sum()))
    off = float(np.sqrt(np.square(a.linear - b.linear).sum()))
    if size == 0.0:
        return FitPictures(a, b, 0.0 if off == 0.0 else np.inf)
    return FitPictures(a, b, off / size)
