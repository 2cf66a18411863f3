"""Value noise from a table of lattice values has the bits of noise that hashes."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import INTERPOLANTS, seeds_or_none

from refcloud.noise import uniform, value
from refcloud.noise.lattice import PERIOD

tables = importlib.import_module("refcloud.noise.value_table")

ways = st.fixed_dictionaries(
    {
        "seed": seeds_or_none,
        # Cosine is a library function that may round by the array's layout.
        "interpolant": st.sampled_from([n for n in INTERPOLANTS if n != "cosine"]),
        "smooth": st.booleans(),
        "period": st.none() | st.integers(1, 9),
    }
)


def test_e09_the_paper_s_hash_needs_a_table_of_m_alone(monkeypatch) -> None:
    # A box of 60 cells a side holds 63^3 lattice points with the halo, and fewer m.
    counted = []
    original = tables._lattice_random

    def counting(x, y, z, seed):
        g = original(x, y, z, seed)
        counted.append(g.size)
        return g

    monkeypatch.setattr(tables, "_lattice_random", counting)
    at = 60.0 * uniform(np.arange(20_000)[:, None], np.arange(3), seed=3)
    tabled = value(at, seed=None, interpolant="quintic")
    halos = 2 * (1 + 57 + 57**2) * len(counted)
    assert 62 * (1 + 57 + 57**2) < sum(counted) <= 61 * (1 + 57 + 57**2) + 1 + halos
    monkeypatch.setattr(tables, "MOST_LATTICE", 0)
    np.testing.assert_array_equal(value(at, seed=None, interpolant="quintic"), tabled)


@settings(max_examples=25)
@given(ways, st.sampled_from([0.0, -1.5, PERIOD - 3.0, 3.0 - PERIOD]))
def test_the_box_of_close_points_does_not_show(how, corner) -> None:
    close = corner + 3.0 * uniform(np.arange(300)[:, None], np.arange(3), seed=1)
    boxed = value(close, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "SLAB", 7)
        np.testing.assert_array_equal(value(close, **how), boxed)
        patch.setattr(tables, "MOST_LATTICE", 0)
        np.testing.assert_array_equal(value(close, **how), boxed)
