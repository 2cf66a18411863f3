"""Column densities by one accumulator that shears along the light.

Slices are numbered from the sun. One slice toward the sun a ray moves by `slope`
samples across the slices, so for all samples j of slice m that lie on one ray

    c = j + m slope

is the same. One two-dimensional accumulator over c holds, for every ray at once, what
its light has passed so far. Slice after slice:

1. *mix*: halfway from the slice before to this one, the field is the mean of both;
2. *place*: that is added where it lies in c (the midpoint rule along the ray), linear
   between cells as the field is;
3. *read*: the column densities of the slice stand at c = j + m slope, between columns:
   cubic (Catmull-Rom), for this is the one place that blurs.

Each slice is touched once, and no interpolated value is interpolated again. With two
samples per cell there are twice as many slices and rays through the *same* field: its
values are not resampled, for between new samples it would be another field. The columns
are then kept in 2 x 2 arrays, for even and odd c, each as wide as a slice.

Slices and columns are rows of numbers here, `stride` of them from one v to the next, so
that every operation runs over one unbroken piece of memory. Columns that the light has
left are used again for those that it enters. `refcloud.transport.literal` is the same
with one index for each thing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.transport.windows import (
    PAD,
    border_factor,
    lit_share,
    own_share,
    steps_inside,
    taps_of,
    window_of,
)

Values = NDArray[Any]  # float32 or float64
Pair = tuple[float, float]  # along v and along u
# Slices read and written at a time, since they may lie scattered in memory: half a
# megabyte of 128 x 128, which stays in a cache.
TOGETHER = 8


@dataclass(frozen=True)
class Columns:
    """The accumulator: what the light of every ray has passed.

    Attributes
    ----------
    V, U
        Cells of a slice.
    scale
        Samples per cell along each axis, s.
    slopes
        Samples that a ray moves up v and u, one slice toward the sun.
    values
        Shape (s, s, size), by phase along v and u. Column (r, q) of a phase is number
        (r + PAD) stride + q + PAD.
    entered
        By phase along u: the column of cell 0 when the light last moved on.
    room
        Shape (s + 2, numbers of a slice), for sums.
    """

    V: int
    U: int
    scale: int
    slopes: Pair
    values: Values
    entered: dict[int, int]
    room: Values

    @property
    def stride(self) -> int:
        """Numbers from one v to the next."""
        return self.U + 2 * PAD

    def number(self, r: int, q: int) -> int:
        """Give the place of a column in its phase's row of numbers."""
        return (r + PAD) * self.stride + q + PAD


def sheared_depths(
    slabs: Values, slopes: Pair, *, length: float, scale: int, out: Values
) -> None:
    """Integrate a field from each sample toward the sun, unchecked.

    Parameters
    ----------
    slabs
        Shape (K, V, U), slice 0 nearest the sun.
    slopes
        Cells that a ray moves up v and up u, one slice toward the sun; in [0, 1].
    length
        Of a ray between slices.
    scale
        Samples per cell along each axis, s.
    out
        Written, shape (s K, s V, s U); its type is that of the arithmetic.
    """
    (K, V, U), s = slabs.shape, scale
    stride, filled = U + 2 * PAD, border_is_filled(slabs)
    # As far as cell 0's column moves in K slices, and the columns around a slice.
    size = (V + int(K * slopes[0]) + 8) * stride + int(K * slopes[1])
    values = np.zeros((s, s, size), out.dtype)
    room = np.empty((s + 2, (V + 2 * PAD) * stride), out.dtype)
    columns = Columns(V, U, s, slopes, values, {}, room)
    done = np.zeros((TOGETHER, s * V, s * U), out.dtype)
    for m, mixed in enumerate(mixed_slices(slabs, s, filled, out.dtype)):
        if m and m % TOGETHER == 0:
            out[m - TOGETHER : m] = done
        if mixed is None and not columns.entered:
            continue  # nothing between here and the sun
        step = 0.5 if m == 0 else 1.0  # the box begins half a step before slice 0
        enter(columns, m - 0.5 * step)
        if mixed is not None:
            place(columns, mixed, m - 0.5 * step, step, length / s, filled)
        enter(columns, m)
        kept = lengthen(columns, m) if filled else []
        read(columns, m, done[m % TOGETHER])
        for view, old in reversed(kept):
            view[...] = old
    rest = (s * K - 1) % TOGETHER + 1
    out[s * K - rest :] = done[:rest]


