"""Pictures of noise: every kind in every view, in range, as large as it says."""

from __future__ import annotations

import typing

import numpy as np
import pytest

from refcloud import noise_pictures
from refcloud.image import srgb_encode
from refcloud.noise import (
    cloud_sheet,
    fbm_grid,
    octave_sum_grid,
    sheet_map,
    turbulence_grid,
    worley_grid,
)
from refcloud.noise_pictures import BASES, GAP, Kind, View, noise_picture

KINDS = typing.get_args(Kind)
VIEWS = {"slice": (1, 1), "channels": (1, 4), "octaves": (2, 3)}  # rows and columns


def values(picture) -> np.ndarray:
    """Give what the codes show, in [0, 1], of the red channel."""
    return srgb_encode(picture.linear[..., 0])


def test_the_table_has_every_kind_and_the_test_every_view() -> None:
    assert {*BASES, "sheet"} == set(KINDS)
    assert set(VIEWS) == set(typing.get_args(View))


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_in_every_view(kind: str, view: str) -> None:
    picture = noise_picture(kind, size=24, octaves=3, seed=5, view=view, cells=4)
    rows, columns = VIEWS[view]
    height, width = (n * (24 + GAP) - GAP for n in (rows, columns))
    assert picture.linear.shape == (height, width, 3)
    assert ((picture.linear >= 0.0) & (picture.linear <= 1.0)).all()
    again = noise_picture(kind, size=24, octaves=3, seed=5, view=view, cells=4)
    np.testing.assert_array_equal(picture.linear, again.linear)
    other = noise_picture(kind, size=24, octaves=3, seed=6, view=view, cells=4)
    assert (picture.linear != other.linear).any()


@pytest.mark.parametrize("kind", sorted(set(KINDS) - {"sheet"}))
def test_nothing_is_cut_off(kind: str) -> None:
    shown = values(noise_picture(kind, size=96))
    # No two pixels beside each other lie on an end of the range.
    for end in (0.0, 1.0):
        flat = shown == end
        assert not (flat[1:] & flat[:-1]).any()
        assert not (flat[:, 1:] & flat[:, :-1]).any()


def test_the_code_of_a_pixel_is_the_value_itself() -> None:
    along = (np.arange(32) + 0.5) / 4.0
    expected = worley_grid(along, along, [0.5], seed=3, normalize="bound")[0]
    shown = values(noise_picture("worley_f1", size=32, seed=3))
    # There and back through the sRGB curve; its printed numbers meet to 1e-8.
    np.testing.assert_allclose(shown, expected, rtol=0, atol=1e-7)


def test_the_sums_are_those_of_the_room() -> None:
    along = (np.arange(32) + 0.5) / 4.0
    expected, _ = octave_sum_grid(along, along, [0.5], seed=3, octaves=3)
    shown = values(noise_picture("man", size=32, octaves=3, seed=3))
    np.testing.assert_allclose(shown, expected[0], rtol=0, atol=1e-7)
    sums = (("fbm", 0.5 + 0.5 * fbm_grid(along, along, [0.5], seed=3)[0]),)
    sums += (("turbulence", turbulence_grid(along, along, [0.5], seed=3)[0]),)
    for kind, expected in sums:
        shown = values(noise_picture(kind, size=32, seed=3))
        np.testing.assert_allclose(shown, expected[0], rtol=0, atol=1e-7)
    sheet = cloud_sheet(64, seed=3)
    shown = values(noise_picture("sheet", size=64, seed=3))
    np.testing.assert_allclose(shown, sheet / 255.0, rtol=0, atol=1e-7)
    assert sheet_map(seed=3).shape == (32, 32)


def test_too_many_panels_are_refused_before_they_are_drawn(monkeypatch) -> None:
    drawn: list[int] = []
    monkeypatch.setattr(noise_pictures, "_octaves", lambda *_: drawn.append(1))
    with pytest.raises(ValueError, match=r"^size: expected [^\n]* fewer octaves$"):
        noise_picture("value", view="octaves", size=2048, octaves=8)
    assert not drawn
