"""Figures of the errata in light: phase functions, extinction, gain."""

from __future__ import annotations

import math

import numpy as np
from errata_sheet import (
    Draw,
    Figure,
    frame,
    name,
    plots,
)

from refcloud.drawing import BLUE, RED, curve
from refcloud.optics import (
    beer_lambert,
    coupling_man2003,
    henyey_greenstein,
    largest_steady_tau,
    rayleigh,
    rayleigh_man2003,
    scattered_man2003,
)

WHOLE_SPHERE = 4.0 * math.pi


NODES, WEIGHTS = np.polynomial.legendre.leggauss(64)


def e20() -> Figure:
    """Integrate the phase functions over the sphere."""
    mean = float(WEIGHTS @ rayleigh_man2003(NODES)) / 2.0
    whole = 2.0 * math.pi * float(WEIGHTS @ rayleigh(NODES))
    lobe = 2.0 * math.pi * float(WEIGHTS @ henyey_greenstein(NODES, 0.6))
    once = 8.0 * coupling_man2003()
    return Figure(
        f"Mean of eq 25 over the sphere {mean:.6g}; integrals of `rayleigh` {whole:.6g}"
        f" and of `henyey_greenstein` {lobe:.6g}. With a = 0.9, tau = 8 and p = 1.5 a"
        f" ball hands on {once:.3f} of its light; divided twice it would be"
        f" {once / WHOLE_SPHERE:.3f}."
    )


def e21() -> Figure:
    """Draw eq 25 and another phase function over the angle."""
    degrees = np.linspace(0.0, 180.0, 181)
    cosine = np.cos(np.radians(degrees))
    canvas, cells = plots(1)
    frame_ = frame(
        canvas, cells[0], (0, 180), (-1.5, 1.5), ((0, 45, 90, 135), (-1, 0, 1)),
        "log10 of 4 pi p", "angle, degrees; 0 is forward",
    )  # fmt: skip
    lobe = WHOLE_SPHERE * henyey_greenstein(cosine, 0.6)
    curve(frame_, degrees, np.log10(rayleigh_man2003(cosine)), BLUE, 3.0)
    curve(frame_, degrees, np.log10(lobe), RED, 3.0)
    name(frame_, 20, 0.85, "Henyey-Greenstein, g = 0.6", RED)
    name(frame_, 100, 0.35, "eq 25", BLUE)
    ends = rayleigh_man2003([1.0, -1.0])
    return Figure(
        f"At 0 and 180 degrees eq 25 has {ends[0]:g} and {ends[1]:g};"
        f" Henyey-Greenstein with g = 0.6 has {lobe[0]:.3g} and {lobe[-1]:.3g}.",
        canvas,
    )


def e22() -> Figure:
    """Compare the constants of the two sources."""
    man = 8.0 * coupling_man2003()
    sky = 80.0 * coupling_man2003(0.9, 1.0, solid_angle=0.09)
    return Figure(
        f"Share handed on: the paper, tau = 8 and 1 steradian, {man:.3f}; SkyWorks,"
        f" extinction 80 and 0.09 steradian, {sky:.3f} as stored and {1.5 * sky:.3f}"
        f" with the phase function's 1.5. 80 x 0.09 = {80 * 0.09:g}."
    )


