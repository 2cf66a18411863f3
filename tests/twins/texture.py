"""Textures beside their plain twins."""

from __future__ import annotations

import typing

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud import raster
from refcloud.plain import texture as plain
from refcloud.raster import texture as room
from refcloud.raster.lookup import transformed
from twins import Draw, twin

WITHOUT: dict[str, str] = {}

sides = st.integers(1, 7)
wraps = st.sampled_from(typing.get_args(room.Wrap))
texels = st.floats(-2.0, 2.0)
coordinate = st.floats(-4.0, 4.0) | st.integers(-16, 16).map(lambda n: n / 8.0)
CLEAR = 1e-6  # of a texel, and of a level: nearer ones may be rounded either way


def drawn_texture(draw: Draw) -> tuple[raster.Texture, plain.Texture]:
    """Draw a texture in the plane or in space, with any filters."""
    dimension = draw(st.sampled_from([2, 2, 3]))
    shape = (*draw(st.tuples(*[sides] * dimension)), draw(st.integers(1, 4)))
    values = draw(arrays(np.float64, shape, elements=texels))
    every = tuple(draw(st.tuples(*[wraps] * dimension)))
    mag = draw(st.sampled_from(typing.get_args(room.Filter)))
    minify = draw(st.sampled_from(typing.get_args(room.MinFilter)))
    matrix = np.eye(4)
    if draw(st.booleans()):
        matrix[:3] = draw(arrays(np.float64, (3, 4), elements=st.floats(-2.0, 2.0)))
    found = raster.Texture(values, every, mag, minify, matrix)
    return found, plain.Texture(values.tolist(), every, mag, minify, matrix.tolist())


def assume_clear(texture: raster.Texture, coords: np.ndarray) -> None:
    """Leave out places where one texel ends and the next begins, in any level."""
    if "NEAREST" in texture.min_filter + texture.mag_filter:
        place = transformed(texture, coords.T)
        for level in texture.levels:
            for c, size in zip(place, level.shape[-2::-1], strict=True):
                assume((np.abs((c * size + 0.5) % 1.0 - 0.5) > CLEAR).all())


@twin(
    raster.sample,
    plain.sample,
    tolerance=1e-12,
    why="places of up to 70 texels, wrapped before or after: 70 times 2^-53, mixed",
)
def sample(draw: Draw):
    texture, plainly = drawn_texture(draw)
    k = draw(st.sampled_from([2, 3]))
    coords = np.array(draw(st.lists(st.tuples(*[coordinate] * k), max_size=3)))
    coords = coords.reshape(-1, k)
    assume_clear(texture, coords)
    chosen = draw(st.sampled_from(["none", "level", "derivatives"]))
    levels: list = [None] * len(coords)
    how = {}
    if chosen == "level":
        levels = [draw(st.floats(-2.0, 5.0)) for _ in coords]
        how = {"level": np.array(levels, np.float64)}
    elif chosen == "derivatives":
        size = st.floats(-1.0, 1.0).filter(lambda x: abs(x) > 1e-3)
        ways = [draw(arrays(np.float64, coords.shape, elements=size)) for _ in "xy"]
        how = {"along_x": ways[0], "along_y": ways[1]}
        pairs = zip(ways[0].tolist(), ways[1].tolist(), strict=True)
        levels = [plain.level_of_detail(plainly, *pair) for pair in pairs]
    for level in levels:  # where another filter or level takes over
        assume(level is None or abs((2.0 * level + 0.5) % 1.0 - 0.5) > CLEAR)
    pairs = zip(coords.tolist(), levels, strict=True)
    expected = [plain.sample(plainly, place, level) for place, level in pairs]
    channels = texture.texels.shape[-1]
    found = raster.sample(texture, coords, **how)
    return found, np.array(expected).reshape(-1, channels)


@twin(raster.mip_levels, plain.mip_levels, tolerance=1e-14, why="the same means")
def mip_levels(draw: Draw):
    dimension = draw(st.sampled_from([2, 3]))
    shape = (*draw(st.tuples(*[sides] * dimension)), 2)
    values = draw(arrays(np.float64, shape, elements=texels))
    found = [level.ravel() for level in raster.mip_levels(values)]
    expected = plain.mip_levels(values.tolist(), dimension)
    flat = [np.array(level).ravel() for level in expected]
    return np.concatenate(found), np.concatenate(flat)
