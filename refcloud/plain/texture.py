"""Textures, looked up at one place at a time.

Each function is the twin of the one of the same name in `refcloud.raster`. Texels are
nested lists, of rows, or of layers of rows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

Texels = Any  # [row][column][channel], or [layer][row][column][channel]


class Texture(NamedTuple):
    """Texels, and how they are looked up; twin of `refcloud.raster.Texture`."""

    texels: Texels
    wraps: tuple[str, ...]
    mag_filter: str
    min_filter: str
    matrix: Sequence[Sequence[float]]


def sides(texels: Texels, dimension: int) -> list[int]:
    """Give width, height and depth."""
    found = []
    for _ in range(dimension):
        found.append(len(texels))
        texels = texels[0]
    return found[::-1]


def wrapped(index: int, size: int, wrap: str) -> int:
    """Find the texel that stands at an index beyond the edges."""
    if wrap == "REPEAT":
        return index % size
    if wrap == "CLAMP_TO_EDGE":
        return min(max(index, 0), size - 1)
    turned = index % (2 * size)
    return min(turned, 2 * size - 1 - turned)


def nearest(
    texels: Texels, coords: Sequence[float], wraps: Sequence[str]
) -> list[float]:
    """Give the texel that a place lies in."""
    *rest, c = coords
    place = wrapped(math.floor(c * len(texels)), len(texels), wraps[len(rest)])
    return nearest(texels[place], rest, wraps) if rest else texels[place]


def linear(
    texels: Texels, coords: Sequence[float], wraps: Sequence[str]
) -> list[float]:
    """Mix the texels about a place, each by its nearness."""
    *rest, c = coords
    size, wrap = len(texels), wraps[len(rest)]
    low = math.floor(c * size - 0.5)
    share = c * size - 0.5 - low
    pair = [texels[wrapped(low + k, size, wrap)] for k in (0, 1)]
    a, b = (linear(texel, rest, wraps) for texel in pair) if rest else pair
    return [(1.0 - share) * x + share * y for x, y in zip(a, b, strict=True)]


def mixed(parts: Sequence[Any], weights: Sequence[float]) -> Any:
    """Mix texels, rows or layers."""
    if isinstance(parts[0], (list, tuple)):
        return [mixed(inner, weights) for inner in zip(*parts, strict=True)]
    return sum(w * x for w, x in zip(weights, parts, strict=True))


def half(texels: Texels, dimension: int) -> Texels:
    """Halve every side: means of two, or of what covers an odd one."""
    if dimension > 1:
        texels = [half(part, dimension - 1) for part in texels]
    size = len(texels)
    m = size // 2
    if m == 0:
        return texels
    if size == 2 * m:
        pairs = zip(texels[::2], texels[1::2], strict=True)
        return [mixed(pair, (0.5, 0.5)) for pair in pairs]
    return [
        mixed(texels[2 * i : 2 * i + 3], ((m - i) / size, m / size, (i + 1) / size))
        for i in range(m)
    ]


def mip_levels(texels: Texels, dimension: int) -> list[Texels]:
    """List the levels, from the texture to a single texel."""
    levels = [texels]
    while max(sides(levels[-1], dimension)) > 1:
        levels.append(half(levels[-1], dimension))
    return levels


def transformed(texture: Texture, coords: Sequence[float], one: float) -> list[float]:
    """Apply the texture matrix to a place, one = 1, or to a difference, one = 0."""
    place = [*coords, *[0.0] * (3 - len(coords)), one]
    rows = texture.matrix[: len(texture.wraps)]
    return [sum(m * x for m, x in zip(row, place, strict=True)) for row in rows]


def level_of_detail(
    texture: Texture, along_x: Sequence[float], along_y: Sequence[float]
) -> float:
    """Give log2 of texels to a pixel."""
    size = sides(texture.texels, len(texture.wraps))
    lengths = []
    for way in (along_x, along_y):
        moved = transformed(texture, way, 0.0)
        lengths.append(math.hypot(*(n * x for n, x in zip(size, moved, strict=True))))
    return math.log2(max(*lengths, 2.0**-100))


def sample(
    texture: Texture, coords: Sequence[float], level: float | None = None
) -> list[float]:
    """Look a texture up at one place and one level of detail."""
    place, wraps = transformed(texture, coords, 1.0), texture.wraps
    minify, _, between = texture.min_filter.partition("_MIPMAP_")
    sharp = texture.mag_filter == "LINEAR" and minify == "NEAREST" and between
    within = {"NEAREST": nearest, "LINEAR": linear}
    if level is None or level <= (0.5 if sharp else 0.0):
        return within[texture.mag_filter](texture.texels, place, wraps)
    if not between:
        return within[minify](texture.texels, place, wraps)
    levels = mip_levels(texture.texels, len(wraps))
    held = min(max(level, 0.0), len(levels) - 1.0)
    if between == "NEAREST":
        return within[minify](levels[math.ceil(held + 0.5) - 1], place, wraps)
    low = math.floor(held)
    pair = levels[low], levels[min(low + 1, len(levels) - 1)]
    a, b = (within[minify](texels, place, wraps) for texels in pair)
    return [x + (held - low) * (y - x) for x, y in zip(a, b, strict=True)]
