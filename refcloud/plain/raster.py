"""The framebuffer as rows of pixels, one pixel at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.metaballs import chord, profile

Colour = Sequence[float]  # red, green, blue, alpha
Buffer = list[list[list[float]]]  # buffer[row][column] is a colour


def framebuffer(width: int, height: int, color: Colour = (0, 0, 0, 0)) -> Buffer:
    """Make the rows of pixels; twin of `refcloud.raster.framebuffer`."""
    return [[list(color) for _ in range(width)] for _ in range(height)]


def read_pixels(buffer: Buffer, rows: range, columns: range) -> Buffer:
    """Copy a box of pixels; twin of `refcloud.raster.read_pixels`."""
    return [[list(buffer[row][column]) for column in columns] for row in rows]


def factor(name: str, source: Colour, destination: Colour, constant: Colour) -> Colour:
    """Give the four numbers that a blend factor stands for."""
    if name.startswith("ONE_MINUS_"):
        base = name.removeprefix("ONE_MINUS_")
        return [1.0 - f for f in factor(base, source, destination, constant)]
    if name == "SRC_ALPHA_SATURATE":
        room = min(source[3], 1.0 - destination[3])
        return [room, room, room, 1.0]
    if name in ("ZERO", "ONE"):
        return [float(name == "ONE")] * 4
    origin, part = name.split("_")
    colour = {"SRC": source, "DST": destination, "CONSTANT": constant}[origin]
    return colour if part == "COLOR" else [colour[3]] * 4


def blend(
    source: Colour,
    destination: Colour,
    src_factor: str,
    dst_factor: str,
    equation: str = "FUNC_ADD",
    constant: Colour = (0, 0, 0, 0),
) -> list[float]:
    """Blend one pixel (eq 28); twin of `refcloud.raster.blend`."""
    result = []
    f_src = factor(src_factor, source, destination, constant)
    f_dst = factor(dst_factor, source, destination, constant)
    for s, d, fs, fd in zip(source, destination, f_src, f_dst, strict=True):
        # The minimum and the maximum leave the factors out.
        terms = (s, d) if equation in ("MIN", "MAX") else (s * fs, d * fd)
        result.append(combined(*terms, equation))
    return result


def combined(s: float, d: float, equation: str) -> float:
    """Make one of two terms, by a blend equation."""
    if equation == "FUNC_ADD":
        return s + d
    if equation == "FUNC_SUBTRACT":
        return s - d
    if equation == "FUNC_REVERSE_SUBTRACT":
        return d - s
    return min(s, d) if equation == "MIN" else max(s, d)


def patch(
    x: float, y: float, radius: float, width: int, height: int
) -> list[tuple[int, int, float]]:
    """List (row, column, q) in the bounding square; twin of `refcloud.raster.patch`."""
    found = []
    for row in range(height):
        for column in range(width):
            across, down = column + 0.5, row + 0.5
            if x - radius <= across <= x + radius and y - radius <= down <= y + radius:
                q = ((across - x) / radius) ** 2 + ((down - y) / radius) ** 2
                found.append((row, column, q))
    return found


def footprint(q: float, kernel: str = "wyvill", name: str = "chord") -> float:
    """Weigh one pixel; twin of `refcloud.raster.footprint`."""
    if name == "profile":
        return profile(q, kernel)
    return chord(q, kernel) / chord(0.0, kernel)


def transmittance(weight: float, tau: float, law: str = "beer") -> float:
    """Let light through at one pixel; twin of `refcloud.raster.transmittance`."""
    if law == "beer":
        return math.exp(-tau * weight)
    return 1.0 - (1.0 - math.exp(-tau)) * weight


def splat(
    buffer: Buffer,
    x: float,
    y: float,
    radius: float,
    emission: Sequence[float],
    tau: float,
    kernel: str = "wyvill",
    name: str = "chord",
    law: str = "beer",
) -> None:
    """Blend one ball pixel by pixel (eq 27 to 29); twin of `refcloud.raster.splat`."""
    for row, column, q in patch(x, y, radius, len(buffer[0]), len(buffer)):
        weight = footprint(q, kernel, name)
        alpha = 1.0 - transmittance(weight, tau, law)
        # At depth 0 the ball glows as its footprint, and covers nothing.
        glow = alpha / -math.expm1(-tau) if tau > 0.0 else weight
        source = [light * glow for light in emission] + [alpha]
        pixel = buffer[row][column]
        pixel[:] = blend(source, pixel, "ONE", "ONE_MINUS_SRC_ALPHA")


def read_mean(
    buffer: Buffer,
    x: float,
    y: float,
    radius: float,
    area: str = "disc",
    kernel: str = "wyvill",
    name: str = "chord",
) -> list[float] | None:
    """Average pixel by pixel (E27); twin of `refcloud.raster.read_mean`."""
    width, height = len(buffer[0]), len(buffer)
    total, weights = [0.0] * 4, 0.0
    reach = radius + 0.5 if area == "antialiased" else radius
    for row, column, q in patch(x, y, reach, width, height):
        weight = 1.0 if area == "square" or q <= 1.0 else 0.0
        if area == "footprint":
            weight = footprint(q, kernel, name)
        elif area == "antialiased":  # about the share of the pixel in the disc
            weight = min(max(reach - math.sqrt(q) * reach, 0.0), 1.0)
        weights += weight
        for channel, value in enumerate(buffer[row][column]):
            total[channel] += weight * value
    if weights > 0.0:
        return [value / weights for value in total]
    # No pixel's centre lies in the area: the nearest pixel stands for it.
    column, row = min(max(x, 0.0), width), min(max(y, 0.0), height)
    aside = [abs(x - column) / radius, abs(y - row) / radius]
    if (max(aside) if area == "square" else math.hypot(*aside)) >= 1.0:
        return None
    return list(buffer[min(int(row), height - 1)][min(int(column), width - 1)])
