"""Light across a voxel grid along every direction: the sweep, as it is meant.

A beam of light goes from slice to slice of the grid. In each voxel it loses what the
voxel absorbs and scatters, gains the voxel's source, and moves on to the next slice,
shifted sideways by as many voxels as its slope says. Along the 26 neighbours of a voxel
that is a whole number, and nothing is interpolated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape
from refcloud.transport.directions import Directions

Shift = Literal["cubic", "linear"]
WHOLE = 1e-9  # voxels: a shift nearer to a whole number than this is that number
THIN = 1e-3  # optical depth below which the mean is a series: 1 - t/2 + t^2/6


@dataclass(frozen=True)
class Step:
    """How a beam goes through a grid ``[z, y, x]``.

    Attributes
    ----------
    axis, sense
        The axis of the array that it steps along, a slice at a time, and +1 or -1.
    side
        How far it moves along the other two axes meanwhile, voxels.
    length
        Of its path within one slice, scene units.
    """

    axis: int
    sense: int
    side: tuple[float, float]
    length: float


def step_of(vector: Array, cell: Array) -> Step:
    """Find how a beam along a unit vector in x, y, z steps through cells of a size."""
    slope = (vector / cell)[::-1]  # voxels per scene unit, in the array's order
    axis = int(np.argmax(np.abs(slope) > (1.0 - WHOLE) * np.abs(slope).max()))
    length = 1.0 / float(abs(slope[axis]))
    side = [float(slope[a]) * length for a in range(3) if a != axis]
    whole = [round(s) if abs(s - round(s)) < WHOLE else s for s in side]
    return Step(axis, 1 if slope[axis] > 0 else -1, (whole[0], whole[1]), length)


def mean_transmittance(tau: Array) -> Array:
    """Average exp(-t) over a path of optical depth tau, whatever its size."""
    thick = np.maximum(tau, THIN)
    series = 1.0 - tau * (0.5 - tau / 6.0)
    return np.where(tau > THIN, -np.expm1(-thick) / thick, series)


def shift_matrix(n: int, offset: float, shift: Shift = "cubic") -> Array:
    """Move n values by a part of their spacing; what comes from outside is 0.

    Row i holds the weights of the values around i - offset: two by distance, or four of
    a Catmull-Rom spline.
    """
    base = int(np.floor(-offset))
    t = -offset - base
    if shift == "linear" or t == 0.0:
        taps = {0: 1.0 - t, 1: t}
    else:
        taps = {
            -1: -0.5 * t * (1.0 - t) ** 2,
            0: 1.0 + t * t * (1.5 * t - 2.5),
            1: t * (0.5 + t * (2.0 - 1.5 * t)),
            2: -0.5 * t * t * (1.0 - t),
        }
    matrix = np.zeros((n, n))
    for tap, weight in taps.items():
        matrix += weight * np.eye(n, k=base + tap)
    return matrix


@checked
def sweep(
    source: Annotated[Array, Shape("N", "D", "H", "W")],
    extinction: Annotated[Array, Shape("D", "H", "W"), Range(0.0)],
    directions: Directions,
    *,
    cell: Annotated[Array, Shape(3), Positive],
    inflow: Annotated[Array, Shape("N"), Range(0.0, unit="radiance")] | None = None,
    shift: Shift = "cubic",
) -> Array:
    """Carry light through a grid along every direction.

    Formula: in a voxel with depth tau = extinction times the path, the mean radiance is
    S + (1 - e^-tau) / tau (I - S), and S + e^-tau (I - S) goes on

    Parameters
    ----------
    source
        S, radiance per optical depth of each direction in each voxel, shape
        (N, D, H, W).
    extinction
        Shape (D, H, W), 1 / scene unit, at least 0.
    directions
        Of `sphere_directions`, N of them.
    cell
        Edges of a voxel in x, y, z, shape (3,), scene units.
    inflow
        Radiance that enters the grid along each direction, shape (N,); None for none.
    shift
        How beams move by parts of a voxel: "cubic" is sharp and may undershoot,
        "linear" blurs and stays positive. Along lattice directions both are exact.

    Returns
    -------
    Mean radiance in each voxel along each direction, shape (N, D, H, W).

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> down = Directions([[0, -1, 0]], [1.0], 0)
    >>> cloud = np.ones((1, 3, 1))
    >>> dark = np.zeros((1, 1, 3, 1))
    >>> sweep(dark, cloud, down, cell=[1, 1, 1], inflow=[1.0]).ravel().round(3)
    array([0.086, 0.233, 0.632])
    """
    radiance = np.empty_like(source)
    outside = np.zeros(len(source)) if inflow is None else inflow
    for n, vector in enumerate(directions.vectors):
        step = step_of(vector, cell)
        # Slices in the order in which light meets them.
        slices, source_of, out = (
            np.moveaxis(v, step.axis, 0)[:: step.sense]
            for v in (extinction, source[n], radiance[n])
        )
        tau = slices * step.length
        fade, mean = np.exp(-tau), mean_transmittance(tau)
        # Outside is dark: the inflow is taken off everywhere, and put back at the end.
        S = source_of - outside[n]
        down, across = (
            shift_matrix(size, side, shift)
            for size, side in zip(tau.shape[1:], step.side, strict=True)
        )
        beam = np.zeros(tau.shape[1:])
        for k in range(len(tau)):
            beam = down @ beam @ across.T
            out[k] = S[k] + mean[k] * (beam - S[k]) + outside[n]
            beam = S[k] + fade[k] * (beam - S[k])
    return radiance
