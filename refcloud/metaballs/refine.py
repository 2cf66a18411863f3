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
# Below this share of the diagonal, damping is lost in the rounding of the blocks.
SOFTEST = float(np.finfo(float).eps)
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


@dataclass(frozen=True)
class Listed:
    """A fit on a grid, the pairs of its balls there, and what it leaves.

    Attributes
    ----------
    fit, pairs
        The balls, and their pairs with the grid's voxels.
    residual
        Density minus the balls', at every voxel of the pairs' box.
    cost
        Its squares' sum.
    """

    fit: Fit
    pairs: Pairs
    residual: Array
    cost: float


def listed(work: Work, fit: Fit, kernel: Kernel, pairs: Pairs | None = None) -> Listed:
    """List a fit's pairs, unless they are known, and what it leaves."""
    if pairs is None:
        pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    residual = pairs.target - pairs.forward(fit.heights)
    return Listed(fit, pairs, residual, dot(residual, residual))


def refine(
    work: Work,
    state: Listed,
    kernel: Kernel,
    *,
    steps: int,
    least_radius: float,
    inner: int = INNER_STEPS,
    observe: Callable[[int, Fit], object] | None = None,
) -> Listed:
    """Move all balls to lower the squared error over all voxels.

    Formula: (J^T J + mu diag J^T J) s = J^T (y - g), a step s for (c, log R, v)

    Steps end early where the damping has become so large that none lowers the cost.
    """
    damping = DAMPING
    # With D for the diagonal, A = J^T J <= A + mu D, r = y - g and b = J^T r: the
    # linear model's cost falls by 2 b.s - s.A s <= 2 b.s <= 2 b.(A + mu D)^-1 b
    # <= 2 b.D^-1 b / mu; b.s is largest for the solution itself, so this holds for
    # each of the conjugate gradients' steps too. b_i^2 <= D_ii |r|^2 for each of the
    # 5 N unknowns, hence the fall is at most 10 N |r|^2 / mu (what the model leaves
    # out is of order 1 / mu^2). From this mu on it is under half a last bit of |r|^2.
    stiffest = 20.0 * len(state.fit.radii) / np.finfo(float).eps
    jacobian = _jacobian(state.pairs, state.fit, kernel) if steps else np.zeros((5, 0))
    for number in range(steps):
        if damping > stiffest:
            break
        step = _solve(state.pairs, jacobian, state.residual, damping, inner)
        trial = listed(work, _moved(work, state.fit, step, least_radius), kernel)
        if trial.cost < state.cost:
            state = trial
            damping = max(damping * EASE, SOFTEST)
            if number + 1 < steps:
                jacobian = _jacobian(state.pairs, state.fit, kernel)
        else:
            damping *= HARDEN
        if observe is not None:
            observe(number + 1, state.fit)
    return state


def _jacobian(pairs: Pairs, fit: Fit, kernel: Kernel) -> Array:
    """Differentiate the field at each pair by (c, log R, v), shape (5, P)."""
    slope = pairs.spread(-2.0 * fit.heights) * slope_of(pairs.q, kernel)
    jacobian = np.empty((5, len(pairs.q)))
    np.multiply(pairs.away, slope * pairs.spread(fit.radii**-2.0), out=jacobian[:3])
    np.multiply(slope, pairs.q, out=jacobian[3])
    jacobian[4] = pairs.value
    return jacobian


def _solve(
    pairs: Pairs,
    jacobian: Array,
    residual: Array,
    damping: float,
    inner: int = INNER_STEPS,
) -> Array:
    """Solve for the step, shape (5, N), by conjugate gradients with 5 x 5 blocks."""
    gradient = pairs.by_ball(jacobian * residual[pairs.voxel])
    blocks = np.zeros((pairs.count, 5, 5))
    for i in range(5):
        below = pairs.by_ball(jacobian[i] * jacobian[i:])
        blocks[:, i, i:] = blocks[:, i:, i] = below.T
    diagonal = np.einsum("nii->in", blocks)
    floor = SMALLEST * diagonal.mean(axis=1, keepdims=True)
    extra = damping * np.maximum(diagonal, floor) + np.finfo(float).tiny
    blocks += extra.T[:, :, None] * np.eye(5)
    inverse = np.linalg.inv(blocks)  # (N, 5, 5)

    def times(s: Array) -> Array:
        image = pairs.by_voxel(np.einsum("ip,ip->p", jacobian, pairs.spread(s)))
        return pairs.by_ball(jacobian * image[pairs.voxel]) + extra * s

    def condition(s: Array) -> Array:
        return np.einsum("nij,jn->in", inverse, s)

    step = np.zeros_like(gradient)
    left = gradient
    guess = condition(left)
    direction, power = guess, float((left * guess).sum())
    first = power
    for _ in range(inner):
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
