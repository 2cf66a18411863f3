"""Pieces of rays cut further: down to an optical depth, or evenly."""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.march.cells import Numbers, Pieces, density_at
from refcloud.march.quadrature import gauss

POINTS, WEIGHTS = gauss(4)
# Optical depth of a piece: four points integrate exp(-2 tau) over it, which is light
# that comes and goes the same way, to 3e-10.
THICKEST = 0.5
# A last bit does not decide how often a piece of a round depth is cut.
SLACK = 1e-9
HALVINGS = 50  # of a piece, to find where an optical depth is reached
# Four values of a cubic, and what of them makes its primitive x (A + x (B + ...)).
THIRDS = np.array([0.0, 1.0, 2.0, 3.0]) / 3.0
PRIMITIVE = np.array(
    [
        [1.0, 0.0, 0.0, 0.0],
        [-11.0 / 4.0, 9.0 / 2.0, -9.0 / 4.0, 1.0 / 2.0],
        [3.0, -15.0 / 2.0, 6.0, -3.0 / 2.0],
        [-9.0 / 8.0, 27.0 / 8.0, -27.0 / 8.0, 9.0 / 8.0],
    ]
)


def taken(pieces: Pieces, which: Numbers) -> Pieces:
    """Keep some pieces, or repeat them."""
    return Pieces(
        pieces.ray[which],
        pieces.start[which],
        pieces.length[which],
        pieces.corners[:, which],
        pieces.place[:, which],
        pieces.step[:, which],
    )


def thinner(
    pieces: Pieces, before: Array, mass: Array, rates: Array, deepest: float
) -> tuple[Pieces, Array]:
    """Cut pieces that are optically thick, down to where nothing shows.

    Each channel cuts what it shows of them, the densest first, so that there are no
    more pieces than light has changes. What it hides stays whole, for clearer ones.

    Parameters
    ----------
    pieces
        P pieces.
    before, mass
        Columns of density in front of each and within it, shape (P,).
    rates
        Extinctions per column of the channels, shape (C,).
    deepest
        Optical depth behind which nothing shows.

    Returns
    -------
    Pieces of optical depth `THICKEST` at most in each channel that shows them, and the
    columns in front of them.
    """
    different = np.unique(rates)[::-1]
    for rate in different:
        hidden_stays = bool(rate != different[-1])
        pieces, before, mass = _thinner(
            pieces, before, mass, float(rate), deepest, hidden_stays
        )
    return pieces, before


def _thinner(
    pieces: Pieces,
    before: Array,
    mass: Array,
    rate: float,
    deepest: float,
    hidden_stays: bool,
) -> tuple[Pieces, Array, Array]:
    tau = rate * mass
    if not (tau > THICKEST).any():
        return pieces, before, mass
    # 1. Into how many, and how many of those may show.
    parts = np.ceil(np.maximum(tau / THICKEST - SLACK, 1.0))
    left = (deepest - rate * before) * parts / np.maximum(tau, THICKEST)
    if hidden_stays:
        parts = np.where(left > 0.0, parts, 1.0)
    shown = np.maximum(np.minimum(parts, np.ceil(left)), 1.0).astype(np.intp)
    count = shown + (hidden_stays & (shown < parts))
    parent = np.repeat(np.arange(len(tau)), count)
    number = np.arange(len(parent)) - np.repeat(np.cumsum(count) - count, count)
    first = number / parts[parent]
    last = np.where(number < shown[parent], (number + 1) / parts[parent], 1.0)

    # 2. Find where the column within the piece has each part behind it, by halving:
    # only in pieces that are more than one part. Its density is a cubic, so that few
    # products tell the column up to any place of it.
    several = np.flatnonzero(parts[parent] > 1.0)
    whole = taken(pieces, parent)
    thick = taken(whole, several)
    A, B, C, D = thick.length * (PRIMITIVE @ density_at(thick, THIRDS).T)
    begin, end = np.zeros(len(parent)), np.ones(len(parent))
    for shares, found in ((first, begin), (last, end)):
        share = shares[several]
        low, high = np.zeros(len(several)), np.ones(len(several))
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            passed = middle * (A + middle * (B + middle * (C + middle * D)))
            beyond = passed > share * mass[parent[several]]
            high = np.where(beyond, middle, high)
            low = np.where(beyond, low, middle)
        inner = np.where(share >= 1.0, 1.0, high)
        found[several] = np.where(share == 0.0, 0.0, inner)

    # 3. Each part is a piece of its own.
    return (
        part_of(whole, begin, np.maximum(end - begin, 0.0)),
        before[parent] + first * mass[parent],
        (last - first) * mass[parent],
    )


def evenly(pieces: Pieces, before: Array, parts: Numbers) -> tuple[Pieces, Array]:
    """Cut each piece into parts of one length; give also the columns before them."""
    parent = np.repeat(np.arange(len(parts)), parts)
    number = np.arange(len(parent)) - np.repeat(np.cumsum(parts) - parts, parts)
    begin, extent = number / parts[parent], 1.0 / parts[parent]
    whole = taken(pieces, parent)
    ahead = density_at(whole, begin[:, None] * POINTS) @ WEIGHTS
    return part_of(whole, begin, extent), before[parent] + whole.length * begin * ahead


def part_of(whole: Pieces, begin: Array, extent: Array) -> Pieces:
    """Keep a part of each piece: where it begins and how long it is, as shares."""
    return Pieces(
        whole.ray,
        whole.start + begin * whole.length,
        extent * whole.length,
        whole.corners,
        whole.place + whole.step * begin,
        whole.step * extent,
    )
