"""Probes of light and matter: phase functions, extinction, kernels, tone."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud import image, march, metaballs, optics, raster
from refcloud.bench.stability.exact import MATH, exact, exact_numbers
from refcloud.bench.stability.probe import Axis, Probe
from refcloud.bench.stability.verdict import Found
from refcloud.plain import image as plain_image
from refcloud.plain import march as plain_march
from refcloud.plain import metaballs as plain_metaballs
from refcloud.plain import optics as plain_optics
from refcloud.plain import raster as plain_raster

TWIN = "plain twin in 60 digits"
NEAR_1 = (0.0, 0.5, 0.9, 0.999, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12)
DEPTHS = Axis(
    "tau",
    (
        0.0,
        1e-300,
        1e-16,
        1e-9,
        1e-3,
        1.0,
        10.0,
        100.0,
        700.0,
        1e4,
        1e37,
        1e300,
        math.inf,
        -1.0,
    ),
)


def lobe(g: float, versed: float) -> Found:
    """Measure Henyey-Greenstein at 1 - cos_theta."""
    cos_theta = 1.0 - versed
    found = optics.henyey_greenstein(np.array([cos_theta]), g)
    with exact_numbers(plain_optics):
        right = plain_optics.henyey_greenstein(*exact([cos_theta, g]))
    return Found(found, [right])


# Each takes tau and gives what the package finds, and what is right.
EXTINCTION: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "T": (optics.beer_lambert, plain_optics.beer_lambert),
    "1 - T": (march.segment_share, lambda tau: plain_march.segment_share(tau, "beer")),
    "split, k .7": (
        lambda tau: optics.scattered_split(tau, 0.7),
        lambda tau: split(tau, 0.7),
    ),
    "split, k 1e-12": (
        lambda tau: optics.scattered_split(tau, 1e-12),
        lambda tau: split(tau, 1e-12),
    ),
    "eq 26": (
        lambda tau: optics.scattered_man2003(tau, 0.1),
        lambda tau: plain_optics.scattered_man2003(tau, exact(0.1)),
    ),
    "splat, beer": (
        lambda tau: raster.transmittance(np.full(1, 0.3), float(tau[0])),
        lambda tau: plain_raster.transmittance(exact(0.3), tau),
    ),
    "splat, linear": (
        lambda tau: raster.transmittance(np.full(1, 0.3), float(tau[0]), law="linear"),
        lambda tau: plain_raster.transmittance(exact(0.3), tau, "linear"),
    ),
}


def split(tau: Any, forward: float) -> Any:
    """Give the light that a split ball hands on, without cancelling."""
    k = exact(forward)
    return MATH.exp(-(1 - k) * tau) * -MATH.expm1(-k * tau)


def extinction(name: str, tau: float) -> Found:
    """Measure one form of extinction."""
    found, twin = EXTINCTION[name]
    values = found(np.array([tau]))
    with exact_numbers(plain_optics, plain_march, plain_raster):
        return Found(values, [twin(exact(tau))])


def steady(_: str, kappa: float) -> Found:
    """Measure where eq 26 begins to make light, by what is left of its equation."""
    tau = optics.largest_steady_tau(kappa)
    if not 0.0 < tau < math.inf:
        return Found([tau], [0.0 if kappa >= 1.0 else math.inf])
    left = exact(kappa) * exact(tau) + MATH.expm1(-exact(tau))
    slope = exact(kappa) - MATH.exp(-exact(tau))
    return Found([tau], [exact(tau) - left / slope])


KERNELS: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    f"{what.__name__}, {kernel}": (
        lambda q, what=what, kernel=kernel: what(q, kernel),
        lambda q, twin=twin, kernel=kernel: twin(q, kernel),
    )
    for what, twin in (
        (metaballs.profile, plain_metaballs.profile),
        (metaballs.chord, plain_metaballs.chord),
    )
    for kernel in ("wyvill", "gaussian")
}


def kernel(name: str, q: float) -> Found:
    """Measure one kernel, or its chord, at q = (r / R)^2."""
    found, twin = KERNELS[name]
    values = found(np.array([q]))
    with exact_numbers(plain_metaballs):
        # A profile is 0 at its edge, in sums of terms near 1: only its peak is a scale.
        scale = 1.0 if name.startswith("profile") else 0.0
        return Found(values, [twin(exact(q))], scale=scale)


TONES: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "srgb_encode": (image.srgb_encode, plain_image.srgb_encode),
    "srgb_decode": (image.srgb_decode, plain_image.srgb_decode),
    "tone_shoulder": (image.tone_shoulder, plain_image.tone_shoulder),
}


def tone(name: str, linear: float) -> Found:
    """Measure a curve of the picture's output."""
    found, twin = TONES[name]
    values = found(np.array([linear]))
    with exact_numbers(plain_image):
        return Found(values, [twin(exact(linear))])


PROBES = (
    Probe(
        "henyey_greenstein",
        TWIN,
        Axis("g", (*(-g for g in reversed(NEAR_1[1:])), *NEAR_1, 1.0)),
        Axis("1 - cos_theta", (0.0, 1e-15, 1e-9, 1e-3, 0.5, 1.0, 1.5, 2.0, 2.1)),
        lobe,
    ),
    Probe("extinction", TWIN, Axis("form", tuple(EXTINCTION)), DEPTHS, extinction),
    Probe(
        "largest_steady_tau",
        "a Newton step in 60 digits",
        Axis("", ("tau",)),
        Axis(
            "kappa",
            (0.0, 1e-300, 1e-12, 1e-3, 0.1, 0.5, 0.9, 1 - 1e-6, 1 - 1e-12, 1.0, 2.0),
        ),
        steady,
        note="near kappa 1 the answer is the small difference of two numbers near it",
    ),
    Probe(
        "kernels and chords",
        TWIN,
        Axis("kernel", tuple(KERNELS)),
        Axis(
            "q",
            (
                0.0,
                1e-300,
                1e-9,
                0.1,
                0.5,
                0.9,
                1 - 1e-6,
                1 - 1e-12,
                1.0,
                1.1,
                1e300,
                -1.0,
            ),
        ),
        kernel,
    ),
    Probe(
        "tone and sRGB",
        TWIN,
        Axis("curve", tuple(TONES)),
        Axis(
            "linear",
            (0.0, 1e-300, 1e-9, 0.003, 0.0031308, 0.1, 0.7, 1.0, 10.0, 1e300),
        ),
        tone,
    ),
)
