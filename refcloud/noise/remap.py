"""Remap: numbers carried from one range to another, as document D does with noise.

Document D names "the scale function described in Fredrik Haggstrom's thesis" for the
combination of its two noises, and prints no formula; its sky's `scale(y, -1, 1, 0.4,
0.6)` shows the order of the arguments: value, old range, new range. The thesis
("Real-time rendering of volumetric clouds", Umeå 2018) is known here from what others
quote of it: it writes R(v, l0, h0, ln, hn) for the straight line of `remap`, a function
that Schneider's talk and chapter on the clouds of Horizon Zero Dawn (2015, 2016) call
Remap. Where l0 = h0 the formula divides by zero (E33).
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Range

Real = Annotated[Array, Range()]


@checked
def remap(
    values: Real,
    l0: Real,
    h0: Real,
    ln: Real,
    hn: Real,
    *,
    empty: Literal["refuse", "step"] = "refuse",
) -> Array:
    """Carry numbers from one range to another along a straight line.

    Formula: ln + (v - l0) (hn - ln) / (h0 - l0)

    Parameters
    ----------
    values
        Numbers (v), in or out of the old range.
    l0, h0
        Ends of the old range, which broadcast.
    ln, hn
        Ends of the new range, which broadcast.
    empty
        What a range with l0 = h0 does, where the formula divides by zero (E33).
        "refuse" is an error; "step" gives ln below it and hn from it on, to which the
        clamped line tends as the range shrinks.

    Returns
    -------
    The numbers, of the broadcast shape. They are not clamped.

    Raises
    ------
    ValueError
        A range is empty, unless "step".

    Source: document D's scale, after Häggström (N31); E33.

    Examples
    --------
    >>> remap([0.0, 0.5, 2.0], -1.0, 1.0, 0.4, 0.6).round(9)
    array([0.5 , 0.55, 0.7 ])
    """
    width = h0 - l0
    flat = width == 0.0
    if not flat.any():
        return ln + (values - l0) * (hn - ln) / width
    if empty == "refuse":
        raise ValueError(
            complaint(
                "h0", "other than l0", f"{int(flat.sum())} equal", 'or empty="step"'
            )
        )
    line = ln + (values - l0) * (hn - ln) / np.where(flat, 1.0, width)
    return np.where(flat, np.where(values < l0, ln, hn), line)
