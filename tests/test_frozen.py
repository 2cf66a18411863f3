"""What frozen objects hold and what observers see: nobody else writes into it."""

from __future__ import annotations

import dataclasses
import tracemalloc
from array import array as buffer_of
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import refcloud as rc
from refcloud import Metaballs, VoxelGrid
from refcloud.frozen import Onlooker, only_looking, sealed, settled, shown
from refcloud.lighting import Look
from refcloud.metaballs import adaptive_kmeans, lloyd
from refcloud.noise.hashing import uniform

SIZE = {"width": 24, "height": 16}
SHAPE = (4, 5, 6)
ERODED = Look(erosion=0.5)


def fresh(seed: int = 0) -> np.ndarray:
    """Make densities that nothing else refers to."""
    return uniform(np.arange(120), seed=seed).reshape(SHAPE)


def small(density: Any) -> VoxelGrid:
    return VoxelGrid(density, np.zeros(3), np.array([6.0, 5.0, 4.0]))


@pytest.fixture(scope="module")
def cloud() -> VoxelGrid:
    return rc.generate(voxel=4.0)


# Ways to give the same numbers, each with what a caller could later write into.
GIVEN: dict[str, Callable[[], tuple[Any, np.ndarray]]] = {
    "array": lambda: (a := fresh(), a),
    "view": lambda: ((a := fresh())[:], a),
    "read-only view": lambda: (np.broadcast_to(a := fresh(), SHAPE), a),
    "transposed": lambda: ((a := fresh().T.copy()).T, a),
    "every second": lambda: ((a := np.repeat(fresh(), 2, axis=2))[..., ::2], a),
    "a buffer": lambda: (
        (a := np.frombuffer(buffer_of("d", fresh().ravel()))).reshape(SHAPE),
        a,
    ),
    "float32": lambda: (a := fresh().astype(np.float32), a),
    "a list of arrays": lambda: (list(a := fresh()), a),
}


@pytest.mark.parametrize("way", GIVEN)
def test_later_writes_into_the_callers_array_do_not_show(way: str) -> None:
    value, memory = GIVEN[way]()
    grid = small(value)
    before = grid.density.copy()
    memory[...] = 7.0
    np.testing.assert_array_equal(grid.density, before)
    assert grid.density.flags.c_contiguous
    assert not grid.density.flags.writeable


def test_balls_and_corners_are_copied_too() -> None:
    arrays = np.ones((2, 3)), np.ones(2), np.ones(2)
    balls = Metaballs(*arrays)
    lower, upper = np.zeros(3), np.ones(3)
    grid = VoxelGrid(fresh(), lower, upper)
    for part in (*arrays, lower, upper):
        part[...] = 9.0
    for part in (balls.centers, balls.radii, balls.densities, grid.upper):
        assert (part == 1.0).all()
    assert not grid.lower.any()


def test_vectors_and_colours_are_copied_everywhere() -> None:
    vector, colour = np.array([0.0, 1.0, 0.0]), np.full(3, 0.5)
    sun, medium = rc.Sun(vector, colour), rc.Medium(colour, colour)
    eye = rc.Camera(vector, [9.0, 9.0, 9.0], width=8, height=8)
    look = Look(sky_light=colour)
    vector[...] = 7.0
    colour[...] = 7.0
    for part in (sun.irradiance, medium.sigma_t, medium.albedo, look.sky_light):
        assert (np.asarray(part) == 0.5).all()
    assert eye.eye.tolist() == sun.direction.tolist() == [0.0, 1.0, 0.0]


def test_what_nobody_can_write_into_is_not_copied() -> None:
    density = sealed(fresh())
    grid = small(density)
    assert np.shares_memory(grid.density, density)
    for again in (
        small(grid.density),
        small(grid.density[1:3]),
        dataclasses.replace(grid, upper=np.full(3, 9.0)),
    ):
        assert np.shares_memory(again.density, density)
    values = fresh().tolist()
    array = np.asarray(values)
    assert settled(values, array) is array, "check made it of the list"


@pytest.mark.parametrize(
    "make",
    [
        lambda: rc.generate(voxel=1.0),
        lambda: rc.cloudmap.billows(voxel=1.0),
        lambda: rc.cloudmap.worley_smooth_texture(48),
        lambda: rc.cloudmap.box_cloud([0, 0, 0], [1, 1, 1], voxel=1 / 48, cell=0.3),
    ],
    ids=["generate", "billows", "texture", "box"],
)
def test_makers_hand_their_grids_over(make, monkeypatch: pytest.MonkeyPatch) -> None:
    """The step that builds the object takes no second grid."""
    peaks: list[float] = []
    own = VoxelGrid.__post_init__

    def traced(grid: VoxelGrid) -> None:
        tracemalloc.start()
        own(grid)
        peaks.append(tracemalloc.get_traced_memory()[1] / grid.density.size)
        tracemalloc.stop()

    monkeypatch.setattr(VoxelGrid, "__post_init__", traced)
    make()
    assert peaks
    # Checks hold a byte a cell, twice; a copy would be 8.
    assert max(peaks) < 4.0


