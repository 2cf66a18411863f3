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
from numpy.typing import NDArray

from refcloud.checking import check, check_fields, checked, complaint
from refcloud.conventions import Array, Range, Shape
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
PLACES = Range(-1e100, 1e100)
LEAST = 2.0**-100  # texels to a pixel: of anything smaller the logarithm is no matter
# Texels beyond an edge, as a border of one texel shows them.
BORDER = {"REPEAT": "wrap", "MIRRORED_REPEAT": "symmetric", "CLAMP_TO_EDGE": "edge"}


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
    def tables(self) -> tuple[Array, ...]:
        """Give the levels with a border of one texel around, by `wrap`.

        A lookup of two neighbours then needs no care at edges.
        """
        return tuple(self._bordered(level) for level in self.levels)

    def _bordered(self, level: Array) -> Array:
        for axis, wrap in enumerate(reversed(self.wraps)):
            width = [(int(k == axis),) * 2 for k in range(level.ndim)]
            level = np.pad(level, width, BORDER[wrap])  # type: ignore[call-overload]
        return level


@checked
def sample(
    texture: Texture,
    coords: Annotated[Array, Shape("...", "k"), PLACES],
    *,
    along_x: Annotated[Array, Shape("...", "k"), PLACES] | None = None,
    along_y: Annotated[Array, Shape("...", "k"), PLACES] | None = None,
    level: Annotated[Array, Shape("...")] | float | None = None,
) -> Array:
    """Look a texture up.

    Formula: NEAREST texel floor(s W); LINEAR the texels about s W - 1/2, each by its
    nearness; level log2 max(|d(s W, t H)/dx|, |d(s W, t H)/dy|)

    Parameters
    ----------
    texture
        The texels, their filters, wrap and matrix.
    coords
        s, t or s, t, r, shape (..., 2) or (..., 3); a missing r is 0, and of three the
        matrix makes as many as the texture has.
    along_x, along_y
        Their change from pixel to pixel, the same shape: chooses between the filters
        and the level. None for both magnifies.
    level
        The level itself (textureLod), shape (...) or one number, in place of these.

    Returns
    -------
    Shape (..., C).

    Raises
    ------
    ValueError
        coords has other than 2 or 3 numbers, or only one of along_x and along_y is
        there.

    Source: OpenGL 4.6, section 8.14 and 8.15 (texture minification, magnification);
    paper S (F11), document C (F05, F06).

    Examples
    --------
    >>> ramp = Texture([[[0.0], [1.0]]], wrap="CLAMP_TO_EDGE")
    >>> sample(ramp, [[0.25, 0.5], [0.5, 0.5], [0.9, 0.5]])[:, 0]
    array([0. , 0.5, 1. ])
    """
    if coords.shape[-1] not in (2, 3):
        got = f"shape {coords.shape}"
        raise ValueError(complaint("coords", "shape (..., 2) or (..., 3)", got))
    if (along_x is None) != (along_y is None):
        raise ValueError(complaint("along_x", "both along_x and along_y", "one"))
    leading, k = coords.shape[:-1], coords.shape[-1]
    columns = coords.reshape(-1, k).T
    levels = None
    if level is not None:
        levels = np.broadcast_to(level, leading).ravel()
    elif along_x is not None and along_y is not None:
        levels = level_of_detail(
            texture, along_x.reshape(-1, k).T, along_y.reshape(-1, k).T
        )
    found = looked_up(texture, transformed(texture, columns), levels)
    return found.reshape(*leading, -1)


def transformed(texture: Texture, coords: Array, way: bool = False) -> Array:
    """Apply the texture matrix.

    Parameters
    ----------
    texture
        Of d coordinates.
    coords
        Shape (k, n), k being 2 or 3.
    way
        Whether they are differences, which a shift leaves as they are.

    Returns
    -------
    Shape (d, n).
    """
    d, k = texture.dimension, len(coords)
    turn, shift = texture.matrix[:d, :k], texture.matrix[:d, 3:]
    if np.array_equal(turn, np.eye(d, k)):
        padded = coords[:d] if d <= k else np.concatenate([coords, 0.0 * coords[:1]])
        return padded if way or not shift.any() else padded + shift
    # Without a matrix product: the same bits wherever a place stands in the list.
    moved = np.stack([sum(turn[a, b] * coords[b] for b in range(k)) for a in range(d)])
    return moved if way else moved + shift


