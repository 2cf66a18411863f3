"""The cloud file: the same bits again, and damage in one line."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.metaballs import as_metaballs, balls_drawn, kernels

from refcloud.files import write_arrays
from refcloud.metaballs import Metaballs, load_metaballs, save_metaballs
from refcloud.metaballs.file import FORMAT, VERSION


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("balls") / "cloud.npz"


@given(balls=balls_drawn, kernel=kernels, scale=st.floats(1e-300, 1e300))
def test_round_trip_is_bit_for_bit(path, balls, kernel, scale):
    saved = as_metaballs(balls, kernel)
    saved = Metaballs(saved.centers * scale, saved.radii, saved.densities, kernel)
    assert save_metaballs(saved, path) == path
    back = load_metaballs(path)
    for name in ("centers", "radii", "densities"):
        assert getattr(back, name).tobytes() == getattr(saved, name).tobytes()
        assert getattr(back, name).shape == getattr(saved, name).shape
    assert back.kernel == kernel


GOOD = {"centers": np.zeros((2, 3)), "radii": np.ones(2), "densities": np.ones(2)}
WRONG = {
    "a negative radius": ({"radii": np.array([1.0, -1.0])}, "radii: expected numbers"),
    "a negative density": ({"densities": -np.ones(2)}, "densities: expected numbers"),
    "not a number": ({"centers": np.full((2, 3), np.nan)}, "centers: expected|finite"),
    "another kernel": ({"kernel": "blob"}, "kernel: expected one of"),
    "another count": (
        {"radii": np.ones(3)},
        r"radii of shape \(N,\), N = 2, got \(3,\)",
    ),
    "another shape": ({"centers": np.zeros((2, 2))}, r"centers of shape \(N, 3\)"),
    "texts": ({"radii": np.array(["a", "b"])}, "radii as integers or floats"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_no_ball_may_have_is_refused_with_the_files_name(tmp_path, case):
    changes, message = WRONG[case]
    path = tmp_path / "cloud.npz"
    write_arrays(path, FORMAT, VERSION, {**GOOD, "kernel": "wyvill", **changes})
    with pytest.raises(ValueError, match=message) as refusal:
        load_metaballs(path)
    assert str(path) in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "cloud.npz"
    write_arrays(path, "refcloud.voxels", 1, {"density": np.ones((2, 2, 2))})
    with pytest.raises(
        ValueError, match=r"expected a refcloud.metaballs file, got for"
    ):
        load_metaballs(path)
    write_arrays(path, FORMAT, VERSION + 1, {**GOOD, "kernel": "wyvill"})
    with pytest.raises(ValueError, match="version 2; update"):
        load_metaballs(path)
    with pytest.raises(FileNotFoundError, match="got no such file"):
        load_metaballs(tmp_path / "none.npz")
