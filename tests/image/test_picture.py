"""The picture: its fields, its two kinds of file, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.conventions import MOST_PIXELS, Skipped
from refcloud.image import (
    Picture,
    load_picture,
    read_png,
    srgb_decode,
    write_png,
)
from refcloud.image.png import SIGNATURE

FILES = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
FINITE = st.floats(allow_nan=False, allow_infinity=False)
SHAPE = st.tuples(st.integers(1, 5), st.integers(1, 5))


@st.composite
def pictures(draw: st.DrawFn, light: st.SearchStrategy[float] = FINITE) -> Picture:
    shape = draw(SHAPE)
    linear = draw(arrays(np.float64, (*shape, 3), elements=light))
    if draw(st.booleans()):
        cover = draw(arrays(np.float64, shape, elements=st.floats(0.0, 1.0)))
        return Picture(linear, alpha=cover)
    return Picture(linear)


@FILES
@given(picture=pictures())
def test_linear_light_comes_back_to_the_bit(tmp_path: Path, picture: Picture) -> None:
    path = picture.save(tmp_path / "a.npy")
    back = load_picture(path)
    np.testing.assert_array_equal(back.linear, picture.linear)
    if picture.alpha is None:
        assert back.alpha is None
    else:
        np.testing.assert_array_equal(back.alpha, picture.alpha)


@FILES
@given(picture=pictures(st.floats(0.0, 1.0)), dither=st.booleans())
def test_png_holds_the_codes(tmp_path: Path, picture: Picture, dither: bool) -> None:
    path = picture.save(tmp_path / "a.png", dither=dither)
    codes = picture.codes(dither=dither)
    np.testing.assert_array_equal(read_png(path), codes)
    assert codes.shape[2] == (3 if picture.alpha is None else 4)


@FILES
@given(codes=SHAPE.flatmap(lambda shape: arrays(np.uint8, (*shape, 4))))
def test_a_png_with_alpha_loads_multiplied_and_saves_as_it_was(
    tmp_path: Path, codes: np.ndarray
) -> None:
    covered = codes[..., 3:] > 0
    values = codes / 255
    light = srgb_decode(values[..., :3]) * values[..., 3:]
    again = Picture(light, alpha=values[..., 3]).codes(tone="none", dither=False)
    np.testing.assert_array_equal(again, np.where(covered, codes, 0))
    back = load_picture(write_png(tmp_path / "a.png", codes))
    np.testing.assert_array_equal(back.linear, light)
    np.testing.assert_array_equal(back.alpha, values[..., 3])


@given(picture=pictures(), exposure=st.floats(1e-3, 1e3))
def test_every_picture_has_codes(picture: Picture, exposure: float) -> None:
    assert picture.codes(exposure=exposure).dtype == np.uint8


def test_alpha_is_kept_and_colours_are_divided_by_it() -> None:
    picture = Picture(np.full((1, 1, 3), 0.25), alpha=np.full((1, 1), 0.5))
    opaque = Picture(np.full((1, 1, 3), 0.5))
    style = {"tone": "none", "dither": False}
    assert picture.codes(**style)[0, 0].tolist() == [
        *opaque.codes(**style)[0, 0].tolist(),
        128,
    ]


def test_exposure_and_tone_reach_the_file(tmp_path: Path) -> None:
    picture = Picture(np.full((2, 2, 3), 0.5))
    bright = picture.save(tmp_path / "b.png", exposure=2.0, tone="none", dither=False)
    assert (read_png(bright) == 255).all()
    bent = picture.save(tmp_path / "c.png", exposure=2.0, tone="shoulder")
    assert (read_png(bent) < 255).all()


def test_the_name_may_be_text_and_in_capitals(tmp_path: Path) -> None:
    path = Picture(np.zeros((1, 1, 3))).save(str(tmp_path / "A.PNG"))
    assert path == tmp_path / "A.PNG"
    assert load_picture(str(path)).linear.shape == (1, 1, 3)


@pytest.mark.parametrize("name", ["a.jpg", "a", "a.png.txt", ".png", "a.exr"])
def test_other_suffixes_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"path: expected a name ending in \.png or"):
        Picture(np.zeros((1, 1, 3))).save(tmp_path / name)
    with pytest.raises(ValueError, match=r"path: expected a name ending in \.png or"):
        load_picture(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="none"):
        Picture(np.zeros((1, 1, 3))).save(tmp_path / "none" / "a.png")


@pytest.mark.parametrize(
    ("linear", "alpha", "message"),
    [
        (np.full((2, 2, 3), np.nan), None, "linear: expected finite numbers"),
        (np.full((2, 2, 3), np.inf), None, "linear: expected finite numbers"),
        (np.zeros((2, 2, 4)), None, r"linear: expected an array of shape \(H, W, 3\)"),
        (np.zeros((2, 2)), None, r"linear: expected an array of shape \(H, W, 3\)"),
        (np.zeros((0, 2, 3)), None, "linear: expected 1 to"),
        (np.zeros((2, 2, 3)), np.zeros((2, 3)), r"alpha: expected an array of shape"),
        (np.zeros((2, 2, 3)), np.full((2, 2), 1.5), r"alpha: expected numbers in"),
        (np.zeros((2, 2, 3)), np.full((2, 2), np.nan), "alpha: expected finite"),
    ],
)
def test_other_fields_are_refused(linear, alpha, message) -> None:
    with pytest.raises(ValueError, match=message):
        Picture(linear, alpha=alpha)


def test_too_many_pixels_are_refused() -> None:
    large = np.broadcast_to(0.0, (MOST_PIXELS // 1000 + 1, 1000, 3))  # takes 8 bytes
    with pytest.raises(ValueError, match=f"expected 1 to {MOST_PIXELS} pixels"):
        Picture(large)


def test_a_picture_reports_and_cannot_be_changed() -> None:
    row = Skipped("noise", "octaves", 1, 4, 0.01)
    picture = Picture(np.zeros((1, 1, 3)), skipped=(row,), seconds={"noise": 0.5})
    assert picture.skipped[0] is row
    assert picture.seconds["noise"] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        picture.linear[0, 0, 0] = 1.0


def test_a_notebook_gets_a_png() -> None:
    assert Picture(np.zeros((2, 3, 3)))._repr_png_().startswith(SIGNATURE)


def npy(folder: Path, array: np.ndarray, **how) -> Path:
    np.save(folder / "a.npy", array, **how)
    return folder / "a.npy"


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((2, 2)), r"expected numbers of shape .*, got shape \(2, 2\)"),
        (np.zeros((2, 2, 5)), r"got shape \(2, 2, 5\)"),
        (np.zeros((2, 2, 3), complex), "expected numbers"),
        (np.zeros((2, 2, 3), bool), "expected numbers"),
        (np.zeros((0, 2, 3)), "damaged|expected 1 to"),
        (np.full((2, 2, 3), np.nan), "linear: expected finite numbers"),
        (np.full((2, 2, 4), 2.0), "alpha: expected numbers in"),
        (np.array([[["a"] * 3]]), "expected numbers"),
    ],
)
def test_other_arrays_in_a_file_are_refused(tmp_path: Path, array, message) -> None:
    path = npy(tmp_path, array)
    with pytest.raises(ValueError, match=rf"^{path}: .*({message})") as caught:
        load_picture(path)
    assert "\n" not in str(caught.value)


def test_a_pickle_is_refused(tmp_path: Path) -> None:
    path = npy(tmp_path, np.array([[[{}] * 3]], dtype=object), allow_pickle=True)
    with pytest.raises(ValueError, match=rf"^{path}: expected a picture as .npy"):
        load_picture(path)


@FILES
@given(keep=st.floats(0.0, 1.0, exclude_max=True))
def test_a_cut_npy_file_is_refused(tmp_path: Path, keep: float) -> None:
    path = npy(tmp_path, np.zeros((4, 5, 3)))
    data = path.read_bytes()
    path.write_bytes(data[: int(keep * len(data))])
    with pytest.raises(ValueError, match=rf"^{path}: ") as caught:
        load_picture(path)
    assert "\n" not in str(caught.value)


def test_a_header_of_an_enormous_array_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npy"
    with path.open("wb") as file:
        header = {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6, 3)}
        np.lib.format.write_array_header_1_0(file, header)
    with pytest.raises(ValueError, match=rf"^{path}: "):
        load_picture(path)


def test_a_missing_npy_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none\.npy: .*got no such file"):
        load_picture(tmp_path / "none.npy")


def test_integers_and_other_orders_are_read(tmp_path: Path) -> None:
    values = np.arange(12, dtype=np.int16).reshape(2, 2, 3)
    for stored in (values, np.asfortranarray(values), values.astype(">f4")):
        picture = load_picture(npy(tmp_path, stored))
        np.testing.assert_array_equal(picture.linear, values)
