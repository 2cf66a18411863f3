"""Phase functions and extinction, one number at a time.

Each function is the twin of the one of the same name in `refcloud.optics`.
"""

from __future__ import annotations

import math

from refcloud.conventions import WHOLE_SPHERE


def isotropic(cos_theta: float) -> float:
    """Scatter the same into every direction."""
    return 1.0 / WHOLE_SPHERE


def rayleigh_man2003(cos_theta: float) -> float:
    """Give Rayleigh's phase function with mean 1 (eq 25)."""
    return 3.0 / 4.0 * (1.0 + cos_theta**2)


def rayleigh(cos_theta: float) -> float:
    """Give Rayleigh's phase function with integral 1 (E20)."""
    return 3.0 / (16.0 * math.pi) * (1.0 + cos_theta**2)


def henyey_greenstein(cos_theta: float, g: float) -> float:
    """Scatter with mean cosine g: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).

    The base of the power is written as (1 - g)^2 + 2 g (1 - cos), two terms that are
    never negative, since 1 + g^2 and 2 g cos cancel near g = 1 (E36).
    """
    if g < 0.0:
        return henyey_greenstein(-cos_theta, -g)
    spread = (1.0 - g) ** 2 + 2.0 * g * (1.0 - cos_theta)
    return (1.0 - g) * (1.0 + g) / (WHOLE_SPHERE * spread**1.5)


def phase(name: str, g: float, cos_theta: float) -> float:
    """Evaluate a medium's phase function."""
    if name == "hg":
        return henyey_greenstein(cos_theta, g)
    return rayleigh(cos_theta) if name == "rayleigh" else isotropic(cos_theta)


def beer_lambert(tau: float) -> float:
    """Give the share of light that passes (eq 27, E24)."""
    return math.exp(-tau)


def coupling_man2003(
    albedo: float = 0.9, p: float = 1.5, *, solid_angle: float = 1.0
) -> float:
    """Give kappa of g = kappa tau I (eq 26, E22)."""
    return albedo * p * solid_angle / WHOLE_SPHERE


def largest_steady_tau(kappa: float) -> float:
    """Find where kappa tau + exp(-tau) = 1 again, by Newton's steps (E23).

    The sum is convex and above 1 at 1 / kappa: from there each step stays on the
    right of the answer, until rounding ends the way down.
    """
    if kappa >= 1.0:
        return 0.0
    tau = math.inf if kappa == 0.0 else 1.0 / kappa
    while math.isfinite(tau):
        step = (kappa * tau + math.expm1(-tau)) / (kappa - math.exp(-tau))
        if not 0.0 < step < tau:
            return tau
        tau -= step
    return tau


def scattered_man2003(tau: float, kappa: float, *, gain: str = "hold") -> float:
    """Give g / I of eq 26, held where g + T would pass 1 (E23)."""
    if gain == "refuse" and tau > largest_steady_tau(kappa):
        raise ValueError("tau: eq 26 and 27 would make light")
    return min(kappa * tau, -math.expm1(-tau))


def scattered_split(tau: float, forward: float) -> float:
    """Give the share scattered on that splitting a ball does not change."""
    return math.exp(-(1.0 - forward) * tau) - math.exp(-tau)
