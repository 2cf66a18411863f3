"""Levenberg-Marquardt steps on the centres, radii and heights of all balls together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.metaballs.heights import dot
from refcloud.metaballs.kernels import Kernel, slope_of
from refcloud.metaballs.pairs import Pairs, Work, list_pairs

# Damping: where it starts, and how a good and a bad step change it.
DAMPING, EASE, HARDEN = 0.1, 0.3, 5.0
# Conjugate gradients: most steps, and the share of the right side that ends them.
INNER_STEPS, INNER_SHARE = 8, 0.03
# A step moves a centre by at most this many radii, and log R by at most this much.
FARTHEST = 0.5
# Diagonals below this share of their mean count as this: a ball of height 0 is no hole.
SMALLEST = 1e-6


@dataclass(frozen=True)
class Fit:
    """A state of the fit: N balls in work units.

    Attributes
    ----------
    centers, radii, heights
        Shapes (N, 3), (N,) and (N,), in mean cell edges and shares of the peak.
    """

    centers: Array
    radii: Array
    heights: Array


def refine(
    work: Work,
    fit: Fit,
    kernel: Kernel,
    *,
    steps: int,
    least_radius: float,
    observe: Callable[[int, Fit], object],
) -> Fit:
    """Move all balls to lower the squared error over all voxels.

    Formula: (J^T J + mu diag J^T J) s = J^T (y - g), a step s for (c, log R, v)
    """
    damping = DAMPING
    pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    residual = pairs.target - pairs.forward(fit.heights)
    cost = dot(residual, residual)
    jacobian = _jacobian(pairs, fit, kernel)
    for number in range(steps):
        step = _solve(pairs, jacobian, residual, damping)
        trial = _moved(work, fit, step, least_radius)
        listed = list_pairs(work, trial.centers, trial.radii, kernel)
        left = listed.target - listed.forward(trial.heights)
        trial_cost = dot(left, left)
        if trial_cost < cost:
            fit, pairs, residual, cost = trial, listed, left, trial_cost
            jacobian = _jacobian(pairs, fit, kernel)
            damping *= EASE
        else:
            damping *= HARDEN
        observe(number + 1, fit)
    return fit


def _jacobian(pairs: Pairs, fit: Fit, kernel: Kernel) -> Array:
    """Differentiate the field at each pair by (c, log R, v), shape (5, P)."""
    slope = fit.heights[pairs.ball] * slope_of(pairs.q, kernel)
    squared = fit.radii[pairs.ball] ** 2
    return np.concatenate(
        [
            pairs.away * (-2.0 * slope / squared),
            (-2.0 * slope * pairs.q)[None],
            pairs.value[None],
        ]
    )


def _solve(pairs: Pairs, jacobian: Array, residual: Array, damping: float) -> Array:
    """Solve for the step, shape (5, N), by conjugate gradients with 5 x 5 blocks."""
    gradient = pairs.by_ball(jacobian * residual[pairs.voxel])
    blocks = np.zeros((pairs.count, 5, 5))
    for i in range(5):
        for j in range(i, 5):
            blocks[:, i, j] = pairs.by_ball(jacobian[i] * jacobian[j])
            blocks[:, j, i] = blocks[:, i, j]
    diagonal = np.einsum("nii->in", blocks)
    floor = SMALLEST * diagonal.mean(axis=1, keepdims=True)
    extra = damping * np.maximum(diagonal, floor) + np.finfo(float).tiny
    blocks += extra.T[:, :, None] * np.eye(5)
    inverse = np.linalg.inv(blocks)  # (N, 5, 5)

    def times(s: Array) -> Array:
        parts = np.einsum("cp,cp->p", jacobian, s[:, pairs.ball])
        image = np.bincount(pairs.voxel, parts, minlength=len(residual))
        return pairs.by_ball(jacobian * image[pairs.voxel]) + extra * s

    def condition(s: Array) -> Array:
        return np.einsum("nij,jn->in", inverse, s)

    step = np.zeros_like(gradient)
    left = gradient
    guess = condition(left)
    direction, power = guess, float((left * guess).sum())
    first = power
    for _ in range(INNER_STEPS):
        if power <= INNER_SHARE**2 * first or power <= 0.0:
            break
        image = times(direction)
        length = power / float((direction * image).sum())
        step = step + length * direction
        left = left - length * image
        guess = condition(left)
        before, power = power, float((left * guess).sum())
        direction = guess + power / before * direction
    return step


def _moved(work: Work, fit: Fit, step: Array, least_radius: float) -> Fit:
    """Apply a step within bounds: no far jump, no ball outside, tiny or below 0."""
    shift = step[:3].T  # (N, 3)
    length = np.sqrt((shift * shift).sum(axis=1)) / (FARTHEST * fit.radii)
    shift = shift / np.maximum(length, 1.0)[:, None]
    last = (np.array(work.density.shape[::-1]) - 1.0) * work.edges
    longest = max(float(np.sqrt(((last + work.edges) ** 2).sum())), least_radius)
    growth = np.exp(np.clip(step[3], -FARTHEST, FARTHEST))
    return Fit(
        np.clip(fit.centers + shift, 0.0, last),
        np.clip(fit.radii * growth, least_radius, longest),
        np.maximum(fit.heights + step[4], 0.0),
    )
