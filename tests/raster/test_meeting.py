"""Layers that meet in a pixel: none is missed, and those apart do not count."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lighting import scattered_balls, seeds

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.compose import WHITE, merged, reached_by
from refcloud.conventions import Skipped
from refcloud.noise import uniform
from refcloud.raster.meeting import most_together, reached_by_box, shares_of, together
from refcloud.raster.tile_lists import SIDE

EYE = np.array([0.5, 1.0, 7.0])
CAMERAS = (
    Camera(EYE, [0, 0, 0], width=70, height=50),
    Camera([0.1, 0.0, 0.4], [0, 0, -3], fov_y=1.5, width=70, height=50),
    OrthographicCamera(EYE, [0, 0, 0], height_of_view=3.0, width=70, height=50),
)


def in_pixels(reached: np.ndarray, camera: Camera) -> np.ndarray:
    return np.kron(reached, np.ones((SIDE, SIDE), bool))[
        : camera.height, : camera.width
    ].astype(bool)


@settings(max_examples=40)
@given(seeds, st.integers(0, 6), st.sampled_from(CAMERAS))
def test_no_pixel_of_a_disc_is_missed(seed, count, camera) -> None:
    balls = scattered_balls(seed, count)
    reached = in_pixels(reached_by(balls, camera), camera)
    x, y, _, scale = project(camera, balls.centers)
    row, column = np.mgrid[: camera.height, : camera.width] + 0.5
    for k, r in enumerate(balls.radii * scale):
        assert reached[np.hypot(column - x[k], row - y[k]) < r].all()
    if not count:
        assert not reached.any()


@settings(max_examples=40)
@given(seeds, st.sampled_from(CAMERAS))
def test_no_pixel_of_a_box_is_missed(seed, camera) -> None:
    ends = 6.0 * uniform(np.arange(2)[:, None], np.arange(3), seed=seed) - 3.0
    lower, upper = ends.min(axis=0), ends.max(axis=0)
    reached = in_pixels(reached_by_box(lower, upper, camera), camera)
    inside = uniform(np.arange(400)[:, None], np.arange(3), 1, seed=seed)
    x, y, depth, scale = project(camera, lower + inside * (upper - lower))
    shown = (depth > 0.0) & (scale > 0.0) & (x >= 0) & (y >= 0)
    shown &= (x < camera.width) & (y < camera.height)
    assert reached[y[shown].astype(int), x[shown].astype(int)].all()


def test_layers_apart_do_not_count_together() -> None:
    camera = CAMERAS[0]
    left, right = (
        reached_by_box(np.array([x, -1.0, -0.5]), np.array([x + 0.3, 1, 0.5]), camera)
        for x in (-2.0, 1.5)
    )
    wide = reached_by_box(np.array([-3.0, -0.2, 0]), np.array([3, 0.2, 0.1]), camera)
    assert not (left & right).any()
    assert most_together(together([left, right])) == 1
    sets = together([left, right, wide])
    assert most_together(sets) == 2
    # Bounds add up where layers meet; counts always; other units stay the largest.
    rows = [
        [Skipped("eye", "balls", 1, 2, bound), Skipped("noise", "o", 1, 4, bound, "n")]
        for bound in (0.1, 0.2, 0.4)
    ]
    balls, noise = merged(rows, sets)
    assert (balls.skipped, balls.of, balls.unit) == (3, 6, WHITE)
    assert np.isclose(balls.bound, 0.2 + 0.4)
    assert noise.bound == 0.4
    assert merged([], np.zeros((0, 0), bool)) == ()


def test_nothing_meets_nothing() -> None:
    empty = np.zeros((2, 3), bool)
    assert most_together(together([empty, empty])) == 1


@settings(max_examples=60)
@given(seeds, st.integers(1, 6), st.floats(0.0, 1.0))
def test_layers_that_meet_never_have_more_than_all_of_a_tolerance(
    seed, count, filled
) -> None:
    layers = uniform(np.arange(count)[:, None, None], *np.indices((4, 5)), seed=seed)
    layers = list(layers < filled)
    shares = shares_of(layers)
    assert min(shares) > 0.0
    in_tiles = sum(share * layer for share, layer in zip(shares, layers, strict=True))
    assert np.max(in_tiles) <= 1.0 + 1e-12
    assert shares_of(layers[:1]) == [1.0]
