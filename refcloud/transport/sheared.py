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
    for m, mixed in enumerate(mixed_slices(slabs, s, filled, out.dtype)):
        step = 0.5 if m == 0 else 1.0  # the box begins half a step before slice 0
        occupied = mixed.any()
        if not occupied and not columns.entered:
            out[m] = 0.0  # nothing between here and the sun
            continue
        enter(columns, m - 0.5 * step)
        if occupied:
            place(columns, mixed, m - 0.5 * step, step, length / s, filled)
        enter(columns, m)
        kept = lengthen(columns, m) if filled else []
        read(columns, m, out[m])
        for view, old in reversed(kept):
            view[...] = old


def border_is_filled(slabs: Values) -> bool:
    """Tell whether there is cloud on a side of the box that rays leave aslant."""
    ends = (slabs[:, 0], slabs[:, -1], slabs[:, :, 0], slabs[:, :, -1])
    return any(end.any() for end in ends)


def mixed_slices(
    slabs: Values, scale: int, filled: bool, dtype: np.dtype
) -> Iterator[Values]:
    """Give, for every step of a ray, the field in its middle (step 1).

    Each is a row of numbers, PAD cells wider than a slice on every side; what lies
    there is as dense as the border, since the field is so for half a cell.
    """
    K, V, U = slabs.shape
    padded = np.zeros((2, V + 2 * PAD, U + 2 * PAD), dtype)
    rows = padded.reshape(2, -1)
    mixed = np.empty_like(rows[0])
    half = mixed.dtype.type(0.5)

    def take(k: int) -> None:
        slab = padded[k % 2]
        slab[PAD:-PAD, PAD:-PAD] = slabs[k]
        if filled:
            slab[:PAD], slab[-PAD:] = slab[PAD], slab[-PAD - 1]
            slab[:, :PAD] = slab[:, PAD : PAD + 1]
            slab[:, -PAD:] = slab[:, -PAD - 1 : -PAD]

    take(0)
    yield rows[0]  # from the face to the first sample
    for k in range(K):
        if scale == 2:
            yield rows[k % 2]  # slice k lies between its two samples
        if k + 1 < K:
            take(k + 1)
            np.add(rows[0], rows[1], out=mixed)
            mixed *= half
            yield mixed


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
    first = min(tap.column for taps in across for tap in taps)
    lines, total, spare = columns.room[:-2], columns.room[-2], columns.room[-1]
    size = V * stride
    for p in range(s):
        for q in range(s):
            terms = []
            for tap in taps_of(by_v, p, s):
                start = columns.number(tap.column, first)
                row = columns.values[tap.phase, q, start : start + size + PAD + 1]
                terms.append((tap.weight, row))
            weighted(terms, lines[q][: size + PAD + 1], spare)
        for q in range(s):
            terms = []
            for tap in across[q]:
                start = tap.column - first
                terms.append((tap.weight, lines[tap.phase][start : start + size]))
            weighted(terms, total[:size], spare)
            # A cubic may fall below 0 beside an edge; no column density does.
            samples = total[:size].reshape(V, stride)[:, :U]
            np.maximum(samples, 0.0, out=out[p::s, q::s])


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
