"""Simplex noise in space on a regular grid: the same few kernels, over and over.

The lattice of simplex noise in space comes back to itself after a step (a, b, c) of
whole units where a + b + c is a multiple of 3. So where a unit holds a whole number of
samples, the grid is made of blocks of one unit with but 3 kinds of surroundings, and

    noise of a block = gradients of the lattice points in reach @ their kernels,

where the kernels times the offsets, (r^2 - |d|^2)^4 d, are the same for all blocks of
a kind: they are made once, and the rest is one matrix product per kind.

The floor: tiles of 8 samples a side in blocks of 16 are in reach of some 10 points, so
30 multiplications a sample at about 0.05 ns each in float32, and one pass to put the
product's rows in their places at 1 ns.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.directions import SETS, USUAL
from refcloud.noise.mixing import Hash, _axis_bits, _choice, _joined
from refcloud.noise.scattered import Dtype, Numbers
from refcloud.products import ONE_THREAD

SQUARED = 0.5  # of the continuous radius: no kernel reaches out of its simplices
KINDS = 3  # of blocks, by the sum of their places modulo 3
TILE = 8  # samples along an axis that share a list of lattice points
LEAST = 1 << 12  # samples below which making kernels does not pay
SAME = 2.0**-46  # of a unit; the noise slopes up to 8, so it moves by 1e-13
AROUND = np.array(list(itertools.product(range(-5, 6), repeat=3)))  # reach + a block


@dataclass(frozen=True)
class Phases:
    """One axis, cut in blocks of one unit.

    Attributes
    ----------
    start
        The whole number that local coordinates are counted from.
    local
        Coordinates of the first block's samples, less `start`, shape (m,).
    blocks
        How many blocks there are; the last may reach past the axis's end.
    """

    start: int
    local: Array
    blocks: int


def _phases(axis: Array) -> Phases | None:
    """Cut an axis in blocks, None where a unit holds no whole number of samples."""
    start = np.floor(axis[0])
    local = axis - start
    size = local.size
    if np.ptp(local) < 1.0:
        return Phases(int(start), local, 1)
    m = int(np.argmin(np.abs(local - local[0] - 1.0)))
    number = np.arange(size)
    first = local[:m]
    if m == 0 or np.ptp(first) >= 1.0:
        return None
    if np.abs(first[number % m] + number // m - local).max() > SAME:
        return None
    return Phases(int(start), first, -(-size // m))


def _regular(axes: list[Array]) -> list[Phases] | None:
    """Cut the axes x, y, z of a grid in blocks, None where that does not pay."""
    size = int(np.prod([axis.size for axis in axes]))
    if len(axes) != 3 or size < LEAST:
        return None
    cut = []
    for axis in axes:
        if (phases := _phases(axis)) is None:
            return None
        cut.append(phases)
    whole = np.prod([phases.local.size * phases.blocks for phases in cut])
    return cut if whole <= 2 * size else None


def _on_blocks(cut: list[Phases], seed: int, hash: Hash, peak: float, dtype: Dtype):
    """Give simplex noise of the continuous radius, all blocks whole, as [z, y, x]."""
    (nx, ny, nz), (mx, my, mz) = (
        [phases.blocks for phases in cut],
        [phases.local.size for phases in cut],
    )
    out = np.empty((nz, mz, ny, my, nx, mx), dtype)
    by_block = out.transpose(0, 2, 4, 1, 3, 5)
    # 1. List the blocks of each kind: their places along x, y and z.
    places = np.indices((nx, ny, nz)).reshape(3, -1)
    starts = np.array([[phases.start] for phases in cut])
    total = (places + starts).sum(axis=0)
    rows = (SETS[USUAL[3]] / peak).astype(dtype)
    for kind, tile in itertools.product(range(KINDS), _tiles(mx, my, mz)):
        mine = places[:, total % KINDS == kind]
        if not mine.size:
            continue
        # 2. Make the kernels of the kind's first block, which lies at (kind, 0, 0).
        local = [phases.local[part] for phases, part in zip(cut, tile, strict=True)]
        points, kernels = _kernels(local, kind, dtype)
        # 3. Multiply them by the gradients, some blocks at a time.
        slopes = _slopes(points, mine + starts, kind, rows, seed, hash)
        step = max(1, ONE_THREAD // kernels.size)
        shape = [line.size for line in local[::-1]]
        for first in range(0, mine.shape[1], step):
            x, y, z = mine[:, first : first + step]
            made = (slopes[first : first + step] @ kernels).reshape(-1, *shape)
            by_block[z, y, x, tile[2], tile[1], tile[0]] = made
    return out.reshape(nz * mz, ny * my, nx * mx)


def _tiles(*sizes: int) -> Iterator[tuple[slice, ...]]:
    """Cut a block in tiles."""
    parts = [[slice(k, k + TILE) for k in range(0, size, TILE)] for size in sizes]
    return itertools.product(*parts)


def _kernels(
    local: list[Array], kind: int, dtype: Dtype
) -> tuple[NDArray[np.int64], Numbers]:
    """List the lattice points in reach of a tile, and their kernels times offsets.

    The tile is one of the block at (kind, 0, 0). Points have shape (L, 3), kernels
    (3 L, samples) with the samples in the order [z, y, x].
    """
    corner = np.array([kind, 0, 0])
    low, high = (np.array([end(line) for line in local]) for end in (np.min, np.max))
    middle = corner + (low + high) / 2
    near = AROUND + np.floor(middle + middle.sum() / 3).astype(np.int64)
    at = near - near.sum(axis=1, keepdims=True) / 6 - corner
    outside = at - np.clip(at, low, high)
    reached = (outside * outside).sum(axis=1) < SQUARED
    x, y, z = (
        line - p[:, np.newaxis] for line, p in zip(local, at[reached].T, strict=True)
    )
    x, y, z = x[:, None, None, :], y[:, None, :, None], z[:, :, None, None]
    kernel = (SQUARED - (z * z + y * y)).astype(dtype) - (x * x).astype(dtype)
    np.maximum(kernel, np.zeros_like(kernel), out=kernel)
    kernel *= kernel
    kernel *= kernel
    weighed = [kernel * d.astype(dtype) for d in (x, y, z)]
    count = 3 * int(reached.sum())
    return near[reached], np.stack(weighed, axis=1).reshape(count, -1)


def _slopes(
    points: NDArray[np.int64],
    block: NDArray[np.int64],
    kind: int,
    rows: Numbers,
    seed: int,
    hash: Hash,
) -> Numbers:
    """Look up the gradients of lattice points about blocks, shape (blocks, 3 L)."""
    # A step (a, b, c) with a + b + c = 3 h is one by (a + h, b + h, c + h) of the
    # lattice's own coordinates, whose sum then moves each of them back by h.
    third = (block.sum(axis=0) - kind) // KINDS
    moved = [block[0] - kind + third, block[1] + third, block[2] + third]
    words = [
        _axis_bits(points[:, k] + move[:, np.newaxis], k, seed, hash)
        for k, move in enumerate(moved)
    ]
    pick = _choice(_joined(words, seed, hash), len(rows))
    return rows[pick].reshape(len(pick), -1)