def border_is_filled(slabs: Values) -> bool:
    """Tell whether there is cloud on a side of the box that rays leave aslant."""
    ends = (slabs[:, 0], slabs[:, -1], slabs[:, :, 0], slabs[:, :, -1])
    return any(end.any() for end in ends)


def mixed_slices(
    slabs: Values, scale: int, filled: bool, dtype: np.dtype
) -> Iterator[Values | None]:
    """Give, for every step of a ray, the field in its middle (step 1); None if empty.

    Each is a row of numbers, PAD cells wider than a slice on every side; what lies
    there is as dense as the border, since the field is so for half a cell.
    """
    K, V, U = slabs.shape
    block = np.zeros((TOGETHER + 1, V + 2 * PAD, U + 2 * PAD), dtype)
    rows = block.reshape(len(block), -1)
    mixed = np.empty_like(rows[0])
    before = False  # whether there is cloud in slice k - 1
    for k in range(K):
        n = k % TOGETHER + 1
        if n == 1:
            block[0] = block[TOGETHER]
            fetch(slabs[k : k + TOGETHER], filled, out=block[1:])
        here = bool(rows[n].max() > 0.0)
        if k == 0:  # from the face to the first sample
            yield rows[n] if here else None
        elif before or here:
            np.add(rows[n - 1], rows[n], out=mixed)
            yield np.multiply(mixed, 0.5, out=mixed)
        else:
            yield None
        if scale == 2:  # slice k lies in the middle between its two samples
            yield rows[n] if here else None
        before = here


def fetch(slabs: Values, filled: bool, out: Values) -> None:
    """Copy slices between their pads; where the border is filled it goes on there."""
    out = out[: len(slabs)]
    out[:, PAD:-PAD, PAD:-PAD] = slabs
    if filled:
        for before, after in ((slice(PAD), PAD), (slice(-PAD, None), -PAD - 1)):
            out[:, before] = out[:, after, None]
            out[:, :, before] = out[:, :, after, None]


def enter(columns: Columns, along: float) -> None:
    """Empty the columns that rays enter at a place along the light; old ones return."""
    s, last = columns.scale, columns.U + 1
    for q in range(s):
        u, _ = window_of(along * columns.slopes[1], q, s)
        for new in range(columns.entered.get(q, u) + 1, u + 1):
            for p in range(s):
                v, _ = window_of(along * columns.slopes[0], p, s)
                first = columns.number(v - 1, new + last)
                columns.values[p, q, first :: columns.stride] = 0.0
        columns.entered[q] = u


def place(
    columns: Columns,
    mixed: Values,
    along: float,
    step: float,
    length: float,
    filled: bool,
) -> None:
    """Add a step of light through a slice to the columns that it lies on (step 2)."""
    s, V, U, stride = columns.scale, columns.V, columns.U, columns.stride
    by_v, by_u = (along * slope for slope in columns.slopes)
    line, added, spare = columns.room[0][:-1], columns.room[1], columns.room[2]
    added = added[: (V + 3) * stride - 1]
    for q in range(s):
        # Number i of a line is on column u + i - 1, between cells i - 2 and i - 1.
        (u, part), share_u = window_of(by_u, q, s), 1.0
        weighted([(part, mixed[:-1]), (1.0 - part, mixed[1:])], line, spare)
        if filled:
            share_u = lit_share(part, columns.slopes[1], step, s)
            line[U + 1 :: stride] *= share_u
            line[U + 2 :: stride] = 0.0
        for p in range(s):
            v, part = window_of(by_v, p, s)
            near, far = part * step * length, (1.0 - part) * step * length
            weighted([(near, line[:-stride]), (far, line[stride:])], added, spare)
            if filled:
                share = lit_share(part, columns.slopes[0], step, s)
                added[(V + 1) * stride : (V + 2) * stride] *= share
                added[(V + 2) * stride :] = 0.0
                # At the corner the nearer side counts, not both.
                added[(V + 1) * stride + U + 1] /= max(share, share_u) or 1.0
            first = columns.number(v - 1, u - 1)
            columns.values[p, q, first : first + added.size] += added