def test_order_in_memory_changes_no_bit_of_a_fit() -> None:
    grid = rc.generate(voxel=2.0)
    turned = VoxelGrid(np.asfortranarray(grid.density), grid.lower, grid.upper)
    a, b = (rc.approximate(g, count=12) for g in (grid, turned))
    for name in ("centers", "radii", "densities"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


@settings(max_examples=20)
@given(seed=st.integers(0, 2**32))
def test_order_in_memory_changes_no_bit_of_clusters(seed: int) -> None:
    points = uniform(np.arange(300), seed=seed).reshape(100, 3)
    weights = uniform(1, np.arange(100), seed=seed)
    turned = np.asfortranarray(points)
    for a, b in (
        (lloyd(points, weights, 7), lloyd(turned, weights, 7)),
        (adaptive_kmeans(points, 7), adaptive_kmeans(turned, 7)),
    ):
        np.testing.assert_array_equal(a.centers, b.centers)
        np.testing.assert_array_equal(a.assignment, b.assignment)


@dataclasses.dataclass(frozen=True)
class Holder:
    numbers: np.ndarray
    name: str = "a"
    inner: Any = None


def spoiled(name: str, value: Any) -> int:
    """Count the arrays in a value; none of them lets itself be written into."""
    if isinstance(value, np.ndarray):
        assert not value.flags.writeable, name
        with pytest.raises(ValueError, match="read-only"):
            value[...] = 1
        return 1
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, (tuple, list)):
        return sum(spoiled(name, part) for part in value)
    if dataclasses.is_dataclass(value):
        fields = dataclasses.fields(value)
        return sum(spoiled(name, getattr(value, f.name)) for f in fields)
    return 0


def test_what_is_shown_is_read_only_all_through() -> None:
    numbers = fresh()
    value = {"a": [numbers, (1, numbers)], "b": Holder(numbers, inner=Holder(numbers))}
    assert spoiled("value", shown(value)) == 4
    assert numbers.flags.writeable, "the work itself goes on"
    assert value["b"].numbers is numbers
    numbers[...] = 2.0
    assert (shown(value)["b"].inner.numbers == 2.0).all(), "views, not copies"


def test_what_cannot_be_written_into_is_shown_as_it_is() -> None:
    grid = small(fresh())
    for value in (grid, (grid, 1), "text", 3.0, None, Holder(sealed(fresh()))):
        assert shown(value) is value


def test_an_observer_is_wrapped_once() -> None:
    once = only_looking(lambda name, value: value)
    assert isinstance(once, Onlooker)
    assert only_looking(once) is once
    assert once("name", 3) == 3


def drawn(name: str, cloud: VoxelGrid, observe: Any) -> Any:
    balls = rc.approximate(cloud, count=12)
    how = {**SIZE, "observe": observe}
    coloured = rc.Medium([0.3, 0.2, 0.1])
    return {
        "generate": lambda: rc.generate(voxel=4.0, observe=observe).density,
        "ellipsoid": lambda: rc.generate("ellipsoid", observe=observe).density,
        "billows": lambda: rc.cloudmap.billows(voxel=4.0, observe=observe).density,
        "approximate": lambda: (
            rc.approximate(cloud, count=12, observe=observe).densities
        ),
        "man": lambda: (
            rc.approximate(cloud, count=12, method="man", observe=observe).densities
        ),
        "balls": lambda: rc.render(balls, **how).linear,
        "coloured": lambda: rc.render(balls, medium=coloured, **how).linear,
        "eroded": lambda: rc.render(balls, look=ERODED, **how).linear,
        "grid": lambda: (
            rc.render(
                cloud, tolerance=1 / 255, width=64, height=40, observe=observe
            ).linear
        ),
        "multiple": lambda: (
            rc.render(small(fresh()), scattering="multiple", **how).linear
        ),
    }[name]()


@pytest.mark.parametrize(
    "name",
    [
        *("generate", "ellipsoid", "billows", "approximate", "man", "balls"),
        *("coloured", "eroded", "grid", "multiple"),
    ],
)
def test_no_observer_can_write_into_what_it_sees(cloud, name: str) -> None:
    seen: list[int] = []

    def look(name: str, value: Any) -> None:
        seen.append(spoiled(name, value))

    watched = drawn(name, cloud, look)
    np.testing.assert_array_equal(watched, drawn(name, cloud, None))
    assert sum(seen) or name == "billows", "something was shown"


def test_clouds_compare_by_identity() -> None:
    """Arrays have no truth value: a comparison of them would be an error."""
    balls = [Metaballs(np.zeros((2, 3)), np.ones(2), np.ones(2)) for _ in range(2)]
    grids = [small(fresh()) for _ in range(2)]
    for a, b in (balls, grids):
        assert (a == a, a == b, a in [b], len({a, b})) == (True, False, False, 2)
