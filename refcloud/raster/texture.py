"""Textures: arrays of colours that are looked up at fractions of their sides.

As in OpenGL the first coordinate, s, runs along the last axis of places, W, and t along
H, both from the array's first texel: texel (row j, column i) has its centre at
s = (i + 1/2) / W, t = (j + 1/2) / H. So a picture, whose row 0 is its top, stands
upright where t runs down, and a map of noise where t runs as its rows do. In space r
runs along D of (D, H, W, C), as in voxels. Nothing is turned over anywhere.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.checking import check, check_fields, complaint
from refcloud.conventions import Array, Shape
from refcloud.raster.mipmaps import mip_levels

Filter = Literal["NEAREST", "LINEAR"]
MinFilter = Literal[
    "NEAREST",
    "LINEAR",
    "NEAREST_MIPMAP_NEAREST",
    "LINEAR_MIPMAP_NEAREST",
    "NEAREST_MIPMAP_LINEAR",
    "LINEAR_MIPMAP_LINEAR",
]
Wrap = Literal["REPEAT", "MIRRORED_REPEAT", "CLAMP_TO_EDGE"]
MOST_TEXELS = 16_000_000  # 4096 x 4096 or 256^3: half a gigabyte of float64 RGBA
CODES = 255.0
# Texels beyond an edge, as a border of one texel shows them.
# By numpy's names, of which its stubs want to know each: hence Any.
BORDER: dict[str, Any] = {
    "REPEAT": "wrap",
    "MIRRORED_REPEAT": "symmetric",
    "CLAMP_TO_EDGE": "edge",
}


@dataclass(frozen=True, eq=False)
class Texture:
    """Texels, and how they are looked up; the defaults but for wrap are OpenGL's own.

    Attributes
    ----------
    texels
        Shape (H, W, C) in the plane or (D, H, W, C) in space, C from 1 to 4: red,
        green, blue, alpha, of which those that are missing read as 0, alpha as 1.
        float64 or float32 of any size; uint8 are codes of 1/255.
    wrap
        What lies outside [0, 1]: REPEAT, MIRRORED_REPEAT or CLAMP_TO_EDGE; one name,
        or one for each of s, t and r.
    mag_filter
        NEAREST or LINEAR, where texels are larger than pixels.
    min_filter
        Where they are smaller: NEAREST or LINEAR of the texture itself, or in the four
        forms NEAREST_MIPMAP_NEAREST, LINEAR_MIPMAP_NEAREST, NEAREST_MIPMAP_LINEAR and
        LINEAR_MIPMAP_LINEAR of smaller copies of it: the first word is the filter
        within a level, the last that between levels.
    matrix
        Shape (4, 4), applied to (s, t, r, 1) before the lookup; the last row is
        0 0 0 1.
    """

    texels: Any
    wrap: Wrap | tuple[Wrap, ...] = "REPEAT"
    mag_filter: Filter = "LINEAR"
    min_filter: MinFilter = "LINEAR"
    matrix: Annotated[Array, Shape(4, 4)] = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        texels = np.asarray(self.texels)
        kept = texels if texels.dtype == np.uint8 else check("texels", texels, Array)
        if not (kept.ndim in (3, 4) and kept.size and kept.shape[-1] <= 4):
            expected = "shape (H, W, C) or (D, H, W, C), C from 1 to 4"
            raise ValueError(complaint("texels", expected, f"shape {texels.shape}"))
        if kept.size // kept.shape[-1] > MOST_TEXELS:
            expected = f"at most {MOST_TEXELS} texels"
            raise ValueError(complaint("texels", expected, f"shape {texels.shape}"))
        check_fields(self)
        object.__setattr__(self, "texels", kept)
        if isinstance(self.wrap, tuple) and len(self.wrap) != self.dimension:
            expected = f"one name, or {self.dimension}"
            raise ValueError(complaint("wrap", expected, f"{len(self.wrap)}"))
        if not np.array_equal(self.matrix[3], [0.0, 0.0, 0.0, 1.0]):
            raise ValueError(
                complaint("matrix", "a last row of 0 0 0 1", "a projection")
            )

    @property
    def dimension(self) -> int:
        """Give the number of coordinates, 2 or 3."""
        return self.texels.ndim - 1

    @property
    def wraps(self) -> tuple[str, ...]:
        """Give the wrap of s, t and r."""
        if isinstance(self.wrap, tuple):
            return self.wrap
        return (self.wrap,) * self.dimension

    @functools.cached_property
    def moves(self) -> bool:
        """Tell whether the matrix changes coordinates."""
        return not np.array_equal(self.matrix, np.eye(4))

    @property
    def levels(self) -> tuple[Array, ...]:
        """Give what is looked up: level 0, and the smaller ones where there are some.

        Those of codes are rounded to codes, ties to even.
        """
        codes = self.texels.dtype == np.uint8
        first = self.texels / CODES if codes else self.texels
        if "MIPMAP" not in self.min_filter:
            return (first,)
        if codes:
            every = mip_levels(self.texels.astype(np.float64))
            return tuple(np.rint(level) / CODES for level in every)
        return mip_levels(first)

    @functools.cached_property
    def tables(self) -> dict[str, list[Array]]:
        """Give the levels as they are looked up, by kind of float.

        Each has a border of one texel around, by `wrap`: a lookup of two neighbours
        then needs no care at edges. A texel's channels lie side by side: they are
        fetched in one piece.
        """
        exact = [self._bordered(level) for level in self.levels]
        return {"f8": exact, "f4": [table.astype("f4") for table in exact]}

    def _bordered(self, level: Array) -> Array:
        for axis, wrap in zip((-2, -3, -4), self.wraps, strict=False):
            width = [(0, 0)] * level.ndim
            width[axis] = 1, 1
            level = np.pad(level, width, BORDER[wrap])
        return np.ascontiguousarray(level, np.float64)

    @functools.cached_property
    def largest(self) -> float:
        """Give the largest number in it, whatever its sign."""
        return max(float(np.abs(table).max()) for table in self.tables["f8"])
