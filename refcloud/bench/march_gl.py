"""The same march as a fragment shader, where moderngl and an OpenGL driver are."""

from __future__ import annotations

import importlib
import importlib.util
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.camera import Camera, axes
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.transport import LightVolume

VERTEX = """
#version 330
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.0, 1.0); }
"""

FRAGMENT = """
#version 330
uniform sampler3D density;
uniform sampler3D reached;  // share of the sun's light at each voxel
uniform vec3 eye, right, up, back, sun, lower, upper;
uniform vec2 size;
uniform float pixel, sigma_t;
uniform int steps, sunward;
out vec4 color;

vec2 span(vec3 o, vec3 d) {
    vec3 a = (lower - o) / d, b = (upper - o) / d;
    vec3 least = min(a, b), most = max(a, b);
    return vec2(max(max(least.x, least.y), max(least.z, 0.0)),
                min(min(most.x, most.y), most.z));
}

float lit(vec3 p) {
    if (sunward == 0) return texture(reached, (p - lower) / (upper - lower)).r;
    float dt = span(p, sun).y / float(sunward), column = 0.0;
    for (int i = 0; i < sunward; ++i) {
        vec3 q = p + (float(i) + 0.5) * dt * sun;
        column += texture(density, (q - lower) / (upper - lower)).r;
    }
    return exp(-sigma_t * column * dt);
}

void main() {
    vec2 at = (gl_FragCoord.xy - 0.5 * size) * pixel;
    vec3 d = normalize(at.x * right + at.y * up - back);
    vec2 t = span(eye, d);
    float L = 0.0, T = 1.0;
    if (t.y > t.x) {
        float dt = (t.y - t.x) / float(steps);
        for (int i = 0; i < steps; ++i) {
            vec3 p = eye + (t.x + (float(i) + 0.5) * dt) * d;
            float rho = texture(density, (p - lower) / (upper - lower)).r;
            if (rho == 0.0) continue;
            float alpha = 1.0 - exp(-sigma_t * rho * dt);
            L += T * alpha * lit(p);
            T *= 1.0 - alpha;
        }
    }
    color = vec4(L, L, L, T);
}
"""


@dataclass(frozen=True)
class Shader:
    """A march on a grid and its light volume, ready to draw frames.

    Attributes
    ----------
    name
        What the driver calls its renderer.
    context, program, quad, textures
        Of moderngl; the context releases what nobody holds.
    """

    name: str
    context: Any
    program: Any
    quad: Any
    textures: tuple[Any, ...]

    @staticmethod
    def here(grid: VoxelGrid, volume: LightVolume, sigma_t: float) -> Shader | None:
        """Set the shader up; None where there is no OpenGL 3.3."""
        if not importlib.util.find_spec("moderngl"):
            return None
        moderngl = importlib.import_module("moderngl")
        try:
            context = importlib.import_module("refcloud.gl").context()
        except ValueError:  # no OpenGL here
            return None
        program = context.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        reached = np.exp(-sigma_t * volume.density)
        held = []
        for unit, (name, values) in enumerate(
            (("density", grid.density), ("reached", reached))
        ):
            data = np.ascontiguousarray(values, np.float32)
            texture = context.texture3d(values.shape[::-1], 1, data, dtype="f4")
            texture.repeat_x = texture.repeat_y = texture.repeat_z = False
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            held.append(texture)
            program[name].value = unit
        program["lower"].value = tuple(grid.lower)
        program["upper"].value = tuple(grid.upper)
        program["sigma_t"].value = sigma_t
        corners = np.array([-1, -1, 3, -1, -1, 3], np.float32)  # one large triangle
        quad = context.vertex_array(program, context.buffer(corners), "corner")
        name = context.info["GL_RENDERER"].split("(")[0].strip()
        return Shader(name, context, program, quad, tuple(held))

    def frame(self, camera: Camera, sun: Array, steps: int, sunward: int) -> Array:
        """Draw and read back a frame, (H, W, 3); sunward 0 reads the light volume."""
        right, up, back = axes(camera)
        size = camera.width, camera.height
        values: dict[str, Any] = {
            "eye": tuple(camera.eye),
            "right": tuple(right),
            "up": tuple(up),
            "back": tuple(back),
            "sun": tuple(sun),
            "size": size,
            "pixel": 2.0 * math.tan(0.5 * camera.fov_y) / camera.height,
            "steps": steps,
            "sunward": sunward,
        }
        for name, value in values.items():
            if name in self.program:
                self.program[name].value = value
        target = self.context.simple_framebuffer(size, 4, dtype="f4")
        target.use()
        for unit, texture in enumerate(self.textures):
            texture.use(unit)
        self.context.enable_only(self.context.NOTHING)  # it serves others too
        self.quad.render(vertices=3)
        data = target.read(components=3, dtype="f4")
        picture = np.frombuffer(data, np.float32).reshape(size[1], size[0], 3)
        return picture[::-1].astype(np.float64)
