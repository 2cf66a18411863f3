"""Suns and media: what they keep, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from refcloud.conventions import WHOLE_SPHERE
from refcloud.optics import Medium, Sun

number = st.floats(-1e300, 1e300)


@given(st.tuples(number, number, number))
def test_a_direction_of_any_length_is_kept_as_a_unit_vector(way) -> None:
    assume(max(abs(c) for c in way) > 0.0)
    direction = Sun(way).direction
    assert math.hypot(*direction) == pytest.approx(1.0, abs=5e-16)
    largest = int(np.argmax(np.abs(way)))
    assert np.sign(direction[largest]) == np.sign(way[largest])


def test_the_default_sun_shows_an_isotropic_scatterer_as_white() -> None:
    irradiance = Sun([0, 1, 0]).irradiance
    assert (irradiance / WHOLE_SPHERE).tolist() == [1.0, 1.0, 1.0]


def test_a_medium_is_grey_or_coloured() -> None:
    grey, coloured = Medium(2.0, 0.9), Medium([1, 2, 3], [0.5, 0.6, 0.7])
    assert grey.sigma_t_rgb.tolist() == [2.0, 2.0, 2.0]
    assert grey.albedo_rgb.tolist() == [0.9, 0.9, 0.9]
    assert coloured.sigma_t_rgb.tolist() == [1.0, 2.0, 3.0]
    assert coloured.albedo_rgb.tolist() == [0.5, 0.6, 0.7]


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Sun([0, 0, 0]), "direction"),
        (lambda: Sun([0, math.nan, 0]), "direction"),
        (lambda: Sun([0, 1]), "direction"),
        (lambda: Sun([0, 1, 0], [-1, 0, 0]), "irradiance"),
        (lambda: Medium(-1.0), "sigma_t"),
        (lambda: Medium([1.0, 2.0]), "sigma_t"),
        (lambda: Medium(math.inf), "sigma_t"),
        (lambda: Medium(1.0, 1.1), "albedo"),
        (lambda: Medium(1.0, [0.5, 0.5, -0.5]), "albedo"),
        (lambda: Medium(1.0, g=1.0), "g"),
        (lambda: Medium(1.0, phase="mie"), "phase"),
    ],
)
def test_refusals_name_the_argument_in_one_line(make, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        make()
