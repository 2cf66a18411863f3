"""A state of the rasteriser as OpenGL takes it: names to numbers, all set every time.

moderngl's state belongs to the context and stays: whoever draws sets all of it.
"""

from __future__ import annotations

import ctypes
from typing import Any

from refcloud.checking import complaint
from refcloud.gl.opengl import context
from refcloud.raster import Blending, State
from refcloud.raster.formats import nearest_float32

ENUMS = {
    "ZERO": 0,
    "ONE": 1,
    "SRC_COLOR": 0x0300,
    "ONE_MINUS_SRC_COLOR": 0x0301,
    "SRC_ALPHA": 0x0302,
    "ONE_MINUS_SRC_ALPHA": 0x0303,
    "DST_ALPHA": 0x0304,
    "ONE_MINUS_DST_ALPHA": 0x0305,
    "DST_COLOR": 0x0306,
    "ONE_MINUS_DST_COLOR": 0x0307,
    "SRC_ALPHA_SATURATE": 0x0308,
    "CONSTANT_COLOR": 0x8001,
    "ONE_MINUS_CONSTANT_COLOR": 0x8002,
    "CONSTANT_ALPHA": 0x8003,
    "ONE_MINUS_CONSTANT_ALPHA": 0x8004,
    "FUNC_ADD": 0x8006,
    "MIN": 0x8007,
    "MAX": 0x8008,
    "FUNC_SUBTRACT": 0x800A,
    "FUNC_REVERSE_SUBTRACT": 0x800B,
}
# moderngl names depth functions by their signs.
DEPTH_FUNCS = {
    "NEVER": "0",
    "LESS": "<",
    "EQUAL": "==",
    "LEQUAL": "<=",
    "GREATER": ">",
    "NOTEQUAL": "!=",
    "GEQUAL": ">=",
    "ALWAYS": "1",
}
BLEND, DEPTH_TEST, FRAMEBUFFER_SRGB = 1, 2, 0x8DB9  # moderngl's flags, GL's number
SRGB8_ALPHA8 = 0x8C43  # a format that moderngl does not name


def set_state(fbo: Any, state: State) -> None:
    """Bind a framebuffer and set all that its fragments go through.

    Parameters
    ----------
    fbo
        A moderngl.Framebuffer, its viewport and scissor set.
    state
        Of the rasteriser.
    """
    ctx = context()
    masks = (state.color_mask,) * len(fbo.color_attachments)
    fbo.color_mask = masks if len(masks) > 1 else state.color_mask
    fbo.depth_mask = state.depth_mask
    fbo.use()
    flags = 0
    if state.blending is not None:
        flags |= BLEND
        _set_blending(ctx, state.blending)
    if state.depth_func is not None:
        flags |= DEPTH_TEST
        ctx.depth_func = DEPTH_FUNCS[state.depth_func]
    ctx.enable_only(flags)
    ctx.enable_direct(FRAMEBUFFER_SRGB)  # counts for targets with encoded values alone


def _set_blending(ctx: Any, blending: Blending) -> None:
    (src, dst, equation), (src_a, dst_a, equation_a) = blending.rgb, blending.alpha
    ctx.blend_func = tuple(ENUMS[name] for name in (src, dst, src_a, dst_a))
    ctx.blend_equation = ENUMS[equation], ENUMS[equation_a]
    if any("CONSTANT" in name for name in (src, dst, src_a, dst_a)):
        blend_color(ctx, blending)


def blend_color(ctx: Any, blending: Blending) -> None:
    """Set the constant of the CONSTANT factors: glBlendColor, which moderngl lacks.

    Parameters
    ----------
    ctx
        The context, current.
    blending
        Its constant is set.

    Raises
    ------
    ValueError
        This moderngl does not tell where the function is.
    """
    try:  # a private attribute: the one place that knows of it
        address = ctx.mglo._context.load("glBlendColor")
    except AttributeError:
        address = 0
    if not address:
        expected, got = "a moderngl that finds glBlendColor", "one that does not"
        advice = "choose factors without CONSTANT"
        raise ValueError(complaint("constant", expected, got, advice))
    call = ctypes.CFUNCTYPE(None, *[ctypes.c_float] * 4)(address)
    call(*nearest_float32(blending.constant).tolist())
