"""Random numbers as integer hashes: the paper's, Elias's, and one with a true seed.

Every random choice in refcloud is a hash of integers, so that the same seed gives the
same numbers on each system, in any order and at any place. The paper's hash (eq 2) sees
only ``m = x + 57 y + 57^2 z`` and therefore repeats (E09). The seeded hash mixes each
coordinate on its own into 64 bits: it has no period but the 2^32 of the coordinates.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Range, Seed

Integers = int | NDArray[np.integer]  # whole numbers of any size; arrays broadcast
Words = NDArray[np.uint64]

LOW_31_BITS = 0x7FFFFFFF  # the mask of eq 2; 002 prints four digits too many (E05)
DIVISOR = 2**30  # maps 31 bits to (-1, 1]; the printed 2^30 - 1 leaves it (E06)
ROW = 57  # what a step in y adds to m: the period of eq 2 (E09)
SEED_STEP = 131  # what a step of the seed adds to n in Elias's form: 2 * 57 + 17
WORD_BITS = 2**64 - 1

# Weyl constant and finaliser of SplitMix64 (variant 13 of Stafford's mixers): each
# input bit flips each output bit with probability 1/2 within measuring error.
WEYL = 0x9E3779B97F4A7C15
MIX = ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB))
LAST_SHIFT = 31


@checked
def man2003(
    x: Integers,
    y: Integers,
    z: Integers,
    *,
    shift: Literal["plain", "rotate"] = "plain",
    divisor: Annotated[int, Range(1)] = DIVISOR,
) -> Array:
    """Give the paper's random number of a lattice point.

    Formula: g = 1 - ((n (15731 n^2 + 789221) + 1376312589) & 0x7fffffff) / 2^30,
    n = (m << 13) ^ m, m = x + 57 y + 57^2 z, all in 32 bits

    Parameters
    ----------
    x, y, z
        Whole numbers, which broadcast. Taken modulo 2^32, as C's int wraps.
    shift
        How n is made from m. "plain" is C's shift; "rotate" is the paper's "round left
        shifting", which differs where m is negative or at least 2^19 (E07).
    divisor
        What 31 bits are divided by. The printed 2^30 - 1 reaches below -1 (E06).

    Returns
    -------
    Numbers in (-1, 1], of the broadcast shape.

    Raises
    ------
    TypeError
        A coordinate is not whole.

    Source: paper M, eq 2 (N01); E05, E06, E07, E08, E09.

    Examples
    --------
    >>> float(man2003(0, 0, 0) * 2**30)
    -302570765.0
    """
    cells = (_words("x", x), _words("y", y), _words("z", z))
    return _shaped(_man2003(*cells, shift, divisor), x, y, z)


@checked
def elias2d(x: Integers, y: Integers, *, seed: Seed = 0) -> Array:
    """Give the random number of a lattice point in the plane, in Elias's form.

    Formula: as `man2003` with m = x + 57 y + 131 seed

    Parameters
    ----------
    x, y
        Whole numbers, which broadcast. Taken modulo 2^32, as C's int wraps.
    seed
        Which pattern. Seed r + 1 is the pattern of r moved by (17, 2), no more (E09).

    Returns
    -------
    Numbers in (-1, 1], of the broadcast shape.

    Raises
    ------
    TypeError
        A coordinate is not whole.

    Source: document C, Noise (N02); E07, E08, E09.

    Examples
    --------
    >>> bool(elias2d(3, 4, seed=1) == elias2d(3 + 17, 4 + 2, seed=0))
    True
    """
    offset = _words("seed", SEED_STEP * seed)
    cells = (_words("x", x) + offset, _words("y", y), _words("z", 0))
    return _shaped(_man2003(*cells, "plain", DIVISOR), x, y)


@checked
def lattice_random(
    x: Integers, y: Integers, z: Integers, *, seed: Seed | None = 0
) -> Array:
    """Give the random number of a lattice point, for any seed.

    Formula: 1 - (31 hashed bits of x, y, z and seed) / 2^30

    Parameters
    ----------
    x, y, z
        Whole numbers, which broadcast. Taken modulo 2^32.
    seed
        Which pattern. Patterns of two seeds have nothing in common; None is the
        paper's `man2003` with its periods.

    Returns
    -------
    Numbers in (-1, 1], of the broadcast shape, all multiples of 2^-30.

    Raises
    ------
    TypeError
        A coordinate is not whole.

    Source: in place of paper M, eq 2; E09.

    Examples
    --------
    >>> bool(lattice_random(1, 2, 3, seed=None) == man2003(1, 2, 3))
    True
    """
    cells = (_words("x", x), _words("y", y), _words("z", z))
    return _shaped(_lattice_random(*cells, seed), x, y, z)


@checked
def uniform(*words: Any, seed: Seed) -> Array:
    """Give a random number from a few whole numbers and a seed.

    Formula: (53 hashed bits of the words and seed) / 2^53

    Parameters
    ----------
    words
        Whole numbers or arrays of them, which broadcast. Taken modulo 2^64; their
        order and how many there are count.
    seed
        Which sequence. Sequences of two seeds have nothing in common.

    Returns
    -------
    Numbers in [0, 1), of the broadcast shape.

    Raises
    ------
    TypeError
        A word is not whole.

    Source: determinism (W12).

    Examples
    --------
    >>> uniform(np.arange(3), 5, seed=7).shape
    (3,)
    """
    hashed = _hash([_words("words", word) for word in words], seed)
    return _shaped((hashed >> 11).astype(np.float64) * 2.0**-53, *words)


def _man2003(x: Words, y: Words, z: Words, shift: str, divisor: int) -> Array:
    # uint32 wraps as C's int does, and the mask drops the sign: the bits agree (E08).
    rows, layers = y.astype(np.uint32), z.astype(np.uint32)
    m = x.astype(np.uint32) + ROW * rows + ROW * ROW * layers
    n = m << 13
    if shift == "rotate":
        n |= m >> 19
    n ^= m
    bits = (n * (n * n * 15731 + 789221) + 1376312589) & LOW_31_BITS
    return 1.0 - bits / float(divisor)


def _lattice_random(x: Words, y: Words, z: Words, seed: int | None) -> Array:
    if seed is None:
        return _man2003(x, y, z, "plain", DIVISOR)
    low = np.uint64(0xFFFFFFFF)
    hashed = _hash([x & low, y & low, z & low], seed, upper=True)
    hashed >>= 33
    bits = hashed.view(np.int64).astype(np.float64)  # signed words convert faster
    bits *= -1.0 / DIVISOR
    bits += 1.0
    return bits


def _hash(words: list[Words], seed: int, upper: bool = False) -> Words:
    """Chain the words through the mixer; one that broadcasts is mixed where it is.

    With `upper` the highest 31 bits alone are right.
    """
    state = _mixed(np.array([(seed + WEYL) & WORD_BITS], dtype=np.uint64))
    for number, word in enumerate(words, 1):
        state = _mixed((state + WEYL) ^ word, upper and number == len(words))
    return state


def _mixed(h: Words, upper: bool = False) -> Words:
    """Mix 64 bits in place, one to one; the last step leaves the highest 31."""
    high = np.empty_like(h)
    for shift, factor in MIX:
        h ^= np.right_shift(h, shift, out=high)
        h *= factor
    if not upper:
        h ^= np.right_shift(h, LAST_SHIFT, out=high)
    return h


def _words(name: str, value: Any) -> Words:
    """Wrap whole numbers to 64 bits, as an array of at least one axis."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return np.array([int(value) & WORD_BITS], dtype=np.uint64)
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "iu":
        kind = getattr(value, "dtype", type(value).__name__)
        got = f"{kind} of shape {np.shape(value)}"
        raise TypeError(complaint(name, "whole numbers", got))
    signed = value.astype(np.int64, copy=False) if value.dtype.kind == "i" else value
    return np.atleast_1d(signed.astype(np.uint64))


def _shaped(values: Array, *words: Any) -> Array:
    """Give the result the shape that the words broadcast to."""
    return values.reshape(np.broadcast_shapes(*(np.shape(word) for word in words)))
