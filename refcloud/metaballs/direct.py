"""Metaballs straight from the ellipsoids and the noise, without voxels (X09)."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.generate import BY_SHAPE, SIZE, Length, ellipsoid_volumes
from refcloud.cloudmap.quadric import evaluate_quadric, modulate
from refcloud.conventions import Array, Range, Seed, Shape, Skipped
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.integrals import integral
from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.kmeans import lloyd
from refcloud.metaballs.sizes import OVERLAP
from refcloud.metaballs.spread import rms_radii
from refcloud.metaballs.weights import POWER
from refcloud.noise import octave_sum, uniform

# First word of the hash that draws the places.
DRAW = 4
# From one place to the next: powers of 1/r, r^4 = r + 1. Such places keep apart, so
# that sums over them err less than over places that are drawn one by one.
ROOT = 1.2207440846057596
STEPS = np.array([1.0 / ROOT, 1.0 / ROOT**2, 1.0 / ROOT**3])
# Places with cloud wanted for each ball: their mass and spread are means over as many.
SAMPLES, LEAST_SAMPLES = 16, 2000
# Places drawn at a time, and how often at most: a cloud that fills less than 1 part in
# 100 of its box gets fewer balls.
BATCH, MOST_BATCHES = 8, 200
MOST_PLACES = 1 << 22  # with cloud, kept at a time: 134 MB


@checked
def direct_metaballs(
    *,
    seed: Seed = 0,
    count: Annotated[int, Range(1, MOST_PLACES // SAMPLES)] = 1000,
    diameters: Annotated[Array, Shape(3), SIZE] | None = None,
    octaves: Annotated[int, Range(1, 32)] = 4,
    persistence: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 0.5,
    cell: Length | None = None,
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.1,
    dynamics: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 1.0,
    ellipsoids: Annotated[int, Range(1, 1000)] = 1,
    kernel: Kernel = "wyvill",
) -> Metaballs:
    """Make the metaballs of paper M's cloud without a cloud map in between.

    Formula: density D(p) = d Q(p) P(p) where Q P >= t (eq 8 to 10), asked at
    p_n = start + n (1/r, 1/r^2, 1/r^3) modulo the box; a ball for each cluster
    of these, with the cluster's mass

    Parameters
    ----------
    seed
        Chooses the cloud: that of `generate("ellipsoid")` with the same seed.
    count
        Number of balls wanted.
    diameters
        Width, height and depth, scene units. None is 60 34 44.
    octaves
        Z, number of frequencies in the noise.
    persistence
        s, amplitude of each octave against the one before.
    cell
        Edge of the noise's coarsest cell, scene units. None is 16.
    threshold
        t, products below it are empty.
    dynamics
        d, the largest density.
    ellipsoids
        How many ellipsoid volumes are united.
    kernel
        How a ball's density falls.

    Returns
    -------
    The balls; as skipped those for which there was no cloud.

    Source: paper M, section 5 (X09: balls generated directly); eq 8 to 11.

    Examples
    --------
    >>> len(direct_metaballs(count=20, diameters=[20, 11, 11], cell=6))
    20
    """
    size, _, own_cell = BY_SHAPE["ellipsoid"]
    diameters = np.array(size) if diameters is None else diameters
    cell = own_cell if cell is None else cell
    quadrics, lower, upper = ellipsoid_volumes(diameters, ellipsoids, seed)
    # 1. Draw places until enough of them have cloud.
    start = uniform(DRAW, np.arange(3), seed=seed)
    places: list[Array] = []
    found: list[Array] = []
    drawn = kept = 0
    wanted = max(SAMPLES * count, LEAST_SAMPLES)
    batch = BATCH * wanted // SAMPLES
    while kept < wanted and drawn < MOST_BATCHES * batch:
        numbers = drawn + np.arange(batch)
        drawn += len(numbers)
        shares = (start + numbers[:, np.newaxis] * STEPS) % 1.0
        points = lower + shares * (upper - lower)
        Q = evaluate_quadric(quadrics[0], points)
        for q in quadrics[1:]:
            np.maximum(Q, evaluate_quadric(q, points), out=Q)
        # The noise is at most 1, so that Q below the threshold needs none.
        inside = Q >= max(threshold, np.finfo(float).tiny)
        points, Q = points[inside], Q[inside]
        noise = octave_sum(
            points / cell, seed=seed, octaves=octaves, persistence=persistence
        )
        density = modulate(
            np.minimum(Q, 1.0), noise, threshold=threshold, dynamics=dynamics
        )
        there = density > 0.0
        places.append(points[there])
        found.append(density[there])
        kept += int(there.sum())
    # 2. A ball for each cluster of places, as phases 1 and 2 do with voxels.
    points, density = np.concatenate(places), np.concatenate(found)
    clusters = lloyd(points, (density / dynamics) ** POWER, count, seed=seed)
    volume = float(np.prod((upper - lower) / drawn ** (1.0 / 3.0)))  # of one place
    radii = OVERLAP * rms_radii(
        points,
        clusters.assignment,
        centers=clusters.centers,
        spacing=volume ** (1.0 / 3.0),
        weights=density,
    )
    # 3. Each ball has the mass of its cluster.
    shares = np.bincount(clusters.assignment, density, minlength=len(radii))
    heights = shares * volume / (integral(kernel, 3) * radii**3)
    missing = count - len(radii)
    row = Skipped("direct", "balls without cloud of their own", missing, count)
    return Metaballs(
        clusters.centers, radii, heights, kernel, (row,) if missing else ()
    )
