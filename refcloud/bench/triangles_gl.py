"""OpenGL in the triangle benchmark: mesh and texture are there before the clock runs.

A frame is a clear, a draw and a wait for the end, or a read of the pixels.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud.bench import triangles_scene as scene
from refcloud.bench.splat_gl import opengl
from refcloud.conventions import Array

NOTHING = np.zeros(4)


class Frame:
    """A frame that is drawn; it is read, row 0 at the top, where an error is asked."""

    def __init__(self, read: Callable[[], Array]) -> None:
        self.read = read

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return self.read()


def ways(name: str, count: int, filter: str) -> list[tuple[str, Callable[[], Any]]]:
    """List OpenGL's ways to draw a scene; none without OpenGL."""
    gl = opengl()
    if gl is None:
        return []
    room = importlib.import_module("refcloud.gl.triangles")
    mesh, camera, cull = scene.scene(name, count)
    target = gl.framebuffer(scene.WIDTH, scene.HEIGHT, depth=True)
    how = {"cull": cull, **scene.DEPTHS}
    draw = room.prepared(target, camera, mesh, scene.textured(filter), **how)
    whole = slice(None), slice(None)

    def frame() -> Frame:
        gl.clear(target, NOTHING, depth=1.0)
        draw(scene.state(True))
        gl.context().finish()
        return Frame(lambda: gl.read_pixels(target, *whole))

    def read() -> Array:
        frame()
        return gl.read_pixels(target, *whole)

    renderer = gl.renderer().split(" (")[0]
    return [(f"OpenGL RGBA32F on {renderer}", frame), ("the same, and read", read)]
