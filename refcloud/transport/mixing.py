"""Finding what a map leaves unchanged, by mixing what it gave (Anderson 1965)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.products import dot

Reals = NDArray[np.floating[Any]]

MEMORY = 5  # pairs that are kept: more gain little and cost a product each
# Added to the normal equations, of their trace: nearly parallel pairs stay harmless.
RIDGE = 1e-12


@dataclass(frozen=True)
class Found:
    """A fixed point, and how it was reached.

    Attributes
    ----------
    value
        What the map gave last.
    iterations
        How often it was called.
    residual
        |G(x) - x| / |G(x)| at the last call.
    converged
        Whether the residual came below the tolerance.
    """

    value: Reals
    iterations: int
    residual: float
    converged: bool


def fixed_point(
    step: Callable[[Reals], Reals],
    start: Reals,
    *,
    tolerance: float,
    most: int,
    memory: int = MEMORY,
) -> Found:
    """Iterate x = G(x) with Anderson's mixing.

    Of the last pairs (x, G(x)) that combination is taken whose residuals G(x) - x
    cancel best; the next x is the same combination of what G gave.

    Parameters
    ----------
    step
        G.
    start
        The first x.
    tolerance
        Largest relative residual that counts as converged.
    most
        Calls of G, at least 1.
    memory
        Pairs that are kept; 0 is plain iteration.

    Returns
    -------
    The last G(x), and how it was reached.
    """
    x, calls = start, 0
    changes: list[tuple[Reals, Reals]] = []  # of the residual, of what G gave
    gram = np.zeros((0, 0))
    last: tuple[Reals, Reals] | None = None
    while True:
        given = step(x)
        residual = given - x
        calls += 1
        size = _norm(given)
        relative = _norm(residual) / size if size > 0.0 else 0.0
        if relative <= tolerance or calls >= most:
            return Found(given, calls, relative, relative <= tolerance)
        x = given
        if last is not None and memory:
            changes.append((residual - last[0], given - last[1]))
            changes = changes[-memory:]
            gram = _gram(gram[-(memory - 1) :, -(memory - 1) :], changes)
            right = np.array([dot(r, residual) for r, _ in changes])
            ridge = RIDGE * np.trace(gram) * np.eye(len(gram))
            for share, (_, moved) in zip(
                np.linalg.lstsq(gram + ridge, right, rcond=None)[0],
                changes,
                strict=True,
            ):
                x = x - x.dtype.type(share) * moved
        last = residual, given


def _gram(old: Any, changes: list[tuple[Reals, Reals]]) -> Any:
    """Add the newest change to the table of products."""
    n = len(changes)
    gram = np.zeros((n, n))
    gram[: n - 1, : n - 1] = old[-(n - 1) :, -(n - 1) :] if n > 1 else 0.0
    gram[n - 1] = [dot(changes[-1][0], r) for r, _ in changes]
    gram[:, n - 1] = gram[n - 1]
    return gram


def _norm(a: Reals) -> float:
    return math.sqrt(dot(a, a))
