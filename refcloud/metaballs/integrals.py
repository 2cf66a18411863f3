"""Integrals of the kernels as exact numbers, and what follows: k and optical depth."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Annotated, Literal

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape
from refcloud.metaballs.kernels import CUT, Kernel

WYVILL_LINE = Fraction(944, 945)  # integral along a diameter, over R
WYVILL_DISC = Fraction(8, 27)  # over a disc through the centre, over pi R^2
WYVILL_VOLUME = Fraction(736, 2835)  # over the ball, over pi R^3
PAPER_K = Fraction(748, 405)  # eq 12's k over pi R: no integral of the kernel (E02)


@checked
def integral(
    kernel: Kernel,
    dimension: Literal[1, 2, 3],
    *,
    R: Annotated[float, Positive] = 1.0,
) -> float:
    """Integrate a ball's kernel over a diameter, a central disc, or the ball.

    Formula: 944/945 R, 8/27 pi R^2, 736/2835 pi R^3; for the Gaussian with sigma = R/2
    sqrt(pi) sigma erf(2), pi sigma^2 (1 - e^-4),
    pi^1.5 sigma^3 (erf(2) - 4 e^-4 / sqrt(pi))

    Parameters
    ----------
    kernel
        How the density falls.
    dimension
        1 for the diameter, 2 for the disc, 3 for the ball.
    R
        Radius of the ball, scene units.

    Returns
    -------
    The integral, in scene units to the power of the dimension.

    Source: paper M, eq 12 and 15; E02.

    Examples
    --------
    >>> integral("wyvill", 1) == 944 / 945
    True
    """
    sigma, left = 1.0 / CUT, math.exp(-(CUT**2))
    root = math.sqrt(math.pi)
    unit = {
        ("wyvill", 1): float(WYVILL_LINE),
        ("wyvill", 2): float(WYVILL_DISC) * math.pi,
        ("wyvill", 3): float(WYVILL_VOLUME) * math.pi,
        ("gaussian", 1): root * sigma * math.erf(CUT),
        ("gaussian", 2): math.pi * sigma**2 * (1.0 - left),
        ("gaussian", 3): (root * sigma) ** 3 * (math.erf(CUT) - 2 * CUT * left / root),
    }[kernel, dimension]
    return unit * math.prod([R] * dimension)  # R**3 would raise where this overflows


@checked
def normalisation(
    kernel: Kernel,
    normalize: Literal["peak", "volume", "paper"] = "peak",
    *,
    R: Annotated[float, Positive] = 1.0,
) -> float:
    """Give the k that divides a kernel with peak 1.

    Formula: k = 1 (peak), the integral over the ball (volume), 748/405 pi R (paper)

    Parameters
    ----------
    kernel
        How the density falls.
    normalize
        What the divided kernel has: 1 at its centre, 1 as its integral over the ball,
        or the paper's k, which gives neither (E02). Eq 15 has no k: 1 for a Gaussian.
    R
        Radius of the ball, scene units.

    Returns
    -------
    k; the density of paper M is density / k * profile.

    Source: paper M, eq 12; E02, E03.

    Examples
    --------
    >>> round(normalisation("wyvill", "paper", R=405.0) / math.pi, 9)
    748.0
    """
    if normalize == "volume":
        return integral(kernel, 3, R=R)
    if normalize == "paper" and kernel == "wyvill":
        return float(PAPER_K) * math.pi * R
    return 1.0


@checked
def axis_depth(
    sigma_t: Annotated[float, Range(0.0, unit="1/scene unit")],
    densities: Annotated[Array, Shape("N"), Range(0.0)],
    radii: Annotated[Array, Shape("N"), Positive],
    kernel: Kernel = "wyvill",
) -> Array:
    """Give the optical depth of each ball along its axis.

    Formula: tau = sigma_t density R 944/945 (Wyvill)

    Parameters
    ----------
    sigma_t
        Extinction at density 1, per scene unit.
    densities
        Density at the centre, shape (N,).
    radii
        Radius, shape (N,), scene units.
    kernel
        How the density falls.

    Returns
    -------
    tau, shape (N,). Off the axis it is tau * chord(q) / chord(0).

    Source: paper M, section 4.1; E04.

    Examples
    --------
    >>> axis_depth(0.945, [1.0, 2.0], [1.0, 1.0])
    array([0.944, 1.888])
    """
    return sigma_t * densities * radii * integral(kernel, 1)
