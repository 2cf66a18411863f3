"""Samples on a grid: exact for polynomials, and fourth differences bound the error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.noise import uniform
from refcloud.raster.between import (
    BEYOND,
    FAR,
    HANDED_ON,
    LEAST_RISE,
    ONE_SIDED,
    PER_FOURTH,
    SIZES,
    Fourth,
    Samples,
    by_quarter,
    inside,
    lattice,
    least_step,
    quarter_places,
    samples_for,
)
from refcloud.raster.tile_lists import (
    PIXELS,
    SIDE,
    Discs,
    parts,
    ranges_of,
    tile_lists,
)
from refcloud.raster.tiles import composite, pixel_places

SIZE = 80, 64  # 5 x 4 tiles, 3 x 2 of them inside
every_count = pytest.mark.parametrize("n", SIZES)


def joined(grid):
    """Give x and y of a tile's pixels, and of its samples after them."""
    return tuple(map(np.concatenate, zip(pixel_places(), grid.places, strict=True)))


def between(grid, lists, at):
    """Fill the inner tiles up from samples of all; and largest differences."""
    samples = Samples(grid, lists.box, 3, 1)
    every = np.arange(len(lists.count))
    samples.put(lists, every, at[:, :3, PIXELS:], at[:, 3:, PIXELS:])
    inner = np.flatnonzero(inside(lists))
    around = samples.around(lists, inner)
    fourth = Fourth.of(samples, around)
    tiles = samples.either(fourth.of_tiles())
    ways = samples.either(fourth.down), samples.either(fourth.across)
    of_quarters = Fourth(grid, *ways).of_quarters()
    # A tile whose largest difference is small has no quarter with a larger one.
    assert (of_quarters <= tiles).all()
    return inner, samples.pixels(around).transpose(1, 0, 2), of_quarters


@every_count
@pytest.mark.parametrize("degree", [(0, 0), (1, 2), (5, 5), (5, 0), None])
def test_polynomials_to_the_fifth_degree_are_exact(n, degree) -> None:
    discs = Discs(np.array([40.0]), np.array([32.0]), np.array([500.0]))
    (lists,) = parts(discs, *SIZE)
    x, y = joined(lattice(n))
    x = (x + lists.column[:, None] * SIDE) / 40.0 - 0.8
    y = (y + lists.row[:, None] * SIDE) / 32.0 - 0.8
    # A kink, as at a rim, is none.
    exact = (
        np.maximum(x, 0.0) ** 2 if degree is None else x ** degree[0] * y ** degree[1]
    )
    exact = np.repeat(exact[:, None], 4, axis=1)
    inner, pixels, _ = between(lattice(n), lists, exact)
    error = np.abs(pixels - exact[inner, :, :PIXELS]).max()
    assert len(inner) == 6
    assert error < 2e-6 if degree is not None else error > 2e-5


@every_count
def test_samples_are_equally_spaced_from_tile_to_tile(n: int) -> None:
    along = lattice(n).along
    both = np.concatenate([along, along + SIDE])
    np.testing.assert_allclose(np.diff(both), lattice(n).step, rtol=1e-13)


