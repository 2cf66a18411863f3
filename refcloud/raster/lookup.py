"""Looking textures up: which level, which texels, how they are mixed."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.texture import Texture

PLACES = Range(-1e100, 1e100)
LEAST = 2.0**-100  # texels to a pixel: of anything smaller the logarithm is no matter


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
    return found.reshape(*leading, found.shape[1])


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
    if d <= k and not texture.moves:
        return coords[:d]
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


def looked_up(
    texture: Texture, coords: Array, levels: Array | None, kind: str = "f8"
) -> Array:
    """Look up by the filter that each level of detail asks for, unchecked.

    Parameters
    ----------
    texture
        Of d coordinates and C channels.
    coords
        After the matrix, shape (d, n).
    levels
        log2 of texels to a pixel, shape (n,); None magnifies.
    kind
        f8, or f4 for texels and their mixing in float32.

    Returns
    -------
    Shape (n, C).
    """
    mag, (minify, *mipmap) = texture.mag_filter, texture.min_filter.split("_MIPMAP_")
    between = mipmap[0] if mipmap else None
    if levels is None or (between is None and minify == mag):
        return at_level(texture, 0, mag, coords, kind)
    # 1. Which filter: the limit is half a level where a sharp level would follow.
    limit = 0.5 if mag == "LINEAR" and minify == "NEAREST" and between else 0.0
    smaller = levels > limit
    if not smaller.any():
        return at_level(texture, 0, mag, coords, kind)
    # 2. Which level, and which share of the next smaller one.
    smallest = len(texture.tables[kind]) - 1 if between else 0
    held = np.clip(levels, 0.0, float(smallest))
    lower = np.ceil(held + 0.5) - 1.0 if between == "NEAREST" else np.floor(held)
    share = held - lower if between == "LINEAR" else np.zeros_like(held)
    # 3. All of one level at a time. A texel's channels are put in their place in one
    #    piece: numpy copies rows of a list of places ten times as slowly.
    found = np.empty((len(levels), texture.texels.shape[-1]), kind)
    piece = np.dtype((np.void, found.itemsize * found.shape[1]))
    pieces = found.view(piece)[:, 0]
    large = np.flatnonzero(~smaller)
    if large.size:
        texels = at_level(texture, 0, mag, coords.take(large, axis=1), kind)
        pieces[large] = texels.view(piece)[:, 0]
    for level in np.unique(lower[smaller]).astype(int):
        here = np.flatnonzero(smaller & (lower == level))
        places = coords.take(here, axis=1)
        texels = at_level(texture, level, minify, places, kind)
        part = share.take(here).astype(kind)
        if part.any():  # a share of 0 adds nothing, in the last level as well
            next_level = min(level + 1, smallest)
            change = at_level(texture, next_level, minify, places, kind)
            change -= texels
            change *= part[:, None]
            texels += change
        pieces[here] = texels.view(piece)[:, 0]
    return found


def at_level(
    texture: Texture, level: int, filter: str, coords: Array, kind: str
) -> Array:
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
    kind
        f8 or f4.

    Returns
    -------
    Shape (n, C).
    """
    table = texture.tables[kind][level]
    channels = table.shape[-1]
    texels = table.reshape(-1, channels)
    # 1. Into [0, 1], then to texels; the border makes up for one texel beyond.
    place, strides, shares = 0, [], []
    for a, wrap in enumerate(texture.wraps):
        size, stride = table.shape[-2 - a], math.prod(table.shape[-1 - a : -1])
        x = within_one(coords[a], wrap)
        x *= size - 2
        x += 1.0 if filter == "NEAREST" else 0.5
        whole = np.floor(x)
        x -= whole
        strides.append(stride)
        if filter == "LINEAR":  # one for each channel: they are mixed side by side
            spread = np.empty((len(x), channels), kind)
            for channel in range(channels):
                spread[:, channel] = x
            shares.append(spread)
        whole *= stride
        whole += place
        place = whole
    # Numpy makes whole numbers of 32 bits of floats much faster than those of 64.
    index = np.asarray(place).astype(np.int32).astype(np.intp)
    # 2. Mix the corners, first along s, then along t, then along r.
    if filter == "NEAREST":
        return texels.take(index, axis=0)
    return _mixed(texels, index, strides, shares)


def _mixed(
    texels: Array, index: NDArray[np.intp], strides: list[int], shares: list[Array]
) -> Array:
    """Interpolate between a texel and its neighbours along each axis."""
    if not strides:
        return texels.take(index, axis=0)
    low = _mixed(texels, index, strides[:-1], shares[:-1])
    high = _mixed(texels[strides[-1] :], index, strides[:-1], shares[:-1])
    high -= low
    high *= shares[-1]
    high += low
    return high


def within_one(coords: Array, wrap: str) -> Array:
    """Bring a coordinate into [0, 1] as a texture repeats, mirrors or ends; a copy."""
    if wrap == "CLAMP_TO_EDGE":
        return np.clip(coords, 0.0, 1.0)
    if wrap == "REPEAT":
        return coords - np.floor(coords)
    turned = coords - 2.0 * np.floor(0.5 * coords)
    return np.minimum(turned, 2.0 - turned)
