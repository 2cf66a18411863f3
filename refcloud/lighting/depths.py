"""Optical depths: of each ball, and through the middle of a cloud."""

from __future__ import annotations

import math

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.look import Look
from refcloud.metaballs import Metaballs, axis_depth
from refcloud.raster.footprint import footprint_of


def ball_depths(balls: Metaballs, sigma_t: float, look: Look) -> Array:
    """Give each ball's optical depth on its axis, unchecked.

    Parameters
    ----------
    balls
        The cloud.
    sigma_t
        Extinction at density 1, 1 / scene unit.
    look
        Its `tau`, where given, stands for every ball (the paper's figures).

    Returns
    -------
    Shape (N,).
    """
    if look.tau is not None:
        return np.full(len(balls.radii), look.tau)
    return axis_depth(sigma_t, balls.densities, balls.radii, balls.kernel)


def through_the_middle(balls: Metaballs, sigma_t: float) -> float:
    """Give a cloud's mean optical depth along x, y and z through its centre of mass.

    Parameters
    ----------
    balls
        The cloud.
    sigma_t
        Extinction at density 1, 1 / scene unit.

    Returns
    -------
    tau, at least 0; 0 for an empty cloud.
    """
    mass = balls.densities * balls.radii**3
    whole = math.fsum(mass)  # fsum is exact: no order of the balls shows
    if not whole > 0.0:
        return 0.0
    shares = mass / whole
    middle = np.array([math.fsum(shares * axis) for axis in balls.centers.T])
    square = np.square(balls.centers - middle)
    depth = axis_depth(sigma_t, balls.densities, balls.radii, balls.kernel)
    total = 0.0
    for axis in range(3):
        q = (square.sum(axis=1) - square[:, axis]) / np.square(balls.radii)
        total += math.fsum(depth * footprint_of(q, balls.kernel, "chord"))
    return total / 3.0 if math.isfinite(total) else 0.0
