"""Paper D's loop: what it gives on a slab, and what its sums tend to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, EYE, MEDIUM, SUN, rays_of, relative_error

from refcloud.cloudmap import VoxelGrid
from refcloud.march import Mixing, integrate, march_by_steps, sun_depth_by_steps
from refcloud.march import steps as steps_module
from refcloud.optics import Medium, Sun

SLAB = VoxelGrid(np.ones((2, 3, 2)), [-50.0, -50.0, 0.0], [50.0, 50.0, 2.0])
INWARD = ([0.0, 0.0, 9.0], [[0.0, 0.0, -1.0]])
PLAIN = Medium(1.0, phase="isotropic")


@given(st.floats(1e-9, 30.0), st.integers(1, 20))
def test_a_slab_without_shadow_is_exact_at_any_rate(sigma_t, rate) -> None:
    lit = Mixing(darkness_threshold=1.0)
    L, T = march_by_steps(
        SLAB,
        *INWARD,
        suns=Sun([0, 0, 1]),
        medium=Medium(sigma_t, phase="isotropic"),
        sample_rate=rate,
        sun_sample_rate=1,
        mixing=lit,
    )
    assert T[0] == pytest.approx(math.exp(-2.0 * sigma_t), rel=1e-12)
    assert L[0, 0] == pytest.approx(-math.expm1(-2.0 * sigma_t), rel=1e-12)


def test_e38_the_euler_sum_makes_light() -> None:
    how = {"suns": Sun([0, 0, 1]), "sample_rate": 4, "sun_sample_rate": 1}
    lit = Mixing(darkness_threshold=1.0)
    L, _ = march_by_steps(
        SLAB, *INWARD, medium=Medium(8.0), segment="euler", mixing=lit, **how
    )
    share, _ = march_by_steps(SLAB, *INWARD, medium=Medium(8.0), mixing=lit, **how)
    assert share[0, 0] < 1.5 < L[0, 0], "1.5 is the phase function's value here"


def test_the_column_to_the_sun_of_a_slab() -> None:
    points = [[0.0, 0.0, 0.5], [1.0, 2.0, 2.0], [0.0, 0.0, 3.0]]
    toward = np.array([0.0, 0.6, 0.8])
    found = sun_depth_by_steps(SLAB, points, direction=3.0 * toward, sample_rate=5)
    np.testing.assert_allclose(found, [1.5 / 0.8, 0.0, 0.0], rtol=1e-12)


def test_halving_the_steps_quarters_the_error() -> None:
    exact, _ = integrate(BLOB, *rays_of(EYE), suns=SUN, medium=MEDIUM)
    errors = []
    for rate in (24, 48, 96):
        how = {"sample_rate": rate, "sun_sample_rate": rate // 2}
        L, _ = march_by_steps(BLOB, *rays_of(EYE), suns=SUN, medium=MEDIUM, **how)
        errors.append(relative_error(L, exact))
    # Measured: .0070, .0017, .0004.
    assert errors[1] < errors[0] / 3.0
    assert errors[2] < errors[1] / 3.0


@settings(max_examples=10)
@given(st.integers(1, 7))
def test_the_list_may_be_cut_anywhere(chunk) -> None:
    how = {"suns": SUN, "medium": MEDIUM, "sample_rate": 3, "sun_sample_rate": 2}
    origins, directions = (a.reshape(-1, 3)[:13] for a in rays_of(EYE))
    whole = march_by_steps(BLOB, origins, directions, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(steps_module, "CHUNK", chunk)
        parts = march_by_steps(BLOB, origins, directions, **how)
    np.testing.assert_array_equal(whole[0], parts[0])
    np.testing.assert_array_equal(whole[1], parts[1])


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"sample_rate": 0}, "sample_rate: expected"),
        ({"segment": "trapezoid"}, "segment: expected"),
        ({"mixing": None}, "mixing: expected"),
    ],
)
def test_refusals(how, message) -> None:
    with pytest.raises((ValueError, TypeError), match=rf"^{message}[^\n]*$"):
        march_by_steps(SLAB, *INWARD, suns=(), medium=PLAIN, **how)


def test_mixing_fields_are_checked() -> None:
    with pytest.raises(ValueError, match=r"^darkness_threshold: expected"):
        Mixing(darkness_threshold=1.5)
