"""Every array function equals its plain twin; no public function lacks one."""

from __future__ import annotations

import importlib
import pkgutil

import numpy as np
import pytest
import twins
from hypothesis import given
from hypothesis import strategies as st

ROOMS = [
    "refcloud.noise",
    "refcloud.optics",
    "refcloud.camera",
    "refcloud.image",
    "refcloud.cloudmap",
    "refcloud.metaballs",
    "refcloud.transport",
    "refcloud.raster",
    "refcloud.march",
    "refcloud.lighting",
    "refcloud.sky",
]

MODULES = [
    importlib.import_module(f"twins.{found.name}")
    for found in pkgutil.iter_modules(twins.__path__)
]
# Public functions without a twin, with the reason: {name: reason} in each module.
WITHOUT: dict[str, str] = {
    name: reason
    for module in MODULES
    for name, reason in getattr(module, "WITHOUT", {}).items()
}


@pytest.mark.parametrize("row", twins.ROWS, ids=lambda row: row.name)
@given(data=st.data())
def test_array_function_equals_its_plain_twin(row: twins.Twin, data) -> None:
    actual, expected = row.both(data.draw)
    actual = np.asarray(actual, dtype=np.float64)
    expected = np.asarray(expected, dtype=np.float64)
    assert actual.shape == expected.shape, "a twin gives the same shape"
    finite = np.isfinite(expected)
    scale = max(1.0, float(np.abs(expected[finite]).max(initial=0.0)))
    np.testing.assert_allclose(
        actual, expected, rtol=0.0, atol=row.tolerance * scale, err_msg=row.why
    )


def public_functions() -> list[str]:
    names = []
    for room in ROOMS:
        module = importlib.import_module(room)
        for name in module.__all__:
            thing = getattr(module, name)
            if callable(thing) and not isinstance(thing, type):
                names.append(f"{thing.__module__}.{thing.__name__}")
    return names


@pytest.mark.parametrize("name", public_functions())
def test_public_function_has_a_twin_or_a_reason(name: str) -> None:
    rows = {row.name for row in twins.ROWS}
    assert (name in rows) != (name in WITHOUT), (
        f"{name}: enter a row in tests/twins/, or a reason in WITHOUT, not both"
    )


def test_no_reason_is_left_over() -> None:
    assert set(WITHOUT) <= set(public_functions())
