"""Rows of the image room."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud import image
from refcloud.plain import image as plain
from twins import Draw, twin

WITHOUT = {
    "refcloud.image.animation.write_animation": "writes a file",
    "refcloud.image.picture.load_picture": "reads a file",
    "refcloud.image.png.read_png": "reads a file",
    "refcloud.image.png.write_png": "writes a file",
}

UNIT = st.floats(0.0, 1.0)
LIGHT = st.floats(-0.5, 4.0)
SIDE = st.integers(1, 10)


def _each(function, values):
    return [function(value) for value in np.ravel(values).tolist()]


def _pixels(draw: Draw, elements: st.SearchStrategy[float]) -> np.ndarray:
    return draw(arrays(np.float64, (draw(SIDE), draw(SIDE), 3), elements=elements))


@twin(
    image.srgb_encode,
    plain.srgb_encode,
    tolerance=4e-16,
    why="one power: two last bits between numpy and the C library",
)
def srgb_encode(draw: Draw):
    values = draw(arrays(np.float64, 8, elements=UNIT))
    return image.srgb_encode(values), _each(plain.srgb_encode, values)


@twin(
    image.srgb_decode,
    plain.srgb_decode,
    tolerance=4e-16,
    why="one power: two last bits between numpy and the C library",
)
def srgb_decode(draw: Draw):
    values = draw(arrays(np.float64, 8, elements=UNIT))
    return image.srgb_decode(values), _each(plain.srgb_decode, values)


@twin(
    image.tone_shoulder,
    plain.tone_shoulder,
    tolerance=4e-16,
    why="expm1 beside 1 - exp: two last bits of 1",
)
def tone_shoulder(draw: Draw):
    values = draw(arrays(np.float64, 8, elements=st.floats(0.0, 1e6)))
    return image.tone_shoulder(values), _each(plain.tone_shoulder, values)


@twin(image.quantize, plain.quantize, tolerance=0, why="the same product and sum")
def quantize(draw: Draw):
    values, dither = _pixels(draw, UNIT), draw(st.booleans())
    expected = np.zeros(values.shape)
    for row, column, channel in np.ndindex(values.shape):
        value = float(values[row, column, channel])
        expected[row, column, channel] = plain.quantize(value, row, column, dither)
    return image.quantize(values, dither=dither), expected


@twin(
    image.to_codes,
    plain.to_codes,
    tolerance=1 / 255,
    why="last bits of the power may move a value over a threshold: one code",
)
def to_codes(draw: Draw):
    linear, dither = _pixels(draw, LIGHT), draw(st.booleans())
    exposure = draw(st.floats(0.01, 10.0))
    tone = draw(st.sampled_from(["shoulder", "none"]))
    expected = np.zeros(linear.shape)
    for row, column, channel in np.ndindex(linear.shape):
        expected[row, column, channel] = plain.to_codes(
            float(linear[row, column, channel]), row, column, exposure, tone, dither
        )
    actual = image.to_codes(linear, exposure=exposure, tone=tone, dither=dither)
    # In units of the largest code, so that the tolerance is one code.
    return actual / 255, expected / 255


@twin(
    image.difference_picture,
    plain.difference_picture,
    tolerance=0,
    why="the same difference and product",
)
def difference_picture(draw: Draw):
    a, gain = _pixels(draw, LIGHT), draw(st.floats(0.0, 100.0))
    b = draw(arrays(np.float64, a.shape, elements=LIGHT))
    expected = [
        plain.difference_picture(u, v, gain)
        for u, v in zip(a.ravel().tolist(), b.ravel().tolist(), strict=True)
    ]
    shown = image.difference_picture(image.Picture(a), image.Picture(b), gain=gain)
    return shown.linear.ravel(), expected


@twin(
    image.root_mean_square,
    plain.root_mean_square,
    tolerance=1e-14,
    why="sums of 12 squares in another order, and a scale that avoids overflow",
)
def root_mean_square(draw: Draw):
    a = draw(arrays(np.float64, 12, elements=LIGHT))
    b = draw(arrays(np.float64, 12, elements=LIGHT))
    expected = plain.root_mean_square(a.tolist(), b.tolist())
    return image.root_mean_square(a, b), expected


@twin(
    image.largest_difference,
    plain.largest_difference,
    tolerance=0,
    why="the same differences",
)
def largest_difference(draw: Draw):
    a = draw(arrays(np.float64, 12, elements=LIGHT))
    b = draw(arrays(np.float64, 12, elements=LIGHT))
    expected = plain.largest_difference(a.tolist(), b.tolist())
    return image.largest_difference(a, b), expected


@twin(image.compare_codes, plain.compare_codes, tolerance=0, why="whole numbers")
def compare_codes(draw: Draw):
    shape = (draw(SIDE), draw(SIDE), draw(st.sampled_from([3, 4])))
    a = draw(arrays(np.uint8, shape))
    change = draw(arrays(np.uint8, shape, elements=st.sampled_from([0, 0, 0, 1, 9])))
    b = a + change  # wraps around: differences up to 255 occur
    limits = draw(st.integers(0, 255)), draw(UNIT)
    found = image.compare_codes(a, b, codes=limits[0], fraction=limits[1])
    lists = (x.reshape(-1, shape[2]).tolist() for x in (a, b))
    expected = plain.compare_codes(*lists, *limits)
    return (found.same, found.worst, found.off_share), expected
