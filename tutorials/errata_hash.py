"""Figures of the errata in the hash and in the lattice that is made of it."""

from __future__ import annotations

import itertools
from collections import Counter
from typing import Any

import numpy as np
from errata_sheet import Draw, Figure, frame, grey, name, pictures, plots

from refcloud import noise
from refcloud.conventions import Array
from refcloud.drawing import BLUE, GREY, RED, box, curve, disc
from refcloud.noise.lattice import DENOMINATOR, WEIGHTS

MASK_31, MASK_43 = 0x7FFFFFFF, 0x7FFFFFFFFFF
SIDE = 64  # lattice points along a picture of the hash


LOWEST_M = 230_204_178  # the one m below 2^31 whose 31 bits are all ones


def polynomial(n: Any) -> Any:
    """Evaluate the hash's polynomial in whatever numbers it is given."""
    return n * (n * n * 15731 + 789221) + 1376312589


def block(**how: Any) -> Array:
    """Give the paper's hash about the origin, brought to [0, 1]."""
    at = np.arange(SIDE) - SIDE // 2
    return 0.5 + 0.5 * noise.man2003(at, at[:, None], 0, **how)


def e05() -> Figure:
    """Draw the first numbers with either mask."""
    count = np.arange(300)
    right = noise.man2003(count, 0, 0)
    words = [(m << 13) ^ m for m in count.tolist()]
    wrong = np.array([1.0 - (polynomial(n) & MASK_43) / 2**30 for n in words])
    canvas, cells = plots(2)
    for cell, title, values, low in (
        (cells[0], "31 bits: -1 to 1", right, -1.0),
        (cells[1], "43 bits: -9000 to 900", wrong, -9000.0),
    ):
        top = max(1.0, -0.1 * low)
        axes = frame(canvas, cell, (0, 300), (low * 1.1, top * 1.1), ((), ()), title)
        for place in axes.place(count, values):
            disc(canvas, place, 3.0, BLUE if low == -1.0 else RED)
    return Figure(
        f"g of the first 300 cells lies in [{right.min():.3f}, {right.max():.3f}] with"
        f" 31 bits, in [{wrong.min():.1f}, {wrong.max():.3f}] with 43.",
        canvas,
    )


def e06() -> Figure:
    """Draw where the lowest number lies."""
    right, wrong = (
        float(noise.man2003(LOWEST_M, 0, 0, divisor=d)) for d in (2**30, 2**30 - 1)
    )
    canvas, cells = plots(1, 90)
    axes = frame(
        canvas, cells[0], (-2, 2), (0, 1), ((-2, -1, 0, 1, 2), ()),
        "the lowest g, as (g + 1) 10^9",
    )  # fmt: skip
    curve(axes, [0, 0], [0, 1], GREY, 2.0)
    for value, ink, text in (
        (right, BLUE, "2^30"),
        (wrong, RED, "2^30 - 1"),
    ):
        at = (value + 1.0) * 1e9
        disc(canvas, axes.place(at, 0.35), 7.0, ink)
        name(axes, at - 0.3, 0.72, text, ink)
    return Figure(
        f"The lowest g is -1 + {right + 1.0:.4g} with 2^30 and -1 - {-1.0 - wrong:.4g}"
        " with 2^30 - 1.",
        canvas,
    )


def e07() -> Figure:
    """Draw the hash with the shift, the rotation, and with "and"."""
    at = np.arange(SIDE, dtype=np.int64) - SIDE // 2
    m = at + 57 * at[:, None]
    masked = 1.0 - (polynomial((m << 13) & m) & MASK_31) / 2.0**30
    right, turned = block(), block(shift="rotate")
    canvas, _ = pictures(
        {
            "xor, shift": grey(right),
            "xor, rotation": grey(turned),
            "and, shift": grey(0.5 + 0.5 * masked),
        }
    )
    same = (right == turned).mean()
    most = Counter(masked.ravel().tolist()).most_common(1)[0][1] / masked.size
    return Figure(
        f"In these {SIDE} x {SIDE} cells about the origin shift and rotation agree in"
        f' {100 * same:.1f} %, those with m >= 0. With "and" {100 * most:.0f} % of all'
        " numbers are one and the same.",
        canvas,
    )


