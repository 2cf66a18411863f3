"""The metaballs room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.metaballs as array
from refcloud.cloudmap.voxels import VoxelGrid, cell_centres
from refcloud.metaballs.choices import spread_start, start_patterns, visits
from refcloud.noise.hashing import uniform
from refcloud.plain import metaballs as plain
from refcloud.plain import placing
from twins import twin

COMPOSED = "composed of functions that have rows; judged by its error, like any fit"
WITHOUT = {
    "refcloud.metaballs.approximate.approximate": COMPOSED,
    "refcloud.metaballs.direct.direct_metaballs": COMPOSED,
    "refcloud.metaballs.levels.levels_of_detail": COMPOSED,
    "refcloud.metaballs.levels.choose_level": "looks a row up; judged by pictures",
    "refcloud.metaballs.levels_file.save_levels": "writes a file",
    "refcloud.metaballs.levels_file.load_levels": "reads a file",
    "refcloud.metaballs.sampled.sampled_map": "field_grid at the centres of voxels;"
    " tested in tests/metaballs/test_sampled.py",
    "refcloud.metaballs.file.save_metaballs": "writes a file",
    "refcloud.metaballs.file.load_metaballs": "reads a file",
}

ROUNDED = "worst seen 8.2e-16 in 500 examples, times 10: powers and roots round apart"
SUMMED = "worst seen 2.4e-15 in 500 examples, times 10: sums run in another order"

kernels = st.sampled_from(["wyvill", "gaussian"])
distances = st.floats(0.0, 3.0) | st.sampled_from([0.0, 0.5, 1.0, 2.0])
lengths = st.floats(0.05, 20.0)
squared_ratios = st.floats(0.0, 1.3) | st.sampled_from([0.0, 0.25, 1.0])
seeds = st.integers(0, 2**63 - 1)
coordinates = st.floats(-3.0, 3.0)
places = st.tuples(coordinates, coordinates, coordinates)
densities = st.floats(0.0, 5.0)
balls_drawn = st.lists(st.tuples(places, st.floats(0.3, 3.0), densities), max_size=5)


def as_metaballs(balls, kernel="wyvill") -> array.Metaballs:
    centers = np.array([b[0] for b in balls]).reshape(-1, 3)
    return array.Metaballs(
        centers, [b[1] for b in balls], [b[2] for b in balls], kernel
    )


def scattered(seed: int, count: int, word: int = 0) -> np.ndarray:
    """Give points without ties: hashed, since drawn ones lie at equal distances."""
    return uniform(word, np.arange(count)[:, None], np.arange(3), seed=seed) * 4.0


@twin(array.wyvill, plain.wyvill, tolerance=8e-15, why=ROUNDED)
def wyvill(draw):
    r, R = draw(distances), draw(lengths)
    return array.wyvill(r, R), plain.wyvill(r, R)


@twin(array.printed_wyvill, plain.printed_wyvill, tolerance=8e-15, why=ROUNDED)
def printed_wyvill(draw):
    r, R = draw(distances), draw(lengths)
    return array.printed_wyvill(r, R), plain.printed_wyvill(r, R)


@twin(array.gaussian, plain.gaussian, tolerance=8e-15, why=ROUNDED)
def gaussian(draw):
    r, sigma = draw(distances), draw(lengths)
    return array.gaussian(r, sigma), plain.gaussian(r, sigma)


@twin(array.profile, plain.profile, tolerance=8e-15, why=ROUNDED)
def profile(draw):
    q, kernel = draw(squared_ratios), draw(kernels)
    return array.profile(q, kernel), plain.profile(q, kernel)


@twin(array.chord, plain.chord, tolerance=8e-15, why=ROUNDED)
def chord(draw):
    q, kernel = draw(squared_ratios), draw(kernels)
    return array.chord(q, kernel), plain.chord(q, kernel)


@twin(array.integral, plain.integral, tolerance=8e-15, why=ROUNDED)
def integral(draw):
    kernel, dimension, R = draw(kernels), draw(st.integers(1, 3)), draw(lengths)
    return (
        array.integral(kernel, dimension, R=R),
        plain.integral(kernel, dimension, R=R),
    )


@twin(array.normalisation, plain.normalisation, tolerance=8e-15, why=ROUNDED)
def normalisation(draw):
    kernel, R = draw(kernels), draw(lengths)
    how = draw(st.sampled_from(["peak", "volume", "paper"]))
    return (
        array.normalisation(kernel, how, R=R),
        plain.normalisation(kernel, how, R=R),
    )


@twin(array.axis_depth, plain.axis_depth, tolerance=8e-15, why=ROUNDED)
def axis_depth(draw):
    sigma_t, kernel = draw(st.floats(0.0, 10.0)), draw(kernels)
    rows = draw(st.lists(st.tuples(densities, lengths), max_size=4))
    thick, wide = [row[0] for row in rows], [row[1] for row in rows]
    actual = array.axis_depth(sigma_t, thick, wide, kernel)
    return actual, [plain.axis_depth(sigma_t, *row, kernel) for row in rows]


@twin(array.field, plain.field, tolerance=2.4e-14, why=SUMMED)
def field(draw):
    balls, kernel = draw(balls_drawn), draw(kernels)
    points = draw(st.lists(places, min_size=1, max_size=4))
    actual = array.field(as_metaballs(balls, kernel), np.array(points))
    return actual, [plain.field(balls, point, kernel) for point in points]


@twin(array.field_grid, plain.field_grid, tolerance=2.4e-14, why=SUMMED)
def field_grid(draw):
    balls, kernel = draw(balls_drawn), draw(kernels)
    axis = st.lists(coordinates, min_size=1, max_size=3, unique=True).map(sorted)
    x, y, z = draw(axis), draw(axis), draw(axis)
    actual = array.field_grid(as_metaballs(balls, kernel), x, y=y, z=z)
    expected = [
        [[plain.field_grid(balls, i, y=j, z=k, kernel=kernel) for i in x] for j in y]
        for k in z
    ]
    return actual, expected


@twin(array.voxel_balls, plain.voxel_balls, tolerance=8e-15, why=ROUNDED)
def voxel_balls(draw):
    kernel = draw(kernels)
    edges = draw(st.tuples(lengths, lengths, lengths))
    values = draw(st.lists(densities, min_size=1, max_size=4))
    upper = [edges[0] * len(values), edges[1], edges[2]]
    balls = array.voxel_balls(VoxelGrid([[values]], [0, 0, 0], upper), kernel=kernel)
    expected = [plain.voxel_balls(v, edges, kernel=kernel) for v in values if v > 0.0]
    actual = np.stack([balls.radii, balls.densities], axis=1)
    return actual, np.array(expected).reshape(-1, 2)


@twin(array.placed, plain.placed, tolerance=8e-15, why=ROUNDED)
def placed(draw):
    balls, offset = draw(balls_drawn), draw(places)
    turn, scale = draw(st.floats(-6.2, 6.2)), draw(st.floats(0.1, 10.0))
    moved = array.placed(as_metaballs(balls), offset, turn=turn, scale=scale)
    actual = np.hstack([moved.centers, moved.radii[:, None], moved.densities[:, None]])
    rows = [plain.placed(ball, offset, turn=turn, scale=scale) for ball in balls]
    return actual, np.array([[*c, R, v] for c, R, v in rows]).reshape(-1, 5)


@twin(array.prune, plain.prune, tolerance=0.0, why="the same balls are kept")
def prune(draw):
    seed, count = draw(seeds), draw(st.integers(0, 8))
    spots = scattered(seed, count)
    how = {"neighbour": draw(st.integers(1, 6)), "reach": draw(st.floats(0.1, 3.0))}
    balls = array.Metaballs(spots, np.ones(count), 1.0 + np.arange(count))
    listed = [(spot, 1.0, 1.0) for spot in spots.tolist()]
    kept = plain.prune(listed, **how)
    return array.prune(balls, **how).densities, 1.0 + np.flatnonzero(kept)


@twin(array.depth, plain.depth, tolerance=8e-15, why=ROUNDED)
def depth(draw):
    shape = draw(st.tuples(*[st.integers(1, 4)] * 3))
    edges = draw(st.tuples(*[st.floats(0.3, 3.0)] * 3))
    full = uniform(np.arange(np.prod(shape)), seed=draw(seeds)).reshape(shape)
    density = np.where(full < draw(st.floats(0.5, 1.0)), full, 0.0)
    expected = [
        [
            [plain.depth(density.tolist(), edges, x, y, z) for x in range(shape[2])]
            for y in range(shape[1])
        ]
        for z in range(shape[0])
    ]
    return array.depth(density, edges), expected


@twin(array.adaptive_kmeans, plain.adaptive_kmeans, tolerance=2.4e-14, why=SUMMED)
def adaptive_kmeans(draw):
    seed, total, count = draw(seeds), draw(st.integers(1, 12)), draw(st.integers(1, 4))
    order = draw(st.sampled_from(["shuffled", "raster"]))
    points = scattered(seed, total)
    epochs = draw(st.integers(1, 3))
    found = array.adaptive_kmeans(
        points, count, seed=seed, order=order, minimal_rate=1e-9, most_epochs=epochs
    )
    start = start_patterns(total, count, seed)
    orders = [visits(total, epoch, seed, order) for epoch in range(epochs)]
    centers = plain.adaptive_kmeans(points.tolist(), start.tolist(), orders)
    return found.centers, filled(points, centers)


@twin(array.lloyd, plain.lloyd, tolerance=2.4e-14, why=SUMMED)
def lloyd(draw):
    seed, total, count = draw(seeds), draw(st.integers(1, 12)), draw(st.integers(1, 4))
    rounds = draw(st.integers(0, 3))
    points = scattered(seed, total)
    weights = uniform(1, np.arange(total), seed=seed)
    found = array.lloyd(points, weights, count, seed=seed, rounds=rounds)
    middle = points.mean(axis=0)
    scale = np.abs(points - middle).max() or 1.0
    shares = weights / weights.max()
    start = spread_start((points - middle) / scale, shares, count, seed)
    centers = plain.lloyd(points.tolist(), weights.tolist(), start.tolist(), rounds)
    return found.centers, filled(points, centers)


def filled(points, centers) -> list:
    """Leave out centres that no point is nearest to."""
    used = {plain.nearest(point, centers) for point in points.tolist()}
    return [center for k, center in enumerate(centers) if k in used]


@twin(array.rms_radii, plain.rms_radii, tolerance=8e-15, why=ROUNDED)
def rms_radii(draw):
    seed, total, count = draw(seeds), draw(st.integers(0, 9)), draw(st.integers(1, 3))
    points, centers = scattered(seed, total), scattered(seed, count, word=1)
    labels = np.floor(uniform(2, np.arange(total), seed=seed) * count).astype(int)
    spacing = draw(lengths)
    weights = uniform(3, np.arange(total), seed=seed) if draw(st.booleans()) else None
    actual = array.rms_radii(
        points, labels, centers=centers, spacing=spacing, weights=weights
    )
    expected = []
    for k in range(count):
        own = labels == k
        mass = None if weights is None else weights[own].tolist()
        expected.append(
            plain.rms_radii(
                points[own].tolist(), centers[k], spacing=spacing, weights=mass
            )
        )
    return actual, expected


def overlapping(seed: int, rows: int, columns: int) -> np.ndarray:
    """Give a design matrix like that of balls: numbers in [0, 1], never dependent."""
    design = uniform(np.arange(rows)[:, None], np.arange(columns), seed=seed)
    return design + 2.0 * np.eye(rows, columns)


@twin(
    array.largest_eigenvalue,
    plain.largest_eigenvalue,
    tolerance=1e-6,
    why="the iteration ends where the value moves by less than 1e-9 of itself",
)
def largest_eigenvalue(draw):
    design = overlapping(draw(seeds), 5, draw(st.integers(1, 4)))
    gram = design.T @ design
    return array.largest_eigenvalue(gram), plain.largest_eigenvalue(gram.tolist())


@twin(array.gradient_descent, plain.gradient_descent, tolerance=2.4e-14, why=SUMMED)
def gradient_descent(draw):
    seed, steps = draw(seeds), draw(st.integers(0, 10))
    design = overlapping(seed, 5, draw(st.integers(1, 4)))
    y = uniform(7, np.arange(5), seed=seed)
    rate = draw(st.floats(0.01, 0.9)) / np.linalg.norm(design, 2) ** 2
    actual = array.gradient_descent(design, y, rate=rate, most_steps=steps)
    expected = plain.gradient_descent(
        design.tolist(), y.tolist(), rate=rate, steps=steps
    )
    return actual, expected


@twin(
    array.non_negative_least_squares,
    plain.non_negative_least_squares,
    tolerance=1e-10,
    why="both meet the conditions to 1e-12 of the right side; condition below 100",
)
def non_negative_least_squares(draw):
    seed = draw(seeds)
    design = overlapping(seed, 6, draw(st.integers(1, 5)))
    gram = design.T @ design
    right = (uniform(9, np.arange(len(gram)), seed=seed) - 0.5) * 4.0
    actual = array.non_negative_least_squares(gram, right)
    return actual, plain.non_negative_least_squares(gram.tolist(), right.tolist(), 300)


@twin(
    array.orthogonal_least_squares,
    placing.orthogonal_least_squares,
    tolerance=0.0,
    why="the same columns in the same order",
)
def orthogonal_least_squares(draw):
    seed, columns = draw(seeds), draw(st.integers(1, 5))
    design = overlapping(seed, 8, columns)
    y = uniform(10, np.arange(8), seed=seed)
    count = draw(st.integers(1, 6))
    expected = placing.orthogonal_least_squares(design.tolist(), y.tolist(), count)
    return array.orthogonal_least_squares(design, y, count), expected


@twin(
    array.place_and_subtract, placing.place_and_subtract, tolerance=2.4e-14, why=SUMMED
)
def place_and_subtract(draw):
    shape = draw(st.tuples(*[st.integers(1, 4)] * 3))
    density = uniform(np.arange(np.prod(shape)), seed=draw(seeds)).reshape(shape)
    edges = draw(st.sampled_from([(1.0, 1.0, 1.0), (0.5, 2.0, 1.0)]))
    radii = draw(st.sampled_from([(1.1,), (0.6, 1.3, 2.2)]))
    count = draw(st.integers(1, 4))
    expected = placing.place_and_subtract(density.tolist(), edges, radii, count=count)
    actual = array.place_and_subtract(density, edges, radii, count=count)
    return actual, np.array(expected).reshape(-1, 5)


@twin(array.errors_of_fit, plain.errors_of_fit, tolerance=2.4e-14, why=SUMMED)
def errors_of_fit(draw):
    balls, seed = draw(balls_drawn), draw(seeds)
    density = uniform(np.arange(24), seed=seed).reshape(2, 3, 4)
    density[density < 0.3] = 0.0
    density[0, 0, 0] = 1.0
    grid = VoxelGrid(density, [-2, -2, -2], [2, 2, 2])
    x, y, z = cell_centres(grid)
    found = np.array(
        [[[plain.field(balls, (i, j, k)) for i in x] for j in y] for k in z]
    )
    errors = array.errors_of_fit(grid, as_metaballs(balls))
    pairs = [(density, found), (density[density > 0.0], found[density > 0.0])]
    pairs += [(density.sum(axis=a), found.sum(axis=a)) for a in (2, 1, 0)]
    expected = [plain.errors_of_fit(y.ravel(), g.ravel()) for y, g in pairs]
    return [errors.density, errors.occupied, *errors.projected], expected
