"""Tiles of balls of one colour each: the paper's splats, exact or within a tolerance.

Exact is float64 at every pixel. A tolerance may take float32, and nodes in place of
pixels; both are certified: the tiles' own last terms tell where nodes are too few, and
a hashed sample of pixels is compared with the exact method before anything counts. A
sample can miss what lies beside it: the margins are those that generated scenes needed.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array, Skipped
from refcloud.lighting.look import Look
from refcloud.lighting.seen import Seen
from refcloud.noise import uniform
from refcloud.raster.nodes import LEAST_RISE, Nodes, nodes
from refcloud.raster.quadratics import EXACT, Floats, cancelling
from refcloud.raster.tile_lists import PIXELS, Discs, TileLists, Whole
from refcloud.raster.tiles import composite, pixel_places

LEVELS = (8, 12)  # nodes along a tile's edge, tried in turn
# Tolerances below this leave float32's own rounding, 6e-8 a step, no room.
LEAST_FLOAT32 = 1e-5
MOST_FLOAT32 = 1e-4  # of the tolerance's share: nothing is won by more
SAMPLE_TILES, SAMPLE_PIXELS = 64, 8  # 512 pixels are compared with the exact method
# The largest error of a picture over the largest of its sample: of float32, whose
# errors are sums of many roundings; and of nodes, whose errors sit at a few rims.
MARGIN_FLOAT32, MARGIN_NODES = 6.0, 1.2


@dataclass(frozen=True, eq=False)
class Flat:
    """Balls of one colour each, near to far.

    Attributes
    ----------
    discs
        Where they are in the picture.
    tau
        By group of channels, each of shape (N,).
    colours
        Shape (N, 3).
    groups
        Channels of one extinction each.
    look
        The rules.
    """

    discs: Discs
    tau: Sequence[Array]
    colours: Array
    groups: Sequence[Sequence[int]]
    look: Look


class Drawn(NamedTuple):
    """What was drawn of some tiles.

    Attributes
    ----------
    light
        What the balls add, shape (T, 3, S).
    clear
        Share of the background that passes, by group, shape (T, G, S).
    unseen
        List entries behind an opaque front, shape (T,).
    """

    light: Floats
    clear: Floats
    unseen: Whole


def flat_balls(seen: Seen, drawn: Whole) -> Flat:
    """Collect what tiles need of the balls that are drawn, near to far."""
    groups = seen.channel_groups()
    return Flat(
        Discs(seen.x[drawn], seen.y[drawn], seen.radius[drawn]),
        [seen.tau[channels[0]][drawn] for channels in groups],
        seen.flat_colours()[drawn],
        groups,
        seen.lit.look,
    )


def drawn_at(
    lists: TileLists,
    flat: Flat,
    places: tuple[Array, Array],
    least: float,
    dtype: type = np.float64,
    most: float = EXACT,
) -> Drawn:
    """Composite tiles at given places, group after group, unchecked.

    Parameters
    ----------
    lists, flat
        The tiles' lists and the balls.
    places, least, dtype
        As `composite`.
    most
        Of a ball's opacity: what rounding may change.

    Returns
    -------
    What was drawn.
    """
    count, size, look = len(lists.count), len(places[0]), flat.look
    light = np.empty((count, 3, size), dtype)
    clear = np.empty((count, len(flat.groups), size), dtype)
    unseen = np.zeros(count, np.intp)
    for group, channels in enumerate(flat.groups):
        tau = flat.tau[group]
        found = composite(
            lists,
            flat.discs,
            tau,
            flat.colours[:, channels],
            places,
            name=look.footprint,
            law=look.transmittance,
            dtype=dtype,
            least=least,
            direct=cancelling(
                flat.discs, tau, look.transmittance, most=most, dtype=dtype
            ),
        )
        light[:, channels], clear[:, group] = found.light, found.clear
        unseen += found.unseen
    return Drawn(light, clear, unseen)


def exact_tiles(lists: TileLists, flat: Flat, least: float) -> Drawn:
    """Composite tiles in float64 at every pixel."""
    return drawn_at(lists, flat, pixel_places(), least)


def certified_tiles(
    lists: TileLists,
    flat: Flat,
    least: float,
    most: float,
    brightest: float,
    behind: float,
) -> tuple[Drawn, list[Skipped]]:
    """Composite tiles with an error of at most `most`, as cheaply as that allows.

    Parameters
    ----------
    lists, flat, least
        As `exact_tiles`.
    most
        Largest error of a channel.
    brightest
        Largest colour, at least 1.
    behind
        Largest colour of the background; 0 where there is none.

    Returns
    -------
    What was drawn, and the rows of the report.
    """
    share = most if most < 2.0 * MOST_FLOAT32 else MOST_FLOAT32
    # What rounding may change of one ball's opacity at the worst; the sample tells.
    digits = 4.0 * share / brightest
    if most < 0.4 * LEAST_FLOAT32 or not _fits(flat, digits):
        return exact_tiles(lists, flat, least), []
    # 1. Tiles of wide balls at their nodes, those pass whose last terms are small.
    how = least, np.float32, digits
    count = len(lists.count)
    drawn = Drawn(
        np.empty((count, 3, PIXELS), np.float32),
        np.empty((count, len(flat.groups), PIXELS), np.float32),
        np.zeros(count, np.intp),
    )
    rise = _rise(lists, flat)
    open_ = np.ones(count, dtype=bool)
    saved = 0
    for level in map(nodes, LEVELS):
        tried = np.flatnonzero(open_ & _promising(level, rise, most - share))
        if not len(tried):
            continue
        found = drawn_at(lists.chosen(tried), flat, level.places, *how)
        error = _of_picture(
            level.error_of(found.light), level.error_of(found.clear), behind
        )
        good = np.flatnonzero(error <= most - share)
        passed = tried[good]
        drawn.light[passed] = level.at_pixels(found.light[good])
        drawn.clear[passed] = level.at_pixels(found.clear[good])
        drawn.unseen[passed] = found.unseen[good]
        open_[passed] = False
        saved += len(passed) * (PIXELS - level.n**2)
    # 2. All others at their pixels.
    if open_.all():
        drawn = drawn_at(lists, flat, pixel_places(), *how)
    elif open_.any():
        rest = np.flatnonzero(open_)
        found = drawn_at(lists.chosen(rest), flat, pixel_places(), *how)
        for whole, part in zip(drawn, found, strict=True):
            whole[rest] = part
    # 3. The sample decides whether it counts.
    cut = least * brightest  # what an opaque front may hide is counted apart
    sampled = _sampled_error(lists, flat, drawn, open_, behind)
    whole, between = (max(error - cut, 0.0) for error in sampled)
    if MARGIN_FLOAT32 * whole > share or MARGIN_NODES * between > most:
        return exact_tiles(lists, flat, least), []
    told = functools.partial(Skipped, "eye", how="certified")
    rows = [told("tiles in double precision", count, count, share)]
    if saved:
        what = "pixels between nodes of smooth tiles"
        rows.append(told(what, saved, count * PIXELS, most - share))
    return drawn, rows


def _fits(flat: Flat, most: float) -> bool:
    """Tell whether float32 pays: where most balls' opacities keep enough digits."""
    return all(
        np.count_nonzero(
            cancelling(
                flat.discs,
                tau,
                flat.look.transmittance,
                most=most,
                dtype=np.float32,
            )
        )
        <= 0.5 * len(tau)
        for tau in flat.tau
    )


