"""A cloud whose every place shines: its light and its transmittance along rays.

All light models that know what a place sends to the eye end here. The march gathers:
one table holds color and extinction of each sample side by side, so that a sample of a
ray costs eight reads of four neighbouring numbers.

1. Rays that miss the box are left out.
2. All rays of a chunk go forward together, a step at a time, from a start that is
   hashed by pixel: equal starts would show as rings.
3. Rays that stand between eight empty samples wait; the others are sampled.
4. A ray ends where its transmittance is at most `least`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.checking import checked, complaint
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array, Positive, Range, Seed, Shape, Skipped
from refcloud.march import ray_box
from refcloud.noise import uniform

Table = NDArray[Any]  # float64 or float32, as the caller asks
DType = Literal["float64", "float32"]
MOST_CELLS = 1 << 26  # 2 GB of float64, four numbers each
MOST_STEPS = 1 << 16  # on a ray: more would take hours
CHUNK = 1 << 14  # rays at a time: what all steps read and write stays in the cache
Step = Annotated[float, Positive]
Least = Annotated[float, Range(0.0, 1.0, open_upper=True)]


@dataclass(frozen=True)
class Shining:
    """A cloud that shines, as the march reads it.

    Attributes
    ----------
    table
        Color times 1 and extinction per scene unit, shape (D + 2, H + 2, W + 2, 4):
        the grid with its border once more around it, since values go on as they are
        from the outermost centres to the walls.
    occupied
        Whether one of the eight samples around a place has extinction, shape
        (D + 1, H + 1, W + 1).
    lower, size
        Corner of the box and edges of a cell, shape (3,), scene units.
    """

    table: Table
    occupied: NDArray[np.bool_]
    lower: Array
    size: Array


def shining_of(grid: VoxelGrid, sigma_t: float, dtype: DType) -> Shining:
    """Make the table of a cloud, still dark.

    Parameters
    ----------
    grid
        The cloud map.
    sigma_t
        Extinction at density 1, 1 / scene unit.
    dtype
        Type of the numbers.

    Returns
    -------
    The table with colors 0.
    """
    D, H, W = grid.density.shape
    if grid.density.size > MOST_CELLS:
        got = f"{grid.density.size} cells"
        raise ValueError(complaint("grid", f"at most {MOST_CELLS} cells", got))
    table = np.zeros((D + 2, H + 2, W + 2, 4), dtype)
    inner = table[1:-1, 1:-1, 1:-1, 3]
    np.multiply(grid.density, sigma_t, out=inner, casting="same_kind")
    bordered(table[..., 3:])
    some = table[..., 3] > 0.0
    for axis in range(3):
        n = some.shape[axis]
        some = some.take(range(n - 1), axis) | some.take(range(1, n), axis)
    return Shining(table, some, grid.lower, cell_size(grid))


def bordered(table: Table) -> None:
    """Repeat the outermost samples around a table, in place."""
    for axis in range(3):
        side = np.moveaxis(table, axis, 0)
        side[0], side[-1] = side[1], side[-2]


@checked
def march_shining(
    grid: VoxelGrid,
    colors: Annotated[Array, Shape("D", "H", "W", 3), Range(0.0)],
    camera: Camera | OrthographicCamera,
    *,
    sigma_t: Annotated[float, Range(0.0, unit="1 / scene unit")],
    step: Step,
    least: Least = 0.0,
    seed: Seed = 0,
    dtype: DType = "float64",
) -> tuple[Array, Array]:
    """March a camera's rays through a cloud that shines.

    Formula: L += T (1 - exp(-sigma dt)) color, T *= exp(-sigma dt), from the eye on,
    sigma and color at t0 + (k + u) dt, u hashed by pixel

    Parameters
    ----------
    grid
        The cloud map; its density times sigma_t is sigma.
    colors
        Radiance per unit of optical depth at the samples, linear RGB, shape
        (D, H, W, 3).
    camera
        The eye.
    sigma_t
        Extinction at density 1, 1 / scene unit.
    step
        dt, scene units.
    least
        A ray ends where its transmittance is at most this.
    seed
        Chooses the starts of the rays.
    dtype
        Type of the arithmetic: "float64", or "float32", some 1e-5 off.

    Returns
    -------
    Radiance of shape (H, W, 3), and transmittance of shape (H, W).

    Raises
    ------
    ValueError
        A ray would have more than 65,536 steps, or the grid has more than 2^26 cells.

    Source: document D (R02, R03); E38.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [-1, -1, -1], [1, 1, 1])
    >>> eye = OrthographicCamera([0, 0, 9], [0, 0, 0], width=1, height=1)
    >>> white = dict(colors=np.ones((2, 2, 2, 3)), sigma_t=0.5)
    >>> L, T = march_shining(grid, camera=eye, step=0.125, **white)
    >>> bool(np.allclose(L + T[..., None], 1.0, atol=1e-6)), abs(T[0, 0] - 0.37) < 0.03
    (True, np.True_)
    """
    cloud = shining_of(grid, sigma_t, dtype)
    cloud.table[1:-1, 1:-1, 1:-1, :3] = colors
    bordered(cloud.table[..., :3])
    radiance, through, _ = marched(cloud, camera, step=step, least=least, seed=seed)
    return radiance, through


def marched(
    cloud: Shining,
    camera: Camera | OrthographicCamera,
    *,
    step: float,
    least: float,
    seed: int,
) -> tuple[Array, Array, tuple[Skipped, ...]]:
    """March without a check, and tell what was left out.

    Parameters
    ----------
    cloud
        The table.
    camera, step, least, seed
        As `march_shining`.

    Returns
    -------
    Radiance of shape (H, W, 3), transmittance of shape (H, W), and rows of what was
    skipped.
    """
    height, width = camera.height, camera.width
    origins, directions = (a.reshape(-1, 3) for a in rays(camera))
    counts = np.array(cloud.occupied.shape[::-1]) - 1
    upper = cloud.lower + counts * cloud.size
    across = float(np.sqrt(np.square(counts * cloud.size).sum()))
    if across / MOST_STEPS > step:
        expected = f"at least {across / MOST_STEPS:.3g}, {MOST_STEPS} steps on a ray"
        raise ValueError(complaint("step", expected, f"{step:g}"))
    # 1. Rays that meet the box, and where each begins.
    t0, t1 = ray_box(origins, directions, lower=cloud.lower, upper=upper)
    hit = np.flatnonzero(t1 > t0)
    row, column = np.divmod(hit, width)
    late = uniform(row, column, seed=seed)
    radiance = np.zeros((height * width, 3))
    through = np.ones(height * width)
    tally = np.zeros(3, np.int64)
    for first in range(0, len(hit), CHUNK):
        some = hit[first : first + CHUNK]
        start = t0[some] + late[first : first + CHUNK] * step
        # In cells of the table, whose first centre lies half a cell outside the box.
        at = origins[some] - cloud.lower + start[:, None] * directions[some]
        at = at / cloud.size + 0.5
        move = directions[some] * (step / cloud.size)
        steps = np.ceil((t1[some] - start) / step).astype(np.int64)
        found = _go(cloud, at, move, steps, step, least, tally)
        radiance[some], through[some] = found
    sampled, passed, ended = tally.tolist()
    # Either the cloud is missed behind the front, or a background of at most white.
    brightest = max(float(cloud.table[..., :3].max()), 1.0)
    skipped = (
        Skipped("march", "samples between empty voxels", passed, passed + sampled),
        Skipped(
            "march", "rays behind an opaque front", ended, len(hit), least * brightest
        ),
    )
    shape = height, width
    return radiance.reshape(*shape, 3), through.reshape(shape), skipped


def _go(
    cloud: Shining,
    at: Array,
    move: Array,
    steps: NDArray[np.int64],
    step: float,
    least: float,
    tally: NDArray[np.int64],
) -> tuple[Table, Table]:
    """Take all rays of a chunk through the cloud, in the arithmetic of the table."""
    D, H, W = (n - 1 for n in cloud.occupied.shape)
    flat, occupied = cloud.table.reshape(-1, 4), cloud.occupied.ravel()
    line, layer = W + 2, (W + 2) * (H + 2)
    dtype = cloud.table.dtype
    real = dtype.type
    last = np.array([W, H, D], dtype)
    corners = (0, line, layer, layer + line)
    start, speed = at.astype(dtype), move.astype(dtype)
    light: Table = np.zeros((len(at), 3), dtype)
    T: Table = np.ones(len(at), dtype)
    going = np.flatnonzero(steps > 0)
    for k in range(int(steps.max(initial=0))):
        # 2. Where the rays are that still go; rounding may leave them outside.
        place = start[going] + real(k) * speed[going]
        np.clip(place, 0.0, last, out=place)
        cell = place.astype(np.int32)
        # 3. Those with cloud around them.
        i, j, m = cell.T
        here = occupied[(m * (H + 1) + j) * (W + 1) + i]
        index = going[here]
        tally[:2] += len(index), len(going) - len(index)
        if len(index):
            place, cell = place[here], cell[here]
            place -= cell
            first = cell[:, 2] * layer + cell[:, 1] * line + cell[:, 0]
            u, v, w = place[:, :1], place[:, 1:2], place[:, 2:]
            edges = []
            for corner in corners:
                near = flat.take(first + corner, 0)
                far = flat.take(first + (corner + 1), 0)
                far -= near
                far *= u
                far += near
                edges.append(far)
            for a, b, t in ((0, 1, v), (2, 3, v), (1, 3, w)):
                edges[b] -= edges[a]
                edges[b] *= t
                edges[b] += edges[a]
            sample = edges[3]
            share = -np.expm1(-real(step) * sample[:, 3])
            seen = T[index]
            light[index] += (seen * share)[:, None] * sample[:, :3]
            T[index] = seen - seen * share
        # 4. Rays that are through, and rays that nothing shines through any more.
        unfinished = steps[going] > k + 1
        clear = T[going] > least
        tally[2] += np.count_nonzero(unfinished & ~clear)
        going = going[unfinished & clear]
    return light, T
