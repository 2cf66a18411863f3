"""Choosing how finely to march: a sample of rays is held against the quadrature.

No bound that is known beforehand tells how far slabs and a light volume are from the
integral, so the march measures it: some hundred rays, chosen by a hash, are integrated
as `refcloud.march.reference` does, and each setting in turn, from the coarsest on, is
tried on them. The first whose largest error, with a margin, stays below the tolerance
marches all rays. Where none does, rays are integrated by the quadrature, whose light
comes from a lattice that leans with the sun's rays if that passes, and is exact if it
does not.

A sample can miss the worst ray. That is why a margin stands on the largest error seen;
the risk that is left is small and is hunted by a test with generated scenes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Skipped
from refcloud.march.cells import lattice
from refcloud.march.fast import (
    Scale,
    Setting,
    fast,
    reached,
)
from refcloud.march.gather import Counts, Slabs
from refcloud.march.lines import Frame, frame_numbers
from refcloud.march.mixing import PHYSICAL
from refcloud.march.reference import Reference, reference_for
from refcloud.march.sampling import CHECKED, chosen_rays, edge_rays
from refcloud.march.shafted import SHAFTINGS, Shafting, shafted, shafts_of
from refcloud.march.sliced import SLICINGS, Slicing, sliced
from refcloud.march.task import Task
from refcloud.march.volumes import Volumes, volumes_of

FEWER = (2, 3)  # Gauss points of a piece, that may do where light is exact
# On the largest error of the sample: what other rays may have beyond it.
MARGIN = 2.0
# The steepest rays of slices are their worst ones, so less is left beyond them.
EDGE_MARGIN = 1.25
# Below it single precision shows.
FINEST = 1e-5
# From coarse to fine; each takes up to twice as long as the one before.
SETTINGS = (
    Setting(4.0, 1),
    Setting(2.0, 1),
    Setting(4.0 / 3.0, 1),
    Setting(1.0, 1),
    Setting(0.5, 1),
    Setting(0.5, 2),
    Setting(0.25, 2),
)
# Share of the tolerance that what lies behind opaque fronts may take.
HIDDEN = 0.05


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
        Called with (name, value): the rays that were checked, errors by setting, and
        the light volumes.

    Returns
    -------
    Radiance of shape (N, 3), columns of density of shape (N,), and what is told.
    """
    watch = observe or (lambda name, value: None)
    volumes = volumes_of(task.cloud, task.suns, task.kept)
    radiance, column, rows, notes = _marched(task, tolerance, watch, volumes)
    watch("light volumes", volumes.all)
    return radiance, column, rows, notes + volumes.notes()


def _marched(
    task: Task, tolerance: float, watch: Observer, volumes: Volumes
) -> tuple[Array, Array, tuple[Skipped, ...], tuple[str, ...]]:
    sample = chosen_rays(task)
    # A few rays cost less than to find out how to save.
    if tolerance < FINEST or len(task.origins) <= 2 * CHECKED or not len(sample):
        radiance, column = task.exact(HIDDEN * tolerance / task.brightest)
        return radiance, column, (), ()

    # 1. The sample, and what it shows.
    some = task.taken(sample)
    least = HIDDEN * tolerance / task.brightest
    reference = reference_for(some, volumes, tolerance, 0.1 * least)
    expected = reference.of(some)
    watch("checked rays", sample)
    watch("gap of the reference", reference.gap)

    # 2. Slices, which march all rays of a camera or none.
    inner = volumes.cloud
    tried: dict[Slicing, float] = {}
    for slicing in SLICINGS if task.camera and task.mixing == PHYSICAL else ():
        found = by_slices(task, volumes, slicing)
        if found is None:
            break
        tried[slicing] = some.error((found[0][sample], found[1][sample]), expected)
        bound = MARGIN * tried[slicing] + reference.gap
        if bound <= tolerance:
            steepest = EDGE_MARGIN * edge_error(task, found, reference)
            bound = max(bound, steepest + reference.gap)
        if bound <= tolerance:
            watch("errors of slices", tried)
            count = len(found[1])
            row = Skipped("march", "exact rays", count, count, bound)
            note = (
                f"march: slices, {slicing.finer:g} samples of the image and"
                f" {slicing.scale} of light per cell; off by {tried[slicing]:.2g} at"
                f" most on {len(sample)} checked rays"
            )
            return *found, (row,), (note,)
    watch("errors of slices", tried)

    # 3. Settings of slabs in turn, on the sample.
    small = lattice(inner)
    frames = frame_numbers(small, task.directions)
    lights: dict[Scale, list[NDArray[np.float32]]] = {}
    made: dict[tuple[Setting, Frame], Slabs] = {}

    def march(
        rays: Task, frames: NDArray[np.intp], setting: Setting, counts: Counts
    ) -> tuple[Array, Array]:
        if setting.scale not in lights:
            depths = volumes.at(setting.scale)
            lights[setting.scale] = reached(depths, task.medium, task.mixing)
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
            frames=frames,
            lights=lights[setting.scale],
            made=made,
        )

    errors: dict[Setting, float] = {}
    most = (tolerance - reference.gap) / MARGIN
    for setting in SETTINGS:
        if errors and out_of_reach(setting, errors, most):
            continue
        made.clear()
        errors[setting] = some.error(
            march(some, frames[sample], setting, Counts()), expected
        )
        if errors[setting] <= most:
            break
    watch("errors of settings", errors)

    # 4. All rays, with the one that passed.
    setting, error = next(reversed(errors.items()))
    bound = MARGIN * error + reference.gap
    if bound > tolerance:
        if reference.tables is not None:
            expected = some.exact(0.1 * least)
        return _by_quadrature(task, some, expected, tolerance, watch, inner)
    counts = Counts()
    radiance, column = march(task, frames, setting, counts)
    rows = (
        Skipped("march", "exact rays", len(column), len(column), bound),
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
        f"march: slabs of {setting.thickness:.3g} cells, {setting.scale} samples of"
        f" light per cell; off by {error:.2g} at most on {len(sample)} checked rays"
    )
    return radiance, column, rows, (note,)


