"""Codes: the sRGB curve, the tone curve, rounding and dither."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.image import (
    quantize,
    srgb_decode,
    srgb_encode,
    to_codes,
    tone_shoulder,
)
from refcloud.image.encode import KNEE, SRGB_JOIN, THRESHOLDS

UNIT = arrays(np.float64, 9, elements=st.floats(0.0, 1.0))
CODES = np.arange(256)


def grey(values: np.ndarray) -> np.ndarray:
    return np.repeat(np.reshape(values, (1, -1, 1)), 3, axis=2)


@pytest.mark.parametrize("dither", [False, True])
def test_all_256_codes_come_back(dither: bool) -> None:
    linear = grey(srgb_decode(CODES / 255))
    codes = to_codes(linear, tone="none", dither=dither)
    if dither:  # a last bit below a code, and a threshold of 1/128: still the code
        np.testing.assert_array_equal(codes[0, :, 0], CODES)
    np.testing.assert_array_equal(codes, grey(CODES))


@given(values=UNIT)
def test_encode_and_decode_undo_each_other(values) -> None:
    # The power 2.4 magnifies the last bit by 2.4; worst seen 4e-16.
    np.testing.assert_allclose(srgb_decode(srgb_encode(values)), values, atol=1.5e-15)
    np.testing.assert_allclose(srgb_encode(srgb_decode(values)), values, atol=1.5e-15)


@given(values=UNIT)
def test_curves_are_monotone_and_keep_to_their_range(values) -> None:
    for curve in (srgb_encode, srgb_decode, tone_shoulder):
        result = curve(np.sort(values))
        assert (np.diff(result) >= 0.0).all()
        assert result.min() >= 0.0
        assert result.max() <= 1.0


def test_the_two_pieces_meet_without_a_step() -> None:
    near = SRGB_JOIN + np.arange(-50, 51) * np.spacing(SRGB_JOIN)
    steps = np.diff(srgb_encode(near))
    # The power is formed beside 1, where numbers are 1.1e-16 apart.
    assert steps.min() >= -1.2e-16
    assert steps.max() <= 1.2e-16


def test_known_values() -> None:
    assert srgb_encode([0.0, 1.0]).tolist() == [0.0, 1.0]
    # IEC 61966-2-1 at mid grey: linear 0.2140 is code 127.5.
    assert srgb_decode([0.5])[0] == pytest.approx(0.21404114, abs=1e-8)
    assert to_codes(grey(np.array([0.18])), tone="none", dither=False)[0, 0, 0] == 118


def test_tone_curve_is_straight_then_bends_below_white() -> None:
    low = np.linspace(0.0, KNEE, 100)
    np.testing.assert_array_equal(tone_shoulder(low), low)
    high = np.linspace(KNEE, 8.0, 1000)
    assert (np.diff(tone_shoulder(high)) > 0.0).all()
    assert tone_shoulder([1e300]).tolist() == [1.0]


def test_tone_curve_has_one_slope_at_the_knee() -> None:
    h = 1e-6
    below, at, above = tone_shoulder([KNEE - h, KNEE, KNEE + h])
    # The second derivative there is -1/0.3: h/0.6 between the one-sided slopes.
    assert (above - at) / h == pytest.approx((at - below) / h, abs=2e-6)


def test_thresholds_are_each_of_64_once() -> None:
    assert sorted(THRESHOLDS.ravel()) == [(i + 0.5) / 64 for i in range(64)]


def test_thresholds_of_each_square_of_4_spread_over_the_quarters() -> None:
    squares = THRESHOLDS.reshape(4, 2, 4, 2).transpose(0, 2, 1, 3).reshape(16, 4)
    np.testing.assert_array_equal(np.sort(squares * 4 // 1), [[0, 1, 2, 3]] * 16)


@given(value=st.floats(0.0, 1.0))
def test_dither_keeps_the_mean(value: float) -> None:
    codes = quantize(np.full((16, 24, 3), value))
    assert np.ptp(codes) <= 1
    # 64 equal steps of a code: at most half a step of 1/64 from the value.
    assert codes.mean() == pytest.approx(255 * value, abs=1 / 128 + 1e-10)


@given(values=arrays(np.float64, (3, 4, 3), elements=st.floats(0.0, 1.0)))
def test_rounding_without_dither_is_to_the_nearest_code(values) -> None:
    codes = quantize(values, dither=False)
    assert codes.dtype == np.uint8
    assert np.abs(codes - 255 * values).max() <= 0.5 + 1e-12


@given(
    linear=arrays(np.float64, (2, 2, 3), elements=st.floats(-1e308, 1e308)),
    exposure=st.floats(1e-300, 1e6),
    tone=st.sampled_from(["shoulder", "none"]),
    dither=st.booleans(),
)
def test_every_finite_light_has_a_code(linear, exposure, tone, dither) -> None:
    codes = to_codes(linear, exposure=exposure, tone=tone, dither=dither)
    assert (codes[linear <= 0.0] == 0).all(), "below 0 counts as 0 (E34)"


@given(
    linear=arrays(np.float64, (2, 2, 3), elements=st.floats(0.0, 1e3)),
    exposure=st.floats(0.01, 100.0),
)
def test_exposure_is_a_factor_on_the_light(linear, exposure) -> None:
    one = to_codes(linear, exposure=exposure)
    np.testing.assert_array_equal(one, to_codes(linear * exposure))


@pytest.mark.parametrize("value", [-0.1, 1.1, np.nan, np.inf])
def test_encoded_values_outside_are_refused(value: float) -> None:
    for curve, name in ((srgb_encode, "linear"), (srgb_decode, "encoded")):
        with pytest.raises(ValueError, match=f"^{name}: expected .*numbers"):
            curve([value])


@pytest.mark.parametrize("exposure", [0.0, -1.0, np.nan, 1e7])
def test_a_wrong_exposure_is_refused(exposure: float) -> None:
    with pytest.raises(ValueError, match="exposure: expected a finite number in"):
        to_codes(np.zeros((1, 1, 3)), exposure=exposure)


def test_a_wrong_tone_is_refused() -> None:
    with pytest.raises(ValueError, match="tone: expected one of 'shoulder', 'none'"):
        to_codes(np.zeros((1, 1, 3)), tone="filmic")
