"""What rays show, for others to be held against: exact, or known to be nearly so.

The quadrature integrates a column to the sun from every one of its points, which is
nearly all that it costs. Columns that are read from a light volume by cubics cost next
to nothing, and are off by little. By how much, a few rays tell that are integrated
both ways: the *gap*. The largest one seen, with a margin, counts against the tolerance;
where it takes too much of it the quadrature itself is the reference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.march.cubics import Smooth, smooth_columns
from refcloud.march.shafted import shafted
from refcloud.march.task import Task
from refcloud.march.volumes import Volumes

GAUGED = 16  # rays that are integrated both ways, spread over the sample
# Gauss points of a piece for them: the gap changes less along it than light does.
PAIR = 2
# On the largest gap of the gauged rays: what that of other rays may be.
GAP_MARGIN = 3.0
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
) -> Reference:
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
    The cheaper one if it is near enough.
    """
    if not some.suns:
        return Reference(None, 0.0, least)
    tables = [smooth_columns(volume) for volume in volumes.at(1)]
    spread = np.linspace(0, len(some.origins) - 1, GAUGED).round()
    gauged = some.taken(np.unique(spread.astype(np.intp)))
    both = (gauged.exact(least, PAIR), shafted(gauged, tables, PAIR, least))
    gap = GAP_MARGIN * gauged.error(*both)
    if gap <= MOST * tolerance:
        return Reference(tables, gap, least)
    return Reference(None, 0.0, least)