def e23() -> Figure:
    """Draw the gain of a ball over its depth, and of a row of balls."""
    kappa = coupling_man2003()
    limit = largest_steady_tau(kappa)
    tau = np.linspace(0.0, 16.0, 161)
    through = beer_lambert(tau)
    printed, held = kappa * tau + through, scattered_man2003(tau, kappa) + through
    canvas, cells = plots(2)
    gain = frame(
        canvas, cells[0], (0, 16), (0, 1.8), ((0, 8, 16), (0, 0.5, 1, 1.5)),
        "g / I + T of a ball", "tau",
    )  # fmt: skip
    curve(gain, tau, printed, RED, 3.0)
    curve(gain, tau, held, BLUE, 3.0)
    count = np.arange(0, 31)
    row = frame(
        canvas, cells[1], (0, 30), (-1, 4), ((0, 15, 30), (0, 2, 4)),
        "log10, balls of tau 12", "balls in a row",
    )  # fmt: skip
    one = kappa * 12.0 + math.exp(-12.0)
    kept = float(scattered_man2003([12.0], kappa)[0]) + math.exp(-12.0)
    curve(row, count, count * math.log10(one), RED, 3.0)
    curve(row, count, count * math.log10(kept), BLUE, 3.0)
    return Figure(
        f"The gain passes 1 at tau = {limit:.4g}. With tau = 12 it is {one:.3f}, after"
        f" 30 balls {one**30:.0f}; held (blue) {kept:.6g}.",
        canvas,
    )


def e24() -> Figure:
    """Draw what either sign lets through."""
    tau = np.linspace(0.0, 3.0, 121)
    canvas, cells = plots(1)
    axes_ = frame(
        canvas, cells[0], (0, 3), (0, 3), ((0, 1, 2, 3), (0, 1, 2, 3)),
        "share of light behind a depth of tau", "tau",
    )  # fmt: skip
    rising = np.exp(tau)
    curve(axes_, tau[rising <= 3.0], rising[rising <= 3.0], RED, 3.0)
    curve(axes_, tau, beer_lambert(tau), BLUE, 3.0)
    name(axes_, 1.1, 2.4, "e^tau", RED)
    name(axes_, 1.2, 0.7, "e^-tau", BLUE)
    return Figure(
        f"tau = 8, the paper's: e^-tau = {float(beer_lambert([8.0])[0]):.3e}, e^tau ="
        f" {math.exp(8.0):.0f}.",
        canvas,
    )


def e36() -> Figure:
    """Draw the peak in single precision, by the usual form over refcloud's."""
    power = np.linspace(0.0, 4.5, 181)
    shares = []
    for g in (1.0 - 10.0 ** -power[1:]).tolist():
        small = np.float32(g)
        base = np.float32(1.0) + small * small - np.float32(2.0) * small
        peak = (1.0 - float(small) ** 2) / WHOLE_SPHERE
        right = float(henyey_greenstein([1.0], float(small))[0])
        # Where the sum is 0 the usual form has no value; it is drawn at the top.
        shares.append(2.0 if base <= 0 else peak / float(base) ** 1.5 / right)
    canvas, cells = plots(1)
    axes_ = frame(
        canvas, cells[0], (0, 4.5), (0, 2), ((0, 1, 2, 3, 4), (0, 1, 2)),
        "float32 peak, usual form over exact", "-log10(1 - g)",
    )  # fmt: skip
    curve(axes_, power[1:], shares, RED, 2.0)
    curve(axes_, [0, 4.5], [1, 1], BLUE, 2.0)
    mu = np.linspace(-1.0, 1.0, 200_001)
    step = mu[1] - mu[0]
    values = 2.0 * math.pi * henyey_greenstein(mu, 0.999)
    even = step * float(values.sum() - 0.5 * (values[0] + values[-1]))
    g = np.float32(0.999)
    base = np.float32(1.0) + g * g - np.float32(2.0) * g
    usual = (1.0 - 0.999**2) / (WHOLE_SPHERE * float(base) ** 1.5)
    exact = float(henyey_greenstein([1.0], 0.999)[0])
    return Figure(
        f"At g = 0.999 the usual form has {usual / exact:.2f} of the peak; farther"
        " right, where it is drawn at the top, it divides by a sum that has become 0."
        f" A sum over 200,001 even steps of the cosine gives {even:.2f} instead of 1.",
        canvas,
    )


FIGURES: dict[str, Draw] = {
    "E20": e20,
    "E21": e21,
    "E22": e22,
    "E23": e23,
    "E24": e24,
    "E36": e36,
}
