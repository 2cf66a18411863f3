"""Intermediate views show what they say."""

from __future__ import annotations

import numpy as np
import pytest

import refcloud as rc
from refcloud.lighting import Octaves, octave_march
from refcloud.lighting.lightview import light_view
from refcloud.studio import box_picture, setups
from refcloud.studio.box import step_of
from refcloud.studio.counts import balls_per_pixel, steps_per_pixel
from refcloud.studio.glimpse import glimpse, glimpse_of_multiple
from refcloud.studio.recipe import Kept
from refcloud.studio.setups import frame_of
from refcloud.studio.views import GAIN, VIEWS, Request, heat, shown

LITTLE = {"diameters": [20, 11, 11], "relief": 2, "cell": 3, "voxel": 2}
VALUES = {
    "cloud": {
        "generate": LITTLE,
        "approximate": {"count": 12, "method": "quick"},
        "look": {"buffer": 24, "sky_buffer": 16},
    },
    "march": {"generate": LITTLE},
    "box": {"texture": {"voxel": 0.2}},
}
MEDIUM = rc.Medium(4.0, phase="hg", g=0.2)
SUN = rc.Sun([-1, 1, 1])


def request(name: str, view: str, *, share: float = 0.5) -> Request:
    setup = setups()[name]
    values = setup.taken(VALUES.get(name, {}))
    return Request(setup, values, frame_of(24, 18), view, share)


def cloud(seed: int) -> rc.VoxelGrid:
    """A grid with empty parts, seen whole by `eye`."""
    density = np.maximum(np.sin(np.arange(6 * 5 * 7.0) * (seed + 1.3)), 0.0) ** 2
    density = density.reshape(6, 5, 7)
    density[:, :, :2] = 0.0
    return rc.VoxelGrid(density, [-1, -1, -1], [1, 1, 1])


EYE = rc.Camera([1, 0.5, 4], [0, 0, 0], fov_y=0.7, width=13, height=11)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("samples", [1, 7, 40])
def test_steps_are_those_that_the_march_takes(seed, samples) -> None:
    grid = cloud(seed)
    step = step_of(grid, samples)
    how = {"medium": MEDIUM, "octaves": Octaves(1), "suns": (SUN,), "step": step}
    rows = octave_march(grid, EYE, seed=seed, **how)[2]
    passed = next(row for row in rows if row.what.startswith("samples"))
    taken, left = steps_per_pixel(grid, EYE, sigma_t=4.0, step=step, seed=seed)
    assert (taken + left).sum() == passed.of
    assert left.sum() == passed.skipped


def test_opaque_fronts_end_steps() -> None:
    dense = rc.VoxelGrid(np.ones((4, 4, 4)), [-1, -1, -1], [1, 1, 1])
    how = {"sigma_t": 100.0, "step": 0.05}
    all_of_them, none = steps_per_pixel(dense, EYE, **how)
    taken, left = steps_per_pixel(dense, EYE, least=1e-3, **how)
    assert none.sum() == 0
    assert np.array_equal(taken + left, all_of_them)
    assert 0 < taken.max() <= 3, "two steps of depth 5 leave e^-10"


def test_balls_are_counted_over_the_pixels_that_they_cover() -> None:
    centers = np.array([[0.0, 0, 0], [0.2, 0, 0], [0, 0, 9.0], [50.0, 0, 0]])
    balls = rc.Metaballs(centers, np.array([0.5, 0.5, 0.1, 0.5]), np.ones(4))
    eye = rc.OrthographicCamera([0, 0, 8], [0, 0, 0], width=20, height=20)
    counts = balls_per_pixel(balls, eye)
    at = (np.arange(20) + 0.5 - 10) / 10
    wanted = sum(
        ((at - x) ** 2 + at[:, None] ** 2 <= r * r).astype(int)
        for x, r in ((0.0, 0.5), (0.2, 0.5), (0.0, 0.1))
    )
    assert np.array_equal(counts, wanted)


def test_false_colours_grow_brighter() -> None:
    colours = heat(np.linspace(0.0, 1.0, 64)).astype(float)
    light = colours @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) > 0.0).all()


