"""Heights on a grid: the third phase, as the paper has it and as least squares."""

from __future__ import annotations

from dataclasses import replace

from refcloud.metaballs.heights import descend, dot
from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.nonnegative import solve_non_negative
from refcloud.metaballs.pairs import Pairs, Work, list_pairs
from refcloud.metaballs.refine import Fit, Listed, listed

# Phase 3 ends where the relative error of all voxels is this, or after so many steps.
PAPER_ERROR, PAPER_STEPS = 0.1, 30
# How far the heights' gradient may be from 0, over the right side. H is above its least
# by that squared times the condition, below 100 for balls: 1e-10 of sum y^2 at 1e-6.
# Heights that the next steps move on need no more than 1e-2.
OPTIMAL, ROUGH, MOST_STEPS = 1e-6, 1e-2, 2000


def with_heights(
    work: Work,
    fit: Fit,
    kernel: Kernel,
    *,
    pairs: Pairs | None = None,
    optimal: float = OPTIMAL,
) -> Listed:
    """Give balls the heights, none below 0, that fit best; start from their own."""
    if pairs is None:
        pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    heights, _ = solve_non_negative(
        lambda v: pairs.backward(pairs.forward(v)),
        pairs.by_ball(pairs.value**2),
        pairs.backward(pairs.target),
        start=fit.heights,
        optimal=optimal,
        most_steps=MOST_STEPS,
        positive=True,
    )
    return listed(work, replace(fit, heights=heights), kernel, pairs)


def with_learned_heights(work: Work, fit: Fit, kernel: Kernel) -> Listed:
    """Give balls the heights that the paper's gradient learns (eq 24)."""
    pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    heights = descend(
        pairs.forward,
        pairs.backward,
        pairs.target,
        pairs.count,
        rate=None,
        limit=PAPER_ERROR**2 * dot(pairs.target, pairs.target),
        most_steps=PAPER_STEPS,
    )
    return listed(work, replace(fit, heights=heights), kernel, pairs)
