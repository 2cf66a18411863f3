"""What rays show, for others to be held against: exact, or known to be nearly so.

The quadrature integrates a column to the sun from every one of its points, which is
nearly all that it costs. Columns that are read from a light volume by cubics cost next
to nothing, and are off by little. By how much, a few rays tell that are integrated
both ways: the *gap*. Most of them are those where cubics and straight lines through the
same samples differ most: where light bends, cubics are off as well. The largest gap
seen, with a margin, counts against the tolerance; where it takes too much of it the
quadrature itself is the reference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.march.cubics import Smooth, Straight, smooth_columns
from refcloud.march.shafted import shafted
from refcloud.march.task import Task
from refcloud.march.volumes import Volumes

# Rays that are integrated both ways: spread over the sample, and the most doubtful.
SPREAD, DOUBTFUL = 4, 16
# Gauss points of a piece for them: the gap changes less along it than light does.
PAIR = 2
# On the largest gap of the gauged rays: what that of other rays may be. In 298 pictures
# of generated clouds the largest one anywhere was more than twice as large in 4, by
# 2.39 at most; more than 3 times that of 16 rays spread over the sample in 59.
GAP_MARGIN = 2.5
# Share of the tolerance that the gap, with its margin, may take.
MOST = 0.5


@dataclass(frozen=True)
class Reference:
    """A way to integrate checked rays.

    Attributes
    ----------
    tables
        Columns to each sun, read by cubics; None where columns are exact.
    gap
        By how much it may be off.
    least
        Transmittance behind which nothing is looked for.
    """

    tables: Sequence[Smooth] | None
    gap: float
    least: float

    def of(self, rays: Task) -> tuple[Array, Array]:
        """Integrate rays; radiance of shape (N, 3), and columns of density, (N,)."""
        if self.tables is None:
            return rays.exact(self.least)
        return shafted(rays, self.tables, 4, self.least)


def reference_for(
    some: Task, volumes: Volumes, tolerance: float, least: float
) -> tuple[Reference, tuple[Array, Array]]:
    """Choose what checked rays are held against.

    Parameters
    ----------
    some
        The checked rays.
    volumes
        The suns' light.
    tolerance
        What the march must hold.
    least
        Transmittance behind which nothing is looked for.

    Returns
    -------
    The cheaper one if it is near enough, and what it finds along the checked rays.
    """
    exact = Reference(None, 0.0, least)
    if not some.suns:
        return exact, exact.of(some)
    lights = volumes.at(1)
    tables = [smooth_columns(volume) for volume in lights]

    def gap_of(which: NDArray[np.intp]) -> float:
        gauged = some.taken(which)
        both = (gauged.exact(least, PAIR), shafted(gauged, tables, PAIR, least))
        return GAP_MARGIN * gauged.error(*both)

    # 1. Some rays of the sample, for those that are far from it to be told soon.
    spread = np.linspace(0, len(some.origins) - 1, SPREAD).round()
    gap = gap_of(np.unique(spread.astype(np.intp)))
    if gap > MOST * tolerance:
        return exact, exact.of(some)
    # 2. Those where straight lines say something else.
    expected = Reference(tables, gap, least).of(some)
    lines = shafted(some, [Straight(volume) for volume in lights], PAIR, least)
    doubtful = np.argsort(-some.errors(expected, lines), kind="stable")[:DOUBTFUL]
    gap = max(gap, gap_of(np.sort(doubtful)))
    if gap > MOST * tolerance:
        return exact, exact.of(some)
    return Reference(tables, gap, least), expected
