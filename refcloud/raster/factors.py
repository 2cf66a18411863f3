"""Blend factors and equations under OpenGL's names, one rule for each.

The four dual-source factors of glBlendFunc (SRC1_...) need a second colour from a
shader; there is none here, so they are refused by name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from refcloud.checking import check_fields
from refcloud.raster.framebuffer import NOTHING, Rgba

Factor = Literal[
    "ZERO",
    "ONE",
    "SRC_COLOR",
    "ONE_MINUS_SRC_COLOR",
    "DST_COLOR",
    "ONE_MINUS_DST_COLOR",
    "SRC_ALPHA",
    "ONE_MINUS_SRC_ALPHA",
    "DST_ALPHA",
    "ONE_MINUS_DST_ALPHA",
    "CONSTANT_COLOR",
    "ONE_MINUS_CONSTANT_COLOR",
    "CONSTANT_ALPHA",
    "ONE_MINUS_CONSTANT_ALPHA",
    "SRC_ALPHA_SATURATE",
]
Equation = Literal["FUNC_ADD", "FUNC_SUBTRACT", "FUNC_REVERSE_SUBTRACT", "MIN", "MAX"]
Rule = tuple[str, str, str]  # source factor, destination factor, equation
Numbers = Any  # an array of float64, float32 or integers, as the format computes


def _saturate(s: Numbers, d: Numbers, c: Numbers, one: Any) -> Numbers:
    """Let colour in only as far as the buffer's alpha leaves room; alpha whole."""
    room = np.minimum(s[..., 3:], one - d[..., 3:])
    return np.concatenate([room, room, room, np.full_like(room, one)], axis=-1)


# Factor of (source, destination, constant, one), where one is what the format holds for
# 1.0; a last axis of length 1 is the same on RGBA.
FACTORS: dict[str, Callable[[Numbers, Numbers, Numbers, Any], Numbers]] = {
    "ZERO": lambda s, d, c, one: np.zeros(1, s.dtype),
    "ONE": lambda s, d, c, one: np.full(1, one, s.dtype),
    "SRC_COLOR": lambda s, d, c, one: s,
    "ONE_MINUS_SRC_COLOR": lambda s, d, c, one: one - s,
    "DST_COLOR": lambda s, d, c, one: d,
    "ONE_MINUS_DST_COLOR": lambda s, d, c, one: one - d,
    "SRC_ALPHA": lambda s, d, c, one: s[..., 3:],
    "ONE_MINUS_SRC_ALPHA": lambda s, d, c, one: one - s[..., 3:],
    "DST_ALPHA": lambda s, d, c, one: d[..., 3:],
    "ONE_MINUS_DST_ALPHA": lambda s, d, c, one: one - d[..., 3:],
    "CONSTANT_COLOR": lambda s, d, c, one: c,
    "ONE_MINUS_CONSTANT_COLOR": lambda s, d, c, one: one - c,
    "CONSTANT_ALPHA": lambda s, d, c, one: c[..., 3:],
    "ONE_MINUS_CONSTANT_ALPHA": lambda s, d, c, one: one - c[..., 3:],
    "SRC_ALPHA_SATURATE": _saturate,
}

# Result of (source, destination, source times factor, destination times factor).
EQUATIONS: dict[str, Callable[[Numbers, Numbers, Numbers, Numbers], Numbers]] = {
    "FUNC_ADD": lambda s, d, sf, df: sf + df,
    "FUNC_SUBTRACT": lambda s, d, sf, df: sf - df,
    "FUNC_REVERSE_SUBTRACT": lambda s, d, sf, df: df - sf,
    "MIN": lambda s, d, sf, df: np.minimum(s, d),  # the factors do not count
    "MAX": lambda s, d, sf, df: np.maximum(s, d),
}


@dataclass(frozen=True)
class Blending:
    """How a new colour and the framebuffer's own make one.

    Attributes
    ----------
    src_rgb, dst_rgb
        Factors of the new colour and of the buffer's, under OpenGL's names
        (glBlendFunc).
    src_alpha, dst_alpha
        Those of the alpha channel (glBlendFuncSeparate); None for the same.
    equation
        How the two products make one (glBlendEquation).
    equation_alpha
        That of the alpha channel (glBlendEquationSeparate); None for the same.
    constant
        RGBA of the CONSTANT factors, shape (4,) (glBlendColor).
    """

    src_rgb: Factor = "ONE"
    dst_rgb: Factor = "ZERO"
    src_alpha: Factor | None = None
    dst_alpha: Factor | None = None
    equation: Equation = "FUNC_ADD"
    equation_alpha: Equation | None = None
    constant: Rgba = field(default_factory=lambda: NOTHING)

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def rgb(self) -> Rule:
        """Give source factor, destination factor and equation of the colours."""
        return self.src_rgb, self.dst_rgb, self.equation

    @property
    def alpha(self) -> Rule:
        """Give source factor, destination factor and equation of alpha."""
        return (
            self.src_alpha or self.src_rgb,
            self.dst_alpha or self.dst_rgb,
            self.equation_alpha or self.equation,
        )


OVER = Blending("ONE", "ONE_MINUS_SRC_ALPHA")  # eq 28, of every splat


def by_rule(s: Numbers, d: Numbers, c: Numbers, rule: Rule, one: Any = 1.0) -> Numbers:
    """Blend all channels by one rule, unchecked: f_src s and f_dst d, made one.

    Parameters
    ----------
    s, d, c
        Source and destination, shape (..., 4), and constant, shape (4,).
    rule
        Source factor, destination factor, equation.
    one
        What the numbers count as 1.0.

    Returns
    -------
    Shape (..., 4).
    """
    src, dst, equation = rule
    f_src, f_dst = FACTORS[src](s, d, c, one), FACTORS[dst](s, d, c, one)
    return EQUATIONS[equation](s, d, s * f_src, d * f_dst)


def by_channel(
    how: Callable[[Numbers, Numbers, Numbers, Rule, Any], Numbers],
    s: Numbers,
    d: Numbers,
    c: Numbers,
    blending: Blending,
    one: Any = 1.0,
) -> Numbers:
    """Blend colours by one rule and alpha by its own, unchecked.

    Parameters
    ----------
    how
        `by_rule`, or a driver's way to do the same.
    s, d, c, one
        As `by_rule`.
    blending
        Both rules.

    Returns
    -------
    Shape (..., 4).
    """
    result = how(s, d, c, blending.rgb, one)
    if blending.alpha != blending.rgb:
        result[..., 3] = how(s, d, c, blending.alpha, one)[..., 3]
    return result
