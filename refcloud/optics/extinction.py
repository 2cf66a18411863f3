"""Extinction, and the light that a ball hands on to the next (paper M, eq 26 and 27).

Two forms of the light handed on: the paper's product kappa tau, guarded where it would
make light, and a form that does not change when a ball is split into thinner ones.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import WHOLE_SPHERE, Array, Range
from refcloud.optics.media import Share

ALBEDO_MAN2003 = 0.9  # eq 26's a
TAU_MAN2003 = 8.0  # eq 26's optical depth of every ball
PHASE_MAN2003 = 1.5  # pass 1 uses eq 25 at 180 degrees; 0 degrees gives the same (E21)


@checked
def beer_lambert(tau: Annotated[Array, Range(0.0)]) -> Array:
    """Give the share of light that passes an optical depth.

    Formula: T = exp(-tau)

    Parameters
    ----------
    tau
        Optical depth, any shape, at least 0.

    Returns
    -------
    Transmittance, the same shape, in [0, 1].

    Source: paper M, eq 27; E24.

    Examples
    --------
    >>> beer_lambert([0.0, np.log(2.0)])
    array([1. , 0.5])
    """
    return np.exp(-np.asarray(tau))


@checked
def coupling_man2003(
    albedo: Share = ALBEDO_MAN2003,
    p: Annotated[float, Range(0.0)] = PHASE_MAN2003,
    *,
    solid_angle: Annotated[float, Range(0.0, WHOLE_SPHERE, "sr")] = 1.0,
) -> float:
    """Give the share of the light that eq 26 hands on per unit of optical depth.

    Formula: kappa = albedo p Omega / (4 pi), so that g = kappa tau I

    Parameters
    ----------
    albedo
        The paper's a, in [0, 1].
    p
        Phase function with mean 1 (eq 25).
    solid_angle
        Omega, from which light is gathered; the paper leaves it out, that is 1 sr.

    Returns
    -------
    kappa, per unit of optical depth.

    Source: paper M, eq 26; E22.

    Examples
    --------
    >>> round(coupling_man2003(), 4)
    0.1074
    """
    return albedo * p * solid_angle / WHOLE_SPHERE


@checked
def largest_steady_tau(kappa: Annotated[float, Range(0.0)]) -> float:
    """Find the optical depth beyond which eq 26 and 27 make light.

    Formula: the tau > 0 at which kappa tau + exp(-tau) = 1; 0 if kappa >= 1,
    infinity if kappa = 0

    Parameters
    ----------
    kappa
        The coupling, at least 0.

    Returns
    -------
    tau, at least 0.

    Source: paper M, eq 26 and 27; E23.

    Examples
    --------
    >>> round(largest_steady_tau(coupling_man2003()), 3)
    9.308
    """
    if kappa >= 1.0:
        return 0.0
    high = math.inf if kappa == 0.0 else 1.0 / kappa
    if high == math.inf:
        return high
    # g + T - 1 is convex, 0 at 0, lowest at -ln kappa, and at least 0 at 1 / kappa.
    low = -math.log(kappa)
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return low
        if kappa * middle + math.expm1(-middle) < 0.0:
            low = middle
        else:
            high = middle


@checked
def scattered_man2003(
    tau: Annotated[Array, Range(0.0)],
    kappa: Annotated[float, Range(0.0, 1.0)],
    *,
    gain: Literal["hold", "refuse"] = "hold",
) -> Array:
    """Give the share of the light at a ball that it scatters on, as the paper has it.

    Formula: g / I = min(kappa tau, 1 - exp(-tau)); the minimum is the guard and equals
    the paper's kappa tau up to `largest_steady_tau`

    Parameters
    ----------
    tau
        Optical depth of the ball, any shape, at least 0.
    kappa
        The coupling of `coupling_man2003`, in [0, 1].
    gain
        Beyond the steady range: "hold" g + T at 1, or "refuse" the call.

    Returns
    -------
    The same shape, in [0, 1].

    Raises
    ------
    ValueError
        With gain="refuse", where g + T would pass 1.

    Source: paper M, eq 26; E22, E23.

    Examples
    --------
    >>> scattered_man2003([8.0, 1e9], coupling_man2003()).round(4)
    array([0.8594, 1.    ])
    """
    tau = np.asarray(tau)
    limit = largest_steady_tau(kappa)
    if gain == "refuse" and tau.size and float(tau.max()) > limit:
        raise ValueError(
            f"tau: expected at most {limit:.4g}, where eq 26 and 27 stop making light,"
            f' got {float(tau.max()):.4g}; lower tau or albedo, or say gain="hold"'
        )
    return held_share(tau, kappa, limit)


def held_share(tau: Array, kappa: float, limit: float) -> Array:
    """Hold g + T at 1 beyond the limit, unchecked: inner form of `scattered_man2003`.

    Parameters
    ----------
    tau, kappa
        As `scattered_man2003`.
    limit
        Of `largest_steady_tau`.

    Returns
    -------
    The same shape as tau.
    """
    # Past limit + 1 the second term is the smaller one: no product can overflow.
    if tau.size and float(tau.max()) <= limit:
        return kappa * tau
    most = min(limit + 1.0, float(np.finfo(tau.dtype).max))  # float32 ends at 3e38
    return np.minimum(kappa * np.minimum(tau, most), -np.expm1(-tau))


@checked
def scattered_split(
    tau: Annotated[Array, Range(0.0)], forward: Annotated[float, Range(0.0, 1.0)]
) -> Array:
    """Give the share scattered on, in the form that splitting a ball does not change.

    Formula: exp(-(1 - k) tau) - exp(-tau); with T added it is exp(-(1 - k) tau), so two
    balls of half the depth hand on what one does

    Parameters
    ----------
    tau
        Optical depth, any shape, at least 0.
    forward
        k, the share of the scattered light that goes on forward, in [0, 1].

    Returns
    -------
    The same shape, in [0, 1].

    Source: an extension of paper M, eq 26 and 27; E22, E23.

    Examples
    --------
    >>> scattered_split([0.0], 0.7)
    array([0.])
    """
    return split_share(np.asarray(tau), forward)


def split_share(tau: Array, forward: float) -> Array:
    """Give the share scattered on, unchecked: the inner form of `scattered_split`.

    Parameters
    ----------
    tau, forward
        As `scattered_split`.

    Returns
    -------
    The same shape as tau.
    """
    # The difference of the two exponentials, written so that nothing cancels.
    return np.exp(-(1.0 - forward) * tau) * -np.expm1(-forward * tau)
