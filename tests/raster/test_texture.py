"""Laws of textures: where texels stand, how they repeat, what smaller levels keep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.texture import drawn_texture

from refcloud.raster import Texture, mip_levels, sample
from refcloud.raster import texture as texture_module

RAMP = np.arange(12.0).reshape(3, 4, 1)
far_away = st.floats(-1e6, 1e6)


def centres(height: int, width: int) -> np.ndarray:
    j, i = np.mgrid[0:height, 0:width]
    return np.stack([(i + 0.5) / width, (j + 0.5) / height], axis=-1)


@pytest.mark.parametrize("name", ["NEAREST", "LINEAR"])
def test_at_their_centres_texels_are_themselves(name) -> None:
    texture = Texture(RAMP, mag_filter=name)
    np.testing.assert_allclose(sample(texture, centres(3, 4)), RAMP, atol=1e-13)


def test_linear_is_linear_between_centres() -> None:
    s, t = np.meshgrid(np.linspace(0.125, 0.875, 9), np.linspace(1 / 6, 5 / 6, 7))
    found = sample(Texture(RAMP), np.stack([s, t], axis=-1))[..., 0]
    np.testing.assert_allclose(found, 4 * s - 0.5 + 4 * (3 * t - 0.5), atol=1e-13)


@settings(max_examples=50)
@given(st.data(), st.integers(-5, 5))
def test_wraps_have_their_period(data, turns) -> None:
    texels = np.arange(15.0).reshape(3, 5, 1)
    place = np.array([data.draw(st.integers(-64, 64)) / 64.0 for _ in "st"])
    for wrap, period in (("REPEAT", 1.0), ("MIRRORED_REPEAT", 2.0)):
        texture = Texture(texels, wrap)
        one = sample(texture, place)
        np.testing.assert_array_equal(one, sample(texture, place + period * turns))
    mirrored = Texture(texels, "MIRRORED_REPEAT")
    np.testing.assert_allclose(
        sample(mirrored, place), sample(mirrored, -place), atol=1e-13
    )
    clamped = Texture(texels, "CLAMP_TO_EDGE")
    edge = sample(clamped, np.clip(place, 0.0, 1.0))
    np.testing.assert_array_equal(sample(clamped, place), edge)


@given(st.data(), far_away, far_away)
def test_a_lookup_stays_between_the_texels(data, s, t) -> None:
    texture, _ = drawn_texture(data.draw)
    found = sample(texture, [s, t], level=data.draw(st.floats(-3.0, 9.0)))
    assert found.min() >= texture.texels.min() - 1e-12
    assert found.max() <= texture.texels.max() + 1e-12


@given(st.integers(1, 9), st.integers(1, 9), st.integers(1, 4))
def test_every_level_keeps_the_mean(height, width, depth) -> None:
    texels = np.sin(np.arange(height * width * depth * 2.0))
    levels = mip_levels(texels.reshape(depth, height, width, 2))
    for level in levels:
        mean = levels[0].mean(axis=(0, 1, 2))
        np.testing.assert_allclose(level.mean(axis=(0, 1, 2)), mean, atol=1e-14)
    assert levels[-1].shape == (1, 1, 1, 2)


def test_codes_are_fractions_of_255_in_every_level() -> None:
    codes = np.array([[[0], [255]], [[1], [2]]], np.uint8)
    texture = Texture(codes, min_filter="LINEAR_MIPMAP_LINEAR")
    assert [level.ravel().tolist() for level in texture.levels] == [
        [0.0, 1.0, 1.0 / 255.0, 2.0 / 255.0],
        [64.0 / 255.0],  # 64.5, ties to even
    ]


def test_f05_a_matrix_scrolls_and_scales() -> None:
    matrix = np.eye(4)
    matrix[0, 3], matrix[1, 1] = 0.25, 2.0
    moved = Texture(RAMP, matrix=matrix)
    place = np.array([[0.3, 0.2], [0.9, 0.7]])
    expected = sample(Texture(RAMP), place * [1.0, 2.0] + [0.25, 0.0])
    np.testing.assert_allclose(sample(moved, place), expected, atol=1e-13)
    # Levels follow what the matrix does to a pixel.
    mip = {"min_filter": "LINEAR_MIPMAP_LINEAR", "mag_filter": "NEAREST"}
    step = {"along_x": [[0.0, 0.0]], "along_y": [[0.0, 2.0 / 3.0]]}
    found = sample(Texture(RAMP, matrix=matrix, **mip), [[0.0, 0.0]], **step)
    same = sample(Texture(RAMP, **mip), [[0.25, 0.0]], level=2.0)
    np.testing.assert_allclose(found, same, atol=1e-13)


def test_f06_a_level_is_chosen_by_the_larger_change() -> None:
    texels = np.zeros((8, 8, 1))
    texels[::2] = 1.0
    texture = Texture(texels, min_filter="NEAREST_MIPMAP_NEAREST", mag_filter="NEAREST")
    at, none = [[0.1, 0.06]], [[0.0, 0.0]]
    for texels_a_pixel, shown in ((1.0, 1.0), (1.3, 1.0), (1.5, 0.5), (64.0, 0.5)):
        step = [[0.0, texels_a_pixel / 8.0]]
        for ways in ((step, none), (none, step)):
            found = sample(texture, at, along_x=ways[0], along_y=ways[1])
            assert found[0, 0] == shown


def test_f06_levels_are_made_once(monkeypatch) -> None:
    made = []
    monkeypatch.setattr(
        texture_module, "mip_levels", lambda t: made.append(1) or mip_levels(t)
    )
    texture = Texture(RAMP, min_filter="LINEAR_MIPMAP_LINEAR")
    for level in (0.0, 0.5, 1.5, 9.0):
        sample(texture, centres(3, 4), level=level)
    assert len(made) == 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Texture(np.ones((2, 2))), r"texels: expected shape \(H, W, C\)"),
        (lambda: Texture(np.ones((2, 2, 5))), r"texels: expected shape \(H, W, C\)"),
        (lambda: Texture(np.full((1, 1, 1), np.nan)), "texels: expected finite"),
        (
            lambda: Texture(np.broadcast_to(0.0, (9999, 9999, 1))),
            "texels: expected at",
        ),
        (lambda: Texture(RAMP, "TILE"), "wrap: expected"),
        (lambda: Texture(RAMP, ("REPEAT",) * 3), "wrap: expected one name, or 2"),
        (lambda: Texture(RAMP, min_filter="BEST"), "min_filter: expected one of"),
        (
            lambda: Texture(RAMP, matrix=np.ones((4, 4))),
            "matrix: expected a last row of 0 0 0 1",
        ),
        (lambda: sample(Texture(RAMP), [0.5]), r"coords: expected shape \(\.\.\., 2\)"),
        (lambda: sample(Texture(RAMP), [0.5, np.nan]), "coords: expected finite"),
        (
            lambda: sample(Texture(RAMP), [0.5, 0.5], along_x=[0.1, 0.0]),
            "along_x: expected both",
        ),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=rf"^{message}[^\n]*$"):
        call()
