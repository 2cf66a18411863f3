"""Choosing how finely to march: a sample of rays is held against the quadrature.

No bound that is known beforehand tells how far slabs and a light volume are from the
integral, so the march measures it: some hundred rays, chosen by a hash, are integrated
exactly, and each setting in turn, from the coarsest on, is tried on them. The first
whose largest error, with a margin, stays below the tolerance marches all rays. Where
none does, all rays are integrated exactly.

A sample can miss the worst ray. That is why a margin stands on the largest error seen;
the risk that is left is small and is hunted by a test with generated scenes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Skipped
from refcloud.march.cells import Lattice, cropped, lattice
from refcloud.march.exact import exact
from refcloud.march.fast import Setting, fast, light_volumes
from refcloud.march.gather import Counts
from refcloud.march.mixing import Mixing
from refcloud.march.quadrature import columns
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun

CHECKED = 256  # rays of the sample
# Gauss points of a piece on checked rays: two are off by less than a hundredth of the
# least tolerance that slabs can meet.
CHECKED_POINTS = 2
# On the largest error of the sample: what other rays may have beyond it.
MARGIN = 2.0
# Below it single precision shows.
FINEST = 1e-5
# From coarse to fine; each is about twice as slow as the one before.
SETTINGS = (
    Setting(4.0, 1),
    Setting(2.0, 1),
    Setting(1.0, 1),
    Setting(0.5, 1),
    Setting(0.5, 2),
    Setting(0.25, 2),
)
# Share of the tolerance that what lies behind opaque fronts may take.
HIDDEN = 0.05


@dataclass(frozen=True)
class Task:
    """Rays to march, and all that their light depends on.

    Attributes
    ----------
    cloud, grid
        The cloud map, and its lattice.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, lit
        The lights, and what each sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.
    ambient
        Radiance from all sides, shape (3,).
    background
        What lies behind each ray, shape (N, 3); None where alpha is wanted.
    """

    cloud: VoxelGrid
    grid: Lattice
    origins: Array
    directions: Array
    suns: tuple[Sun, ...]
    lit: Array
    medium: Medium
    mixing: Mixing
    ambient: Array
    background: Array | None

    def taken(self, which: NDArray[np.intp]) -> Task:
        """Keep some rays."""
        behind = None if self.background is None else self.background[which]
        return Task(
            self.cloud,
            self.grid,
            self.origins[which],
            self.directions[which],
            self.suns,
            self.lit[:, which],
            self.medium,
            self.mixing,
            self.ambient,
            behind,
        )

    @property
    def brightest(self) -> float:
        """Give what a ray can show at most, at least white."""
        light = float(self.lit.sum(axis=0).max(initial=0.0)) + self.ambient.max()
        behind = 1.0 if self.background is None else self.background.max(initial=1.0)
        return max(light, float(behind), 1.0)

    def seen(self, radiance: Array, column: Array) -> tuple[Array, Array]:
        """Complete what rays show.

        Returns
        -------
        Colours of shape (N, 3), and transmittance of shape (N, 1), or (N, 3) where
        sigma_t is RGB.
        """
        k = self.mixing.light_absorption_through_cloud
        tau = column[:, None] * (k * np.atleast_1d(self.medium.sigma_t))
        through = np.exp(-tau)
        light = radiance + self.medium.albedo_rgb * self.ambient * -np.expm1(-tau)
        if self.background is not None:
            light = light + through * self.background
        return light, through

    def error(self, found: tuple[Array, Array], expected: tuple[Array, Array]) -> float:
        """Give the largest difference of a channel; alpha is one where it is shown."""
        a, b = self.seen(*found), self.seen(*expected)
        worst = float(np.abs(a[0] - b[0]).max(initial=0.0))
        if self.background is None:
            worst = max(worst, float(np.abs(a[1] - b[1]).max(initial=0.0)))
        return worst

    def exact(self, least: float = 0.0, points: int = 4) -> tuple[Array, Array]:
        """Integrate the rays; see `refcloud.march.exact`."""
        return exact(
            self.grid,
            self.origins,
            self.directions,
            self.suns,
            self.lit,
            self.medium,
            self.mixing,
            least,
            points,
        )


def to_tolerance(
    task: Task, tolerance: float, observe: Observer | None
) -> tuple[Array, Array, tuple[Skipped, ...], tuple[str, ...]]:
    """March rays as coarsely as a tolerance allows.

    Parameters
    ----------
    task
        N rays.
    tolerance
        Largest error of a channel, above 0.
    observe
        Called with (name, value): the rays that were checked, and errors by setting.

    Returns
    -------
    Radiance of shape (N, 3), columns of density of shape (N,), and what is told.
    """
    watch = observe or (lambda name, value: None)
    sample = chosen_rays(task)
    # A few rays cost less than to find out how to save.
    if tolerance < FINEST or len(task.origins) <= 2 * CHECKED or not len(sample):
        radiance, column = task.exact(HIDDEN * tolerance / task.brightest)
        return radiance, column, (), ()

    # 1. The sample, exactly.
    some = task.taken(sample)
    least = HIDDEN * tolerance / task.brightest
    expected = some.exact(0.1 * least, CHECKED_POINTS)
    watch("checked rays", sample)

    # 2. Settings in turn, on the sample.
    inner = cropped(task.cloud)
    small = lattice(inner)
    lights: dict[Literal[1, 2], list[NDArray[np.float32]]] = {}

    def march(rays: Task, setting: Setting, counts: Counts) -> tuple[Array, Array]:
        if setting.scale not in lights:
            lights[setting.scale] = light_volumes(
                inner, task.suns, task.medium, task.mixing, setting.scale
            )
        return fast(
            inner,
            small,
            rays.origins,
            rays.directions,
            suns=rays.suns,
            lit=rays.lit,
            medium=rays.medium,
            mixing=rays.mixing,
            setting=setting,
            least=least,
            counts=counts,
            lights=lights[setting.scale],
        )

    errors: dict[Setting, float] = {}
    for setting in SETTINGS:
        errors[setting] = some.error(march(some, setting, Counts()), expected)
        if MARGIN * errors[setting] <= tolerance:
            break
    watch("errors of settings", errors)

    # 3. All rays, with the one that passed.
    setting, error = next(reversed(errors.items()))
    if MARGIN * error > tolerance:
        radiance, column = task.exact(least)
        note = f"march: exact, since slabs were off by {error:.2g} on the checked rays"
        return radiance, column, (), (note,)
    counts = Counts()
    radiance, column = march(task, setting, counts)
    rows = (
        Skipped("march", "exact rays", len(column), len(column), MARGIN * error),
        Skipped("march", "passages through empty slabs", counts.empty, counts.all),
        Skipped(
            "march",
            "passages behind opaque fronts",
            counts.hidden,
            counts.all,
            HIDDEN * tolerance,
        ),
    )
    note = (
        f"march: slabs of {setting.thickness:g} cells, {setting.scale} samples of light"
        f" per cell; off by {error:.2g} at most on {len(sample)} checked rays"
    )
    return radiance, column, rows, (note,)


def chosen_rays(task: Task) -> NDArray[np.intp]:
    """Choose rays that meet density, by a hash of their number."""
    count = len(task.origins)
    if not count:
        return np.zeros(0, np.intp)
    drawn = np.unique((uniform(np.arange(8 * CHECKED), seed=0) * count).astype(np.intp))
    held = columns(task.grid, task.origins[drawn], task.directions[drawn])
    drawn = drawn[held > 0.0]
    order = np.argsort(uniform(drawn, seed=0), kind="stable")
    return np.sort(drawn[order[:CHECKED]])
