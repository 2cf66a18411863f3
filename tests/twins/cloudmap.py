"""The cloud-map room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import refcloud.cloudmap as array
from refcloud.cloudmap.cumulus import CREST, LOBES, MEAN_NOISE, SHRINK
from refcloud.noise import uniform
from refcloud.plain import cloudmap as plain
from twins import Draw, twin

WITHOUT = {
    "refcloud.cloudmap.generate.generate": "composed of functions that have rows",
    "refcloud.cloudmap.file.save_voxels": "writes a file",
    "refcloud.cloudmap.file.load_voxels": "reads a file",
}

ROUNDED = "worst seen 4.5e-16 in 600 examples, times 10: the same few operations"
EXPANDED = "worst seen 2.3e-15 in 600 examples, times 10: squares that cancel"

coordinates = st.floats(-5.0, 5.0)
places = st.tuples(coordinates, coordinates, coordinates)
axes = st.tuples(*[st.floats(0.3, 4.0)] * 3)
turns = st.floats(-6.28, 6.28)
seeds = st.integers(-(2**63), 2**63 - 1)


@st.composite
def grids(draw: st.DrawFn) -> array.VoxelGrid:
    """Draw a small cloud map anywhere, with cells of any proportions."""
    shape = draw(st.tuples(*[st.integers(1, 4)] * 3))
    # Hashed: to draw each cell would take longer than to test it.
    density = 2.0 * uniform(np.arange(np.prod(shape)), seed=draw(seeds)).reshape(shape)
    density[density < 0.5] = 0.0
    lower, size = np.array(draw(places)), np.array(draw(axes))
    return array.VoxelGrid(density, lower, lower + size)


def plain_grid(grid: array.VoxelGrid) -> tuple:
    return grid.density.tolist(), grid.lower.tolist(), grid.upper.tolist()


@twin(array.quadric, plain.quadric, tolerance=2e-14, why=EXPANDED)
def quadric(draw: Draw):
    center, radii = draw(places), draw(axes)
    how = {"turn": draw(turns), "tilt": draw(turns), "roll": draw(turns)}
    return array.quadric(center, radii, **how), plain.quadric(center, radii, **how)


@twin(array.evaluate_quadric, plain.evaluate_quadric, tolerance=2e-14, why=EXPANDED)
def evaluate_quadric(draw: Draw):
    q = array.quadric(draw(places), draw(axes), turn=draw(turns), tilt=draw(turns))
    points = draw(st.lists(places, min_size=1, max_size=4))
    # Terms of up to 5000 meet: what is compared stays within the largest of them.
    largest = np.abs(q).max() * 25.0
    expected = [plain.evaluate_quadric(q.tolist(), p) / largest for p in points]
    return array.evaluate_quadric(q, np.array(points)) / largest, expected


@twin(array.modulate, plain.modulate, tolerance=5e-15, why=ROUNDED)
def modulate(draw: Draw):
    Q = draw(st.lists(st.floats(-1.0, 1.5), max_size=6))
    P = draw(st.lists(st.floats(0.0, 1.0), min_size=len(Q), max_size=len(Q)))
    how = {
        "threshold": draw(st.floats(0.0, 1.0, exclude_max=True)),
        "dynamics": draw(st.floats(0.0, 1.0, exclude_min=True)),
    }
    pairs = zip(Q, P, strict=True)
    return array.modulate(Q, P, **how), [plain.modulate(q, p, **how) for q, p in pairs]


@twin(array.cell_size, plain.cell_size, tolerance=0.0, why="the same quotient")
def cell_size(draw: Draw):
    grid = draw(grids())
    return array.cell_size(grid), plain.cell_size(*plain_grid(grid))


@twin(array.cell_centres, plain.cell_centres, tolerance=5e-15, why=ROUNDED)
def cell_centres(draw: Draw):
    grid = draw(grids())
    expected = plain.cell_centres(*plain_grid(grid))
    return np.concatenate(array.cell_centres(grid)), np.concatenate(expected)


@twin(
    array.trilinear,
    plain.trilinear,
    tolerance=5e-14,
    why="worst seen 2e-16; in cells of 0.08 at 5 a place is known to 1e-14 of a cell",
)
def trilinear(draw: Draw):
    grid = draw(grids())
    shares = draw(st.lists(st.tuples(*[st.floats(-0.2, 1.2)] * 3), max_size=5))
    points = grid.lower + np.reshape(shares, (-1, 3)) * (grid.upper - grid.lower)
    expected = [plain.trilinear(*plain_grid(grid), p) for p in points.tolist()]
    return array.trilinear(grid, points), expected


@twin(array.largest_part, plain.largest_part, tolerance=0.0, why="the same cells stay")
def largest_part(draw: Draw):
    shape = draw(st.tuples(*[st.integers(1, 5)] * 3))
    values = st.just(0.0) | st.floats(0.1, 1.0)
    density = draw(arrays(np.float64, shape, elements=values))
    return array.largest_part(density), plain.largest_part(density.tolist())


@twin(array.cumulus_ellipsoids, plain.cumulus_ellipsoids, tolerance=5e-15, why=ROUNDED)
def cumulus_ellipsoids(draw: Draw):
    diameters, seed = draw(st.tuples(*[st.floats(1.0, 100.0)] * 3)), draw(seeds)
    expected = plain.cumulus_ellipsoids(
        diameters, seed=seed, lobes=LOBES, shrink=SHRINK, crest=CREST
    )
    return np.stack(array.cumulus_ellipsoids(diameters, seed=seed), axis=1), expected


@twin(array.depth_inside, plain.depth_inside, tolerance=5e-15, why=ROUNDED)
def depth_inside(draw: Draw):
    pile = draw(st.lists(st.tuples(places, axes), max_size=4))
    line = st.lists(coordinates, min_size=1, max_size=3)
    x, y, z = draw(line), draw(line), draw(line)
    least = draw(st.sampled_from([-1e300, -1.0, 0.0]))
    centers, radii = np.reshape(pile, (-1, 2, 3)).swapaxes(0, 1)
    actual = array.depth_inside(x, y, z, centers=centers, radii=radii, least=least)
    expected = [
        [[plain.depth_inside((i, j, k), pile, least=least) for i in x] for j in y]
        for k in z
    ]
    return np.maximum(actual, -1e3), np.maximum(expected, -1e3)


@twin(array.displace, plain.displace, tolerance=5e-15, why=ROUNDED)
def displace(draw: Draw):
    shape = draw(st.tuples(*[st.integers(1, 3)] * 3))
    depth = draw(arrays(np.float64, shape, elements=st.floats(-10.0, 10.0)))
    noise = draw(arrays(np.float64, shape, elements=st.floats(-1.0, 1.0)))
    y = draw(arrays(np.float64, shape[1], elements=st.floats(-2.0, 2.0)))
    how = {"relief": draw(st.floats(0.0, 10.0)), "edge": draw(st.floats(0.1, 3.0))}
    expected = [
        [
            [
                plain.displace(d, n, height, **how, mean=MEAN_NOISE)
                for d, n in zip(depths, noises, strict=True)
            ]
            for depths, noises, height in zip(layer, noisy, y.tolist(), strict=True)
        ]
        for layer, noisy in zip(depth.tolist(), noise.tolist(), strict=True)
    ]
    return array.displace(depth, noise, y, **how), expected