@pytest.mark.parametrize(
    ("name", "view"),
    [(n, v) for n in VALUES for v in setups()[n].views],
)
def test_every_view_shows_something(name, view) -> None:
    found = shown(request(name, view), Kept())
    assert found.codes.dtype == np.uint8
    assert found.codes.shape[2] == 3
    assert found.caption
    if view != "error":
        assert found.codes.std() > 5.0, "one colour alone shows nothing"


def test_views_are_those_of_the_table() -> None:
    named = {view for setup in setups().values() for view in setup.views}
    assert named == set(VIEWS)


def test_a_slice_is_the_level_that_is_asked_for() -> None:
    grid = rc.generate(seed=12, **LITTLE)
    noise: list[np.ndarray] = []
    rc.generate(seed=12, **LITTLE, observe=lambda n, v: noise.append((n, v)))
    values = dict(noise)["noise"]
    for share, level in ((0.0, 0), (1.0, len(values) - 1)):
        codes = shown(request("cloud", "noise slice", share=share), Kept()).codes
        times = codes.shape[0] // values.shape[1]
        small = codes[times // 2 :: times, times // 2 :: times, 0]
        assert np.abs(small / 255.0 - (0.5 + 0.5 * values[level][::-1])).max() < 0.003
    assert grid.density.max() > 0.0


def test_the_order_toward_the_light_is_that_of_pass_1() -> None:
    """The ball that is nearest to the light is painted last, over all others."""
    setup = setups()["cloud"]
    values = setup.taken(VALUES["cloud"])
    kept = Kept()
    codes = shown(request("cloud", "order toward the light"), kept).codes
    lit = next(v for k, (v, _) in kept.results.items() if k.startswith("rc.sunward"))
    view = light_view(lit.balls, lit.suns[0].direction, 640)
    first = view.order[0]
    found = codes[int(view.y[first]), int(view.x[first])]
    assert np.array_equal(found, heat(np.array([0.1]))[0])
    assert values["sun"] is not None


def test_the_error_is_measured_against_the_exact_picture() -> None:
    found = shown(request("box", "error"), Kept())
    assert "largest " in found.caption
    assert GAIN == 10.0
    worst = float(found.caption.split("largest ")[1].split(",")[0])
    assert worst <= 1 / 255
    assert abs(int(found.codes.max()) / 255.0) <= 1.0


def test_a_glimpse_is_near_the_picture() -> None:
    grid = rc.generate(seed=12, edge=4.0, **LITTLE)
    camera = rc.Camera([0, 0, 50], [0, 4, 0], width=24, height=18)
    medium = rc.Medium(0.3, g=0.3, phase="hg")
    exact = rc.render(grid, camera=camera, suns=SUN, medium=medium)
    rough = glimpse(
        grid,
        camera=camera,
        suns=(SUN,),
        medium=medium,
        background=rc.Sky(),
        mixing=rc.march.Mixing(),
    )
    off = np.abs(rough.linear - exact.linear)
    # One sample for a voxel; worst seen .2 in a pixel and .02 in the mean.
    assert off.mean() < 0.04


def test_a_glimpse_of_multiple_scattering_is_as_bright_as_the_scene() -> None:
    camera = rc.scenes.cumulus.camera(rc.scenes.View(16, 12))
    rough = glimpse_of_multiple(width=16, height=12)
    exact = rc.render("multiple", camera=camera, tolerance=0.05)
    off = np.abs(rough.linear - exact.linear).mean()
    assert off < 0.15, "octaves of scattering are a guess; single scattering is .4 off"


def test_a_box_without_frame_is_the_march_before_the_sky() -> None:
    grid = cloud(1)
    how = {"medium": MEDIUM, "octaves": Octaves(1), "suns": (SUN,)}
    bare = box_picture(grid, EYE, samples=9, frame="none", **how)
    L, T, _ = octave_march(grid, EYE, step=step_of(grid, 9), **how)
    behind = rc.scenes.demand_plane.mended(rc.scenes.View(13, 11))
    assert np.allclose(bare.linear, L + T[..., None] * behind, atol=1e-15)
    lines = box_picture(grid, EYE, samples=9, frame="lines", **how)
    walls = box_picture(grid, EYE, samples=9, frame="walls", **how)
    some = np.abs(lines.linear - bare.linear).max(axis=2) > 0
    assert 0.05 < some.mean() < 0.6
    assert (np.abs(walls.linear - bare.linear).max(axis=2) > 0).mean() > some.mean()
