"""Solved light along rays, to a tolerance: ways are certified, and fall back."""

from __future__ import annotations

import numpy as np
import pytest
from small_lights import FORWARD, SUN, cloud

from refcloud.camera import OrthographicCamera, rays
from refcloud.march import glowing
from refcloud.march.glow import Way, glow
from refcloud.march.glowing import WAYS, glow_within
from refcloud.transport import scattered_light

CLOUD = cloud()
LIGHT = scattered_light(CLOUD, SUN, medium=FORWARD, plan="standard")
SIDE = 9


def view() -> tuple[np.ndarray, np.ndarray]:
    """Rays of a camera without perspective that sees all of the box."""
    middle, offset = np.full(3, 0.5), np.array([0.6, 0.3, 3.0])
    camera = OrthographicCamera(
        middle + offset, middle, height_of_view=1.5, width=SIDE, height=SIDE
    )
    origins, directions = rays(camera)
    return origins.reshape(-1, 3), directions.reshape(-1, 3)


def test_halving_the_stride_quarters_the_error() -> None:
    exact = glow(CLOUD, *view(), LIGHT, None)
    errors = [
        np.abs(glow(CLOUD, *view(), LIGHT, Way(stride, 0.01)) - exact).max()
        for stride in (0.25, 0.0625)
    ]
    # A sixteenth by theory; at the cloud's rim samples come and go.
    assert errors[1] < errors[0] / 6.0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5, 1e-6, 1e-7, 1e-8])
def test_the_error_stays_below_the_tolerance_and_is_told(tolerance: float) -> None:
    exact = glow(CLOUD, *view(), LIGHT, None)
    seen: dict = {}
    found, rows = glow_within(
        CLOUD,
        *view(),
        LIGHT,
        tolerance,
        rows=(SIDE, SIDE),
        observe=seen.__setitem__,
    )
    off = np.abs(found - exact).max()
    assert off <= tolerance
    assert list(seen["errors of ways"]) == list(WAYS[: len(seen["errors of ways"])])
    if rows:
        (row,) = rows
        assert (row.how, row.skipped) == ("certified", SIDE * SIDE)
        assert off <= row.bound <= tolerance
    else:
        assert off == 0.0


def test_where_the_steepest_rays_fail_all_are_exact(monkeypatch) -> None:
    """A sample that sees nothing would vouch for the coarsest way: edges object."""
    nothing = np.zeros(1, np.intp)  # a ray beside the cloud
    monkeypatch.setattr(glowing, "_glowing", lambda *args: nothing)
    found, rows = glow_within(CLOUD, *view(), LIGHT, 1e-9, rows=(SIDE, SIDE))
    assert not rows
    assert np.array_equal(found, glow(CLOUD, *view(), LIGHT, None))
