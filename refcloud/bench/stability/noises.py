"""Probes of noise: coordinates from small to past every period, octaves, sharpness."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from refcloud import noise
from refcloud.bench.stability.exact import exact, exact_numbers
from refcloud.bench.stability.probe import Axis, DType, Probe
from refcloud.bench.stability.verdict import Found
from refcloud.plain import fbm as plain_fbm
from refcloud.plain import gradient as plain_gradient
from refcloud.plain import noise as plain_noise
from refcloud.plain import simplex as plain_simplex
from refcloud.plain import smooth as plain_smooth
from refcloud.plain import worley as plain_worley

TWIN = "plain twin in exact fractions"
FAR = "simplex's skew, and the octaves' shifts of smooth noise, round far coordinates"
SHIFTED = "each octave's origin is moved, which rounds far coordinates"
PLACES = Axis(
    "coordinate", (1e-300, 0.3, 1e2, 1e4, 1e6, 1e9, 2.0**32, 1e12, 1e15, 1e300)
)
# A place in units of its cell's coordinate, so that axes differ.
SPREAD = (-0.9, 0.731, 0.377, -0.613)
MODULES = (
    plain_noise,
    plain_gradient,
    plain_simplex,
    plain_worley,
    plain_smooth,
    plain_fbm,
)


def against_twin(
    found: Callable[..., Any],
    twin: Callable[..., Any],
    coordinate: float,
    dimensions: int = 3,
    *,
    dtype: DType = "float64",
    **how: Any,
) -> Found:
    """Compare a noise with its plain twin in exact fractions, at one place.

    Parameters
    ----------
    found, twin
        The noise, and its plain form.
    coordinate
        How far from the origin.
    dimensions
        Of the places.
    dtype
        In which the noise computes.
    how
        Further parameters of both.

    Returns
    -------
    The numbers of the cell; errors count against the noise's range, 1.
    """
    point = [coordinate * part for part in SPREAD[:dimensions]]
    values = found(np.array([point]), dtype=dtype, **how)
    return Found(values, [right(twin, tuple(point), **how)], scale=1.0)


@cache
def right(twin: Callable[..., Any], point: tuple[float, ...], **how: Any) -> Any:
    """Give what a plain twin makes of a point in exact fractions."""
    with exact_numbers(*MODULES):
        return twin(exact(point), **how)


def kind(name: str, coordinate: float, dtype: DType) -> Found:
    """Measure one kind of noise at one distance."""
    base, _, axes = name.partition(" ")
    found, twin = KINDS[base]
    return against_twin(found, twin, coordinate, int(axes[0]), dtype=dtype)


KINDS: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "value": (noise.value, plain_noise.value),
    "gradient": (noise.gradient, plain_gradient.gradient),
    "simplex": (noise.simplex, plain_simplex.simplex),
    "worley": (noise.worley, plain_worley.worley),
    "smooth": (noise.smooth, plain_smooth.smooth),
    "worley_smooth": (noise.worley_smooth, plain_smooth.worley_smooth),
}
NAMES = Axis(
    "kind",
    (
        "value 3-D",
        "gradient 2-D",
        "gradient 3-D",
        "simplex 2-D",
        "simplex 3-D",
        "simplex 4-D",
        "worley 2-D",
        "worley 3-D",
        "smooth 3-D",
        "worley_smooth 3-D",
    ),
)
INTERPOLANTS = Axis(
    "interpolant", ("linear", "cosine", "cubic", "hermite", "quintic", "catmull_rom")
)
OCTAVES = Axis("octaves", (1, 4, 16, 32, 33))


def interpolated(name: str, coordinate: float) -> Found:
    """Measure value noise with one interpolant."""
    how = {"interpolant": name, "smooth": False}
    return against_twin(noise.value, plain_noise.value, coordinate, **how)


def summed(octaves: int, persistence: float) -> Found:
    """Measure the paper's fractal sum near the origin."""
    how = {"octaves": octaves, "persistence": persistence, "normalize": "bound"}
    return against_twin(noise.octave_sum, plain_noise.octave_sum, 0.3, **how)


def brownian(octaves: int, coordinate: float) -> Found:
    """Measure fractional Brownian motion far from the origin."""
    return against_twin(noise.fbm, plain_fbm.fbm, coordinate, octaves=octaves)


def carried(span: float, value: float) -> Found:
    """Measure remap from a range of some span, at a part of it."""
    l0, h0 = 0.25, 0.25 + span
    place = l0 + value * span
    ends = [np.array([end]) for end in (l0, h0, 0.0, 1.0)]
    found = noise.remap(np.array([place]), *ends)
    with exact_numbers(plain_smooth):
        part = plain_smooth.remap(*exact([place, l0, h0, 0.0, 1.0]))
    return Found(found, [part], scale=1.0)


PROBES = (
    Probe(
        "noise",
        TWIN,
        NAMES,
        PLACES,
        lambda name, at: kind(name, at, "float64"),
        note=FAR,
    ),
    Probe(
        "noise",
        TWIN,
        NAMES,
        PLACES,
        lambda name, at: kind(name, at, "float32"),
        "float32",
    ),
    Probe(
        "value noise",
        TWIN,
        INTERPOLANTS,
        Axis("coordinate", PLACES.values[1::2]),
        interpolated,
    ),
    Probe(
        "octave_sum",
        TWIN,
        OCTAVES,
        Axis("persistence", (0.0, 1e-300, 0.25, 0.5, 0.9, 1.0, 1.5, -0.5)),
        summed,
    ),
    Probe(
        "fbm, gradient noise", TWIN, OCTAVES, PLACES, brownian, note=SHIFTED, slow=True
    ),
    Probe(
        "remap",
        TWIN,
        Axis("span", (0.0, 1e-300, 1e-16, 1e-12, 1e-6, 1.0, 1e9, 1e290)),
        Axis("part", (0.0, 0.25, 0.5, 1.0, 2.0, 1e9)),
        carried,
    ),
)