def level_of_detail(texture: Texture, along_x: Array, along_y: Array) -> Array:
    """Give the level whose texels are about as large as a pixel.

    Parameters
    ----------
    texture
        Of d coordinates.
    along_x, along_y
        Change of the coordinates from pixel to pixel, before the matrix, shape (k, n).

    Returns
    -------
    log2 of texels to a pixel, shape (n,).
    """
    sides = np.array(texture.texels.shape[-2::-1], np.float64)[:, None]
    ways = (sides * transformed(texture, a, way=True) for a in (along_x, along_y))
    wide, high = (np.sqrt(np.square(way).sum(axis=0)) for way in ways)
    return np.log2(np.maximum(np.maximum(wide, high), LEAST))


def looked_up(texture: Texture, coords: Array, levels: Array | None) -> Array:
    """Look up by the filter that each level of detail asks for, unchecked.

    Parameters
    ----------
    texture
        Of d coordinates and C channels.
    coords
        After the matrix, shape (d, n).
    levels
        log2 of texels to a pixel, shape (n,); None magnifies.

    Returns
    -------
    Shape (n, C).
    """
    mag, (minify, *mipmap) = texture.mag_filter, texture.min_filter.split("_MIPMAP_")
    between = mipmap[0] if mipmap else None
    if levels is None or (between is None and minify == mag):
        return at_level(texture, 0, mag, coords)
    # 1. Which filter: the limit is half a level where a sharp level would follow.
    limit = 0.5 if mag == "LINEAR" and minify == "NEAREST" and between else 0.0
    smaller = levels > limit
    # 2. Which level, and which share of the next smaller one.
    lower, share = np.zeros(len(levels), np.int64), np.zeros(len(levels))
    if between:
        last = float(len(texture.tables) - 1)
        held = np.clip(levels, 0.0, last)
        lower = (np.ceil(held + 0.5) - 1.0 if between == "NEAREST" else held).astype(
            np.int64
        )
        lower = np.minimum(lower, int(last))
        share = held - lower if between == "LINEAR" else share
    # 3. All of one level at a time.
    found = np.empty((len(levels), texture.texels.shape[-1]))
    large = np.flatnonzero(~smaller)
    found[large] = at_level(texture, 0, mag, coords[:, large])
    for level in np.unique(lower[smaller]):
        here = np.flatnonzero(smaller & (lower == level))
        found[here] = at_level(texture, level, minify, coords[:, here])
        here = here[share[here] > 0.0]
        if here.size:
            next_one = at_level(texture, level + 1, minify, coords[:, here])
            found[here] += share[here, None] * (next_one - found[here])
    return found


def at_level(texture: Texture, level: int, filter: str, coords: Array) -> Array:
    """Look up within one level.

    Parameters
    ----------
    texture
        Of d coordinates and C channels.
    level
        0 for the largest.
    filter
        NEAREST or LINEAR.
    coords
        Shape (d, n).

    Returns
    -------
    Shape (n, C).
    """
    table = texture.tables[level]
    flat = table.reshape(-1, table.shape[-1])
    # 1. Into [0, 1], then to texels; the border makes up for one texel beyond.
    base = np.zeros(coords.shape[1], np.int64)
    stride, strides, shares = 1, [], []
    for a, wrap in enumerate(texture.wraps):
        size = table.shape[-2 - a]
        x = within_one(coords[a], wrap) * (size - 2)
        if filter == "LINEAR":
            x = x + 0.5
            whole = np.floor(x)
            shares.append((x - whole)[:, None])
            base += stride * whole.astype(np.int64)
        else:
            base += stride * (np.floor(x) + 1.0).astype(np.int64)
        strides.append(stride)
        stride *= size
    # 2. Mix the corners, first along s, then along t, then along r.
    if filter == "NEAREST":
        return flat.take(base, axis=0)
    return _mixed(flat, base, strides, shares)


def _mixed(flat: Array, base: NDArray[np.int64], strides: list, shares: list) -> Array:
    """Interpolate between a texel and its neighbours along each axis."""
    if not strides:
        return flat.take(base, axis=0)
    *strides, stride = strides
    *shares, share = shares
    low = _mixed(flat, base, strides, shares)
    high = _mixed(flat, base + stride, strides, shares)
    high -= low
    high *= share
    high += low
    return high


def within_one(coords: Array, wrap: str) -> Array:
    """Bring a coordinate into [0, 1] as a texture repeats, mirrors or ends."""
    if wrap == "CLAMP_TO_EDGE":
        return np.clip(coords, 0.0, 1.0)
    if wrap == "REPEAT":
        return coords - np.floor(coords)
    turned = coords - 2.0 * np.floor(0.5 * coords)
    return np.minimum(turned, 2.0 - turned)
