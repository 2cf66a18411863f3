"""The framebuffer's type, its clear and its readback of boxes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.raster import Framebuffer, clear, framebuffer, read_pixels

CHANNEL = st.floats(-1e300, 1e300)


@given(
    width=st.integers(1, 40),
    height=st.integers(1, 40),
    first=st.lists(CHANNEL, min_size=4, max_size=4),
    second=st.lists(CHANNEL, min_size=4, max_size=4),
)
def test_clear_sets_every_pixel(width, height, first, second) -> None:
    buffer = framebuffer(width, height, color=first)
    assert buffer.pixels.shape == (height, width, 4)
    assert (buffer.pixels == first).all()
    clear(buffer, second)
    assert (buffer.pixels == second).all()


@settings(max_examples=50)
@given(data=st.data(), width=st.integers(1, 9), height=st.integers(1, 9))
def test_read_pixels_is_a_copy_of_the_box(data, width, height) -> None:
    pixels = np.arange(width * height * 4.0).reshape(height, width, 4)
    top = data.draw(st.integers(0, height))
    bottom = data.draw(st.integers(top, height))
    left = data.draw(st.integers(0, width))
    right = data.draw(st.integers(left, width))
    buffer = Framebuffer(pixels)
    box = read_pixels(buffer, slice(top, bottom), slice(left, right))
    np.testing.assert_array_equal(box, pixels[top:bottom, left:right])
    box[...] = -1.0
    assert (buffer.pixels >= 0.0).all()


def test_read_pixels_takes_open_ends() -> None:
    assert read_pixels(framebuffer(3, 2), slice(None), slice(1, None)).shape == (
        2,
        2,
        4,
    )


@pytest.mark.parametrize(
    "part", [slice(0, 5), slice(-1, 2), slice(2, 1), slice(0, "a")]
)
def test_a_box_outside_is_refused(part: slice) -> None:
    with pytest.raises(ValueError, match="rows: expected a slice of step 1 within"):
        read_pixels(framebuffer(4, 4), part, slice(0, 1))


def test_a_framebuffer_keeps_the_array_it_was_given() -> None:
    pixels = np.zeros((2, 3, 4))
    clear(Framebuffer(pixels), [1, 2, 3, 4])
    assert pixels[1, 2].tolist() == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("pixels", "error", "message"),
    [
        (np.zeros((2, 2, 4), np.float32), TypeError, "float64, got float32"),
        ([[[0.0] * 4]], TypeError, "float64, got list"),
        (np.zeros((2, 2, 3)), ValueError, r"\(H, W, 4\), got shape \(2, 2, 3\)"),
        (np.zeros((2, 4)), ValueError, r"\(H, W, 4\), got shape \(2, 4\)"),
        (np.zeros((0, 2, 4)), ValueError, r"\(H, W, 4\), got shape \(0, 2, 4\)"),
        (np.broadcast_to(0.0, (2, 2, 4)), ValueError, "read-only"),
    ],
)
def test_other_arrays_are_refused(pixels, error, message) -> None:
    with pytest.raises(error, match=message):
        Framebuffer(pixels)


@pytest.mark.parametrize(("width", "height"), [(0, 1), (1, 0), (-3, 2), (2**70, 1)])
def test_a_size_outside_is_refused(width: int, height: int) -> None:
    with pytest.raises(ValueError, match=r"width|height"):
        framebuffer(width, height)


def test_a_buffer_too_large_is_refused_before_memory_is_taken() -> None:
    with pytest.raises(ValueError, match="at most 64000000 pixels, got 1000000000000"):
        framebuffer(10**6, 10**6)


@pytest.mark.parametrize("color", [[0, 0, 0], [0, 0, 0, np.nan], [0, 0, 0, np.inf]])
def test_a_wrong_colour_is_refused(color: list[float]) -> None:
    with pytest.raises(ValueError, match="color: expected"):
        clear(framebuffer(1, 1), color)
