"""The pixels that a picture with a tolerance is held to are the exact ones."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.lighting import sampled_pixels
from refcloud.lighting.flat_tiles import Flat, exact_tiles
from refcloud.lighting.look import Look
from refcloud.lighting.sampled_pixels import (
    SAMPLE_PIXELS,
    exact_pixels,
    hashed_pixels,
    hashed_tiles,
)
from refcloud.noise import uniform
from refcloud.raster.tile_lists import PIXELS, Discs, parts
from refcloud.raster.tiles import pixel_places

SIZE = 96, 64


def scene(seed: int, count: int, depth: float, look: Look) -> Flat:
    """Scatter balls, with a depth of their own in every channel."""
    k = np.arange(count)
    x, y = (uniform(k, a, seed=seed) * side for a, side in enumerate(SIZE))
    radius = 3.0 + 30.0 * uniform(k, 2, seed=seed)
    tau = [depth * (0.5 + uniform(k, 3 + a, seed=seed)) for a in range(2)]
    colours = uniform(np.arange(3)[:, None], k, seed=seed)
    lights, shown = [colours[:2], colours[2:]], [(0, 1.0), (1, 1.0), (2, 1.0)]
    return Flat(Discs(x, y, radius), tau, lights, shown, [[0, 1], [2]], look)


@settings(max_examples=20)
@given(
    st.integers(0, 2**63 - 1),
    st.integers(1, 60),
    st.sampled_from([1e-9, 0.3, 2.0, 40.0, 1e5, 1e37]),
    st.sampled_from(["chord", "profile"]),
    st.sampled_from(["beer", "linear"]),
)
def test_they_are_those_of_the_tiles(seed, count, depth, name, law) -> None:
    look = dataclasses.replace(Look(), footprint=name, transmittance=law)
    flat = scene(seed, count, depth, look)
    (lists,) = parts(flat.discs, *SIZE)
    every, at = exact_tiles(lists, flat, 0.0), hashed_pixels()
    some = hashed_tiles(lists, 5)
    x, y = pixel_places()
    light, clear = exact_pixels(lists, some, flat, (x[at], y[at]))
    # Sums of logarithms down to -800 for each ball round by 1e-13 of theirs.
    close = {"rtol": 0.0, "atol": 1e-12 + 1e-14 * count * min(depth, 800.0)}
    np.testing.assert_allclose(light, every.light[some][..., at], **close)
    np.testing.assert_allclose(clear, every.clear[some][..., at], **close)


def test_parts_of_bounded_size_make_no_difference(monkeypatch) -> None:
    flat = scene(3, 50, 1.0, Look())
    (lists,) = parts(flat.discs, *SIZE)
    some, places = hashed_tiles(lists, 6), pixel_places()
    whole = exact_pixels(lists, some, flat, places)
    for together in (1, 1000):
        monkeypatch.setattr(sampled_pixels, "TOGETHER", together)
        for one, other in zip(
            whole, exact_pixels(lists, some, flat, places), strict=True
        ):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("count", [1, 4, 100])
def test_tiles_and_pixels_are_chosen_once_each(count: int) -> None:
    (lists,) = parts(scene(1, 40, 1.0, Look()).discs, *SIZE)
    tiles = hashed_tiles(lists, count)
    assert len(tiles) == min(count, len(lists.count)) == len(set(tiles.tolist()))
    pixels = hashed_pixels().tolist()
    assert len(pixels) == SAMPLE_PIXELS == len(set(pixels))
    assert all(0 <= pixel < PIXELS for pixel in pixels)
