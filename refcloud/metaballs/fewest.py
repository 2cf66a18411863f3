"""The fewest balls that reach an error: a search over counts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

from refcloud.refusal import complaint

Result = TypeVar("Result")

# Where the search starts, and the most that a count may grow in one try.
FIRST, GROWTH = 30, 8
# The error of n balls falls about as n^-1/3 where nothing is known yet.
SLOPE = 1.0 / 3.0
# The next try aims this much below the error asked for, so that one try may do.
AIM = 0.97


def fewest(
    attempt: Callable[[int], tuple[float, Result]], tolerance: float, most: int
) -> Result:
    """Find a count that reaches an error where the one below does not.

    The search keeps two counts, one that fails and a larger one that succeeds. It aims
    between them along the line of log error against log count, takes the middle where
    that would hardly move, and ends where no count is left between.

    Parameters
    ----------
    attempt
        Fits with a count, and gives the error and the result.
    tolerance
        The largest error that counts as reached.
    most
        The largest count that is tried.

    Returns
    -------
    The result of the smallest count tried that reached it; with one ball fewer, the
    error was tried and is larger. Errors are not monotone: by chance, a still smaller
    count may reach it too.

    Raises
    ------
    ValueError
        Even the largest count does not reach it.
    """
    fails, above = 0, 1.0  # no balls leave everything
    reached: tuple[int, float, Result] | None = None
    count = min(FIRST, most)
    while True:
        error, result = attempt(count)
        if error <= tolerance:
            reached = (count, error, result)
        elif count == most:
            raise ValueError(
                complaint(
                    "tolerance",
                    f"an error that balls can reach, here {error:.4g} with {most}",
                    f"{tolerance:.4g}",
                    "allow more, or use smaller voxels",
                )
            )
        else:
            fails, above = count, error
        if reached is None:
            count = _beyond(fails, above, tolerance, most)
        elif reached[0] - fails <= 1:
            return reached[2]
        else:
            count = _between(fails, above, reached[0], reached[1], tolerance)


def _beyond(fails: int, above: float, tolerance: float, most: int) -> int:
    """Aim at a larger count from one that failed."""
    factor = (above / (AIM * tolerance)) ** (1.0 / SLOPE)
    return min(most, max(fails + 1, round(fails * min(factor, GROWTH))))


def _between(
    fails: int, above: float, reaches: int, below: float, tolerance: float
) -> int:
    """Aim between a count that failed and one that succeeded."""
    middle = (fails + reaches) // 2
    if fails < 1 or not below < tolerance < above:
        return middle
    share = math.log(above / tolerance) / math.log(above / below)
    aimed = round(fails * (reaches / fails) ** share)
    # A step that leaves most of the gap would take many: the middle halves it.
    room = max(1, (reaches - fails) // 8)
    return min(max(aimed, fails + room), reaches - room)