def read(columns: Columns, m: int, out: Values) -> None:
    """Read slice m's column densities between the columns (step 3)."""
    s, V, U, stride = columns.scale, columns.V, columns.U, columns.stride
    by_v, by_u = (m * slope for slope in columns.slopes)
    across = [taps_of(by_u, q, s) for q in range(s)]
    first = min(column for taps in across for _, _, column in taps)
    lines, total, spare = columns.room[:-2], columns.room[-2], columns.room[-1]
    size = V * stride
    total, more = total[:size], size + PAD + 1
    for p in range(s):
        rows = [
            (weight, phase, columns.number(column, first))
            for weight, phase, column in taps_of(by_v, p, s)
        ]
        for q in range(s):
            values = columns.values[:, q]
            terms = [(w, values[phase, at : at + more]) for w, phase, at in rows]
            weighted(terms, lines[q][:more], spare)
        for q, taps in enumerate(across):
            terms = [(w, lines[i][c - first : c - first + size]) for w, i, c in taps]
            weighted(terms, total, spare)
            # A cubic may fall below 0 beside an edge; no column density does.
            np.maximum(total, 0.0, out=total)
            out[p::s, q::s] = total.reshape(V, stride)[:, :U]


def weighted(terms: list[tuple[float, Values]], out: Values, spare: Values) -> None:
    """Sum rows of numbers of one size, each times its weight."""
    (weight, values), *rest = terms
    np.multiply(values, weight, out=out)
    for weight, values in rest:
        product = np.multiply(values, weight, out=spare[: out.size])
        np.add(out, product, out=out)


def lengthen(columns: Columns, m: int) -> list[tuple[Values, Values]]:
    """Carry columns on beyond the sides that face the sun; give what was there.

    Rays beyond the side never met the cloud; read as they are, they would take depth
    from the outermost samples. See `border_factor`.
    """
    s, stride = columns.scale, columns.stride
    kept: list[tuple[Values, Values]] = []
    shape = columns.V, columns.U
    corner = [(math.floor(m * slope) - 1) // s for slope in columns.slopes]
    for axis, count in ((1, shape[0] + 2 * PAD), (0, stride)):
        # The lines of columns beside the side: their length is the other axis's.
        other = 1 - axis
        c = s * (np.arange(count) + corner[other]) + np.arange(s)[:, None]
        steps = steps_inside(c, m, columns.slopes[other], s * shape[other])
        slope = columns.slopes[axis]
        last = s * shape[axis] - 1 + math.floor(m * slope)
        lines = []
        for column in (last, last + 1, last + 2):
            number, phase = divmod(column, s)
            if axis == 1:
                start = columns.number(corner[0], number)
                lines.append(columns.values[:, phase, start::stride][:, :count])
            else:
                start = columns.number(number, corner[1])
                lines.append(columns.values[phase, :, start : start + count])
        inside, next_, beyond = lines
        kept += [(next_, next_.copy()), (beyond, beyond.copy())]
        own = own_share(m * slope)
        next_ *= own
        next_ += inside * ((1.0 - own) * border_factor(m * slope, slope, steps))
        beyond[...] = 2.0 * next_ - inside
    return kept
