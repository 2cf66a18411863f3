"""The generator: range, determinism, crop, union, what is skipped and refused."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.cloudmap import VoxelGrid, cell_centres, generate
from refcloud.cloudmap.generate import BY_SHAPE, PADDING

SHAPES = sorted(BY_SHAPE)
# Clouds of some hundred cells, so that a whole one takes milliseconds.
SMALL = {"diameters": [12, 7, 8], "cell": 4.0, "voxel": 1.0, "relief": 1.5}
few = settings(max_examples=20)


@st.composite
def small_clouds(draw: st.DrawFn) -> dict:
    return SMALL | {
        "shape": draw(st.sampled_from(SHAPES)),
        "seed": draw(st.integers(0, 2**40)),
        "voxel": draw(st.sampled_from([0.7, 1.0, 1.5])),
        "octaves": draw(st.integers(1, 4)),
        "persistence": draw(st.floats(0.1, 1.0)),
        "interpolant": draw(st.sampled_from(["linear", "cosine", "cubic", "quintic"])),
        "normalize": draw(st.sampled_from(["clip", "bound"])),
        "threshold": draw(st.sampled_from([0.0, 0.05, 0.2])),
        "dynamics": draw(st.floats(0.1, 1.0)),
        "ellipsoids": draw(st.integers(1, 4)),
    }


def cells(grid: VoxelGrid, voxel: float) -> dict[tuple, float]:
    """Give the occupied cells by their whole numbers in the world."""
    first = np.round(grid.lower / voxel).astype(int)
    where = np.argwhere(grid.density > 0.0)
    return {
        tuple((first + place[::-1]).tolist()): grid.density[tuple(place)]
        for place in where
    }


@few
@given(small_clouds())
def test_density_keeps_its_range_and_is_empty_below_the_threshold(how) -> None:
    grid = generate(**how)
    largest = how["dynamics"] if how["shape"] == "ellipsoid" else 1.0
    assert grid.density.max() <= largest
    full = grid.density[grid.density > 0.0]
    if how["shape"] == "ellipsoid":
        assert (full >= how["dynamics"] * how["threshold"] * (1.0 - 1e-15)).all()


@few
@given(small_clouds())
def test_the_same_seed_gives_the_same_bits(how) -> None:
    one, two = generate(**how), generate(**how)
    np.testing.assert_array_equal(one.density, two.density)
    np.testing.assert_array_equal(one.lower, two.lower)
    np.testing.assert_array_equal(one.upper, two.upper)
    assert one.skipped == two.skipped


@pytest.mark.parametrize("shape", SHAPES)
def test_another_seed_gives_another_cloud(shape: str) -> None:
    clouds = [cells(generate(shape, seed=s, **SMALL), 1.0) for s in (1, 2)]
    assert clouds[0] != clouds[1]


@few
@given(small_clouds())
def test_the_crop_leaves_whole_cells_and_padding(how) -> None:
    grid, voxel = generate(**how), how["voxel"]
    for end in (grid.lower, grid.upper):
        np.testing.assert_allclose(end / voxel, np.round(end / voxel), atol=1e-9)
    edges = (grid.upper - grid.lower) / grid.density.shape[::-1]
    np.testing.assert_allclose(edges, voxel, rtol=1e-12)
    x, _, _ = cell_centres(grid)
    np.testing.assert_allclose(x / voxel % 1.0, 0.5, atol=1e-9)
    where = np.argwhere(grid.density > 0.0)
    if len(where):
        assert (where.min(axis=0) == PADDING).all()
        assert (where.max(axis=0) == np.array(grid.density.shape) - 1 - PADDING).all()


def test_an_empty_cloud_is_a_small_empty_grid() -> None:
    grid = generate("ellipsoid", threshold=0.999, **SMALL)
    assert grid.density.shape == (2 * PADDING + 1,) * 3
    assert not grid.density.any()


@few
@given(st.integers(0, 2**40), st.integers(2, 5))
def test_a_union_is_no_thinner_than_its_parts(seed: int, count: int) -> None:
    few_, many = (
        cells(generate("ellipsoid", seed=seed, ellipsoids=n, **SMALL), 1.0)
        for n in (count - 1, count)
    )
    assert all(many.get(place, 0.0) >= density for place, density in few_.items())


@few
@given(st.integers(0, 2**40), st.floats(0.0, 0.3), st.floats(0.0, 0.3))
def test_e15_a_higher_threshold_only_empties_cells(seed, low, more) -> None:
    thick, thin = (
        cells(generate("ellipsoid", seed=seed, threshold=t, **SMALL), 1.0)
        for t in (low, low + more)
    )
    assert all(thick[place] == density for place, density in thin.items())


def test_the_default_ellipsoid_is_the_papers_cloud() -> None:
    # V04: about 11,000 voxels with Z = 4, s = 0.5, t = 0.1, d = 1.
    assert np.count_nonzero(generate("ellipsoid", seed=2).density) == pytest.approx(
        11_000, rel=0.05
    )


def test_octaves_too_fine_for_the_cells_are_skipped_and_reported() -> None:
    how = SMALL | {"voxel": 1.5, "cell": 4.0}
    every, shown = (generate("ellipsoid", octaves=n, **how) for n in (5, 2))
    (row,) = every.skipped
    assert (row.stage, row.skipped, row.of) == ("noise", 3, 5)
    assert row.bound == pytest.approx(0.5**2 + 0.5**3 + 0.5**4)
    np.testing.assert_array_equal(every.density, shown.density)
    assert shown.skipped == ()


@pytest.mark.parametrize("normalize", ["clip", "none"])
@pytest.mark.parametrize("interpolant", ["cosine", "cubic"])
def test_nothing_is_full_where_the_depth_was_not_computed(
    normalize, interpolant
) -> None:
    seen: dict = {}
    how = SMALL | {"normalize": normalize, "interpolant": interpolant, "cell": 12.0}
    how |= {"persistence": 1.0, "octaves": 4}
    generate("cumulus", seed=3, observe=seen.__setitem__, **how)
    fill = seen["depth"].min()
    assert not seen["density"][seen["depth"] <= fill].any()
    # Nor is anything cut off by the grid: its outermost cells are empty.
    shell = np.ones(seen["density"].shape, dtype=bool)
    shell[1:-1, 1:-1, 1:-1] = False
    assert not seen["density"][shell].any()


def test_the_base_is_flat() -> None:
    grid = generate("cumulus", seed=1, **SMALL)
    _, y, _ = cell_centres(grid)
    below = grid.density[:, y < -0.5]
    assert not below.any(), "nothing lies below -n / 2"


@pytest.mark.parametrize("shape", SHAPES)
def test_every_step_can_be_watched(shape: str) -> None:
    seen: list[str] = []
    generate(shape, observe=lambda name, value: seen.append(name), **SMALL)
    middle = "depth" if shape == "cumulus" else "quadric"
    assert seen == ["noise", middle, "density"]


def test_the_unseeded_hash_is_the_papers() -> None:
    paper = generate("ellipsoid", seed=None, **SMALL)
    assert cells(paper, 1.0) != cells(generate("ellipsoid", seed=0, **SMALL), 1.0)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "given_",
    [{"voxel": 1e-3}, {"voxel": 1e-100}, {"voxel": 1e-100, "diameters": [1e90] * 3}],
)
def test_too_many_cells_are_refused_before_memory_is_taken(shape, given_) -> None:
    tracemalloc.start()
    with pytest.raises(ValueError, match=r"^voxel: expected [^\n]*; choose a larger"):
        generate(shape, **(SMALL | given_))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1e7


@pytest.mark.parametrize(
    ("given_", "name"),
    [
        ({"shape": "cube"}, "shape"),
        ({"diameters": [1, 1, 0]}, "diameters"),
        ({"voxel": 0.0}, "voxel"),
        ({"octaves": 0}, "octaves"),
        ({"persistence": 0.0}, "persistence"),
        ({"threshold": 1.0}, "threshold"),
        ({"edge": 0.0}, "edge"),
        ({"ellipsoids": 0}, "ellipsoids"),
    ],
)
def test_refusals_name_the_argument_in_one_line(given_, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        generate(**given_)
