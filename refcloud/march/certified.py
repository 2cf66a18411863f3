"""Choosing how finely to march: checked rays are held against the quadrature.

No bound that is known beforehand tells how far slabs and a light volume are from the
integral, so the march measures it (`refcloud.march.certificate`). Settings are tried in
turn, from the coarsest on; the first whose errors, with their margins, stay below the
tolerance marches all rays. Where none does, rays are integrated by the quadrature,
whose light comes from a lattice that leans with the sun's rays if that passes, and is
exact if it does not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array, Observer, Skipped
from refcloud.march.cells import lattice
from refcloud.march.certificate import MARGIN, Certificate, Found, certificate_for
from refcloud.march.fast import Scale, Setting, fast, reached
from refcloud.march.gather import Counts, Slabs
from refcloud.march.lines import Frame, frame_numbers
from refcloud.march.mixing import PHYSICAL
from refcloud.march.sampling import CHECKED
from refcloud.march.sharp import by_quadrature
from refcloud.march.sliced import SLICINGS, Slicing, sliced
from refcloud.march.task import Task
from refcloud.march.volumes import Volumes, volumes_of

Told = tuple[tuple[Skipped, ...], tuple[str, ...]]  # rows and notes
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
    found, rows, notes = _marched(task, tolerance, watch, volumes)
    watch("light volumes", volumes.all)
    return *found, rows, notes + volumes.notes()


def _marched(
    task: Task, tolerance: float, watch: Observer, volumes: Volumes
) -> tuple[Found, tuple[Skipped, ...], tuple[str, ...]]:
    least = HIDDEN * tolerance / task.brightest
    certificate = None
    # A few rays cost less than to find out how to save.
    if tolerance >= FINEST and len(task.origins) > 2 * CHECKED:
        certificate = certificate_for(task, volumes, tolerance, 0.1 * least)
    if certificate is None:
        return task.exact(least), (), ()
    watch("checked rays", certificate.sample)
    watch("gap of the reference", certificate.reference.gap)
    found = by_slices(certificate, volumes, watch)
    if found is None:
        found = by_slabs(certificate, volumes, least, watch)
    if found is None:
        return by_quadrature(certificate.exactly(), volumes.cloud, least, watch)
    return found


def by_slices(
    certificate: Certificate, volumes: Volumes, watch: Observer
) -> tuple[Found, tuple[Skipped, ...], tuple[str, ...]] | None:
    """March a camera's rays by slices, all of them or none; None where none hold."""
    task, passed = certificate.task, None
    if task.camera is None or task.mixing != PHYSICAL:
        watch("errors of slices", {})
        return None
    tried: dict[Slicing, float] = {}
    for slicing in SLICINGS:
        found = sliced(
            volumes.cloud,
            task.camera,
            suns=task.suns,
            medium=task.medium,
            slicing=slicing,
            depths=volumes.at(slicing.scale),
        )
        if found is None:
            break
        tried[slicing] = certificate.error_among(found)
        bound = certificate.bound(tried[slicing], found)
        if bound <= certificate.tolerance:
            count = len(found[1])
            row = Skipped("march", "exact rays", count, count, bound, how="certified")
            note = (
                f"march: slices, {slicing.finer:g} samples of the image and"
                f" {slicing.scale} of light per cell; off by {tried[slicing]:.2g} at"
                f" most on {len(certificate.sample)} checked rays"
            )
            passed = found, (row,), (note,)
            break
    watch("errors of slices", tried)
    return passed


def by_slabs(
    certificate: Certificate, volumes: Volumes, least: float, watch: Observer
) -> tuple[Found, tuple[Skipped, ...], tuple[str, ...]] | None:
    """March rays through slabs, tried on the checked rays first; None where none hold.

    Parameters
    ----------
    certificate, volumes
        Of the rays, and of the suns.
    least
        Transmittance below which a ray is dropped.
    watch
        Called with ("errors of settings", errors by setting).
    """
    task, inner = certificate.task, volumes.cloud
    small = lattice(inner)
    frames = frame_numbers(small, task.directions)
    lights: dict[Scale, list[NDArray[np.float32]]] = {}
    made: dict[tuple[Setting, Frame], Slabs] = {}

    def march(rays: Task, frames: NDArray[np.intp], setting: Setting) -> Found:
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
    passed = None
    most = (certificate.tolerance - certificate.reference.gap) / MARGIN
    for setting in SETTINGS:
        if errors and out_of_reach(setting, errors, most):
            continue
        # 1. On the checked rays.
        made.clear()
        counts = Counts()
        error = certificate.error(
            march(certificate.some, frames[certificate.sample], setting)
        )
        errors[setting] = error
        if not certificate.holds(error):
            continue
        # 2. All rays.
        counts = Counts()
        found = march(task, frames, setting)
        bound = certificate.bound(error, found)
        if bound <= certificate.tolerance:
            passed = found, *told(certificate, setting, error, bound, counts)
            break
    watch("errors of settings", errors)
    return passed


def told(
    certificate: Certificate,
    setting: Setting,
    error: float,
    bound: float,
    counts: Counts,
) -> Told:
    """Tell what slabs left out."""
    count = len(certificate.task.origins)
    hidden = HIDDEN * certificate.tolerance
    what = "passages behind opaque fronts"
    rows = (
        Skipped("march", "exact rays", count, count, bound, how="certified"),
        Skipped("march", "passages through empty slabs", counts.empty, counts.all),
        Skipped("march", what, counts.hidden, counts.all, hidden),
    )
    note = (
        f"march: slabs of {setting.thickness:.3g} cells, {setting.scale} samples of"
        f" light per cell; off by {error:.2g} at most on"
        f" {len(certificate.sample)} checked rays"
    )
    return rows, (note,)


def out_of_reach(setting: Setting, errors: dict[Setting, float], most: float) -> bool:
    """Tell that a setting is not worth a trial: thinner slabs will be needed.

    A sum over slabs errs by the square of their thickness at best, so the last trial
    tells how much is to be hoped for. Only time depends on whether that is true.
    """
    last, error = next(reversed(errors.items()))
    hoped = error * (setting.thickness / last.thickness) ** 2
    return hoped > most and setting != SETTINGS[-1] and setting.scale == last.scale
