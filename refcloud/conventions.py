"""Axes, units, symbols and shapes of refcloud, and the marks of every argument.

Axes
    World: right-handed, +y up. A camera looks along -z of its own frame (OpenGL).
    Lengths are in scene units, angles in radians. Points are (x, y, z).
    Voxel arrays are ``density[z, y, x]``; a value sits at its cell's centre.
    Pictures are ``(H, W, 3)`` linear RGB, float64, row 0 at the top.

Shape letters
    ``(H, W, 3)`` picture, ``(D, H, W)`` voxels, ``(N, 3)`` points, ``(S, ...)`` suns,
    ``(...,)`` any leading axes. A letter stands for one size in one call.

Symbols (those of the field; what the papers call otherwise is in brackets)
    ========== ============================================== ===================
    symbol     meaning                                        unit
    ========== ============================================== ===================
    sigma_t    extinction per unit length at density 1        1 / scene unit
    albedo     scattered share of extinction (a)              1
    g          mean cosine of the Henyey-Greenstein phase     1
    cos_theta  dot of the light's direction before and after  1 (forward is +1)
    tau        optical depth                                  1
    T          transmittance exp(-tau)                        1
    L          radiance, 1 is displayed white                 radiance
    irradiance light on a plane across the sun's direction    radiance times sr
    wo, wi     directions toward the eye and the light        unit vectors
    R, r       a ball's radius, distance to its centre        scene units
    density    a ball's density at its centre (rho)           1
    ========== ============================================== ===================

Arguments
    Every public parameter carries its range and unit as ``Annotated[float, Range(0, 1,
    "1")]`` or its shape as ``Annotated[Array, Shape("N", 3)]``. `refcloud.checking`
    reads these annotations, refuses what does not fit with one clear line, and hands
    the function plain floats and float64 arrays. Command-line help, sliders and
    hypothesis strategies read the same annotations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Observer = Callable[[str, Any], Any]  # gets a name and an intermediate, read-only


@dataclass(frozen=True)
class Range:
    """The numbers that an argument may take, and their unit."""

    lower: float = -math.inf
    upper: float = math.inf
    unit: str = "1"
    open_lower: bool = False  # True leaves the lower end out
    open_upper: bool = False

    def __str__(self) -> str:
        left = "(" if self.open_lower or self.lower == -math.inf else "["
        right = ")" if self.open_upper or self.upper == math.inf else "]"
        low, high = (
            str(end) if isinstance(end, int) else f"{end:g}"
            for end in (self.lower, self.upper)
        )
        return f"{left}{low}, {high}{right}"

    def holds(self, value: Any) -> bool:
        """Tell whether every element of a finite value lies in the range."""
        above = value > self.lower if self.open_lower else value >= self.lower
        below = value < self.upper if self.open_upper else value <= self.upper
        return bool(np.all(above & below))


class Shape:
    """The shape of an array argument: numbers, letters, and ``...`` in front."""

    def __init__(self, *axes: int | str) -> None:
        self.axes = axes

    def __str__(self) -> str:
        inner = ", ".join(str(axis) for axis in self.axes)
        return f"({inner},)" if len(self.axes) == 1 else f"({inner})"

    def fits(self, shape: tuple[int, ...], sizes: dict[str, int]) -> bool:
        """Compare with a shape; letters take their size from the first use."""
        axes = self.axes
        if axes and axes[0] == "...":
            axes = axes[1:]
            if len(shape) < len(axes):
                return False
            shape = shape[len(shape) - len(axes) :]
        if len(shape) != len(axes):
            return False
        known = dict(sizes)
        fits = all(
            size == (known.setdefault(axis, size) if isinstance(axis, str) else axis)
            for axis, size in zip(axes, shape, strict=True)
        )
        if fits:
            sizes.update(known)
        return fits


class MayBeNotFinite:
    """Marks scattered noise points: NaN and infinity go in and come out as NaN."""


WHOLE_SPHERE = 4.0 * math.pi  # steradians
# Width times height of a picture. Beside its cloud, drawing and saving one takes at
# most 300 bytes a pixel (measured: shader-lit; other scenes take 160 to 260), so that
# the largest, of 3840 x 2160, takes 2.5 GB; larger ones are refused.
MOST_PIXELS = 8_300_000
# Width and height where the caller names none.
SIZES: dict[str, tuple[int, int]] = {"quick": (320, 240), "final": (1024, 768)}

Positive = Range(0.0, open_lower=True)
UNIT = Range(-1.000001, 1.000001)  # parts of unit vectors, float32 ones among them
Seed = Annotated[int, Range(-(2**63), 2**63 - 1)]
Vector = Annotated[Array, Shape(3)]
Colour = Annotated[Array, Shape(3), Range(0.0, unit="radiance")]
Backend = Literal["numpy", "gl"]  # what runs the two passes of light
Tolerance = Annotated[float, Range(0.0, 1.0, "displayed white")]
# How a bound is known: it was derived; this very picture was held against the exact
# method in places; or it is the worst of other clouds, with a margin.
Known = Literal["proved", "certified", "measured"]


@dataclass(frozen=True)
class Skipped:
    """One row of the report: what a stage left out, and what that can change.

    Attributes
    ----------
    stage, what
        Which stage, and what it did not do.
    skipped, of
        How many were left out, of how many.
    bound
        The largest change of the stage's result; 0 where none.
    unit
        What the bound counts: "displayed white" in pictures, else the stage's own.
    how
        "proved": from what stands in the docstring of the function that skips.
        "certified": from a sample of this picture that was compared with the exact
        method, which may miss the worst place. "measured": from other clouds.
    """

    stage: str
    what: str
    skipped: int
    of: int
    bound: float = 0.0
    unit: str = "displayed white"
    how: Known = "proved"

    def __str__(self) -> str:
        """Give the row as one line of text."""
        return (
            f"{self.stage}: {self.skipped} of {self.of} {self.what}"
            f" skipped, error at most {self.bound:.2g}"
            + (f" ({self.unit}, {self.how})" if self.bound else "")
        )


def unit_vector(vector: Array, name: str = "direction") -> Array:
    """Scale a vector to length 1.

    Parameters
    ----------
    vector
        Shape (3,), finite, any length but 0.
    name
        What the refusal calls it.

    Returns
    -------
    The unit vector, shape (3,).

    Raises
    ------
    ValueError
        The vector is zero.

    Examples
    --------
    >>> unit_vector(np.array([0.0, 3.0, 4.0]))
    array([0. , 0.6, 0.8])
    """
    largest = float(np.abs(vector).max())
    if largest == 0.0:
        raise ValueError(f"{name}: expected a vector that is not zero, got (0, 0, 0)")
    scaled = vector / largest  # no overflow, whatever the length
    return scaled / math.sqrt(float(scaled @ scaled))
