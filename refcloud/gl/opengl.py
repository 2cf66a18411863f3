"""One OpenGL context for the whole process, without a window."""

from __future__ import annotations

import functools
import importlib
import threading
from typing import Any

from refcloud.refusal import complaint, installing

# EGL needs no display; elsewhere the system's own way opens a context off screen.
WAYS: tuple[dict[str, str], ...] = ({"backend": "egl"}, {})
LEAST_VERSION = 330  # OpenGL 3.3: instances, float targets, texelFetch


def context() -> Any:
    """Open the context, or give the one that is open.

    Returns
    -------
    A moderngl.Context.

    Raises
    ------
    ValueError
        There is no moderngl, or no OpenGL, or another thread has opened it: one line
        says which.
    """
    ctx, owner = opened()
    if owner != threading.get_ident():
        expected, got = "the thread that first drew with OpenGL", "another"
        advice = "draw there, or choose the backend numpy"
        raise ValueError(complaint("backend", expected, got, advice))
    return ctx


@functools.cache
def opened() -> tuple[Any, int]:
    """Open the context once: it and the thread that it belongs to."""
    try:
        moderngl = importlib.import_module("moderngl")
    except ImportError:
        expected = "moderngl for the backend gl"
        advice = installing("gl")
        raise ValueError(complaint("backend", expected, "none", advice)) from None
    reasons = []
    for way in WAYS:
        try:
            ctx = moderngl.create_context(LEAST_VERSION, standalone=True, **way)
        except Exception as error:  # moderngl raises what its system layer does
            reasons.append(" ".join(str(error).split()))
            continue
        ctx.gc_mode = "auto"  # what nobody holds any more is released
        return ctx, threading.get_ident()
    advice = "install Mesa's software OpenGL, or choose the backend numpy"
    raise ValueError(
        complaint("backend", "OpenGL 3.3 for the backend gl", reasons[0], advice)
    )


def renderer() -> str:
    """Name what draws: GL_RENDERER, for instance "llvmpipe (LLVM 15.0.6, 256 bits)"."""
    return str(context().info["GL_RENDERER"])


def refuse_errors(what: str) -> None:
    """Raise where OpenGL notes an error, which it does silently."""
    error = context().error
    if error != "GL_NO_ERROR":
        raise RuntimeError(f"OpenGL: {error} from {what}")


def refuse_large_side(width: int, height: int) -> None:
    """Refuse a picture that this OpenGL cannot hold."""
    most = int(context().info["GL_MAX_TEXTURE_SIZE"])
    if max(width, height) > most:
        expected = f"sides of at most {most} pixels with this OpenGL"
        advice = "make the picture smaller, or choose the backend numpy"
        raise ValueError(complaint("width", expected, f"{width} x {height}", advice))
