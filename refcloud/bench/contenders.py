"""Who takes part in the noise benchmark: plain lists, refcloud's and the peers'.

A peer that is not installed takes no part. Each peer's noise is its own, with other
hashes and gradients, so its numbers are not compared. The C library `noise` is called
through `map` on ready-made lists of numbers: its best case.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable, Iterable
from typing import Any, Literal

import numpy as np

import refcloud.noise as ours
from refcloud.bench import worley
from refcloud.bench.timing import Contender
from refcloud.bench.worley import worley_contenders
from refcloud.conventions import Array
from refcloud.noise import uniform

Precision = Literal["float32", "float64"]

PEERS = ("noise", "pyfastnoiselite", "scipy")
UNITS = 8.0  # cells along each axis of the grid
ODD = 0.9904  # makes a spacing of which no whole number is a unit
REACH = 100.0  # cells along each axis that scattered points fill
WORLEY_CELLS = (8, 16, 32)  # along each axis of the grid
PEER_SHARE = 16  # peers that take one point a call get this share of them
PRECISIONS: tuple[Precision, ...] = ("float32", "float64")


def lattice_line(size: int) -> Array:
    """Give the grid's coordinates along an axis, off the lattice points."""
    return np.arange(size, dtype=np.float64) * (UNITS / size) + 0.03


def scattered(count: int) -> Array:
    """Give points scattered over a cube."""
    return REACH * uniform(np.arange(count)[:, np.newaxis], np.arange(3), seed=1)


def peer(name: str) -> Any:
    """Import a peer, None where it is not installed."""
    try:
        module = importlib.import_module(name)
    except ImportError:
        return None
    # A mere folder of that name on the path imports too, without a file.
    return module if getattr(module, "__file__", None) else None


def both(
    task: str, name: str, samples: int, work: Callable[[Precision], Any]
) -> list[Contender]:
    """Enter ours in both precisions, measured against float64."""
    return [
        Contender(
            task,
            f"refcloud {name} {dtype}".replace("  ", " "),
            samples,
            functools.partial(work, dtype),
            functools.partial(work, "float64"),
        )
        for dtype in PRECISIONS
    ]


def on_a_grid(size: int) -> list[Contender]:
    """List all that fill a grid."""
    x, n = lattice_line(size), size**3
    found: list[Contender] = []

    def enter(task: str, name: str, work: Callable[[Precision], Any]) -> None:
        found.extend(both(f"{task} grid", name, n, work))

    enter("Perlin", "", lambda d: ours.gradient_grid(x, x, x, seed=1, dtype=d))
    enter(
        "Perlin",
        "value, 27 taps",
        lambda d: ours.value_grid(x, x, x, seed=1, interpolant="quintic", dtype=d),
    )
    enter("simplex", "", lambda d: ours.simplex_grid(x, x, x, seed=1, dtype=d))
    odd = x * ODD
    enter(
        "simplex",
        "any spacing",
        lambda d: ours.simplex_grid(odd, odd, odd, seed=1, dtype=d),
    )
    enter("fBm, 4 octaves,", "", lambda d: ours.fbm_grid(x, x, x, seed=1, dtype=d)[0])
    enter(
        "fBm, 4 octaves,",
        "turbulence",
        lambda d: ours.turbulence_grid(x, x, x, seed=1, dtype=d)[0],
    )
    box = np.zeros((size, size, size), np.float32)
    found.append(Contender("Perlin grid", "copy of the array float32", n, box.copy))
    mesh = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1)[..., ::-1]
    return found + _peers(mesh.reshape(-1, 3), "grid")


def at_points(count: int) -> list[Contender]:
    """List all that take scattered points."""
    at = scattered(count)
    found: list[Contender] = []

    def enter(task: str, name: str, work: Callable[[Precision], Any]) -> None:
        found.extend(both(f"{task} scattered", name, count, work))

    enter("Perlin", "", lambda d: ours.gradient(at, seed=1, dtype=d))
    enter(
        "Perlin",
        "table",
        lambda d: ours.gradient(at, seed=1, hash="table", dtype=d),
    )
    enter(
        "Perlin",
        "value, 27 taps",
        lambda d: ours.value(at, seed=1, interpolant="quintic", dtype=d),
    )
    enter(
        "Perlin",
        "value, the paper's hash",
        lambda d: ours.value(at, seed=None, interpolant="quintic", dtype=d),
    )
    enter("simplex", "", lambda d: ours.simplex(at, seed=1, dtype=d))
    return found + _peers(at, "scattered")


def _peers(at: Array, where: str) -> list[Contender]:
    """List the peers that are installed, on some of the points."""
    found = []
    few = at[: max(1, len(at) // PEER_SHARE)]
    x, y, z = few.T.tolist()
    if c := peer("noise"):
        works = {
            "Perlin": lambda: list(map(c.pnoise3, x, y, z)),
            "simplex": lambda: list(map(c.snoise3, x, y, z)),
            "fBm, 4 octaves,": lambda: [
                c.pnoise3(*p, octaves=4) for p in zip(x, y, z, strict=True)
            ],
        }
        for kind, work in works.items():
            if where == "grid" or not kind.startswith("fBm"):
                task = f"{kind} {where}"
                found.append(
                    Contender(task, "noise (C)", len(few), work, rival=True, peer=True)
                )
    if lite := peer("pyfastnoiselite.pyfastnoiselite"):
        places = np.ascontiguousarray(at.T, np.float32)
        for kind, own in (("Perlin", "Perlin"), ("simplex", "OpenSimplex2")):
            maker = lite.FastNoiseLite(1)
            maker.noise_type = getattr(lite.NoiseType, f"NoiseType_{own}")
            maker.frequency = 1.0
            work = functools.partial(maker.gen_from_coords, places)
            task = f"{kind} {where}"
            found.append(Contender(task, "pyfastnoiselite", len(at), work, peer=True))
    return found


def worley_on_a_grid(size: int) -> list[Contender]:
    """List all that make Worley noise on a grid, of few cells and of many."""
    return [
        contender
        for cells in WORLEY_CELLS
        for contender in _worley(
            f"grid, {cells} cells",
            worley_contenders("grid", cells=cells, side=size),
        )
    ]


def worley_at_points(count: int) -> list[Contender]:
    """List all that make Worley noise at scattered points."""
    return _worley("scattered", worley_contenders("scattered", count=count))


def _shaped_like(exact: Callable[[], Any], other: Callable[[], Any]) -> Array:
    return np.reshape(exact(), np.shape(other()))


def _worley(where: str, contenders: Iterable[worley.Contender]) -> list[Contender]:
    """Enter Worley noise, measured against its exact form in float64."""
    entered = list(contenders)
    exact = next(c.run for c in entered if c.name == "exact float64")
    return [
        Contender(
            f"Worley {where}",
            c.name if c.peer else f"refcloud {c.name}",
            c.samples,
            c.run,
            functools.partial(_shaped_like, exact, c.run),
            rival=c.peer,
            peer=c.peer,
        )
        for c in entered
    ]


# What the benchmark runs: (a list's maker, its size, its size when quick).
LISTS: list[tuple[Callable[[int], list[Contender]], int, int]] = [
    (on_a_grid, 128, 32),
    (at_points, 2_000_000, 20_000),
    (worley_on_a_grid, 128, 32),
    (worley_at_points, 2_000_000, 20_000),
]