def _by_quadrature(
    task: Task,
    some: Task,
    expected: tuple[Array, Array],
    tolerance: float,
    watch: Observer,
    inner: VoxelGrid,
) -> tuple[Array, Array, tuple[Skipped, ...], tuple[str, ...]]:
    """March where no slabs serve: exact toward the eye, with what light allows."""
    count, least = len(task.origins), HIDDEN * tolerance / task.brightest
    # 1. Light from leaning lattices.
    tried: dict[Shafting, float] = {}
    tables, finer = None, 0
    for way in SHAFTINGS:
        if way.finer != finer:
            tables, finer = shafts_of(task, inner, way.finer), way.finer
        if tables is None:
            break
        tried[way] = some.error(shafted(some, tables, way.points, least), expected)
        if MARGIN * tried[way] <= tolerance:
            watch("errors of shafts", tried)
            bound = MARGIN * tried[way]
            row = Skipped("march", "exact columns to the suns", count, count, bound)
            note = (
                f"march: quadrature, {way.finer} samples of light per cell along the"
                f" suns' rays, {way.points} Gauss points; off by {tried[way]:.2g} at"
                f" most on {len(some.origins)} checked rays"
            )
            return *shafted(task, tables, way.points, least), (row,), (note,)
    watch("errors of shafts", tried)
    # 2. Exact light, at as few points of a piece as do.
    points = 4
    for fewer in FEWER:
        if MARGIN * some.error(some.exact(least, fewer), expected) <= tolerance:
            points = fewer
            break
    note = f"march: exact light at {points} Gauss points, since no saving held"
    return *task.exact(least, points), (), (note,)


def by_slices(
    task: Task, volumes: Volumes, slicing: Slicing
) -> tuple[Array, Array] | None:
    """March a camera's rays by slices; None where they cannot serve."""
    if task.camera is None:
        return None
    return sliced(
        volumes.cloud,
        task.camera,
        suns=task.suns,
        medium=task.medium,
        slicing=slicing,
        depths=volumes.at(slicing.scale),
    )


def out_of_reach(setting: Setting, errors: dict[Setting, float], most: float) -> bool:
    """Tell that a setting is not worth a trial: thinner slabs will be needed.

    A sum over slabs errs by the square of their thickness at best, so the last trial
    tells how much is to be hoped for. Only time depends on whether that is true.
    """
    last, error = next(reversed(errors.items()))
    hoped = error * (setting.thickness / last.thickness) ** 2
    return hoped > most and setting != SETTINGS[-1] and setting.scale == last.scale


def edge_error(task: Task, found: tuple[Array, Array], reference: Reference) -> float:
    """Give the largest error of a camera's picture on the rays where it is steepest."""
    if task.camera is None:
        return 0.0
    thickest = float(np.max(task.medium.sigma_t))
    edges = edge_rays(task.camera, -np.expm1(-thickest * found[1]))
    some = task.taken(edges)
    return some.error((found[0][edges], found[1][edges]), reference.of(some))
