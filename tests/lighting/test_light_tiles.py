"""Tiles in float32 give the literal loop's light, within the bound that they tell."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import EXTENDED, SUNS
from twins.lighting import looks, scattered_balls, seeds

from refcloud.lighting import fragments, share
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.light_tiles import EDGE, READ, light_tiles
from refcloud.lighting.lightview import handed_on, light_view
from refcloud.lighting.literal_light import carried_literally
from refcloud.lighting.look import MAN
from refcloud.lighting.share import light_share
from refcloud.lighting.sweeps import carried
from refcloud.optics import Medium


@pytest.mark.parametrize("readback", READ)
@settings(max_examples=25)
@given(
    seeds,
    st.integers(1, 60),
    looks,
    st.floats(-0.7, 0.3),
    st.floats(-2.0, 1.5),
    st.sampled_from([1, 7, 24, 45]),
)
def test_the_light_is_the_literal_loops_within_the_bound(
    readback, seed, count, look, size, depth, side
) -> None:
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(
        balls,
        radii=10.0**size * balls.radii,
        densities=10.0**depth * balls.densities,
    )
    rules = dataclasses.replace(look, readback=readback)
    view = light_view(balls, SUNS[0].direction, side)
    tau = ball_depths(balls, 1.5, rules)
    found = light_tiles(view, rules, tau)
    if found is None:  # a ball between the pixels' centres
        assert view.radius.min() < 1.0
        return
    literal, buffer = carried_literally(view, tau, 0.9, rules, rules.forward)
    swept = carried(found, tau, 0.9, rules, rules.forward, 1e-3)
    assert np.abs(swept.reached - literal).max() <= swept.bound + 1e-12
    inside = found.pixel < side**2
    pixels = buffer.pixels[..., 0].ravel()[found.pixel[inside]]
    assert np.abs(swept.buffer[inside] - pixels).max() <= swept.bound + found.rough


def test_pairs_are_fewer_than_fragments() -> None:
    view = light_view(scattered_balls(8, 200), SUNS[0].direction, 160)
    tau = ball_depths(view.balls, 1.5, EXTENDED)
    tiles = light_tiles(view, EXTENDED, tau)
    single = fragments.fragments(view, EXTENDED, np.float32)
    assert tiles is not None
    assert single is not None
    # Each pair holds 16 pixels; few of them lie outside the ball.
    assert len(tiles.ball) < 0.1 * len(single.ball)
    assert tiles.weight.size < 1.3 * len(single.ball)
    assert tiles.weight.shape[1] == EDGE**2
    # The same weights in all, and the same that is read.
    for name in ("weight", "read"):
        sums = [
            np.bincount(
                some.ball, getattr(some, name).reshape(len(some.ball), -1).sum(1)
            )
            for some in (tiles, single)
        ]
        np.testing.assert_allclose(sums[0], sums[1], rtol=1e-4)


def test_tiles_serve_only_where_their_roundings_are_allowed(monkeypatch) -> None:
    view = light_view(scattered_balls(8, 30), SUNS[0].direction, 64)
    seen = []
    sweep = share.carried
    monkeypatch.setattr(
        share, "carried", lambda found, *how: seen.append(found) or sweep(found, *how)
    )
    for most in (0.1, 1e-3, 1e-4, 0.0):
        light_share(view, Medium(1.5, 0.9), EXTENDED, 0.5, most, lambda *_: None)
    kinds = [found.weight.ndim for found in seen if found.weight.dtype == np.float32]
    assert kinds[0] == 2
    assert seen[-1].weight.dtype == np.float64
    assert all(f.weight.ndim == 1 for f in seen if f.weight.dtype == np.float64)
    for readback in ("disc", "square"):  # a rounded distance would make them jump
        rules = dataclasses.replace(EXTENDED, readback=readback)
        assert light_tiles(view, rules, np.ones(30)) is None


def test_what_is_scattered_holds_in_float32_for_any_albedo() -> None:
    # Next to no albedo the depth where eq 26 makes light is beyond float32's numbers,
    # and kappa may be below them: 1e37 times what it loses there is 1e-8.
    tau = np.array([0.0, 1.0, 1e37])
    for albedo in (1e-45, 1e-30, 1e-3, 0.9):
        share = handed_on(MAN, albedo, 0.0)
        short = share(tau.astype(np.float32))
        assert short.dtype == np.float32
        np.testing.assert_allclose(short, share(tau), rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(share(tau[:2]), share(tau)[:2], rtol=1e-15)
