"""Savings where clouds are made: octaves of noise, and balls that stand for little."""

from __future__ import annotations

import dataclasses
import importlib
from typing import Any

import numpy as np

from refcloud.cloudmap import VoxelGrid
from refcloud.cloudmap.billows import lumps_grid
from refcloud.lighting import detail_grid
from refcloud.metaballs import Metaballs, approximate, direct_metaballs, field, prune
from refcloud.metaballs.approximate import as_balls, prepare, skipped_of
from refcloud.metaballs.refine import Fit
from refcloud.noise import fbm_grid, octave_sum_grid, uniform
from skipping import Found, proof, replaced

LINE = np.linspace(0.0, 3.0, 9)
PLACES = 4.0 * uniform(np.arange(600), seed=4).reshape(-1, 3) - 0.5
FINE = "octaves too fine to show"


def with_and_without(grid: Any, finest: Any, **how: Any) -> Found:
    """Sum octaves up to the finest cell, and all of them."""
    (found, rows), (whole, none) = (
        grid(LINE, LINE, LINE, seed=3, finest=f, **how) for f in finest
    )
    assert not none
    return Found(found, whole, rows)


@proof("noise", FINE)
def octaves_of_value_noise() -> Found:
    return with_and_without(octave_sum_grid, (0.5, None), octaves=4)


@proof("noise", FINE)
def octaves_of_every_kind() -> Found:
    how = {"octaves": 4, "kind": "gradient", "normalize": "none"}
    return with_and_without(fbm_grid, (0.5, None), **how)


@proof("noise", FINE)
def octaves_of_lumps() -> Found:
    return with_and_without(lumps_grid, (0.6, 0.0))


@proof("erosion", FINE)
def octaves_of_erosion() -> Found:
    module = importlib.import_module("refcloud.lighting.erosion")
    real = module.octave_sum_grid

    def every(*axes, **how):
        return real(*axes, **(how | {"finest": None}))

    how = {"cell": 1.0, "pixel": 0.6}
    found = detail_grid([0, 0, 0], [5, 5, 5], **how)
    with replaced(module.__name__, octave_sum_grid=every):
        whole = detail_grid([0, 0, 0], [5, 5, 5], **how)
    return Found(found.density, whole.density, found.skipped)


@proof("prune", "balls that float alone", rounding=1e-15)  # another order of the sum
def balls_that_float_alone() -> Found:
    spots = [[x, y, 0.0] for x in range(3) for y in range(3)]
    spots += [[3.4, 3.0, 2.9], [3.4, 3.4, 3.4]]
    radii = np.append(np.full(9, 1.5), [0.4, 0.5])
    balls = Metaballs(spots, radii, uniform(np.arange(11), seed=1))
    kept = prune(balls)
    places = np.vstack([PLACES, balls.centers])
    return Found(field(kept, places), field(balls, places), kept.skipped)


@proof("approximate", "balls without a voxel of their own")
def balls_without_a_voxel() -> Found:
    """As many balls as there are voxels are all that a cloud can have."""
    grid = VoxelGrid(uniform(np.arange(27), seed=1).reshape(3, 3, 3), [0] * 3, [3] * 3)
    found, whole = (approximate(grid, count=n, method="quick") for n in (40, 27))
    return Found(field(found, PLACES), field(whole, PLACES), found.skipped)


@proof("approximate", "balls of no density")
def balls_of_no_density() -> Found:
    """Balls below 0 make holes; without them the field is higher by their sum."""
    grid = VoxelGrid(np.ones((4, 4, 4)), [0] * 3, [4] * 3)
    work = prepare(grid)
    assert work is not None
    heights = np.array([1.0, -0.3, 0.5, 0.0, -0.2])
    centers = 4.0 * uniform(np.arange(15), seed=2).reshape(-1, 3)
    fit = Fit(centers, np.full(5, 2.0), heights)
    rows = skipped_of(work, fit, 5)
    kept = as_balls(work, fit, "wyvill", rows)
    below = dataclasses.replace(fit, heights=np.maximum(-heights, 0.0))
    holes = as_balls(work, below, "wyvill", ())
    found = field(kept, PLACES)
    return Found(found, found - field(holes, PLACES), rows)


@proof("direct", "balls without cloud of their own")
def balls_without_cloud() -> Found:
    """A cloud of few places has a ball for each: asking for these is the same."""
    how = {"diameters": [4, 4, 4], "cell": 2.0, "seed": 3, "threshold": 0.42}
    found = direct_metaballs(count=125, **how)  # as many places are drawn for fewer
    whole = direct_metaballs(count=len(found), **how)
    places = found.centers
    return Found(field(found, places), field(whole, places), found.skipped)
