"""Any rays, fast: slab by slab across the axis that each ray runs along.

A ray passes each slab once and moves no farther aside in it than the slab is thick, so
that one bilinear look-up stands for the whole passage. Blocks of slabs around which all
is empty are skipped first, then single passages, then what lies behind an opaque front.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.march.lines import Lines
from refcloud.march.planes import RIM, Planes, Singles, looked_up

RAYS = 4096  # at a time: tables that stay in the cache
BLOCK = 4  # slabs that are tested for emptiness at once
STRETCH = 32  # blocks after which rays that have gone opaque are dropped
ZERO = np.float32(0.0)


@dataclass
class Counts:
    """Passages of rays through slabs: all, and those left out as empty or hidden."""

    all: int = 0
    empty: int = 0
    hidden: int = 0


@dataclass(frozen=True)
class Slabs:
    """A cloud as slabs of one frame.

    Attributes
    ----------
    first, thickness, count
        Where slab 0 begins, in cells of w; how thick each is; how many there are.
    volumes
        The first field is the density; then the light of each sun at each extinction.
    occupied
        Spaces between samples of a slab that hold density, shape (K, V, U), flat.
    blocks
        The same for BLOCK slabs together and as far around as rays move aside in them.
    across
        V and U, with their rim.
    """

    first: float
    thickness: float
    count: int
    volumes: tuple[Planes, ...]
    occupied: NDArray[np.bool_]
    blocks: NDArray[np.bool_]
    across: tuple[int, int]


def gather(
    slabs: Slabs,
    lines: Lines,
    *,
    rates: Array,
    suns: int,
    least: float,
    counts: Counts,
) -> tuple[Array, Array]:
    """March rays of one frame.

    Parameters
    ----------
    slabs
        The cloud.
    lines
        n rays.
    rates
        Extinctions toward the eye, shape (G,).
    suns
        S, how many.
    least
        Transmittance below which a ray is dropped.
    counts
        Adds up what was left out.

    Returns
    -------
    Sums over each ray of light times the drop of transmittance, or times the column
    where a rate is 0, shape (n, S, G); and columns of density, shape (n,).
    """
    count = len(lines.speed)
    light, column = np.zeros((count, suns, len(rates))), np.zeros(count)
    counts.all += count * slabs.count
    lowest = float(rates.min(initial=np.inf))
    # Opaque is what no channel shines through.
    deepest = -np.log(least) / lowest if 0.0 < lowest < np.inf else np.inf
    most = STRETCH * BLOCK
    for begin in range(0, count, RAYS):
        alive = np.arange(begin, min(begin + RAYS, count))
        for start in range(0, slabs.count, most):
            rest = slabs.count - start
            some = np.flatnonzero(column[alive] < deepest)
            counts.hidden += (len(alive) - len(some)) * rest
            alive = alive[some]
            if not len(alive):
                break
            ray, slab, u, v = occupied(slabs, lines, alive, start)
            counts.empty += len(alive) * min(most, rest) - len(ray)
            if not len(ray):
                continue
            fields = [
                f for volume in slabs.volumes for f in looked_up(volume, slab, u, v)
            ]
            amount = fields[0] * passages(slabs, lines, ray, slab)
            add_up(light, column, ray, amount, fields[1:], rates)
    return light, column


def spaces(
    u: Singles, v: Singles, slab: NDArray[np.int32], across: tuple[int, int]
) -> NDArray[np.int32]:
    """Give the number of the space between samples that each place lies in.

    Parameters
    ----------
    u, v
        Places in cells, counted with the rim, shape (..., M).
    slab
        Number of the slab or block, which broadcasts with them.
    across
        V and U, with their rim.
    """
    V, U = across
    # `clip` takes a fifth of the time of a maximum and a minimum.
    number = np.clip(v, ZERO, np.float32(V - 1.5)).astype(np.int32)
    number += slab * np.int32(V)
    number *= np.int32(U)
    number += np.clip(u, ZERO, np.float32(U - 1.5)).astype(np.int32)
    return number


def occupied(
    slabs: Slabs, lines: Lines, rays: NDArray[np.intp], start: int
) -> tuple[NDArray[np.intp], NDArray[np.int32], Singles, Singles]:
    """Find the passages of a stretch around which there is density.

    Parameters
    ----------
    slabs, lines
        The cloud, and the rays.
    rays
        Which of them, ascending, shape (R,).
    start
        The stretch's first slab.

    Returns
    -------
    Ray, slab, u and v in the slab's middle, counted with the rim, shape (M,): ray by
    ray as it goes.
    """
    first = np.float32(slabs.first + 0.5 * slabs.thickness)
    step = np.float32(slabs.thickness)
    slope = lines.slope.take(rays, axis=1)
    at = lines.at.take(rays, axis=1) + np.float32(RIM)
    # 1. Blocks, told by their middles.
    end = min(start + STRETCH * BLOCK, slabs.count)
    block = np.arange(start // BLOCK, -(-end // BLOCK), dtype=np.int32)
    w = first + step * (BLOCK * block + 0.5 * (BLOCK - 1)).astype(np.float32)
    u, v = (slope[k][:, None] * w + at[k][:, None] for k in range(2))
    which = np.flatnonzero(slabs.blocks.take(spaces(u, v, block, slabs.across)))
    row = which // len(block)
    which -= row * len(block)

    # 2. Their slabs: first ones of all blocks, then second ones, in rows as long as
    # can be.
    slab = block.take(which) * np.int32(BLOCK)
    places = np.empty((2, BLOCK, len(row)), np.float32)
    number = np.empty(places.shape[1:], np.int32)
    slope, at = slope.take(row, axis=1), at.take(row, axis=1)
    w = first + step * slab.astype(np.float32)
    for k in range(BLOCK):
        np.multiply(slope, w, out=places[:, k])
        places[:, k] += at
        u, v = places[:, k]
        number[k] = spaces(u, v, slab + np.int32(k), slabs.across)
        w += step
    # 3. Those that hold density, in the order in which their rays go.
    found = np.flatnonzero(slabs.occupied.take(number).T)
    which = found // BLOCK
    found -= which * BLOCK
    slab = slab.take(which) + found.astype(np.int32)
    found *= len(row)
    found += which
    u, v = (axis.take(found) for axis in places.reshape(2, -1))
    return rays.take(row.take(which)), slab, u, v


def passages(
    slabs: Slabs, lines: Lines, ray: NDArray[np.intp], slab: NDArray[np.int32]
) -> Singles:
    """Give the lengths of rays in slabs, scene units, shape (M,)."""
    step = np.float32(slabs.thickness)
    begin = np.float32(slabs.first) + step * slab.astype(np.float32)
    within = np.minimum(begin + step, lines.high.take(ray))
    within -= np.maximum(begin, lines.low.take(ray))
    np.maximum(within, ZERO, out=within)
    within *= lines.speed.take(ray)
    return within


def add_up(
    light: Array,
    column: Array,
    ray: NDArray[np.intp],
    amount: Singles,
    lit: list[Singles],
    rates: Array,
) -> None:
    """Add passages to their rays, from the eye on.

    Parameters
    ----------
    light, column
        Of all rays, shapes (n, S, G) and (n,); changed.
    ray
        Of each passage, ascending, shape (M,).
    amount
        Columns of density, shape (M,).
    lit
        Light of each sun at each extinction, S G arrays of shape (M,).
    rates
        Extinctions toward the eye, shape (G,).
    """
    starts = np.flatnonzero(np.diff(ray, prepend=-1))
    owner = ray[starts]
    lengths = np.diff(starts, append=len(ray))
    # In double precision a running sum keeps the digits of a thin ray in its middle.
    total = np.cumsum(amount, dtype=np.float64)
    before = np.concatenate([[0.0], total])[starts] - column[owner]
    total -= np.repeat(before, lengths)
    for g, rate in enumerate(rates):
        if rate > 0.0:
            after = np.exp((-rate * total).astype(np.float32))
            share = np.empty_like(after)
            share[1:] = after[:-1]
            share[starts] = np.exp(-rate * column[owner])
            share -= after
        else:
            share = amount
        for s in range(light.shape[1]):
            sums = np.add.reduceat(share * lit[s * len(rates) + g], starts)
            light[owner, s, g] += sums
    column[owner] = total[starts + lengths - 1]
