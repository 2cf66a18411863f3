"""Pictures of noise: each kind as a slice, at three scales, and octave by octave."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from refcloud import noise
from refcloud.checking import checked
from refcloud.conventions import MOST_PIXELS, Array, Range, Seed
from refcloud.image import Picture, srgb_decode
from refcloud.refusal import complaint

Kind = Literal[
    "value",
    "gradient",
    "simplex",
    "worley_f1",
    "worley_f2",
    "worley_inverted",
    "smooth",
    "worley_smooth",
    "sheet",
    "fbm",
    "turbulence",
    "man",
]
View = Literal["slice", "channels", "octaves"]

HEIGHT = 0.5  # z of the slice: no lattice plane, where some noises are 0
PERSISTENCE = 0.5  # amplitude of each octave relative to the one before
GAP = 2  # pixels between panels
PAPER = 1.0  # their light
MAP_SAMPLES = 4  # samples of the sheet's map to a cell
GREYS = 256.0  # the largest value of that map
WHITE = 255.0  # the largest value of its filter
CHANNELS = 3  # red, green and blue: one scale each, twice as fine as the one before


@checked
def noise_picture(
    kind: Kind,
    *,
    size: Annotated[int, Range(8, 2048, "pixels")] = 256,
    octaves: Annotated[int, Range(1, 8)] = 4,
    seed: Seed = 0,
    view: View = "slice",
    cells: Annotated[int, Range(1, 1024)] = 8,
) -> Picture:
    """Draw a kind of noise.

    Formula: the code of a pixel is 255 v, with v the noise brought to [0, 1] by its
    true bound

    Parameters
    ----------
    kind
        Which noise. "sheet" is document C's cloud, "man" the sum of paper M, "fbm" and
        "turbulence" those of document S; "worley_inverted" is white at the points.
    size
        Width and height of a panel.
    octaves
        How many octaves "octaves" shows, and how many the kinds that are sums have.
    seed
        Which pattern.
    view
        What is shown. "slice" is one panel; "channels" one with a scale in each of red,
        green and blue, and these alone, side by side; "octaves" a row of the octaves,
        each alone, and below it a row of their sums so far.
    cells
        Cells along each side of a panel, of the first octave.

    Returns
    -------
    The picture; save it with tone="none" for codes of 255 v.

    Source: documents M, D, S and C: N01 to N33.

    Examples
    --------
    >>> noise_picture("worley_f1", size=16, octaves=2, view="octaves").linear.shape
    (34, 34, 3)
    """
    along: Array = np.asarray((np.arange(size) + 0.5) * (cells / size), np.float64)
    columns, rows = {"slice": (1, 1), "channels": (1 + CHANNELS, 1)}.get(
        view, (octaves, 2)
    )
    _refuse_large(size, columns, rows)
    if view == "slice":
        return _shown([[_slice(kind, along, octaves, seed)]])
    if view == "channels":
        scales = [_slice(kind, along * 2.0**i, octaves, seed) for i in range(CHANNELS)]
        return _shown([[np.stack(scales, axis=-1), *scales]])
    alone, sums = _octaves(kind, along, octaves, seed)
    return _shown([alone, sums])


def _refuse_large(size: int, columns: int, rows: int) -> None:
    """Refuse too large panels for one picture before any is drawn."""
    if columns * rows * (size + GAP) ** 2 > MOST_PIXELS:
        expected = f"panels in a picture of {MOST_PIXELS / 1e6:g} megapixels"
        got = f"{columns * rows} of {size} x {size}"
        advice = "choose a smaller size" + (" or fewer octaves" if rows > 1 else "")
        raise ValueError(complaint("size", expected, got, advice))


def _shown(rows: list[list[Array]]) -> Picture:
    """Lay panels of values in [0, 1] in rows, a gap between them."""
    side = rows[0][0].shape[0] + GAP
    shape = (len(rows) * side - GAP, len(rows[0]) * side - GAP, 3)
    linear: Array = np.full(shape, PAPER)
    for j, row in enumerate(rows):
        for i, panel in enumerate(row):
            values = panel if panel.ndim == 3 else panel[..., np.newaxis]
            where = linear[j * side :, i * side :][: side - GAP, : side - GAP]
            where[...] = srgb_decode(np.clip(values, 0.0, 1.0))
    return Picture(linear)


@dataclass(frozen=True)
class Base:
    """A noise of one octave, on a grid."""

    grid: Callable[..., Any]
    signed: bool  # in [-1, 1], else in [0, 1]
    how: Mapping[str, Any] = field(default_factory=dict)

    def octave(self, along: Array, octave: int, seed: int) -> Array:
        """Give the slice of an octave, with the seed and origin of its own."""
        own, shift = noise.octave_frame(octave, seed=seed)
        x, y, z = (
            c * 2.0**octave + s for c, s in zip(_axes(along), shift, strict=True)
        )
        return self.grid(x, y, z, seed=own, **self.how)[0]


BASES = {
    "value": Base(noise.value_grid, True),
    "gradient": Base(noise.gradient_grid, True),
    "simplex": Base(noise.simplex_grid, True),
    "worley_f1": Base(noise.worley_grid, False, {"normalize": "bound"}),
    "worley_f2": Base(
        noise.worley_grid, False, {"feature": "F2", "normalize": "bound"}
    ),
    "worley_inverted": Base(noise.worley_grid, False, {"normalize": "inverted"}),
    "smooth": Base(noise.smooth_grid, False),
    "worley_smooth": Base(noise.worley_smooth_grid, False),
    # The sums, by the noise that they sum.
    "fbm": Base(noise.gradient_grid, True),
    "turbulence": Base(noise.gradient_grid, True),
    "man": Base(noise.value_grid, True),
}
SUMS = ("fbm", "turbulence", "man")


def _axes(along: Array) -> tuple[Array, Array, Array]:
    return along, along, np.array([HEIGHT])


def _slice(kind: Kind, along: Array, octaves: int, seed: int) -> Array:
    """Give one panel, in [0, 1]."""
    if kind == "sheet" or kind in SUMS:
        return _octaves(kind, along, octaves, seed)[1][-1]
    base = BASES[kind]
    values = base.grid(*_axes(along), seed=seed, **base.how)[0]
    return 0.5 + 0.5 * values if base.signed else values


def _octaves(
    kind: Kind, along: Array, octaves: int, seed: int
) -> tuple[list[Array], list[Array]]:
    """Give each octave alone, as strong as it is in the sum, and the sums so far."""
    if kind == "sheet":
        return _sheet_octaves(along, octaves, seed)
    base = BASES[kind]
    alone: list[Array] = []
    sums: list[Array] = []
    total: Any = np.zeros((along.size, along.size))
    for i in range(octaves):
        layer: Any = PERSISTENCE**i * base.octave(along, i, seed)
        if kind == "turbulence":
            layer = np.abs(layer)
        total = total + layer
        bound = noise.octave_bound(i + 1, PERSISTENCE)
        if kind == "man":  # the paper's |sum|, which is cut at 1
            alone.append(0.5 + 0.5 * layer)
            sums.append(np.minimum(np.abs(total), 1.0))
        elif base.signed and kind != "turbulence":
            alone.append(0.5 + 0.5 * layer)
            sums.append(0.5 + 0.5 * total / bound)
        else:
            alone.append(layer)
            sums.append(total / bound)
    return alone, sums


def _sheet_octaves(
    along: Array, octaves: int, seed: int
) -> tuple[list[Array], list[Array]]:
    """Give octaves of document C's map, and its filter of the sums so far.

    The map has four samples to a cell: at 8 cells the document's 32.
    """
    cells = along[0] + along[-1]  # half a pixel is missing at both ends
    small = noise.sheet_map(round(MAP_SAMPLES * cells), seed=seed)
    sums = [
        noise.overlap_octaves(small, along.size, octaves=i + 1) for i in range(octaves)
    ]
    alone = [sums[0], *(b - a for a, b in itertools.pairwise(sums))]
    return (
        [layer / GREYS for layer in alone],
        [noise.exponential_filter(total) / WHITE for total in sums],
    )
