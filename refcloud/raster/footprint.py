"""Where a ball falls on the pixels, and how strongly it covers each of them.

``patch_of`` and ``footprint_of`` are the unchecked inner forms of `patch` and
`footprint`, for loops over thousands of balls; ``opacity_of`` is 1 - `transmittance`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.metaballs.kernels import Kernel, chord_of, profile_of
from refcloud.raster.framebuffer import Size

Name = Literal["chord", "profile"]
Law = Literal["beer", "linear"]
Place = Annotated[float, Range(unit="pixels")]
Radius = Annotated[float, Range(0.0, unit="pixels", open_lower=True)]
Depth = Annotated[float, Range(0.0)]


@dataclass(frozen=True, eq=False, slots=True)
class Patch:
    """The pixels that a ball may touch.

    Attributes
    ----------
    rows, columns
        The box of pixels, as slices of the framebuffer.
    q
        Squared distance of each pixel's centre from the ball's, in radii squared,
        shape (h, w); above 1 in the corners, outside the ball.
    """

    rows: slice
    columns: slice
    q: Array


@checked
def patch(
    x: Place, y: Place, radius: Radius, width: Size, height: Size
) -> Patch | None:
    """Find the pixels whose centres lie in a ball's bounding square.

    Formula: q = ((i + 1/2 - x)^2 + (j + 1/2 - y)^2) / R^2 for column i, row j

    Parameters
    ----------
    x, y
        The ball's centre in pixels, from the left and from the top edge.
    radius
        Its radius in pixels.
    width, height
        Size of the framebuffer, pixels; what lies outside is cut off.

    Returns
    -------
    The patch, or None where the square holds no pixel's centre.

    Source: paper M, section 4.1, third step (the splatted map); L08.

    Examples
    --------
    >>> patch(1.5, 0.5, 2, 4, 4).q
    array([[0.25, 0.  , 0.25, 1.  ],
           [0.5 , 0.25, 0.5 , 1.25],
           [1.25, 1.  , 1.25, 2.  ]])
    """
    return patch_of(x, y, radius, width, height)


def patch_of(
    x: float, y: float, radius: float, width: int, height: int
) -> Patch | None:
    """Find a ball's pixels without a check: the inner form of `patch`.

    Parameters
    ----------
    x, y, radius, width, height
        As `patch`.

    Returns
    -------
    As `patch`.
    """
    # Cut off at the borders before rounding: no radius makes a large integer.
    left = math.ceil(max(x - radius, 0.0) - 0.5)
    right = math.floor(min(x + radius, width) - 0.5) + 1
    top = math.ceil(max(y - radius, 0.0) - 0.5)
    bottom = math.floor(min(y + radius, height) - 0.5) + 1
    if left >= right or top >= bottom:
        return None
    across = (np.arange(left + 0.5, right) - x) / radius
    down = (np.arange(top + 0.5, bottom) - y) / radius
    across *= across
    down *= down
    q = down[:, None] + across
    return Patch(slice(top, bottom), slice(left, right), q)


@checked
def footprint(
    q: Annotated[Array, Shape("..."), Range(0.0)],
    *,
    kernel: Kernel = "wyvill",
    name: Name = "chord",
) -> Array:
    """Give how strongly a ball covers a pixel: 1 at its centre, 0 from its rim on.

    Formula: chord(q) / chord(0), or profile(q)

    Parameters
    ----------
    q
        Squared distance from the ball's centre, in radii squared, any shape.
    kernel
        The ball's density: "wyvill" or "gaussian".
    name
        "chord", the exact integral along the line of sight, or "profile", the paper's
        map, the density in the plane through the centre.

    Returns
    -------
    Weights in [0, 1], shape of q.

    Source: paper M, eq 12 and section 4.1; L08, E04.

    Examples
    --------
    >>> footprint([0.0, 0.25, 1.0]).round(4)
    array([1.    , 0.4376, 0.    ])
    """
    return footprint_of(q, kernel, name)


def footprint_of(q: Array, kernel: Kernel = "wyvill", name: Name = "chord") -> Array:
    """Give the footprint without a check: the inner form of `footprint`.

    Parameters
    ----------
    q, kernel, name
        As `footprint`.

    Returns
    -------
    As `footprint`, a new array.
    """
    if name == "profile":
        return profile_of(q, kernel)
    return chord_of(q, kernel) * PER_AXIS[kernel]


def _per_axis(kernel: Kernel) -> float:
    return 1.0 / float(chord_of(np.zeros(1), kernel)[0])


PER_AXIS = {"wyvill": _per_axis("wyvill"), "gaussian": _per_axis("gaussian")}


@checked
def transmittance(
    weight: Annotated[Array, Shape("..."), Range(0.0, 1.0)],
    tau: Depth,
    *,
    law: Law = "beer",
) -> Array:
    """Give the share of light that a ball lets through at each pixel.

    Formula: exp(-tau w) (beer), or 1 - (1 - exp(-tau)) w (linear)

    Parameters
    ----------
    weight
        Footprint of the ball, any shape, in [0, 1].
    tau
        Optical depth along the ball's axis.
    law
        "beer", or "linear": the paper's blend of eq 28 with alpha modulated by the map.

    Returns
    -------
    Transmittance in [0, 1], shape of the weight.

    Source: paper M, eq 27 and 28; L03, E24, E25.

    Examples
    --------
    >>> transmittance([0.0, 0.5, 1.0], 1.0).round(4)
    array([1.    , 0.6065, 0.3679])
    """
    if law == "beer":
        return np.exp(-tau * weight)  # exact also where hardly anything passes
    return 1.0 - opacity_of(weight, tau, law)


def opacity_of(weight: Array, tau: float, law: Law = "beer") -> Array:
    """Give 1 - `transmittance` without a check.

    Parameters
    ----------
    weight, tau, law
        As `transmittance`.

    Returns
    -------
    Opacity in [0, 1], exact also where it is small; a new array.
    """
    if law == "linear":
        return weight * -math.expm1(-tau)
    opacity = np.multiply(weight, -tau)
    np.expm1(opacity, out=opacity)
    return np.negative(opacity, out=opacity)
