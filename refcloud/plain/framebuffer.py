"""Formats and fragments, one number and one pixel at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.image import srgb_decode, srgb_encode
from refcloud.plain.raster import Buffer, Colour, blend

FLOAT32 = 24, -149, (2.0 - 2.0**-23) * 2.0**127  # digits, finest step, largest
FLOAT16 = 11, -24, 65504.0


class Rules(NamedTuple):
    """Factors, equations and constant of a blend; colours and alpha by themselves."""

    rgb: tuple[str, str, str]
    alpha: tuple[str, str, str]
    constant: Colour


class State(NamedTuple):
    """What fragments go through; twin of `refcloud.raster.State`."""

    blending: Rules | None
    color_mask: tuple[bool, bool, bool, bool]
    scissor: tuple[range, range] | None
    depth_func: str | None
    depth_mask: bool


def rounded(x: float, digits: int, finest: int, largest: float) -> float:
    """Round to a binary float of some digits, ties to even, at most the largest."""
    step = math.ldexp(1.0, max(math.frexp(x)[1] - digits, finest))
    return max(-largest, min(round(x / step) * step, largest)) if x else x


def toward_zero(x: float, digits: int, finest: int, largest: float) -> float:
    """Cut to a binary float of some digits."""
    step = math.ldexp(1.0, max(math.frexp(x)[1] - digits, finest))
    return max(-largest, min(math.trunc(x / step) * step, largest))


def nearest_code(x: float) -> float:
    """Clamp to [0, 1] and round to a multiple of 1/255, ties to even."""
    return round(min(max(x, 0.0), 1.0) * 255.0) / 255.0


def stored(color: Colour, format: str) -> list[float]:
    """Keep of a colour what a format holds; twin of `refcloud.raster.stored`."""
    if format == "RGBA64F":
        return list(color)
    if format == "RGBA32F":
        return [rounded(x, *FLOAT32) for x in color]
    if format == "RGBA16F":
        return [rounded(x, *FLOAT16) for x in color]
    if format == "SRGB8_ALPHA8":
        light = [min(max(x, 0.0), 1.0) for x in color]
        color = [*(srgb_encode(x) for x in light[:3]), light[3]]
    return [nearest_code(x) for x in color]


def linear(pixel: Colour, format: str) -> Colour:
    """Decode a pixel where its format is encoded."""
    if format == "SRGB8_ALPHA8":
        return [*(srgb_decode(x) for x in pixel[:3]), pixel[3]]
    return pixel


def blended_as(source: Colour, pixel: Colour, rules: Rules, format: str) -> list[float]:
    """Blend one pixel in a format; twin of `refcloud.raster.blending.blended_as`."""
    destination, constant = linear(pixel, format), rules.constant
    if format != "RGBA64F":
        fixed = format in ("RGBA8", "SRGB8_ALPHA8")
        low, high = (0.0, 1.0) if fixed else (-FLOAT32[2], FLOAT32[2])
        source = [min(max(x, low), high) for x in source]
        constant = [min(max(x, low), high) for x in constant]
    src, dst, equation = rules.rgb
    result = blend(source, destination, src, dst, equation, constant)
    src, dst, equation = rules.alpha
    result[3] = blend(source, destination, src, dst, equation, constant)[3]
    return stored(result, format)


def passes(new: float, old: float, depth_func: str) -> bool:
    """Compare a fragment's depth with the buffer's (glDepthFunc)."""
    return {
        "NEVER": False,
        "LESS": new < old,
        "EQUAL": new == old,
        "LEQUAL": new <= old,
        "GREATER": new > old,
        "NOTEQUAL": new != old,
        "GEQUAL": new >= old,
        "ALWAYS": True,
    }[depth_func]


def inside(row: int, column: int, scissor: tuple[range, range] | None) -> bool:
    """Tell whether the scissor lets a pixel by."""
    return scissor is None or (row in scissor[0] and column in scissor[1])


def draw_fragments(
    buffer: Buffer,
    depths: list[list[float]],
    fragments: Sequence[tuple[int, int, float, Colour]],
    state: State,
    format: str,
) -> None:
    """Draw (row, column, depth, colour) one by one; twin of `raster.draw_fragments`."""
    for row, column, depth, color in fragments:
        if not inside(row, column, state.scissor):
            continue
        if state.depth_func is not None:
            if not passes(depth, depths[row][column], state.depth_func):
                continue
            if state.depth_mask:
                depths[row][column] = depth
        pixel = buffer[row][column]
        if state.blending is None:
            result = stored(color, format)
        else:
            result = blended_as(color, pixel, state.blending, format)
        for channel in range(4):
            if state.color_mask[channel]:
                pixel[channel] = result[channel]


def clear(
    buffer: Buffer,
    depths: list[list[float]],
    color: Colour,
    depth: float,
    state: State,
    format: str,
) -> None:
    """Set every pixel and every depth; twin of `refcloud.raster.clear`."""
    kept = stored(color, format)
    for row, line in enumerate(buffer):
        for column, pixel in enumerate(line):
            if inside(row, column, state.scissor):
                for channel in range(4):
                    if state.color_mask[channel]:
                        pixel[channel] = kept[channel]
                if state.depth_mask:
                    depths[row][column] = depth


def read_average(buffer: Buffer, rows: range, columns: range) -> list[float] | None:
    """Average those pixels of a box that exist; twin of `raster.read_average`."""
    read = [
        buffer[row][column]
        for row in rows
        for column in columns
        if 0 <= row < len(buffer) and 0 <= column < len(buffer[0])
    ]
    if not read:
        return None
    return [math.fsum(pixel[c] for pixel in read) / len(read) for c in range(4)]


def seen_through_layers(alpha: float, layers: int, format: str) -> list[float]:
    """Look through black layers; twin of `refcloud.raster.seen_through_layers`."""
    over = ("ONE", "ONE_MINUS_SRC_ALPHA", "FUNC_ADD")
    rules, pixel = Rules(over, over, (0.0, 0.0, 0.0, 0.0)), [1.0, 1.0, 1.0, 1.0]
    seen = [1.0]
    for _ in range(layers):
        pixel = blended_as((0.0, 0.0, 0.0, alpha), pixel, rules, format)
        seen.append(pixel[0])
    return seen