def test_quarters_are_all_pixels_once() -> None:
    for axis in range(2):
        pixels = by_quarter(pixel_places()[axis][None, None])[0, :, :, 0]
        for row, column in np.ndindex(2, 2):
            middle = SIDE // 2 * ((row if axis else column) - 0.5)
            found = quarter_places()[axis].reshape(SIDE // 2, SIDE // 2)
            np.testing.assert_array_equal(pixels[row, column] - middle, found)


def test_lists_of_quarters_hold_every_ball_that_reaches_them() -> None:
    k = np.arange(60)
    x, y = (uniform(k, axis, seed=4) * side for axis, side in enumerate(SIZE))
    discs = Discs(x, y, 2.0 + 12.0 * uniform(k, 2, seed=4))
    (lists,) = parts(discs, *SIZE)
    tile, row, column = (
        index.ravel() for index in np.indices((len(lists.count), 2, 2))
    )
    found = lists.quarters(tile, row, column, discs)
    half, box = SIDE // 2, (0, 10, 0, 8)
    ranges = ranges_of(discs, *SIZE, edge=half)
    small = tile_lists(discs, ranges, ranges.tiles(), box, edge=half)
    expected = {
        (r, c): small.ball[first : first + count].tolist()
        for r, c, first, count in zip(
            small.row, small.column, small.first, small.count, strict=True
        )
    }
    for q, (r, c) in enumerate(zip(found.row, found.column, strict=True)):
        mine = found.ball[found.first[q] : found.first[q] + found.count[q]].tolist()
        # The first ball of the tile stays, so that no list is empty.
        want = expected.get((r, c), [])
        assert want in (mine, mine[1:])
    assert found.edge == SIDE // 2
    assert found.box == tuple(2 * side for side in lists.box)


def test_a_lattice_has_steps_up_to_the_one_asked_for() -> None:
    for step in (0.1, 2.0, 2.1, 3.0, 3.9, 4.0, 100.0):
        found = samples_for(step)
        assert found.step <= max(step, least_step())
        assert all(lattice(n).step > step for n in SIZES if n < found.n)


def test_what_samples_beside_a_tile_hand_on() -> None:
    # At a pixel, the weights of samples outside the tile, summed: worst at a corner.
    worst = []
    for n in SIZES:
        every = np.abs(lattice(n).to_pixels)
        across, own = every.sum(axis=0), every[BEYOND:-BEYOND].sum(axis=0)
        worst.append((np.outer(across, across) - np.outer(own, own)).max())
    assert 0.99 * HANDED_ON < max(worst) <= HANDED_ON


def test_what_errors_of_one_sign_make_between_samples() -> None:
    # The worst errors from 0 to 1 are 1 where the pixel's weight is positive.
    made = []
    for n in SIZES:
        weights = np.einsum("ij,kl->jlik", lattice(n).to_pixels, lattice(n).to_pixels)
        more = np.maximum(weights, 0.0).sum(axis=(2, 3)).max()
        less = np.minimum(weights, 0.0).sum(axis=(2, 3)).min()
        made.append(max(more, -less))
    assert 0.999 * ONE_SIDED < max(made) <= ONE_SIDED


@every_count
def test_what_counts_for_the_pixels_of_a_half(n: int) -> None:
    # Of either half: all samples that a pixel lies next to count in full; the others to
    # one side of it weigh no more than `FAR` together, and those it does not use 0.
    grid, half = lattice(n), SIDE // 2
    for i, counted in enumerate(grid.counted):
        weights = np.abs(grid.to_pixels[:, half * i : half * (i + 1)])
        assert ((counted > 0.0) == (weights > 0.0).any(axis=1)).all()
        full = np.flatnonzero(counted == 1.0)
        for pixel in weights.T:
            assert pixel[: full[0]].sum() <= FAR >= pixel[full[-1] + 1 :].sum()
        # The fourth differences around these samples, each by its middle.
        middles = np.arange(n + 2)[grid.halves[i]] + 2
        assert middles.tolist() == full.tolist()


@settings(max_examples=30)
@given(
    st.integers(0, 2**63 - 1),
    st.integers(1, 80),
    st.floats(0.5, 2.2),
    st.floats(-1.0, 1.5),
    st.sampled_from(["chord", "profile"]),
    st.sampled_from(["beer", "linear"]),
    st.booleans(),
    st.sampled_from(SIZES),
)
def test_fourth_differences_bound_the_error(
    seed, count, power, depth, name, law, striped, n
):
    k, grid = np.arange(count), lattice(n)
    radius = 10.0**power * (0.6 + 0.8 * uniform(k, 0, seed=seed))
    tau = 10.0**depth * (0.5 + uniform(k, 1, seed=seed))
    x, y = (
        (1.4 * uniform(k, 2 + axis, seed=seed) - 0.2) * side
        for axis, side in enumerate(SIZE)
    )
    colours = uniform(k[:, None], 4 + np.arange(3), seed=seed)
    if striped:  # dark and bright in turn: nothing cancels
        colours = np.repeat((k % 2)[:, None] * 1.0, 3, axis=1)
    discs, how = Discs(x, y, radius), {"name": name, "law": law}
    for lists in parts(discs, *SIZE):
        drawn = composite(lists, discs, tau, colours, joined(grid), **how)
        exact = np.concatenate([drawn.light, drawn.clear[:, None]], axis=1)
        inner, pixels, fourth = between(grid, lists, exact)
        rise = (radius / np.sqrt(np.maximum(tau, 1.0)))[lists.ball]
        rise = np.minimum.reduceat(rise, lists.first)[inner]
        serves = rise >= LEAST_RISE * grid.step
        off = np.abs(pixels - exact[inner, :, :PIXELS])
        off = off.reshape(len(inner), 4, 2, 8, 2, 8).max(axis=(3, 5))
        off = off.transpose(2, 3, 1, 0)  # by quarter, channel, tile
        # Smaller errors than this no tolerance of float32 asks about.
        for error, bound in (
            (off[:, :, :3].max(axis=2), fourth[:, :, 0]),
            (off[:, :, 3], fourth[:, :, 1]),
        ):
            assert (error <= PER_FOURTH[n] * bound + 3e-4)[..., serves].all()
