"""Document S's lit layer of clouds, and its fog on every object.

``shader-lit`` is figure 2 as a picture: fBm is the density of a layer with a flat base,
and the light that leaves the base was marched from there toward the sun (R08). Its
noise is drawn to a texture first and then sampled (R09); `direct` sums the octaves for
every sample instead, the way that the document feared, with the same picture.
``shader-fog`` is one view of a ground, of balls and of a sky, left in fog as printed,
right in fog that grows with distance (E29).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from refcloud.camera import AnyCamera, rays
from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.declared import Kind, enter_kind, sun_alone, told
from refcloud.image import Picture
from refcloud.noise import fbm
from refcloud.optics import Sun
from refcloud.scene import Model, Motion, Own, View
from refcloud.scenes.demand_plane import pair
from refcloud.scenes.shader_eyes import (
    FRONT,
    NEVER,
    SUN,
    blown,
    kept_places,
    observed,
    outlook,
    refuse_unused,
    sunless,
    texels,
    timed,
)
from refcloud.scenes.shader_kinds import LitLayer, TwoFogs
from refcloud.sky import (
    Cover,
    FlatBase,
    Fog,
    Places,
    Plane,
    Sphere,
    base_density,
    cloud_cover,
    fractal_texture,
    light_from_above,
    looked_up,
    places,
    shaded,
)

SKY_LIGHT = np.array([0.20, 0.29, 0.44])
LIT = LitLayer(
    layer=FlatBase(threshold=0.0, slope=2.6, thickness=0.5, sigma_t=9.0, steps=12),
    base=Plane(height=1.0, tile=10.0, reach=40.0),
    seed=7,
    octaves=7,
    cells=16,
    size=1024,
    sun=SUN,
    sky_light=SKY_LIGHT,  # reaches the base from all sides
    fog=Fog(0.18, None),
)

# The fog's scene: a ground below, balls at growing distances, a sky above.
BALLS = tuple(
    Sphere(np.array([x, -0.25, -z]), 0.35)
    for x, z in ((-0.55, 1.9), (0.7, 3.2), (-1.3, 5.0), (1.2, 7.5), (-0.9, 11.0))
)
GREEN, BROWN = np.array([0.13, 0.21, 0.07]), np.array([0.30, 0.22, 0.12])
RED = np.array([0.62, 0.16, 0.08])
GREY = np.array([0.58, 0.70, 0.83])
FOGS = TwoFogs(
    # As printed the density is a length: up to it all drowns, beyond it all is clear.
    printed=Fog(4.0, GREY, "printed"),
    mended=Fog(0.16, GREY),
    ground=Plane(-0.6, 1.0, 60.0),
    sky=Plane(1.2, 0.9, 60.0),
    cover=Cover(0.01, 6.0, 1.05, -1.1, 0.35),
    sun=FRONT,
)


def lit_eye(model: Model, view: View) -> AnyCamera:
    """Look up to the layer, the horizon in the picture."""
    return outlook(view, (0.0, 0.42, -1.0), 1.05)


def lit_layer(
    model: Model, view: View, *, of: LitLayer = LIT, direct: bool = False
) -> Picture:
    """Draw a layer with a flat base, lit through its thickness."""
    refuse_unused(view)
    camera = lit_eye(model, view)
    layer, base = of.layer, of.base
    suns = (of.sun,) if view.suns is None else view.suns

    def draw():
        found = kept_places(view, camera, base)
        pattern, rows = noise_of(view, direct, of)
        moved = found.coordinates * base.tile - blown(view)[[0, 2]]
        risen = base_density(pattern(moved), np.zeros(len(moved)), layer)
        # Only what is cloud is marched.
        cloud = risen > 0.0
        light = np.tile(of.sky_light, (len(moved), 1))
        for sun in suns:
            T = light_from_above(moved[cloud], pattern, layer, sun=sun.direction)
            observed(view, "transmittance", T)
            light[cloud] += T[:, None] * sun.irradiance / WHOLE_SPHERE
        # Along the view, density falls from `risen` to 0 on the way up to the top.
        _, directions = rays(camera)
        rise = directions[found.seen][:, 1]
        depth = layer.sigma_t * layer.thickness * risen**2 / 2.0 / rise
        behind = sunless(camera)
        over = shaded(behind, found, lambda at: (light, -np.expm1(-depth)), fog=of.fog)
        note = f"marched to the sun: {np.count_nonzero(cloud)} pixels"
        return over, (*found.skipped, *rows), (f"{note}, {layer.steps} samples each",)

    return timed(draw)


def noise_of(
    view: View, direct: bool, of: LitLayer = LIT
) -> tuple[Callable[[Array], Any], tuple]:
    """Give noise over the base: a texture of it, or its sums of octaves themselves."""
    how = {"time": view.time, "seed": of.seed, "octaves": of.octaves}
    cells = of.cells / of.base.tile
    if direct:
        return lambda at: fbm(cells * at, period=of.cells, **how), ()
    texture, rows = fractal_texture(texels(view, of.size), cells=of.cells, **how)
    return lambda at: looked_up(texture, at / of.base.tile), rows


def fog_eye(view: View) -> AnyCamera:
    """Look straight ahead."""
    return outlook(view, (0.0, 0.0, -1.0), 0.95)


def fogs_own(of: TwoFogs, model: Model | None, view: View) -> Own:
    """Give the sun, and the eye of both pictures."""
    return Own((of.sun,), camera=fog_eye(view))


def foggy(view: View, fog: Fog, of: TwoFogs = FOGS) -> Picture:
    """Draw ground, balls and sky, each in the same fog."""
    refuse_unused(view)
    camera = fog_eye(view)
    suns = (of.sun,) if view.suns is None else view.suns

    def clouds(at: Places) -> tuple[Array, Array]:
        drifted = at.coordinates - blown(view)[[0, 2]] / of.sky.tile
        noise = fbm(drifted, kind="simplex", time=view.time, seed=3, octaves=5)
        return cloud_cover(noise, of.cover)

    def ground(at: Places) -> tuple[Array, Array]:
        mixed = np.clip(0.5 + 1.5 * fbm(at.coordinates, seed=5, octaves=4), 0.0, 1.0)
        light = lambert(np.array([[0.0, 1.0, 0.0]]), suns)
        return (GREEN + mixed[:, None] * (BROWN - GREEN)) * light, np.ones(len(mixed))

    def ball(at: Places, center: Array) -> tuple[Array, Array]:
        normals = (at.points - center) / BALLS[0].radius
        return RED * lambert(normals, suns), np.ones(len(normals))

    def draw():
        over = shaded(sunless(camera), places(camera, of.sky), clouds, fog=fog)
        over = shaded(over, places(camera, of.ground), ground, fog=fog)
        for sphere in sorted(BALLS, key=lambda b: b.center[2]):  # the farthest first
            found = places(camera, sphere)
            over = shaded(over, found, partial(ball, center=sphere.center), fog=fog)
        return over, (), ()

    return timed(draw)


def lambert(normals: Array, suns: tuple[Sun, ...]) -> Array:
    """Light a matt surface: the suns by the cosine, and the sky by how far it faces up.

    Parameters
    ----------
    normals
        Unit vectors, shape (N, 3).
    suns
        The lights.

    Returns
    -------
    Factor on the surface's colour, RGB, shape (N, 3).
    """
    light = (1.0 + normals[:, 1:2]) * 0.5 * SKY_LIGHT * 2.0
    for sun in suns:
        facing = np.maximum(normals @ sun.direction, 0.0)[:, None]
        light = light + facing * sun.irradiance / WHOLE_SPHERE * 1.2
    return light


def both_fogs(model: Model, view: View, *, of: TwoFogs = FOGS) -> Picture:
    """Draw the fog as printed, and mended."""
    apart = dataclasses.replace(view, kept=None)
    left, right = (partial(foggy, fog=fog, of=of) for fog in (of.printed, of.mended))
    return pair(apart, left, right)


def lit_motion(of: LitLayer) -> Motion:
    """Turn the eye in place; the layer's noise repeats."""
    repeats = (of.base.tile, math.inf, of.base.tile)
    how = {"turns": "in place", "period": float(of.cells), "repeats": repeats}
    return Motion(lit_eye, (of.sun,), **how)


def fog_motion(of: TwoFogs) -> Motion:
    """Move the sun, and the clouds by wind and time."""
    return Motion(suns=(of.sun,), period=math.inf, repeats=NEVER)


for name, title, own, draw, motion, brings in (
    (
        "lit",
        "section 5.1, of appendix B: a layer lit through its thickness",
        LIT,
        lit_layer,
        lit_motion,
        sun_alone,
    ),
    (
        "fog",
        "section 5.1: fog on every object, as printed and mended",
        FOGS,
        both_fogs,
        fog_motion,
        fogs_own,
    ),
):
    title = f"document S: {title}"
    drawn = partial(told, draw)
    enter_kind(Kind(f"shader-{name}", title, own, drawn, motion, brings=brings))