def _rise(lists: TileLists, flat: Flat) -> Array:
    """Give the pixels over which the steepest ball of each tile becomes opaque."""
    deepest = np.maximum(np.max(flat.tau, axis=0), 1.0)
    rise = (flat.discs.radius / np.sqrt(deepest))[lists.ball]
    return np.minimum.reduceat(rise, lists.first)


def _promising(level: Nodes, rise: Array, most: float) -> np.ndarray:
    """Tell which tiles the nodes may serve, and guess which of them will pass.

    The estimate is about 0.009 where opacity rises within 6 spacings, and falls with
    the third power of that (medians of the benchmark's scene): a wrong guess costs
    time alone.
    """
    spacings = rise / level.spacing
    return (spacings >= LEAST_RISE) & (0.009 * (6.0 / spacings) ** 3 <= most)


def _of_picture(light: Floats, clear: Floats, behind: float) -> Floats:
    """Give a picture's error from those of what is added and of what passes.

    Before a background it shows light + clear background, before none it has an alpha.
    """
    return light + behind * clear if behind > 0.0 else np.maximum(light, clear)


def _sampled_error(
    lists: TileLists, flat: Flat, drawn: Drawn, pixels: np.ndarray, behind: float
) -> tuple[float, float]:
    """Compare hashed pixels with the exact method.

    Returns
    -------
    The largest error where all pixels were drawn, and where nodes were.
    """
    keys = uniform(lists.row, lists.column, seed=0)
    some = np.sort(np.argsort(keys, kind="stable")[:SAMPLE_TILES])
    order = np.argsort(uniform(np.arange(PIXELS), seed=1), kind="stable")
    at = order[:SAMPLE_PIXELS]
    x, y = pixel_places()
    exact = drawn_at(lists.chosen(some), flat, (x[at], y[at]), 0.0)
    error = _of_picture(
        np.abs(exact.light - drawn.light[some][..., at]).max(axis=(1, 2)),
        np.abs(exact.clear - drawn.clear[some][..., at]).max(axis=(1, 2)),
        behind,
    )
    whole = pixels[some]
    return (
        float(error[whole].max(initial=0.0)),
        float(error[~whole].max(initial=0.0)),
    )
