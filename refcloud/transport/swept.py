"""The sweep of prepared beams: light carried along every direction, as few terms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.products import product
from refcloud.transport.beams import Beams, Group

Reals = NDArray[np.floating[Any]]


def swept_terms(terms: Reals, beams: Beams, to_source: Array, to_terms: Array) -> Reals:
    """Sweep sources that are given, and radiance that is wanted, as terms.

    Parameters
    ----------
    terms
        Of the source, shape (R, B, M): R numbers for a batch of B in each near voxel.
    beams
        Of `prepare`.
    to_source, to_terms
        Shapes (N, R) and (R, N).

    Returns
    -------
    Terms of the mean radiance, shape (R, B, M). Outside is dark.
    """
    R, B, M = terms.shape
    dtype = terms.dtype
    if M == 0:
        return np.zeros((len(to_terms), B, 0), dtype)
    # One product for all directions; rows are then overwritten by what comes of them.
    rows = product(to_source.astype(dtype), terms.reshape(R, -1), beams.gathered)
    for group in beams.groups:
        places = beams.places[group.axis]
        n, K = len(group.members), beams.shape[group.axis]
        source = beams.sources[group.axis][: n * B]
        radiance = beams.radiance[: source.size].reshape(source.shape)
        cases = [part for m in group.members for part in rows[m].reshape(B, M)]
        for line, values in zip(source, cases, strict=True):
            line[places] = values
        h, w = (size for a, size in enumerate(beams.shape) if a != group.axis)
        _march(
            source.reshape(n, B, K, -1), radiance.reshape(n, B, K, -1), group, (h, w)
        )
        for line, values in zip(radiance, cases, strict=True):
            np.take(line, places, out=values, mode="clip")  # "raise" would buffer
    return product(to_terms.astype(dtype), rows).reshape(-1, B, M)


def dense(values: Reals, beams: Beams) -> Reals:
    """Spread values of the near voxels, (..., M), over the grid, (..., D, H, W)."""
    spread = np.zeros((*values.shape[:-1], math.prod(beams.shape)), values.dtype)
    at = np.ravel_multi_index(beams.near, beams.shape)
    lines = spread.reshape(-1, spread.shape[-1])
    for line, row in zip(lines, values.reshape(len(lines), -1), strict=True):
        line[at] = row
    return spread.reshape(*values.shape[:-1], *beams.shape)


def compact(values: Reals, beams: Beams) -> Reals:
    """Pick the near voxels' values, (..., M), out of (..., D, H, W)."""
    at = np.ravel_multi_index(beams.near, beams.shape)
    flat = values.reshape(*values.shape[:-3], -1)
    return flat.take(at, axis=-1)


def _march(source: Reals, radiance: Reals, group: Group, rows: tuple[int, int]) -> None:
    """Step a group's beams through the slices; shapes (n, B, K, h (w + 1))."""
    n, B, K, size = source.shape
    kind = _Shifted if group.offsets is None else _Offset
    beams = kind(group, n, B, rows, source.dtype)
    gap = np.zeros((n, B, size), source.dtype)
    order = range(K) if group.sense > 0 else range(K - 1, -1, -1)
    for k in order:
        S, out = source[:, :, k], radiance[:, :, k]
        beams.less(S, gap)  # I - S
        for first, last, fade, mean in group.runs:
            np.multiply(gap[first:last], mean[k], out=out[first:last])
            gap[first:last] *= fade[k]
        out += S
        np.add(gap, S, out=beams.leaving())


class _Offset:
    """Beams that move by whole voxels: seen from elsewhere, they have moved.

    Two lines take turns: one is looked at, one is written.
    """

    def __init__(
        self, group: Group, n: int, B: int, rows: tuple[int, int], dtype: Any
    ) -> None:
        h, w = rows
        size, room = h * (w + 1), w + 2  # no offset reaches farther than a row and one
        frames = np.zeros((2, n, B, size + 2 * room), dtype)
        self.turn = 0
        self.views = [
            [
                frame[i, :, room - offset : room - offset + size]
                for i, offset in enumerate(group.offsets or ())
            ]
            for frame in frames
        ]
        self.lines = [frame[:, :, room : room + size] for frame in frames]

    def less(self, S: Reals, gap: Reals) -> None:
        """Take the source off what arrives."""
        for view, s, g in zip(self.views[self.turn], S, gap, strict=True):
            np.subtract(view, s, out=g)

    def leaving(self) -> Reals:
        """Give the line that takes what goes on."""
        self.turn = 1 - self.turn
        return self.lines[self.turn]


class _Shifted:
    """Beams that move by parts of a voxel: products with their shift matrices."""

    def __init__(
        self, group: Group, n: int, B: int, rows: tuple[int, int], dtype: Any
    ) -> None:
        h, w = rows
        assert group.matrices is not None
        self.down, self.across = group.matrices
        self.beam = np.zeros((n, B, h, w + 1), dtype)
        self.turned = np.empty_like(self.beam)

    def less(self, S: Reals, gap: Reals) -> None:
        """Take the source off what arrives."""
        np.matmul(self.down, self.beam, out=self.turned)
        np.matmul(self.turned, self.across, out=gap.reshape(self.beam.shape))
        gap -= S

    def leaving(self) -> Reals:
        """Give the array that takes what goes on."""
        return self.beam.reshape(*self.beam.shape[:2], -1)
