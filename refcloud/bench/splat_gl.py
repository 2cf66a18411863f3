"""OpenGL in the splat benchmark: the backend gl, and the leanest way to draw discs.

The lean contender gets the projected balls for nothing; sorting, upload, drawing and
reading back are its work. It draws instanced quads without discarding anything, one
polynomial and one exponential a fragment: what OpenGL does best.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.bench import splat_scene
from refcloud.bench.timing import Contender
from refcloud.camera import Camera
from refcloud.conventions import Array
from refcloud.lighting import LitMetaballs
from refcloud.lighting.seen import seen_by

Reference = Callable[[], Any] | None
ROW = 8  # float32 of one ball: x, y, radius, -, red, green, blue, tau

VERTEX = """
#version 330
in vec4 disc;
in vec4 light;
flat out vec3 circle;
flat out vec4 shine;
uniform vec2 size;
void main() {
    vec2 corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
    circle = vec3(disc.xy, 1.0 / disc.z);
    shine = light;
    vec2 place = (disc.xy + corner * disc.z) / size;
    gl_Position = vec4(vec2(2.0, -2.0) * place + vec2(-1.0, 1.0), 0.0, 1.0);
}
"""
# Wyvill's profile and Beer's law, as the scene's balls are drawn; alpha lets through.
FRAGMENT = """
#version 330
flat in vec3 circle;
flat in vec4 shine;
uniform vec2 size;
out vec4 source;
void main() {
    vec2 place = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y);
    vec2 away = (place - circle.xy) * circle.z;
    float p = max(1.0 - dot(away, away), 0.0);
    float T = exp(-shine.a * p * p * (5.0 + 4.0 * p) / 9.0);
    source = vec4(shine.rgb * (1.0 - T), T);
}
"""
BLEND, ONE, ZERO, SRC_ALPHA, FUNC_ADD = 1, 1, 0, 0x0302, 0x8006


@dataclass(frozen=True, eq=False)
class Drawn:
    """Pixels as they were read, row 0 at the bottom, alpha what shines through.

    They become an array of RGBA like ours where an error is asked for, untimed.
    """

    read: Any
    scale: float

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        pixels = self.read[::-1] / self.scale
        pixels[..., 3] = 1.0 - pixels[..., 3]
        return pixels if dtype is None else pixels.astype(dtype)


def opengl() -> Any:
    """Give the optional room, or None where there is no moderngl or no OpenGL."""
    gl = importlib.import_module("refcloud.gl")
    try:
        gl.context()
    except ValueError:
        return None
    return gl


def second_pass_with_opengl(count: int, reference: Reference = None) -> list[Contender]:
    """List OpenGL's ways to draw the scene of so many balls; none without OpenGL."""
    gl = opengl()
    if gl is None:
        return []
    lit, camera = splat_scene.lit(count), splat_scene.eye()
    task, samples = f"second pass N={count}", 1
    name = gl.renderer().split(" (")[0]
    listed = [(f'backend="gl" on {name}', lambda: gl.eyeward(lit, camera)[0])]
    for format, dtype, scale in (("RGBA32F", "f4", 1.0), ("RGBA8", "f1", 255.0)):
        draw = lean(gl.context(), lit, camera, dtype, scale)
        listed.append((f"moderngl {format} with readback on {name}", draw))
    return [
        Contender(task, what, samples, work, reference, peer=True)
        for what, work in listed
    ]


def first_pass_with_opengl(count: int, reference: Reference = None) -> list[Contender]:
    """List OpenGL's way to light the scene of so many balls; none without OpenGL."""
    gl = opengl()
    if gl is None:
        return []
    lit = splat_scene.lit(count)
    work = functools.partial(
        gl.sunward, lit.balls, lit.suns, medium=lit.medium, look=lit.look
    )
    name = f'backend="gl" on {gl.renderer().split(" (")[0]}'
    return [
        Contender(
            f"first pass N={count}", name, 1, lambda: work().light, reference, peer=True
        )
    ]


def lean(
    ctx: Any, lit: LitMetaballs, camera: Camera, dtype: str, scale: float
) -> Callable[[], Drawn]:
    """Prepare the lean way: a program, a buffer of instances and a framebuffer."""
    width, height = camera.width, camera.height
    seen, _ = seen_by(lit, camera, None)
    count, depth = (
        len(seen.x),
        (lit.balls.centers - camera.eye) @ (camera.target - camera.eye),
    )
    balls = np.zeros((count, ROW), np.float32)
    balls[:, :3] = np.stack([seen.x, seen.y, seen.radius], axis=-1)
    balls[:, 4:7], balls[:, 7] = seen.flat_colours(), seen.tau[0]
    program = ctx.program(VERTEX, FRAGMENT)
    program["size"] = width, height
    instances = ctx.buffer(reserve=balls.nbytes)
    layout = instances, "4f 4f/i", "disc", "light"
    quads = ctx.vertex_array(program, [layout])
    fbo = ctx.framebuffer([ctx.texture((width, height), 4, dtype=dtype)])
    kind = "f4" if dtype == "f4" else "u1"

    def draw() -> Drawn:
        far_to_near = np.argsort(-depth, kind="stable")
        instances.write(balls[far_to_near])
        fbo.use()
        fbo.clear(0.0, 0.0, 0.0, 1.0)
        ctx.enable_only(BLEND)
        ctx.blend_func = ONE, SRC_ALPHA, ZERO, SRC_ALPHA
        ctx.blend_equation = FUNC_ADD
        quads.render(ctx.TRIANGLE_STRIP, vertices=4, instances=count)
        read = np.frombuffer(fbo.read(components=4, dtype=dtype), kind)
        return Drawn(read.reshape(height, width, 4), scale)

    return draw
