"""Pieces cut where an optical depth is reached: each holds the column it is told to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, EYE

from refcloud.camera import rays
from refcloud.march.cells import cut, density_at, lattice
from refcloud.march.pieces import POINTS, PRIMITIVE, THICKEST, THIRDS, WEIGHTS, thinner
from refcloud.march.quadrature import before_each, per_ray

cubics = st.lists(st.floats(0.0, 1e3), min_size=4, max_size=4)


@given(cubics, st.floats(0.0, 1.0))
def test_four_values_tell_the_primitive_of_a_cubic(coefficients, x) -> None:
    cubic = np.polynomial.Polynomial(coefficients)
    A, B, C, D = PRIMITIVE @ cubic(THIRDS)
    found = x * (A + x * (B + x * (C + x * D)))
    # Signs alternate in the table, whose rows sum to 18 at the most, in size.
    scale = max(coefficients) * x
    assert found == pytest.approx(cubic.integ()(x), rel=1e-13, abs=1e-13 * scale)


@settings(max_examples=10)
@given(st.floats(1.0, 3.0))
def test_parts_hold_the_columns_that_they_are_cut_for(digits) -> None:
    rate, grid = 10.0**digits, lattice(BLOB)
    origins, ways = (part.reshape(-1, 3) for part in rays(EYE))
    pieces = cut(grid, origins, ways)
    mass = pieces.length * (density_at(pieces, POINTS) @ WEIGHTS)
    before = before_each(pieces.ray, mass, len(origins))
    parts, ahead = thinner(pieces, before, mass, np.array([rate]), np.inf)
    assert len(parts.ray) > len(pieces.ray)
    own = parts.length * (density_at(parts, POINTS) @ WEIGHTS)
    assert rate * own.max() <= THICKEST * (1.0 + 1e-6)
    # Nothing is lost, and each begins where the column ahead of it ends.
    whole = per_ray(pieces.ray, mass, len(origins))
    found = per_ray(parts.ray, own, len(origins))
    np.testing.assert_allclose(found, whole, rtol=1e-11)
    np.testing.assert_allclose(
        before_each(parts.ray, own, len(origins)), ahead, rtol=1e-11, atol=1e-13
    )
