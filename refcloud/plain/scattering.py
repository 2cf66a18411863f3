"""Directions, harmonics and scaled phase functions, one number at a time.

Each function is the twin of the one of the same name in `refcloud.transport`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.conventions import WHOLE_SPHERE

Point = Sequence[float]
Medium = tuple[float, float, float, str]  # sigma_t, albedo, g, phase


def unit(vector: Point) -> tuple[float, ...]:
    """Scale a vector to length 1."""
    length = math.sqrt(sum(v * v for v in vector))
    return tuple(v / length for v in vector)


def sphere_directions(count: int) -> list[tuple[tuple[float, ...], float]]:
    """List directions in x, y, z, and the solid angle of each."""
    if count == 128:
        return product_directions()
    share = {26: (0, 1 / 21, 4 / 105, 9 / 280), 50: (0, 4 / 315, 64 / 2835, 27 / 1280)}
    found = []
    steps = (-1, 0, 1)
    for d in ((x, y, z) for z in steps for y in steps for x in steps):
        axes = sum(map(abs, d))
        if axes:
            found.append((unit(d), WHOLE_SPHERE * share[count][axes]))
    if count == 50:
        signs = (-1, 1)
        for place in (2, 1, 0):
            for d in ((x, y, z) for z in signs for y in signs for x in signs):
                longer = [3 * v if a == place else v for a, v in enumerate(d)]
                found.append((unit(longer), WHOLE_SPHERE * 14641 / 725760))
    return found


def product_directions() -> list[tuple[tuple[float, ...], float]]:
    """List 8 heights, the zeros of P_8, times 16 azimuths."""
    found = []
    for k in range(8, 0, -1):
        y = math.cos(math.pi * (k - 0.25) / 8.5)
        slope = 1.0
        for _ in range(50):  # Newton's steps
            slope = 8 * (y * legendre(8, y) - legendre(7, y)) / (y * y - 1.0)
            y -= legendre(8, y) / slope
        weight = 2.0 / ((1.0 - y * y) * slope * slope) * math.tau / 16
        level = math.sqrt(1.0 - y * y)
        for i in range(16):
            turn = (i + 0.5) * math.tau / 16
            at = (level * math.cos(turn), y, level * math.sin(turn))
            found.append((at, weight))
    return found


def legendre(degree: int, c: float) -> float:
    """Evaluate a Legendre polynomial by its recurrence."""
    before, now = 0.0, 1.0
    for l in range(1, degree + 1):
        before, now = now, ((2 * l - 1) * c * now - (l - 1) * before) / l
    return now


def associated(l: int, m: int, c: float, s: float) -> float:
    """Evaluate P_l^m(c), s = sqrt(1 - c^2), without Condon's and Shortley's sign."""
    before, now = 0.0, math.prod(range(1, 2 * m, 2)) * s**m
    for k in range(m + 1, l + 1):
        before, now = now, ((2 * k - 1) * c * now - (k + m - 1) * before) / (k - m)
    return now


def harmonics(vector: Point, degree: int) -> list[float]:
    """Evaluate real spherical harmonics: N_lm P_l^|m|(cos theta) cos or sin m phi."""
    x, y, z = vector
    phi, sine = math.atan2(y, x), math.hypot(x, y)
    found = []
    for l in range(degree + 1):
        for m in range(-l, l + 1):
            n = abs(m)
            ratio = math.factorial(l - n) / math.factorial(l + n)
            norm = math.sqrt((2 * l + 1) / WHOLE_SPHERE * ratio)
            wave = math.sin(n * phi) if m < 0 else math.cos(n * phi)
            both = math.sqrt(2.0) if m else 1.0
            found.append(both * norm * associated(l, n, z, sine) * wave)
    return found


def legendre_moments(name: str, g: float, degree: int) -> list[float]:
    """Give the mean of each Legendre polynomial over a phase function."""
    if name == "hg":
        return [g**l for l in range(degree + 1)]
    second = 0.1 if name == "rayleigh" else 0.0
    return [{0: 1.0, 2: second}.get(l, 0.0) for l in range(degree + 1)]


def delta_m(
    medium: Medium, degree: int
) -> tuple[float, float, list[float], float, float]:
    """Scale a medium: sigma', a', chi'_l, f and b."""
    sigma_t, albedo, g, name = medium
    *moments, next_moment = legendre_moments(name, g, degree + 1)
    f = next_moment if name == "hg" and g > 0.0 else 0.0
    return (
        sigma_t * (1.0 - albedo * f),
        albedo * (1.0 - f) / (1.0 - albedo * f),
        [(chi - f) / (1.0 - f) for chi in moments],
        f,
        abs(next_moment) if name == "hg" and g < 0.0 else 0.0,
    )


def smooth_phase(moments: Sequence[float], cos_theta: float) -> float:
    """Sum a phase function's Legendre series."""
    terms = (
        (2 * l + 1) * chi * legendre(l, cos_theta) for l, chi in enumerate(moments)
    )
    return sum(terms) / WHOLE_SPHERE


def beer_powder(tau: float) -> float:
    """Dim sunlight as games do: 2 e^-tau (1 - e^-2tau)."""
    return 2.0 * math.exp(-tau) * (1.0 - math.exp(-2.0 * tau))


def forward_depth(tau: float, kappa: float) -> float:
    """Give the depth that a voxel seems to have where it hands light on (eq 27)."""
    passed = math.exp(-tau) + min(kappa * tau, -math.expm1(-tau))
    return -math.log(min(passed, 1.0))
