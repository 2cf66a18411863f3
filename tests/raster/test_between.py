"""Every second pixel: exact for polynomials, and fourth differences bound the error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.noise import uniform
from refcloud.raster.between import (
    FROM_ROW,
    HANDED_ON,
    LEAST_RISE,
    ONE_SIDED,
    PER_FOURTH,
    STEP,
    TOGETHER,
    Samples,
    fourth_differences,
    halfway,
    inside,
    largest_of_quarters,
    largest_of_tiles,
    quarters,
    sampled,
)
from refcloud.raster.tile_lists import PIXELS, SIDE, Discs, parts
from refcloud.raster.tiles import composite, pixel_places

SIZE = 80, 64  # 5 x 4 tiles, 3 x 2 of them inside


def pictures(lists, discs, tau, colours, name, law):
    """Draw all tiles at their pixels: light and clear, (T, 4, 256)."""
    how = {"name": name, "law": law}
    drawn = composite(lists, discs, tau, colours, pixel_places(), **how)
    return np.concatenate([drawn.light, drawn.clear[:, None]], axis=1)


def between(lists, exact):
    """Fill the inner tiles up from every second pixel of all."""
    samples = Samples(lists.box, 3, 1)
    every = np.arange(len(lists.count))
    at = exact[..., sampled()[0]]
    samples.put(lists, every, at[:, :3], at[:, 3:])
    inner = np.flatnonzero(inside(lists))
    around = samples.around(lists, inner)
    fourth = fourth_differences(around)
    tiles = samples.either(largest_of_tiles(fourth))
    quarters = [
        largest_of_quarters(of)
        for of in zip(*(samples.either(each) for each in fourth), strict=True)
    ]
    # A tile whose largest difference is small has no quarter with a larger one.
    for of_tile, of_quarters in zip(tiles, quarters, strict=True):
        assert (of_quarters <= of_tile).all()
    return inner, halfway(around).transpose(1, 0, 2), quarters


@pytest.mark.parametrize("degree", [(0, 0), (1, 2), (5, 5), (5, 0), (12, 0)])
def test_polynomials_to_the_fifth_degree_are_exact(degree) -> None:
    discs = Discs(np.array([40.0]), np.array([32.0]), np.array([500.0]))
    (lists,) = parts(discs, *SIZE)
    x, y = pixel_places()
    x = (x + lists.column[:, None] * SIDE) / 40.0 - 0.8
    y = (y + lists.row[:, None] * SIDE) / 32.0 - 0.8
    exact = np.repeat((x ** degree[0] * y ** degree[1])[:, None], 4, axis=1)
    inner, pixels, _ = between(lists, exact)
    error = np.abs(pixels - exact[inner]).max()
    assert len(inner) == 6
    assert error < 1e-6 if max(degree) <= 5 else error > 1e-6


def test_quarters_and_samples_are_all_pixels_once() -> None:
    parted, places = quarters(), pixel_places()
    every = np.concatenate([sampled()[0], *parted.pixels])
    assert sorted(every.tolist()) == list(range(PIXELS))
    for axis in range(2):
        moved = parted.moved[axis][:, None] + parted.places[axis]
        np.testing.assert_array_equal(moved, places[axis][parted.pixels])


def test_no_product_is_large_enough_for_a_second_thread() -> None:
    assert TOGETHER * FROM_ROW.shape[0] * FROM_ROW.size < 2**18


def test_what_samples_beside_a_tile_hand_on() -> None:
    # At a pixel, the weights of samples outside the tile, summed: worst at a corner.
    own = slice(2, 2 + SIDE // STEP)
    across = np.abs(FROM_ROW).sum(axis=0)
    inside = np.abs(FROM_ROW[own]).sum(axis=0)
    outside = np.outer(across, across) - np.outer(inside, inside)
    assert 1.4 < outside.max() <= HANDED_ON


def test_what_errors_of_one_sign_make_between_samples() -> None:
    # The worst errors from 0 to 1 are 1 where the pixel's weight is positive.
    weights = np.einsum("ij,kl->jlik", FROM_ROW, FROM_ROW)
    worst = np.maximum(weights, 0.0).sum(axis=(2, 3)).max()
    least = np.minimum(weights, 0.0).sum(axis=(2, 3)).min()
    assert 0.999 * ONE_SIDED < max(worst, -least) <= ONE_SIDED


@settings(max_examples=30)
@given(
    st.integers(0, 2**63 - 1),
    st.integers(1, 80),
    st.floats(0.5, 2.0),
    st.floats(-1.0, 1.5),
    st.sampled_from(["chord", "profile"]),
    st.sampled_from(["beer", "linear"]),
    st.booleans(),
)
def test_fourth_differences_bound_the_error(
    seed, count, power, depth, name, law, striped
):
    k = np.arange(count)
    radius = 10.0**power * (0.6 + 0.8 * uniform(k, 0, seed=seed))
    tau = 10.0**depth * (0.5 + uniform(k, 1, seed=seed))
    x, y = (
        (1.4 * uniform(k, 2 + axis, seed=seed) - 0.2) * side
        for axis, side in enumerate(SIZE)
    )
    colours = uniform(k[:, None], 4 + np.arange(3), seed=seed)
    if striped:  # dark and bright in turn: nothing cancels
        colours = np.repeat((k % 2)[:, None] * 1.0, 3, axis=1)
    discs = Discs(x, y, radius)
    for lists in parts(discs, *SIZE):
        exact = pictures(lists, discs, tau, colours, name, law)
        inner, pixels, fourth = between(lists, exact)
        rise = (radius / np.sqrt(np.maximum(tau, 1.0)))[lists.ball]
        rise = np.minimum.reduceat(rise, lists.first)[inner]
        serves = rise >= LEAST_RISE * STEP
        off = np.abs(pixels - exact[inner]).reshape(len(inner), 4, 2, 8, 2, 8)
        off = off.max(axis=(3, 5)).transpose(2, 3, 1, 0)  # by quarter, channel, tile
        # Smaller errors than this no tolerance of float32 asks about.
        for error, bound in (
            (off[:, :, :3].max(axis=2), fourth[0]),
            (off[:, :, 3], fourth[1]),
        ):
            assert (error <= PER_FOURTH * bound + 3e-4)[..., serves].all()
