"""Light that is scattered again and again: the equation, solved stage by stage.

The light of a place is kept as moments: its harmonics, summed over directions. With
first-order light F (from the suns and from outside) and the sweep K,

    moments = K (source),    source = a' chi_l (moments + F)

`solve` iterates that on each stage's grid and directions, and starts each stage from
the moments of the one before.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.transport.beams import Beams, prepare
from refcloud.transport.delta_m import ScaledMedium, delta_m
from refcloud.transport.directions import Directions, sphere_directions
from refcloud.transport.harmonics import degree_of, harmonics
from refcloud.transport.levels import doubled, halved
from refcloud.transport.mixing import fixed_point
from refcloud.transport.plans import Plan, Stage
from refcloud.transport.shone import Field, Light, Shone, inflow_moments, sun_moments
from refcloud.transport.swept import compact, dense, swept_terms

Reals = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Level:
    """A field at one resolution along one set of directions.

    Attributes
    ----------
    scaled
        The medium, its forward peak taken off.
    directions, beams
        And the sweep through the grid.
    Y
        Harmonics of the directions that the phase function sees, shape (N, R).
    share
        a' chi_l of each, shape (R,).
    sunlight
        Moments of light not yet scattered that suns send, shape (R, B, M).
    inflow
        The same of light from outside, or None.
    """

    scaled: ScaledMedium
    directions: Directions
    beams: Beams
    Y: Array
    share: Array
    sunlight: Reals
    inflow: Reals | None


@dataclass(frozen=True)
class Solution:
    """Moments of scattered light, and how they were found.

    Attributes
    ----------
    level
        The last stage's.
    moments
        Of the scattered light, and of the first-order light from outside, shape
        (R, B, M).
    iterations, residuals
        Of each stage.
    converged
        Whether each stage that was to converge did.
    """

    level: Level
    moments: Reals
    iterations: tuple[int, ...]
    residuals: tuple[float, ...]
    converged: bool


def seen(scaled: ScaledMedium) -> NDArray[np.intp]:
    """List the places of the harmonics that a phase function sees."""
    degrees = degree_of(np.arange(len(scaled.moments) ** 2))
    return np.flatnonzero(scaled.moments[degrees])


def solve(field: Field, light: Light, plan: Plan, norms: dict[int, Array]) -> Solution:
    """Run the stages of a plan.

    Parameters
    ----------
    field, light
        Matter and what shines on it.
    plan
        The stages; halvings count from the field's grid.
    norms
        Factors on each sun's light, shape (S,), by the degree of the phase function.

    Returns
    -------
    The last stage's moments.
    """
    dtype = np.float64 if plan.double else np.float32
    shone = Shone(field, light, norms)
    before: tuple[Stage, Level] | None = None
    moments: Reals | None = None
    counts, residuals, converged = [], [], True
    for stage in plan.stages:
        level = _level(field, light, stage, shone, dtype)
        share = level.share[:, None, None].astype(dtype)
        first = (
            level.sunlight if level.inflow is None else level.sunlight + level.inflow
        )
        start = np.zeros_like(first)
        if before is not None and moments is not None:
            start = _carried(moments, *before, stage, level, shone)
        again = partial(_scattered_once_more, level, share, first)
        if stage.most == 1:
            moments = again(start)
            counts.append(1)
        else:
            found = fixed_point(again, start, tolerance=stage.residual, most=stage.most)
            moments = found.value
            counts.append(found.iterations)
            if stage.most > 2:  # shorter stages take a look, they do not converge
                residuals.append(found.residual)
                converged &= found.converged
        before = stage, level
    assert moments is not None
    assert before is not None
    level = before[1]
    if level.inflow is not None:
        moments = moments + level.inflow
    if level.scaled.backward > 0.0:  # an eye sees exactly what was never turned round
        degree, halvings = level.directions.degree, plan.stages[-1].halvings
        moments = moments + sun_moments(
            light,
            shone.at(degree, halvings),
            level.scaled,
            seen(level.scaled),
            level.beams,
            dtype,
            more_than_once=True,
        )
    return Solution(level, moments, tuple(counts), tuple(residuals), converged)


def _scattered_once_more(
    level: Level, share: Reals, first: Reals, moments: Reals
) -> Reals:
    """Let light scatter, and sweep what comes of it."""
    to_moments = level.Y.T * level.directions.weights
    return swept_terms(share * (first + moments), level.beams, level.Y, to_moments)


def _level(field: Field, light: Light, stage: Stage, shone: Shone, dtype: Any) -> Level:
    directions = sphere_directions(stage.directions)
    scaled = delta_m(field.medium, directions.degree)
    density, cell = field.density, field.cell * 2.0**stage.halvings
    for _ in range(stage.halvings):
        density = halved(density)
    batch = len(light.irradiance)
    beams = prepare(
        float(scaled.sigma_t[0]) * density,
        directions,
        cell=cell,
        batch=batch,
        dtype=dtype,
    )
    places = seen(scaled)
    share = float(scaled.albedo[0]) * scaled.moments[degree_of(places)]
    Y = harmonics(directions.vectors, directions.degree)[:, places]
    suns = shone.at(directions.degree, stage.halvings)
    sunlight = sun_moments(light, suns, scaled, places, beams, dtype)
    inflow = inflow_moments(light, directions, beams, Y, dtype)
    return Level(scaled, directions, beams, Y, share, sunlight, inflow)


def _carried(
    moments: Reals,
    old_stage: Stage,
    old: Level,
    stage: Stage,
    level: Level,
    shone: Shone,
) -> Reals:
    """Take moments to the next stage: finer grid, more directions."""
    found = np.zeros_like(level.sunlight)
    terms = min(len(found), len(moments))
    values = moments[:terms]
    if stage.halvings != old_stage.halvings:
        values = dense(values, old.beams)
        for _ in range(old_stage.halvings - stage.halvings):
            values = doubled(values)
        values = compact(values, level.beams)
    found[:terms] = values
    if stage.directions != old_stage.directions:
        # Light that went straight on with the beam before is scattered light now.
        degree, light = level.directions.degree, shone.light
        before, now = (
            shone.at(d, stage.halvings) for d in (old.directions.degree, degree)
        )
        gone = [b.less(n) for b, n in zip(before, now, strict=True)]
        places = seen(level.scaled)
        found += sun_moments(
            light, gone, level.scaled, places, level.beams, found.dtype, smooth=False
        )
    return found
