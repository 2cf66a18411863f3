"""How far two pictures lie apart, as numbers and as a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Range, Shape
from refcloud.image.picture import Picture
from refcloud.image.png import _check_codes

Values = Annotated[Array, Shape("...")]
MOST_NAMED = 5  # worst pixels that a comparison names


@dataclass(frozen=True)
class Comparison:
    """What a comparison of two pictures of codes found.

    Attributes
    ----------
    same
        Whether they pass for the same.
    worst
        Largest difference of a channel, in codes.
    off_share
        Share of pixels with any channel off at all, in [0, 1].
    worst_pixels
        Up to five (row, column, largest difference), worst first.
    """

    same: bool
    worst: int
    off_share: float
    worst_pixels: tuple[tuple[int, int, int], ...]


@checked
def compare_codes(
    a: np.ndarray,
    b: np.ndarray,
    *,
    codes: Annotated[int, Range(0, 255, "codes")] = 1,
    fraction: Annotated[float, Range(0.0, 1.0)] = 0.001,
) -> Comparison:
    """Tell whether two pictures of 8-bit codes pass for the same.

    Formula: max |a - b| <= codes, and the share of pixels off at all <= fraction

    Parameters
    ----------
    a, b
        Codes, shape (H, W, 3) or (H, W, 4), uint8, both of one shape.
    codes
        Largest difference that any channel may have.
    fraction
        Largest share of pixels that may differ at all.

    Returns
    -------
    The verdict, and where they differ most.

    Raises
    ------
    TypeError, ValueError
        Not codes, or of different shapes.

    Source: design of the golden pictures (one code, a thousandth of the pixels).

    Examples
    --------
    >>> black = np.zeros((2, 2, 3), np.uint8)
    >>> compare_codes(black, black + np.uint8(1), fraction=1.0).same
    True
    """
    _check_codes("a", a)
    _check_codes("b", b)
    _check_shapes(a, b)
    off = np.abs(a.astype(np.int16) - b).max(axis=-1)  # (H, W), of the worst channel
    share = int(np.count_nonzero(off)) / off.size
    worst = int(off.max())
    width = off.shape[1]
    order = np.argsort(-off, axis=None, kind="stable")[:MOST_NAMED]
    named = [(int(i) // width, int(i) % width, int(off.flat[i])) for i in order]
    return Comparison(
        same=worst <= codes and share <= fraction,
        worst=worst,
        off_share=share,
        worst_pixels=tuple(pixel for pixel in named if pixel[2] > 0),
    )


@checked
def difference_picture(
    a: Picture, b: Picture, *, gain: Annotated[float, Range(0.0, 1e6)] = 10.0
) -> Picture:
    """Show where two pictures differ.

    Formula: gain |a - b|, in linear light

    Parameters
    ----------
    a, b
        Pictures of one size.
    gain
        Factor on the difference.

    Returns
    -------
    The difference as a picture, at least 0; alpha does not count.

    Raises
    ------
    ValueError
        The sizes differ.

    Source: none; a picture for finding faults.

    Examples
    --------
    >>> grey, dark = Picture([[[0.5, 0.5, 0.5]]]), Picture([[[0.4, 0.5, 0.5]]])
    >>> difference_picture(grey, dark).linear.round(9)
    array([[[1., 0., 0.]]])
    """
    _check_shapes(a.linear, b.linear)
    return Picture(gain * np.abs(a.linear - b.linear))


@checked
def root_mean_square(a: Values, b: Values) -> float:
    """Give the root of the mean squared difference.

    Formula: sqrt(mean((a - b)^2))

    Parameters
    ----------
    a, b
        Values of one shape; linear light of pictures, or anything else.

    Returns
    -------
    The root mean square, in the unit of the values.

    Raises
    ------
    ValueError
        The shapes differ, or there are no values.

    Source: style of the project's evidence (errors as RMSE and maximum).

    Examples
    --------
    >>> root_mean_square([0.0, 0.0], [3.0, 4.0])
    3.5355339059327378
    """
    off = largest_difference(a, b)
    if off == 0.0:
        return 0.0
    return off * float(np.sqrt(np.mean(((a - b) / off) ** 2)))  # no overflow


@checked
def largest_difference(a: Values, b: Values) -> float:
    """Give the largest difference of any value.

    Formula: max |a - b|

    Parameters
    ----------
    a, b
        Values of one shape; linear light of pictures, or anything else.

    Returns
    -------
    The largest difference, in the unit of the values.

    Raises
    ------
    ValueError
        The shapes differ, or there are no values.

    Source: style of the project's evidence (errors as RMSE and maximum).

    Examples
    --------
    >>> largest_difference([0.0, 1.0], [0.5, 1.0])
    0.5
    """
    _check_shapes(a, b)
    if a.size == 0:
        raise ValueError(complaint("a", "at least one value", f"shape {a.shape}"))
    return float(np.abs(a - b).max())


def _check_shapes(a: np.ndarray, b: np.ndarray) -> None:
    if a.shape != b.shape:
        raise ValueError(complaint("b", f"shape {a.shape} as a", f"shape {b.shape}"))
