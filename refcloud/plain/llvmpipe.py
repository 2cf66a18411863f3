"""How llvmpipe blends one pixel: in float32 and in whole 8-bit codes.

Every operation is rounded by itself. A product, a sum or a root of two float32 in
float64, rounded once more, is the one that float32 arithmetic gives: 53 digits are at
least twice 24 and 2 more.
"""

from __future__ import annotations

import math

from refcloud.plain.framebuffer import (
    FLOAT16,
    FLOAT32,
    Rules,
    rounded,
    toward_zero,
)
from refcloud.plain.raster import Colour, combined

COPIES = {
    ("ONE", "ZERO", "FUNC_ADD"): "source",
    ("ONE", "ZERO", "FUNC_SUBTRACT"): "source",
    ("ZERO", "ONE", "FUNC_ADD"): "destination",
    ("ZERO", "ONE", "FUNC_REVERSE_SUBTRACT"): "destination",
}


def f32(x: float) -> float:
    """Round to float32."""
    return rounded(x, *FLOAT32)


def flushed(x: float) -> float:
    """Put 0 in the place of a denormal float32."""
    return 0.0 if abs(x) < 2.0**-126 else x


def clamped(x: float) -> float:
    """Clamp to [0, 1]."""
    return min(max(x, 0.0), 1.0)


def code(x: float) -> int:
    """Round to one of 256 codes, ties to even, as float32 multiplies."""
    return round(f32(clamped(f32(x)) * 255.0))


def code_product(a: int, b: int) -> int:
    """Multiply codes: a b / 255, rounded, without a division."""
    t = a * b
    return (t + (t >> 8) + 128) >> 8


def factor(name: str, s: Colour, d: Colour, c: Colour, channel: int, one: int) -> float:
    """Give the number that a blend factor stands for; one is what 1.0 is held as."""
    if name.startswith("ONE_MINUS_"):
        base = name.removeprefix("ONE_MINUS_")
        return f32(one - factor(base, s, d, c, channel, one))
    if name == "SRC_ALPHA_SATURATE":
        return one if channel == 3 else min(s[3], f32(one - d[3]))
    if name in ("ZERO", "ONE"):
        return one if name == "ONE" else 0.0
    origin, part = name.split("_")
    colour = {"SRC": s, "DST": d, "CONSTANT": c}[origin]
    return colour[channel if part == "COLOR" else 3]


def blended_floats(s: Colour, d: Colour, c: Colour, rules: Rules) -> list[float]:
    """Blend in float32: (s + d) f where both factors are the same f."""
    halves = (rules.rgb, rules.alpha)
    same = all(src == dst or name in ("MIN", "MAX") for src, dst, name in halves)
    result = []
    for channel in range(4):
        src, dst, equation = halves[channel == 3]
        f_src = factor(src, s, d, c, channel, 1)
        f_dst = factor(dst, s, d, c, channel, 1)
        terms = s[channel], d[channel]
        if equation in ("MIN", "MAX"):
            result.append(combined(*terms, equation))
        elif same:
            result.append(f32(f32(combined(*terms, equation)) * f_src))
        else:
            products = f32(terms[0] * f_src), f32(terms[1] * f_dst)
            result.append(f32(combined(*products, equation)))
    return result


def blended_codes(s: Colour, d: Colour, c: Colour, rules: Rules) -> list[float]:
    """Blend 8-bit codes: every product is rounded, sums are clamped."""
    s, d, c = ([code(x) for x in colour] for colour in (s, d, c))
    result = []
    for channel in range(4):
        src, dst, equation = rules.alpha if channel == 3 else rules.rgb
        f_src = int(factor(src, s, d, c, channel, 255))
        f_dst = int(factor(dst, s, d, c, channel, 255))
        terms: tuple[float, float] = s[channel], d[channel]
        if equation not in ("MIN", "MAX"):
            terms = code_product(s[channel], f_src), code_product(d[channel], f_dst)
        result.append(min(max(combined(*terms, equation), 0), 255) / 255.0)
    return result


def srgb_decode(encoded: float) -> float:
    """Decode by llvmpipe's cubic; twin of `srgb_decode_llvmpipe`."""
    v = f32(encoded)
    if f32(v * 255.0) <= 15.5:
        return f32(v / f32(12.6))
    cubic = f32(f32(v * f32(0.3012)) + f32(0.6935))
    cubic = f32(f32(cubic * v) + f32(0.0030))
    return f32(f32(cubic * v) + f32(0.0023))


def srgb_encode(linear: float) -> float:
    """Encode by llvmpipe's roots; twin of `srgb_encode_llvmpipe`."""
    x = f32(linear)
    if x <= f32(0.0031308):
        return f32(x * f32(12.6))
    root = f32(math.sqrt(x))
    third = f32(math.sqrt(f32(root * f32(math.sqrt(root)))))  # x^(3/8)
    power = f32(f32(0.675 * 1.0622) * third)
    power = f32(power + f32(f32(0.325 * 1.0622) * root))
    return f32(power - f32(0.062))


def blended_srgb(s: Colour, pixel: Colour, c: Colour, rules: Rules) -> list[float]:
    """Blend in linear light: what goes in is clamped, but not rounded to codes."""
    d = [*(srgb_decode(x) for x in pixel[:3]), f32(pixel[3])]
    s, c = ([clamped(x) for x in colour] for colour in (s, c))
    light = blended_floats(s, d, c, rules)
    light = [clamped(x) for x in light]
    encoded = [*(srgb_encode(x) for x in light[:3]), light[3]]
    return [code(x) / 255.0 for x in encoded]


def blended_llvmpipe(
    source: Colour, pixel: Colour, rules: Rules, format: str
) -> list[float]:
    """Blend one pixel; twin of `refcloud.raster.llvmpipe.blended_llvmpipe`."""
    s, c = [f32(x) for x in source], [f32(x) for x in rules.constant]
    copied = COPIES.get(rules.rgb, "rgb"), COPIES.get(rules.alpha, "alpha")
    if format == "RGBA8":
        return blended_codes(s, pixel, c, rules)
    if format == "SRGB8_ALPHA8":
        if copied == ("destination", "destination"):
            return list(pixel)
        return blended_srgb(s, pixel, c, rules)
    if copied[0] == copied[1]:
        result = list(s if copied[0] == "source" else pixel)
    else:
        s, d, c = ([flushed(x) for x in colour] for colour in (s, pixel, c))
        result = [flushed(x) for x in blended_floats(s, d, c, rules)]
    if format == "RGBA16F":
        result = [toward_zero(x, *FLOAT16) for x in result]
    return result
