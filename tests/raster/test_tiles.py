"""Tiles make the sums of the literal loop: every splat over what lies behind it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.noise import uniform
from refcloud.raster import framebuffer, splat, tile_lists, tiles
from refcloud.raster.canvas import Canvas
from refcloud.raster.quadratics import cancelling
from refcloud.raster.tile_lists import PIXELS, SIDE, Discs, parts, ranges_of
from refcloud.raster.tiles import composite, pixel_places

# Worst seen 9e-15 in 3000 scenes; the bound on a ball whose terms cancel is 1e-13.
CLOSE = 1e-12
NAMES, LAWS = ("chord", "profile"), ("beer", "linear")
every_form = pytest.mark.parametrize(
    ("name", "law"), list(itertools.product(NAMES, LAWS))
)
seeds = st.integers(0, 2**63 - 1)
# Pixels: much smaller than one, of a tile's size, and so wide that the rim is a line.
radii = st.floats(-2.0, 8.0) | st.floats(-0.5, 1.5)
depths = st.sampled_from([0.0, 1e-9, 0.3, 1.5, 8.0, 1e3, 1e37])


def scattered(seed: int, count: int, size: tuple[int, int], power: float, tau: float):
    """Scatter balls over a picture and a little beyond it, some of them much larger."""
    k = np.arange(count)
    spread = 0.5 + uniform(k, 2, seed=seed)
    radius = 10.0**power * spread
    x, y = (
        # Wide balls stand so far off that their rims run through the picture.
        (1.4 * uniform(k, axis, seed=seed) - 0.2) * side
        + radius * np.cos(6.3 * uniform(k, 3, seed=seed) + axis) * (power > 2.0)
        for axis, side in enumerate(size)
    )
    colours = uniform(k[:, None], 5 + np.arange(3), seed=seed)
    return Discs(x, y, radius), tau * (0.5 + uniform(k, 4, seed=seed)), colours


def tiled(size, discs, tau, colours, name, law, background=None, **how):
    """Draw by tiles; RGBA."""
    canvas = Canvas(*size, background)
    direct = cancelling(discs, tau, law, dtype=how.get("dtype", np.float64))
    unseen = 0
    for lists in parts(discs, *size):
        found = composite(
            lists,
            discs,
            tau,
            colours,
            pixel_places(),
            name=name,
            law=law,
            direct=direct,
            **how,
        )
        canvas.paint(lists, [[0, 1, 2]], found.light, found.clear[:, None])
        unseen += int(found.unseen.sum())
    return canvas.pixels(), unseen


def literally(size, discs, tau, colours, name, law, background=None):
    """Draw ball after ball, the farthest first; RGBA."""
    buffer = framebuffer(*size)
    if background is not None:
        buffer.pixels[..., :3], buffer.pixels[..., 3] = background, 1.0
    for k in range(len(tau))[::-1]:
        place = discs.x[k], discs.y[k], discs.radius[k]
        glow = colours[k] * -np.expm1(-tau[k])
        splat(buffer, *place, emission=glow, tau=tau[k], name=name, law=law)
    return buffer.pixels


@every_form
@settings(max_examples=20)
@given(seeds, st.integers(1, 40), radii, depths)
def test_tiles_equal_the_literal_loop(name, law, seed, count, power, tau) -> None:
    size = 53, 35  # neither whole tiles nor a square
    scene = scattered(seed, count, size, power, tau)
    background = uniform(np.arange(53 * 35 * 3), seed=seed).reshape(35, 53, 3)
    for behind in (None, background):
        found, _ = tiled(size, *scene, name, law, behind)
        expected = literally(size, *scene, name, law, behind)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=CLOSE)


@every_form
@settings(max_examples=20)
@given(seeds, st.floats(0.3, 1.8), st.floats(0.0, 8.0))
def test_in_float32_they_are_as_close_as_its_rounding(name, law, seed, power, tau):
    # Worst seen 2e-6 in 3000 scenes: 30 balls, whose terms grow as 150 / radius^2.
    size = 53, 35
    scene = scattered(seed, 30, size, power, tau)
    found, _ = tiled(size, *scene, name, law, dtype=np.float32)
    expected = literally(size, *scene, name, law)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("law", LAWS)
def test_what_lies_behind_an_opaque_front_is_not_drawn_and_hardly_shows(law) -> None:
    size = 64, 48
    discs, tau, colours = scattered(7, 300, size, 1.3, 3.0)
    exact, none = tiled(size, discs, tau, colours, "chord", law)
    for least in (1e-9, 1e-4, 1e-2):
        found, unseen = tiled(size, discs, tau, colours, "chord", law, least=least)
        assert unseen >= none
        assert np.abs(found - exact).max() <= least
    assert unseen > none


def test_ten_thousand_transmittances_in_a_row() -> None:
    # The running product of exp(-1) is 0 in float64 after 745 balls, and quotients of
    # it are 0 / 0 from there on; the running sum of logarithms knows no end.
    count, size = 10_000, (9, 9)
    discs = Discs(*np.full((2, count), 4.5), np.full(count, 5.0))
    colours = np.tile([[1.0, 0.5, 0.25]], (count, 1))
    for tau, dtype, close in (
        (1.0, np.float64, 1e-12),
        (1e-4, np.float64, 1e-12),
        (1.0, np.float32, 1e-6),
        (1e-4, np.float32, 2e-6),  # worst seen 6e-7; a sum in float32 is off by 2.5e-5
    ):
        depth = np.full(count, tau)
        picture, _ = tiled(size, discs, depth, colours, "chord", "beer", dtype=dtype)
        assert picture[4, 4, 3] == pytest.approx(-np.expm1(-tau * count), abs=close)
        if (
            dtype is np.float64
        ):  # each step of colour rounds: 1250 times alike in float32
            np.testing.assert_allclose(
                picture[..., :3], picture[..., 3:] * colours[0], rtol=0.0, atol=close
            )


def test_lists_hold_just_the_tiles_that_a_disc_reaches() -> None:
    discs = Discs(np.array([24.0, 8.0]), np.array([24.0, 8.0]), np.array([20.0, 1.0]))
    (lists,) = parts(discs, 64, 64)
    found = {
        (int(r), int(c)): lists.ball[f : f + n].tolist()
        for r, c, f, n in zip(
            lists.row, lists.column, lists.first, lists.count, strict=True
        )
    }
    # The corners of the large ball's square: only (0, 0) has a pixel inside the disc.
    middle = np.arange(SIDE) + 0.5
    for row, column in np.ndindex(4, 4):
        down = (row * SIDE + middle - 24.0)[:, None]
        inside = (down**2 + (column * SIDE + middle - 24.0) ** 2 < 400.0).any()
        balls = [0] * bool(inside) + [1] * (row == column == 0)
        assert found.get((row, column), []) == balls


def test_a_ball_between_the_pixels_centres_is_in_no_list() -> None:
    discs = Discs(np.array([8.0]), np.array([8.0]), np.array([0.3]))
    assert not list(parts(discs, 16, 16))
    assert not ranges_of(discs, 16, 16).tiles().any()


@settings(max_examples=10)
@given(seeds, st.floats(0.0, 2.0), st.sampled_from([20, 100]))
def test_a_picture_made_in_parts_is_the_same(seed: int, power, most) -> None:
    size = 100, 40
    scene = scattered(seed, 25, size, power, 1.0)
    whole, _ = tiled(size, *scene, "chord", "beer")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tile_lists, "MOST_PAIRS", most)
        pieces = list(parts(scene[0], *size))
        assert all(len(p.ball) <= most or len(p.count) == 1 for p in pieces)
        found, _ = tiled(size, *scene, "chord", "beer")
    # Other tiles are multiplied together, in other places of a matrix: worst 5e-15.
    np.testing.assert_allclose(found, whole, rtol=0.0, atol=1e-13)


def test_no_product_is_large_enough_for_a_second_thread() -> None:
    # OpenBLAS takes more threads from rows x inner x columns of 2^18 on.
    for size in (8, 64, 144, PIXELS):
        samples = tiles.CACHED // np.dtype(np.float32).itemsize
        together = samples // (tiles.LEAST_SLOTS * size)
        assert together * 4 * size < 2**18
        assert 3 * (4 * tiles.MOST_SLOTS + 1) * size < 2**18
        # Nodes to pixels, and to the last terms.
        assert 4 * size * PIXELS < 2**18 or size == PIXELS
