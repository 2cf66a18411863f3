"""The sun's buffer shrinks with a tolerance, and the light stays within it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import DARK, EXTENDED, MEDIUM, SUNS
from twins.lighting import media, scattered_balls, seeds

from refcloud.lighting import coarser, sunward
from refcloud.lighting.coarser import LEAST_SIDE, PER_RISE, may_shrink, sized_share
from refcloud.lighting.lightview import light_view
from refcloud.lighting.share import light_share
from refcloud.noise import uniform

WIDE = dataclasses.replace(scattered_balls(4, 12), radii=np.full(12, 1.5))
OF = "pixels of the lights' buffers"


def unseen(name, value) -> None:
    """Watch nothing."""


def both(balls, direction, medium, look, most):
    """Carry a light in the buffer that the error allows, and exactly in its own."""
    view = light_view(balls, direction, look.buffer)
    how = view, medium, look, look.forward
    return sized_share(*how, most, may_shrink(*how[:3], most), unseen), light_share(
        *how, 0.0, unseen
    )[0]


@settings(max_examples=60)
@given(
    seeds,
    st.integers(1, 60),
    st.floats(-0.5, 0.3),
    st.floats(-1.0, 1.5),
    st.sampled_from(sorted(PER_RISE)),
    st.sampled_from(["split", "man2003"]),
    st.sampled_from(["beer", "linear"]),
    media,
    st.floats(-3.0, -0.5).map(lambda power: 10.0**power),
    st.sampled_from([33, 64, 128]),
)
def test_the_error_is_below_what_is_allowed(
    seed, count, size, depth, readback, scattering, law, medium, most, side
) -> None:
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(
        balls,
        radii=10.0**size * balls.radii,
        densities=10.0**depth * balls.densities,
    )
    look = dataclasses.replace(
        EXTENDED,
        readback=readback,
        scattering=scattering,
        transmittance=law,
        buffer=side,
    )
    direction = uniform(np.arange(3), seed=seed) - 0.5
    direction /= np.linalg.norm(direction)
    found, exact = both(balls, direction, medium, look, most)
    sweeps = max((run.bound for run in found.sweeps), default=0.0)
    assert np.abs(found.share - exact).max() <= found.bound + sweeps + 1e-12
    assert found.bound + sweeps <= most
    assert LEAST_SIDE**2 <= found.pixels <= found.whole == side**2
    assert (found.bound > 0.0) == (found.pixels < found.whole)


def test_wide_balls_need_few_pixels_and_more_for_less_error() -> None:
    look = dataclasses.replace(EXTENDED, buffer=256, **DARK)
    direction = SUNS[0].direction
    pixels = [
        both(WIDE, direction, MEDIUM, look, most)[0].pixels
        for most in (0.3, 0.002, 1e-6)
    ]
    assert pixels[0] < pixels[1] < pixels[2] == look.buffer**2


@pytest.mark.parametrize("readback", ["footprint", "square"])
def test_the_saving_is_reported_with_its_bound(readback) -> None:
    look = dataclasses.replace(EXTENDED, readback=readback, buffer=256, **DARK)
    how = {"medium": MEDIUM, "look": look}
    tolerance = 0.5
    watched = []
    lit = sunward(
        WIDE,
        SUNS,
        tolerance=tolerance,
        observe=lambda name, value: watched.append((name, value)),
        **how,
    )
    exact = sunward(WIDE, SUNS, **how)
    assert not exact.skipped
    rows = [row for row in lit.skipped if row.what == OF]
    assert sum(row.bound for row in lit.skipped) <= tolerance
    buffers = [value.pixels.shape[0] for name, value in watched if "buffer" in name]
    assert len(buffers) == len(SUNS)  # what was tried is not watched
    if readback == "square":  # its mean jumps with every pixel: the buffer is kept
        assert not rows
        assert buffers == [256, 256]
        return
    (row,) = rows
    assert (row.stage, row.of) == ("light", 2 * 256**2)
    assert row.skipped == row.of - sum(side**2 for side in buffers) > 0.5 * row.of
    assert 0.0 < row.bound <= tolerance


def test_where_the_light_itself_changes_a_larger_side_is_tried(monkeypatch) -> None:
    look = dataclasses.replace(EXTENDED, buffer=256, **DARK)
    direction = SUNS[0].direction
    kept = both(WIDE, direction, MEDIUM, look, 0.05)[0]
    monkeypatch.setattr(coarser, "PER_CHANGE", 60.0)
    found = both(WIDE, direction, MEDIUM, look, 0.05)[0]
    assert kept.pixels < found.pixels
