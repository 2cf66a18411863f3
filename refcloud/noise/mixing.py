"""Which gradient a lattice point has: 32 bits hashed from its coordinates.

Gradient and simplex noise ask for many more lattice points than value noise, so their
hash mixes every axis on its own, adds, and mixes the sum: on a grid the axes are lines,
and for eight corners of a cell there are but six of them. Perlin's shuffled table of
256 entries is the other choice; it repeats after 256 cells.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Seed
from refcloud.noise.hashing import _hash, _words, uniform

Hash = Literal["mixed", "table"]
Bits = NDArray[np.uint32]

# Shifts and odd factors of the 32-bit mixer "lowbias32" of the hash prospector: each
# input bit flips each output bit with a probability within 0.2 % of 1/2.
FIRST, SECOND, LAST = 16, 15, 15
FACTORS = (0x21F0AAAD, 0xD35A2D97)
ENTRIES = 256  # of the shuffled table, which therefore repeats
ENTRY_SHIFT = 24  # moves an entry's 8 bits to the top of 32
DOMAIN = 0x6C617474  # a first word that no other use of the 64-bit hash has


@checked
def lattice_bits(*cells: Any, seed: Seed = 0, hash: Hash = "mixed") -> NDArray[Any]:
    """Give the random bits of a lattice point, which choose its gradient.

    Formula: mix(sum over axes k of mix(cell_k, key_k(seed))), or P[c_1 + P[c_2 + ...]]

    Parameters
    ----------
    cells
        Whole numbers, one array per axis, which broadcast. Taken modulo 2^32.
    seed
        Which pattern. Patterns of two seeds have nothing in common.
    hash
        How bits are made. "mixed" has no period but 2^32; "table" looks them up in
        `permutation_table`, which repeats after 256 cells.

    Returns
    -------
    32 bits as uint32, of the broadcast shape, whose upper bits are the most random;
    "table" fills the upper 8 alone.

    Raises
    ------
    TypeError
        A coordinate is not whole.

    Source: document S (N03), in place of paper M, eq 2; E09.

    Examples
    --------
    >>> lattice_bits(np.arange(4), 7, seed=1).dtype
    dtype('uint32')
    """
    words = [_words("cells", cell).astype(np.int64) for cell in cells]
    mixed = [_axis_bits(word, k, seed, hash) for k, word in enumerate(words)]
    shape = np.broadcast_shapes(*(np.shape(cell) for cell in cells))
    return _joined(mixed, seed, hash).reshape(shape)


@checked
def permutation_table(seed: Seed = 0) -> NDArray[np.int64]:
    """Give the whole numbers below 256 in an order shuffled by a seed.

    Formula: entry i is exchanged with an entry hashed from those up to i, from 255 down

    Parameters
    ----------
    seed
        Which order.

    Returns
    -------
    Shape (256,), each of 0 to 255 once.

    Source: document S (N03): made once, and read as a texture there.

    Examples
    --------
    >>> bool((np.sort(permutation_table(7)) == np.arange(256)).all())
    True
    """
    table = np.arange(ENTRIES)
    chance = uniform(DOMAIN, np.arange(ENTRIES), seed=seed)
    for i in range(ENTRIES - 1, 0, -1):
        j = int(chance[i] * (i + 1))
        table[[i, j]] = table[[j, i]]
    return table


@functools.lru_cache(maxsize=16)
def _table(seed: int) -> Bits:
    return permutation_table(seed).astype(np.uint32)


@functools.lru_cache(maxsize=64)
def _keys(axis: int, seed: int) -> tuple[np.uint32, np.uint32]:
    """Give two secret words of an axis."""
    both = int(_hash([_words("", DOMAIN), _words("", axis)], seed)[0])
    return np.uint32(both >> 32), np.uint32(both & 0xFFFFFFFF)


def _axis_bits(cells: NDArray[Any], axis: int, seed: int, hash: Hash) -> Bits:
    """Mix one coordinate; without the second key seeds would translate."""
    bits = cells.astype(np.uint32)
    if hash == "table":
        return bits
    first, second = _keys(axis, seed)
    bits ^= first
    high = bits >> FIRST
    bits ^= high
    bits *= np.uint32(FACTORS[0])
    bits ^= np.right_shift(bits, SECOND, out=high)
    bits += second
    bits *= np.uint32(FACTORS[1])
    bits ^= np.right_shift(bits, LAST, out=high)
    return bits


def _joined(axes: Sequence[Bits], seed: int, hash: Hash) -> Bits:
    """Join the axes' bits, which broadcast, to those of the lattice points."""
    if hash == "table":
        table = _table(seed)
        entry: Any = 0
        for bits in reversed(axes):
            entry = table[(bits + entry) & np.uint32(ENTRIES - 1)]
        return entry << ENTRY_SHIFT
    first, *others = axes
    total = first
    for bits in others:
        total = total + bits
    return _finished(total if others else total.copy())


def _finished(total: Bits, high: Bits | None = None) -> Bits:
    """Mix the sum of the axes' words, in place; high is an array to work in."""
    high = np.right_shift(total, FIRST, out=high)
    total ^= high
    total *= np.uint32(FACTORS[0])
    total ^= np.right_shift(total, SECOND, out=high)
    total *= np.uint32(FACTORS[1])
    return total


def _choice(bits: Bits, count: int) -> NDArray[np.intp]:
    """Choose one of `count` evenly by the upper 16 bits, as an index."""
    return _chosen(bits, count).astype(np.intp)


def _chosen(bits: Bits, count: int, out: Bits | None = None) -> Bits:
    bits = np.right_shift(bits, np.uint32(16), out=out)
    bits *= np.uint32(count)
    bits >>= np.uint32(16)
    return bits