def e08() -> Figure:
    """Draw the hash in integers and in floating point."""
    at = np.arange(SIDE, dtype=np.int64) + 1000
    rows = at[: SIDE // 2, None]
    m = at + 57 * rows
    n = ((m << 13) ^ m).astype(np.float64)
    wrong = 1.0 - np.fmod(polynomial(n), 2.0**31) / 2.0**30
    right = np.asarray(noise.man2003(at, rows, 0))
    canvas, _ = pictures(
        {
            "integers": grey(0.5 + 0.5 * right),
            "float64": grey(0.5 + 0.5 * wrong),
        }
    )
    return Figure(
        f"Of {right.size} numbers {np.count_nonzero(right == wrong)} are right in"
        f" float64; {100 * (wrong == 1.0).mean():.0f} % have lost all of their 31"
        " bits.",
        canvas,
    )


def e09() -> Figure:
    """Draw the lattice's period, and a seeded hash without one."""
    x, y = np.arange(96), np.arange(48)[:, None]
    man = np.asarray(noise.man2003(x, y, 0))
    seeded = np.asarray(noise.lattice_random(x, y, np.array(0), seed=1))
    canvas, boxes = pictures(
        {
            "paper: twice the same": grey(0.5 + 0.5 * man),
            "seeded": grey(0.5 + 0.5 * seeded),
        }
    )
    left, top, right, _ = boxes[0]
    cell = (right - left) / x.size
    for column, row in ((10, 20), (67, 19)):
        corner = np.array([left + column * cell, top + row * cell])
        box(canvas, corner, corner + 20 * cell, RED, 5.0)
    same = (man[1:, :39] == man[:-1, 57:]).mean()
    one, other = (noise.elias2d(x, y, seed=s) for s in (1, 0))
    moved = (one[:46, :79] == other[2:, 17:]).mean()
    return Figure(
        f"g(x + 57, y) = g(x, y + 1) in {100 * same:.0f} % of the cells; document C's"
        f" seed 1 is seed 0 moved by (17, 2) in {100 * moved:.0f} %. Seeded:"
        f" {100 * (seeded[1:, :39] == seeded[:-1, 57:]).mean():.0f} %.",
        canvas,
    )


EDGES = "-0- +0- 0+- 0-- -0+ +0+ 0++ 0-+ --0 -+0 +-0 ++0".split()


MISPRINT = "-0- +0- 0+- 0-- -0+ +0+ 0++ 0++ --0 -+0 +-0 ++0".split()


def taps(edges: list[str]) -> Array:
    """Give the 27 weights [z, y, x] of a sum with such edges."""
    weights = np.zeros((3, 3, 3))
    for place in itertools.product((-1, 0, 1), repeat=3):
        kind = sum(map(abs, place))  # 0 centre, 1 side, 2 edge, 3 corner
        if kind != 2:
            weights[tuple(c + 1 for c in place)] = WEIGHTS[kind] / DENOMINATOR
    for tap in edges:
        x, y, z = ("-0+".index(sign) for sign in tap)
        weights[z, y, x] += WEIGHTS[2] / DENOMINATOR
    return weights


def e10() -> Figure:
    """Draw the weights of the layer above, of either scan."""
    right, wrong = taps(EDGES), taps(MISPRINT)
    scale = wrong[1:].max(where=np.arange(27).reshape(3, 3, 3)[1:] != 13, initial=0.0)
    canvas, _ = pictures(
        {
            "scan 002, z + 1": grey(np.kron(right[2] / scale, np.ones((16, 16)))),
            "scan 000, z + 1": grey(np.kron(wrong[2] / scale, np.ones((16, 16)))),
            "000, x and z swapped": grey(
                np.kron(wrong.transpose(2, 1, 0)[2] / scale, np.ones((16, 16)))
            ),
        }
    )
    found = [
        max(np.abs(w - w.transpose(a)).max() for a in itertools.permutations(range(3)))
        for w in (right, wrong)
    ]
    return Figure(
        f"Weights sum to {right.sum():.12g} and {wrong.sum():.12g}; exchanging axes"
        f" changes a weight by at most {found[0]:.3g} in scan 002 and by"
        f" {found[1]:.3g}, a whole tap, in scan 000.",
        canvas,
    )


FIGURES: dict[str, Draw] = {
    "E05": e05,
    "E06": e06,
    "E07": e07,
    "E08": e08,
    "E09": e09,
    "E10": e10,
}
