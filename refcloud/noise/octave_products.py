"""The sum of octaves on parts of a grid, as products of small matrices.

`octave_sum_grid` sums two taps along one axis after another, in passes over the whole
grid. Here a grid is cut into cubes of 16 x 16 x 16 samples, and only wanted ones are
made. Along an axis 16 samples need few lattice lines, so that their taps are one small
dense matrix; along the last axis all octaves are summed by one product:

    sum_i s^i Wz_i (Wy_i (Wx_i f_i)) = [Wz_1 Wz_2 ...] [s Wy_1 Wx_1 f_1; ...]

Sums are taken in float64, in another order than `octave_sum_grid`: values agree to its
last bits, and are rounded to float32 once. Every product is smaller than 2^18, from
where OpenBLAS may use more threads: the same bits whatever their number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.fractal import _how, _placed
from refcloud.noise.lattice import AxisTaps, _axis, _block
from refcloud.noise.octaves import octave_frame
from refcloud.noise.value_grid import Axes

EDGE = 16  # samples along a cube's edge
SLAB = 2 * EDGE  # layers of samples whose lattice is hashed at a time
WIDE = 2 * EDGE  # samples of a row that one product interpolates

Cubes = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Octave:
    """One octave: the taps of each axis, z y x, its seed, what its values count."""

    taps: tuple[AxisTaps, AxisTaps, AxisTaps]
    seed: int | None
    amplitude: float


def octave_sum_products(
    axes: Axes,
    wanted: Cubes,
    *,
    octaves: int,
    persistence: float,
    seed: int | None,
    per: float,
) -> NDArray[np.float32]:
    """Give min(|sum of octaves| / per, 1) in wanted cubes of a grid, unchecked.

    Parameters
    ----------
    axes
        x, y and z of the samples, in cells of the first octave, ascending.
    wanted
        Cubes of 16 samples a side that are needed, as [z, y, x].
    octaves, persistence, seed
        As `octave_sum_grid`, whose other arguments have their defaults.
    per
        What counts as 1.

    Returns
    -------
    Shape (D, H, W); 0 in cubes that are not wanted, but for those between two wanted
    ones of a row, which cost little.
    """
    summed = []
    for i in range(octaves):
        own, shift = octave_frame(i, seed=seed)
        how = _how(own, i, "cosine", None, "float64")
        x, y, z = (_axis(c, "cosine", True) for c in _placed(axes, i, shift, how))
        summed.append(_Octave((z, y, x), own, persistence**i / per))
    D, H, W = (c.size for c in axes[::-1])
    out = np.zeros((D, H, W), np.float32)
    for first in range(0, D if summed else 0, SLAB):
        layers = slice(first, min(first + SLAB, D))
        here = wanted[first // EDGE : -(-layers.stop // EDGE)]
        if here.any():
            _add_slab(out, layers, here, summed)
    return out


def _add_slab(
    out: NDArray[np.float32], layers: slice, wanted: Cubes, octaves: list[_Octave]
) -> None:
    """Fill the wanted cubes of some layers of samples."""
    # 1. The box around them, and there the lattice of each octave; along x it is
    #    interpolated already: as many values as lines along y and z, times samples.
    y_box, x_box = (
        _around(wanted.any(axis=others), n)
        for others, n in (((0, 2), out.shape[1]), ((0, 1), out.shape[2]))
    )
    rows = [_interpolated(octave, layers, y_box, x_box) for octave in octaves]
    for k, j in zip(*np.nonzero(wanted.any(axis=2)), strict=True):
        first = layers.start + EDGE * k
        z = slice(first, min(first + EDGE, layers.stop))
        y = slice(EDGE * j, min(EDGE * j + EDGE, out.shape[1]))
        x = _around(wanted[k, j], out.shape[2])
        part = slice(x.start - x_box.start, x.stop - x_box.start)
        # 2. Along y, all octaves' planes one after the other.
        along_y = [_dense(o.taps[1], y) for o in octaves]
        along_z = [_dense(o.taps[0], z) for o in octaves]
        planes = sum(m.shape[1] for _, m in along_z)
        G = np.empty((y.stop - y.start, planes, part.stop - part.start))
        done = 0
        for (low_y, low_z, f), (line, m), (plane, n) in zip(
            rows, along_y, along_z, strict=True
        ):
            these = f[plane - low_z :][: n.shape[1]]
            some = these[:, line - low_y :][:, : m.shape[1], part]
            to = G[:, done : done + n.shape[1]].transpose(1, 0, 2)
            np.matmul(m, some, out=to)
            done += n.shape[1]
        # 3. Along z, and over the octaves.
        values = np.matmul(np.concatenate([n for _, n in along_z], axis=1), G)
        np.abs(values, out=values)
        np.minimum(values, 1.0, out=values)
        out[z, y, x] = values.transpose(1, 0, 2)


def _interpolated(
    octave: _Octave, z: slice, y: slice, x: slice
) -> tuple[int, int, Array]:
    """Give an octave's lattice, interpolated along x: its first lines y, z; values."""
    (z0, z1), (y0, y1), (x0, x1) = (
        (int(taps.index[:, part].min()), int(taps.index[:, part].max()) + 1)
        for taps, part in zip(octave.taps, (z, y, x), strict=True)
    )
    lines = (
        taps.lines[low : high + 2]  # smoothing uses up one at each end
        for taps, low, high in zip(
            octave.taps[::-1], (x0, y0, z0), (x1, y1, z1), strict=True
        )
    )
    f = _block(*lines, seed=octave.seed, smooth=True)
    f *= octave.amplitude
    out = np.empty((*f.shape[:2], x.stop - x.start))
    for some in _parts(x, WIDE):
        line, m = _dense(octave.taps[2], some)
        near = f[..., line - x0 :][..., : m.shape[1]]
        to = out[..., some.start - x.start : some.stop - x.start]
        for first in range(0, f.shape[1], WIDE // 2):
            rows = slice(first, first + WIDE // 2)
            np.matmul(near[:, rows], m.T, out=to[:, rows])
    return y0, z0, out


def _dense(taps: AxisTaps, part: slice) -> tuple[int, Array]:
    """Give the taps of some samples as a matrix, and the lattice line it begins at."""
    index = taps.index[:, part]
    low = int(index.min())
    matrix = np.zeros((index.shape[1], int(index.max()) + 1 - low))
    for line, weight in zip(index, taps.weights[:, part], strict=True):
        matrix[np.arange(len(matrix)), line - low] += weight
    return low, matrix


def _parts(part: slice, size: int) -> Iterator[slice]:
    for first in range(part.start, part.stop, size):
        yield slice(first, min(first + size, part.stop))


def _around(wanted: Any, size: int) -> slice:
    """Give the samples from the first wanted cube of an axis to the last."""
    cubes = np.flatnonzero(wanted)
    return slice(EDGE * int(cubes[0]), min(EDGE * int(cubes[-1]) + EDGE, size))
