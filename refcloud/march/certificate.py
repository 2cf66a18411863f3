"""How far a march is from the quadrature: what some rays tell of all of them.

Four kinds of rays are looked at:

- a hashed *sample* of those that meet density;
- the *steepest* of the picture, once all are marched: errors sit at edges and in bright
  spots, and few of many rays may be there;
- those *around the worst* so far: errors lie beside each other, along edges of shadows
  and across the sides of cells, so that from a large one the way leads to the largest;
- the *gauged* ones of `refcloud.march.reference`, which tell how far off it is that the
  others are held against.

A sample can miss the worst ray: margins stand on the largest errors seen, the risk that
is left is small, and generated scenes hunt for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.march.reference import Reference, reference_for
from refcloud.march.sampling import (
    FOLLOWED,
    chosen_rays,
    edge_rays,
    rays_around,
    strides,
)
from refcloud.march.task import Task
from refcloud.march.volumes import Volumes

Found = tuple[Array, Array]  # radiance (N, 3), columns of density (N,)
# On the largest error of the sample: what other rays may have beyond it. Among 1562
# pictures of generated clouds the largest error anywhere was more than 1.5 times that
# of the sample in 107, and more than twice in 26: the larger the picture, the more.
MARGIN = 2.0
# On that of the steepest rays; they are not always the worst.
EDGE_MARGIN = 1.25
# On the largest error on the way from the worst rays to what is around them: in those
# pictures the largest anywhere was more than 1.5 times as large in 2, by 1.82 at most;
# of 50 others with 256 pixels a side in at least one, by 1.57; 1000 and 50 later ones
# of both sizes stayed below this. (The sample alone misses by 2.98 times in such ones.)
NEAR_MARGIN = 1.75


@dataclass(frozen=True)
class Certificate:
    """What a march of some rays is held against.

    Attributes
    ----------
    task
        All rays.
    tolerance
        Largest error of a channel.
    sample, some
        Numbers of the checked rays, and their own task.
    reference, expected
        How they are integrated, and what that found.
    """

    task: Task
    tolerance: float
    sample: NDArray[np.intp]
    some: Task
    reference: Reference
    expected: Found

    def error(self, found: Found) -> float:
        """Give the largest error of a march of the checked rays alone."""
        return self.some.error(found, self.expected)

    def error_among(self, found: Found) -> float:
        """Give the largest error of a march of all rays on those that are checked."""
        return self.error((found[0][self.sample], found[1][self.sample]))

    def holds(self, error: float) -> bool:
        """Tell whether an error of checked rays lets the others keep the tolerance."""
        return self.bound(error) <= self.tolerance

    def bound(self, error: float, found: Found | None = None) -> float:
        """Bound the error of all rays.

        Parameters
        ----------
        error
            The largest one of the checked rays.
        found
            A march of all rays: the steepest ones, and those around the worst, are
            looked at as well.
        """
        largest = MARGIN * error
        # Once it is beyond the tolerance nothing more need be known.
        if found is not None and largest + self.reference.gap <= self.tolerance:
            largest = max(largest, EDGE_MARGIN * self.edge_error(found))
        if found is not None and largest + self.reference.gap <= self.tolerance:
            largest = max(largest, NEAR_MARGIN * self.near_error(found))
        return largest + self.reference.gap

    def edge_error(self, found: Found) -> float:
        """Give the largest error of a march of all rays where it is steepest.

        That is where opacity changes most, and where light does: a narrow lobe makes a
        bright spot of few rays.
        """
        light, column = found
        thickest = float(np.max(self.task.medium.sigma_t))
        opacity = -np.expm1(-thickest * column)
        red, green, blue = light.T
        brightness = np.maximum(np.maximum(red, green), blue)
        edges = np.union1d(
            edge_rays(opacity.reshape(self.task.rows)),
            edge_rays(brightness.reshape(self.task.rows)),
        )
        steep = self.task.taken(edges)
        return steep.error((light[edges], column[edges]), self.reference.of(steep))

    def near_error(self, found: Found) -> float:
        """Give the largest error on the way from the worst checked rays to worse ones.

        1. Of the rays that are known, the worst.
        2. The rays around them, as far away as halfway to the next checked one.
        3. Again, with half the stride, until next neighbours were looked at twice.
        """
        light, column = found
        known = self.sample
        errors = self.some.errors((light[known], column[known]), self.expected)
        rounds = strides(int(np.count_nonzero(column)), len(known))
        for stride in rounds:
            worst = known[np.argsort(-errors, kind="stable")]
            worst = worst[: FOLLOWED // len(rounds)]
            around = rays_around(worst, self.task.rows, stride)
            around = np.setdiff1d(around[column[around] > 0.0], known)
            some = self.task.taken(around)
            more = some.errors((light[around], column[around]), self.reference.of(some))
            known, errors = np.append(known, around), np.append(errors, more)
        return float(errors.max())

    def exactly(self) -> Certificate:
        """Hold against the quadrature itself."""
        if self.reference.tables is None:
            return self
        reference = Reference(None, 0.0, self.reference.least)
        return Certificate(
            self.task,
            self.tolerance,
            self.sample,
            self.some,
            reference,
            reference.of(self.some),
        )


def certificate_for(
    task: Task, volumes: Volumes, tolerance: float, least: float
) -> Certificate | None:
    """Choose the rays that are checked, and integrate them; None if none meet density.

    Parameters
    ----------
    task
        All rays.
    volumes
        The suns' light.
    tolerance
        Largest error of a channel.
    least
        Transmittance behind which nothing is looked for.
    """
    sample = chosen_rays(task)
    if not len(sample):
        return None
    some = task.taken(sample)
    reference, expected = reference_for(some, volumes, tolerance, least)
    return Certificate(task, tolerance, sample, some, reference, expected)
