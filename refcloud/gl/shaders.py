"""Both passes in GLSL: a quad for each ball, and what the ball adds to each pixel."""

from __future__ import annotations

from refcloud.gl.footprints import footprint_source
from refcloud.gl.tables import FETCH, TRILINEAR
from refcloud.lighting.erosion import SOFT
from refcloud.lighting.lightfield import OWN
from refcloud.lighting.look import Look
from refcloud.lighting.shading import FRONT
from refcloud.metaballs.kernels import Kernel

# What the table of balls holds of each, four numbers at a time; its colours follow.
FIXED = 8
PLACE, BALL, BOX, HAZE, DETAIL, DETAIL_PART, FIELD, FIELD_PART = range(FIXED)

VERTEX = f"""
#version 330
uniform sampler2D balls;
uniform int ball_0;  // the first that is drawn
uniform int columns;  // of the table, for each ball
uniform vec2 size;  // of the picture, pixels
flat out int first;
flat out vec4 place, ball, haze;
flat out vec3 flat_color;  // all lights and the air, where each ball has one colour
{FETCH}
void main() {{
    first = (ball_0 + gl_InstanceID) * columns;
    place = cell_of(balls, first + {PLACE});  // x: whole pixels, rest in radii; y too
    ball = cell_of(balls, first + {BALL});  // 1 / radius, -, tau, air's clearness
    haze = cell_of(balls, first + {HAZE});  // what the air adds; 1 - exp(-tau)
    flat_color = vec3(0.0);
    for (int k = {FIXED}; k < columns; k++) flat_color += cell_of(balls, first + k).rgb;
    flat_color = flat_color * ball.w + haze.rgb;
    vec4 box = cell_of(balls, first + {BOX});  // left, right, top, bottom
    vec2 corner = vec2((gl_VertexID & 1) == 0 ? box.x : box.y,
                       (gl_VertexID >> 1) == 0 ? box.z : box.w);
    // Rows count down from the top, OpenGL's y up from the bottom.
    gl_Position = vec4(vec2(2.0, -2.0) * corner / size + vec2(-1.0, 1.0), 0.0, 1.0);
}}
"""

HEAD = """
#version 330
uniform sampler2D balls;
uniform vec2 size;
flat in int first;
flat in vec4 place, ball, haze;
flat in vec3 flat_color;
out vec4 source;
"""

# Distance from the ball's centre in radii, and p = 1 - q.
DISTANCE = """
    float down = size.y - gl_FragCoord.y;
    float right = (gl_FragCoord.x - place.x) * ball.x - place.y;
    float up = (place.z - down) * ball.x + place.w;
    float p = max(1.0 - (right * right + up * up), 0.0);
    float weight = footprint(p);
"""

# Pass 1, refcloud.lighting.sunward: the light that was read back, scattered on.
SCATTER = {
    "split": "return exp(-(1.0 - forward) * depth) * share_of(forward * depth);",
    "man2003": "return min(kappa * min(depth, limit), share_of(depth));",
}
SUNWARD = """
uniform float light, forward, kappa, limit;
float scatter(float depth) {
    SCATTER
}
void main() {
    DISTANCE
    float alpha = opacity(weight, ball.z, haze.a);
    source = vec4(vec3(GLOW * light), alpha);
}
"""

SHARED = """
uniform int suns;
uniform mat3 frame;  // the camera's right, up and back, as columns
"""

NOISE = """
uniform sampler2D detail;
uniform ivec3 detail_count;
uniform vec3 toward[MOST_SUNS];  // steps toward the suns, in cells
float noise_at(vec3 way, vec4 cell, vec3 part, vec3 ahead) {
    vec3 at = part + way * cell.w + ahead;
    return trilinear(detail, cell.xyz, at, detail_count, 1, 0).r;
}
"""

LIGHT_FIELD = """
uniform sampler2D field;
uniform ivec3 field_count;
"""

