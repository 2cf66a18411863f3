"""E32: what the neighbours-only search of Worley noise misses, built and measured."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest

from refcloud.noise import worley, worley_bound, worley_grid

EDGE = np.nextafter(1.0, 0.0)  # as far in its cell as a point can lie


def lay(monkeypatch, n: int, place) -> None:
    """Let the points of cells lie where place(cell (n, ...)) says, not where hashed."""

    def places(cells, seed):
        signed = [((c.astype(np.int64) + 5) % 10) - 5 for c in cells]
        return place(np.array(np.broadcast_arrays(*signed)))

    for name in ("worley_cells", "worley_search", "worley_ring"):
        module = importlib.import_module(f"refcloud.noise.{name}")
        monkeypatch.setattr(module, "_places", places)


def worst_case(cells: np.ndarray) -> np.ndarray:
    """All points as far from the origin as they can be, but one just two cells off."""
    away = np.where(cells >= 0, EDGE, 0.0)
    odd = (cells[0] == -2) & (cells[1:] == 0).all(axis=0)
    corner = np.zeros(len(cells))
    corner[0] = EDGE
    return np.where(odd, corner.reshape(-1, *(1,) * (cells.ndim - 1)), away)


@pytest.mark.parametrize("n", [2, 3])
def test_the_worst_gap_is_built_and_the_exact_search_is_free_of_it(
    monkeypatch, n: int
) -> None:
    lay(monkeypatch, n, worst_case)
    origin = np.zeros((1, n))
    near = worley(origin, search="neighbours", period=10)[0]
    exact = worley(origin, period=10)[0]
    assert exact == pytest.approx(1.0, abs=1e-15)
    assert near - exact == pytest.approx(math.sqrt(n) - 1.0, abs=1e-15)
    lines = [np.zeros(1)] * n
    assert worley_grid(*lines, period=10).item() == exact
    assert worley_grid(*lines, period=10, search="neighbours").item() == near


@pytest.mark.parametrize(("n", "feature"), [(2, "F1"), (3, "F1"), (2, "F2"), (3, "F2")])
def test_e33_the_bounds_are_reached_as_nearly_as_one_likes(
    monkeypatch, n: int, feature: str
) -> None:
    if (n, feature) == (2, "F2"):
        # The middle of cell 0 with all points pushed away from it.
        at, rest = 0.5, 0.0
        lay(monkeypatch, n, lambda cells: np.where(cells > 0, EDGE, rest))
    else:
        # The corner where the cells -1 and 0 meet, with all points in far corners.
        at = 0.0
        lay(monkeypatch, n, lambda cells: np.where(cells >= 0, EDGE, 0.0))
    found = worley(np.full(n, at), feature=feature, period=10)
    bound = worley_bound(n, feature)
    assert found == pytest.approx(bound, abs=1e-15)
    assert worley(np.full(n, at), feature=feature, period=10, normalize="bound") <= 1.0


def test_e32_the_gap_is_met_in_hashed_patterns_too() -> None:
    # 3,000 cells along an axis of the plane: a few samples in a million are wrong.
    line = np.linspace(0.0, 3000.0, 1400)
    how = {"seed": 0, "period": 3000}
    gap = worley_grid(line, line, search="neighbours", **how) - worley_grid(
        line, line, **how
    )
    assert gap.min() == 0.0
    assert 0.0 < gap.max() < math.sqrt(2.0) - 1.0
    assert 0.0 < (gap > 0.0).mean() < 1e-4


def test_e32_one_cell_is_no_bound() -> None:
    line = np.linspace(0.0, 8.0, 64, endpoint=False)
    noise = worley_grid(line, line, line, period=8)
    # About one sample in a thousand lies farther than a cell from every point.
    assert 0.0 < (noise > 1.0).mean() < 0.01
    clipped = worley_grid(line, line, line, period=8, normalize="clip")
    np.testing.assert_array_equal(clipped, np.minimum(noise, 1.0))
