"""The rules that Mesa's software driver llvmpipe blends by, as measured to the bit.

OpenGL leaves the rounding of blends open, and drivers differ. These are the rules of
llvmpipe of Mesa 22.3 on x86: the tests that draw the same with OpenGL hold them equal
to the driver, for every pair of factors and every equation. Only SRGB8_ALPHA8 is not
equal to the bit: the driver takes roots by a processor's approximate instruction, and
one value in 250 is one code off. (Behind a colour mask MIN and MAX may let a denormal
by.)
"""

from __future__ import annotations

from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.raster.factors import (
    EQUATIONS,
    FACTORS,
    Blending,
    Numbers,
    Rule,
    by_channel,
)
from refcloud.raster.formats import (
    WHITE,
    Format,
    code_llvmpipe,
    float16_toward_zero,
    nearest_float32,
    srgb_decode_llvmpipe,
    stored,
)

NORMAL = 2.0**-126  # the smallest float32 that is not denormal


def blended_llvmpipe(
    source: Array, destination: Array, blending: Blending, format: Format
) -> Array:
    """Blend and round as llvmpipe does, unchecked.

    Parameters
    ----------
    source
        New colours, linear RGBA, shape (..., 4).
    destination
        What the framebuffer holds, the same shape.
    blending
        Factors, equations and constant.
    format
        Of the framebuffer; RGBA64F, which no driver has, counts as RGBA32F.

    Returns
    -------
    What the framebuffer then holds, shape (..., 4), float64.
    """
    s, c = nearest_float32(source), nearest_float32(blending.constant)
    if format == "RGBA8":
        return _blended_codes(s, destination, c, blending) / WHITE
    if format == "SRGB8_ALPHA8":
        return _blended_srgb(s, destination, c, blending)
    result = _blended_float32(s, destination, c, blending)
    return float16_toward_zero(result) if format == "RGBA16F" else result


def _blended_float32(s: Array, d: Array, c: Array, blending: Blending) -> Array:
    """Blend in float32: nothing is clamped, and denormals become 0 on every way."""
    copied = _copied(blending)
    if copied:
        return s if copied == "source" else d
    s, d, c = flushed(s), flushed(d), flushed(c)
    return flushed(nearest_float32(by_channel(_factored(blending), s, d, c, blending)))


def _blended_codes(s: Array, destination: Array, c: Array, blending: Blending) -> Array:
    """Blend 8-bit codes as whole numbers: each product is rounded, sums are clamped."""
    codes = code_llvmpipe(s), np.rint(destination * WHITE), code_llvmpipe(c)
    i, j, k = (code.astype(np.int32) for code in codes)

    def by_codes(s: Numbers, d: Numbers, c: Numbers, rule: Rule, one: Any) -> Numbers:
        src, dst, equation = rule
        f_src, f_dst = FACTORS[src](s, d, c, one), FACTORS[dst](s, d, c, one)
        return EQUATIONS[equation](s, d, code_product(s, f_src), code_product(d, f_dst))

    return np.clip(by_channel(by_codes, i, j, k, blending, int(WHITE)), 0, int(WHITE))


def _blended_srgb(s: Array, destination: Array, c: Array, blending: Blending) -> Array:
    """Blend in linear light, float32: what goes in is clamped but not rounded."""
    if _copied(blending) == "destination":
        return destination
    d = nearest_float32(destination)
    d[..., :3] = srgb_decode_llvmpipe(destination[..., :3])
    s, c = np.clip(s, 0.0, 1.0), np.clip(c, 0.0, 1.0)
    result = nearest_float32(by_channel(_factored(blending), s, d, c, blending))
    return stored(result, "SRGB8_ALPHA8", arithmetic="llvmpipe")


def flushed(values: Array) -> Array:
    """Put 0 in the place of denormal float32."""
    return np.where(np.abs(values) < NORMAL, 0.0, values)


def code_product(a: Any, b: Any) -> Any:
    """Multiply codes of 8 bits: a b / 255, rounded, without a division."""
    t = a * b
    return (t + (t >> 8) + 128) >> 8


def _copied(blending: Blending) -> str:
    """Say which operand all four channels are a copy of, if one is."""
    copies = {
        ("ONE", "ZERO", "FUNC_ADD"): "source",
        ("ONE", "ZERO", "FUNC_SUBTRACT"): "source",
        ("ZERO", "ONE", "FUNC_ADD"): "destination",
        ("ZERO", "ONE", "FUNC_REVERSE_SUBTRACT"): "destination",
    }
    rgb, alpha = copies.get(blending.rgb, ""), copies.get(blending.alpha, "")
    return rgb if rgb == alpha else ""


def _factored(blending: Blending) -> Any:
    """Choose the rule of one half: (s + d) f where both factors are the same f.

    Where colours and alpha have rules of their own, either both halves are computed so
    or none; a half that takes the minimum or maximum does not stand in the way.
    """
    halves = {blending.rgb, blending.alpha}
    same = all(src == dst or name in ("MIN", "MAX") for src, dst, name in halves)

    def by_half(s: Numbers, d: Numbers, c: Numbers, rule: Rule, one: Any) -> Numbers:
        # float64 holds a product of two float32 whole, and a sum so nearly that
        # rounding it once more gives what float32 arithmetic gives.
        src, dst, equation = rule
        combine = EQUATIONS[equation]
        f_src = nearest_float32(FACTORS[src](s, d, c, one))
        if same and equation not in ("MIN", "MAX"):
            return nearest_float32(combine(s, d, s, d)) * f_src
        f_dst = nearest_float32(FACTORS[dst](s, d, c, one))
        return combine(s, d, nearest_float32(s * f_src), nearest_float32(d * f_dst))

    return by_half
