"""Document C's scenes: the scroll has no seam, and each of its faults is measured."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from refcloud.camera import Camera
from refcloud.noise import gradient, value, wrap_halo
from refcloud.raster import Texture, mip_levels, sample
from refcloud.scenes import SCENES, View, simple

VIEW = View(48, 36)


def drawn(name: str, **how) -> np.ndarray:
    scene = SCENES[name]
    return scene.draw(scene.model(), dataclasses.replace(VIEW, **how)).linear


@pytest.mark.parametrize("name", ["simple-quad", "simple-sky"])
def test_the_scroll_closes_and_moves(name: str) -> None:
    period = SCENES[name].motion.period
    first = drawn(name)
    np.testing.assert_allclose(drawn(name, time=period), first, atol=1e-12)
    assert np.abs(drawn(name, time=period / 3) - first).max() > 0.1


def test_the_sky_has_no_seam_either_way() -> None:
    first = drawn("simple-sky")
    for way in np.eye(3)[:2]:
        np.testing.assert_allclose(drawn("simple-sky", offset=way), first, atol=1e-12)
        half = drawn("simple-sky", offset=0.5 * way)
        # Neighbours in the moved picture, its seam in the middle among them, differ no
        # more than neighbours of the first.
        axis = int(way[0] == 1.0)
        steepest = np.abs(np.diff(first, axis=axis)).max()
        assert np.abs(np.diff(half, axis=axis)).max() < 1.5 * steepest


def center_of(picture: np.ndarray) -> float:
    return float((picture * np.arange(picture.shape[1])[:, None]).sum() / picture.sum())


def moved_right(name: str, sign: float) -> bool:
    """Tell whether a bright spot of the texture goes to the right with time."""
    spot = np.zeros((16, 16, 3))
    spot[7:9, 7:9] = 1.0
    view = dataclasses.replace(VIEW, kept={"sheet": Texture(spot)})
    scene = SCENES[name]
    places = []
    for time in (0.0, 10.0):
        at = dataclasses.replace(view, time=time)
        light = scene.draw(scene.model(), at).linear[..., :1]
        light = light - light.min(axis=1, keepdims=True)  # the sky's own
        places.append(center_of(light))
    return sign * (places[1] - places[0]) > 1.0


def test_e31_the_letter_scrolls_from_right_to_left() -> None:
    assert moved_right("simple-quad", -1.0)
    assert moved_right("simple-sky", 1.0), "here from left to right, as it says"


def test_e31_every_frame_leaves_a_texture_behind() -> None:
    levels = mip_levels(np.zeros((256, 256, 3)))
    assert simple.bytes_of_a_frame() == sum(level.size for level in levels) == 262143
    kept: dict = {}
    for frame in range(3):
        drawn("simple-quad", time=frame, kept=kept)
    assert list(kept) == ["sheet"], "here one texture serves"


def test_e31_the_mipmaps_are_never_read() -> None:
    texels = np.repeat(simple.cloud()[..., None] / 255.0, 3, axis=-1)
    plain = Texture(texels, min_filter="LINEAR")
    assert len(plain.levels) == 1
    coords, step = np.random.default_rng().uniform(size=(50, 2)), np.full((50, 2), 0.05)
    how = {"along_x": step, "along_y": step}  # 13 texels to a pixel
    np.testing.assert_array_equal(sample(plain, coords, **how), sample(plain, coords))
    mips = Texture(texels, min_filter="LINEAR_MIPMAP_LINEAR")
    assert np.abs(sample(mips, coords, **how) - sample(plain, coords)).max() > 0.05


def test_e31_a_signed_char_holds_no_grey_above_127() -> None:
    codes = simple.cloud().astype(np.int64)
    assert codes.max() > 127
    signed = np.clip(codes, -128, 127).astype(np.int8)  # a machine that saturates
    assert np.count_nonzero(signed.astype(np.uint8) != codes) > 0.2 * codes.size
    wrapped = codes.astype(np.uint8).view(np.int8)  # one that keeps the low 8 bits
    assert wrapped.min() < 0
    assert (wrapped.view(np.uint8) == codes).all(), "read as unsigned it is right again"


def test_e31_without_the_lucky_reset_the_scroll_speeds_up() -> None:
    place, free = 0.0, 0.0
    for frame in range(1, 41):
        x = 0.01 * frame  # static float x; x += 0.01
        place = 0.0 + x  # glLoadIdentity on the texture's matrix, then glTranslatef
        free += x  # glTranslatef alone
        assert simple.scrolled(frame) == pytest.approx(place)
        assert simple.scrolled(frame, reset=False) == pytest.approx(free)
    assert free > 20 * place


def test_e31_mirroring_is_wrapping_and_perlin_noise_value_noise() -> None:
    values = simple.raw_map()
    halo = wrap_halo(values)
    assert (halo[0, 1:-1] == values[-1]).all()
    assert np.abs(halo - np.pad(values, 1, mode="symmetric")).max() > 100.0
    # Gradient noise is 0 at its lattice points, value noise is anything there.
    at = np.stack(np.meshgrid(np.arange(8.0), np.arange(8.0), [0.0]), axis=-1)
    assert (gradient(at, seed=1) == 0.0).all()
    assert np.std(value(at, seed=1)) > 0.1
    assert np.std(values) > 60.0


def test_e31_what_the_filter_leaves_fits_a_byte() -> None:
    assert simple.first_octave().max() <= 256.0
    assert simple.octaves().max() <= 255.0
    assert 0.0 <= simple.cloud().min() < simple.cloud().max() < 255.0


def test_steps_show_squares_of_the_map() -> None:
    light = drawn("simple-noise", width=64, height=64)
    blocks = light.reshape(32, 2, 32, 2, 3)
    assert (blocks == blocks[:, :1, :, :1]).all()
    assert np.ptp(light) > 0.9
    smoothed = drawn("simple-smoothed", width=64, height=64)
    assert np.std(smoothed) < 0.5 * np.std(light)


def test_the_quad_fills_half_of_each_side() -> None:
    light = drawn("simple-quad", kept={"sheet": Texture(np.ones((2, 2, 3)))})
    rows, columns = np.nonzero(light[..., 0])
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (9, 26, 12, 35)
    assert math.isclose(light.max(), 1.0)


def test_pictures_of_the_plane_refuse_an_eye() -> None:
    eye = Camera([0, 0, 1], [0, 0, 0])
    for name in ("simple-noise", "simple-quad", "simple-sky"):
        with pytest.raises(ValueError, match="camera: expected none beside"):
            drawn(name, camera=eye)