FLAT = """
void main() {
    DISTANCE
    float alpha = opacity(weight, ball.z, haze.a);
    source = vec4(flat_color * alpha, alpha);
}
"""

EYEWARD = """
void main() {
    DISTANCE
    // The place in the world that this pixel shows, from the centre, in radii R.
    vec3 way = frame * vec3(right, up, FRONT * sqrt(p));
    DETAIL_STEPS
    if (weight <= 0.0) { source = vec4(0.0); return; }
    vec3 color = LIGHT(suns);
    for (int s = 0; s < suns; s++) color += LIGHT(s) * SHARE(s);
    float alpha = opacity(weight, ball.z, haze.a);
    source = vec4((color * ball.w + haze.rgb) * alpha, alpha);
}
"""

DETAIL_STEPS = f"""
    vec4 cell = cell_of(balls, first + {DETAIL});  // of the centre; R in cells
    vec3 part = cell_of(balls, first + {DETAIL_PART}).xyz;
    float noise = weight > 0.0 ? noise_at(way, cell, part, vec3(0.0)) : 0.0;
    float low = erosion * (1.0 - noise);
    weight = max(weight - low, 0.0) * {1.0 + SOFT} / ({1.0 + SOFT} - low);
"""
OWN_LIGHT = f"cell_of(balls, first + {FIXED} + (s)).rgb"
FIELD_LIGHT = f"""
vec3 field_light(vec3 way, int s) {{
    vec4 cell = cell_of(balls, first + {FIELD});
    vec3 part = cell_of(balls, first + {FIELD_PART}).xyz;
    vec3 at = part + way * cell.w;
    vec4 sums = trilinear(field, cell.xyz, at, field_count, suns + 1, s);
    return (sums.rgb + {OWN} * {OWN_LIGHT}) / (sums.a + {OWN});
}}
"""


def sunward_source(look: Look, kernel: Kernel) -> str:
    """Write the fragment shader of pass 1.

    Parameters
    ----------
    look, kernel
        The rules.

    Returns
    -------
    GLSL.
    """
    # The paper's blend scales what the axis scatters on; Beer's law asks each pixel.
    linear = look.transmittance == "linear"
    glow = "weight * haze.r" if linear else "scatter(weight * ball.z)"
    text = SUNWARD.replace("SCATTER", SCATTER[look.scattering]).replace("GLOW", glow)
    return (
        HEAD
        + footprint_source(kernel, look.footprint, look.transmittance)
        + text.replace("DISTANCE", DISTANCE)
    )


def eyeward_source(
    look: Look, kernel: Kernel, *, detail: bool, field: bool, suns: int
) -> str:
    """Write the fragment shader of pass 2.

    Parameters
    ----------
    look, kernel
        The rules.
    detail, field
        Whether noise erodes footprints; whether light is a field.
    suns
        How many.

    Returns
    -------
    GLSL.
    """
    footprints = footprint_source(kernel, look.footprint, look.transmittance)
    if not detail and not field:
        return HEAD + footprints + FLAT.replace("DISTANCE", DISTANCE)
    relief = detail and look.relief > 0.0
    ahead = "noise_at(way, cell, part, toward[s])"
    shared = f"(1.0 - 0.5 * relief * (1.0 + {ahead} - noise))"
    macros = {
        "FRONT": f"{FRONT}",
        "MOST_SUNS": f"{max(suns, 1)}",
        "LIGHT(s)": "field_light(way, s)" if field else OWN_LIGHT,
        "SHARE(s)": shared if relief else "1.0",
    }
    text = HEAD + SHARED
    text += "".join(f"#define {name} {value}\n" for name, value in macros.items())
    text += FETCH + footprints + TRILINEAR
    if detail:
        text += "uniform float erosion;\nuniform float relief;\n" + NOISE
    if field:
        text += LIGHT_FIELD + FIELD_LIGHT
    return text + EYEWARD.replace("DISTANCE", DISTANCE).replace(
        "DETAIL_STEPS", DETAIL_STEPS if detail else ""
    )
