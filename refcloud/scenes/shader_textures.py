"""Document S's skies from textures, and what draws any cover of clouds on a surface.

The sphere with a texture in space, the sphere with one wrapped around it, the
half-sphere with an animated one, and the picture that never moves.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable

from refcloud.camera import AnyCamera
from refcloud.conventions import Skipped
from refcloud.image import Picture
from refcloud.noise.scattered import Numbers
from refcloud.raster import Texture, sample
from refcloud.scene import Model, View
from refcloud.scenes.shader_eyes import (
    blown,
    in_single,
    kept_places,
    observed,
    outlook,
    painted,
    precision,
    refuse_unused,
    texels,
)
from refcloud.scenes.shader_kinds import DomeSky, SphereSky
from refcloud.sky import (
    Cover,
    Dome,
    Fog,
    Places,
    Sphere,
    cloud_cover,
    fractal_texture,
    fractal_volume,
    looked_up,
    shaded,
)
from refcloud.sky.places import Way
from refcloud.sky.surfaces import Surface

CLOUDS = Cover(0.01, 6.0, 1.05, -1.1, 0.35)
VOLUME = SphereSky(Sphere(radius=1.0), CLOUDS, seed=1, octaves=6, cells=6, size=96)
DOME = DomeSky(
    Dome(radius=10.0, tiles=2.0), CLOUDS, seed=4, octaves=6, cells=6, size=512
)
WRAPPED = SphereSky(Sphere(), CLOUDS, seed=4, octaves=6, cells=6, size=512)


def upward_eye(model: Model, view: View) -> AnyCamera:
    """Look up into a sphere or a half-sphere."""
    return outlook(view, (0.0, 0.75, -1.0), 1.25)


def pole_eye(model: Model, view: View) -> AnyCamera:
    """Look at the pole above."""
    return outlook(view, (0.0, 1.0, -0.55), 1.4)


def volume_sky(
    model: Model, view: View, *, of: SphereSky = VOLUME, way: Way = "rays"
) -> Picture:
    """Draw the sphere with a texture in space, made anew for every time."""
    rows: list[Skipped] = []

    def noise(at: Places) -> Numbers:
        volume, left_out = fractal_volume(
            min(of.size, texels(view, 2 * of.size) // 2),
            cells=of.cells,
            time=view.time,
            seed=of.seed,
            octaves=of.octaves,
            dtype=precision(view),
        )
        rows.extend(left_out)
        observed(view, "volume", volume)
        solid = Texture(volume[..., None], wrap="CLAMP_TO_EDGE")
        # The sphere fills the texture from side to side.
        return sample(solid, 0.5 + 0.5 * at.points)[:, 0]

    eye = upward_eye(model, view)
    picture = evaluated(view, eye, of.surface, noise, of.cover, way)
    return dataclasses.replace(picture, skipped=(*rows, *picture.skipped))


def textured_sky(
    model: Model,
    view: View,
    *,
    of: DomeSky | SphereSky = DOME,
    way: Way = "rays",
) -> Picture:
    """Draw a texture in the plane on the half-sphere, or wrapped around the sphere."""
    eye = upward_eye if isinstance(of, DomeSky) else pole_eye
    rows: list[Skipped] = []

    def noise(at: Places) -> Numbers:
        texture, left_out = fractal_texture(
            texels(view, of.size),
            cells=of.cells,
            time=view.time,
            seed=of.seed,
            octaves=of.octaves,
            dtype=precision(view),
        )
        rows.extend(left_out)
        observed(view, "texture", texture)
        wind = blown(view)[[0, 2]]
        if isinstance(of, DomeSky):
            wind = wind / along(of)
        return looked_up(texture, at.coordinates - wind)

    picture = evaluated(view, eye(model, view), of.surface, noise, of.cover, way)
    return dataclasses.replace(picture, skipped=(*rows, *picture.skipped))


def evaluated(
    view: View,
    camera: AnyCamera,
    surface: Surface,
    noise: Callable[[Places], Numbers],
    cover: Cover,
    way: Way,
    fog: Fog | None = None,
) -> Picture:
    """Draw clouds on a surface before the clear sky: noise of the places it is seen at.

    Parameters
    ----------
    view, camera
        How, and from where.
    surface, way
        What the clouds are drawn on, and how its pixels are found.
    noise
        Gives noise, shape (N,), for the places that N pixels show.
    cover, fog
        How noise becomes cloud, and what is before it.

    Returns
    -------
    The picture.
    """
    refuse_unused(view)
    start = time.perf_counter()
    found = kept_places(view, camera, surface, way)
    behind = painted(camera, view)
    light = shaded(behind, found, lambda at: cloud_cover(noise(at), cover), fog=fog)
    seconds = {"sky": time.perf_counter() - start}
    rows = (*found.skipped, *in_single(view, cover, len(found.distance)))
    return Picture(light, None, rows, seconds)


def along(of: DomeSky) -> float:
    """Give the length along a half-sphere after which its texture repeats."""
    return math.pi * of.surface.radius / of.surface.tiles


def background(model: Model, view: View, *, of: DomeSky = DOME) -> Picture:
    """Give the picture of one moment, whatever the time: what most games show."""
    moment = dataclasses.replace(view, time=0.0, offset=None)
    name = "background", view.width, view.height
    stored = None if view.kept is None else view.kept.get(name)
    if stored is None or view.camera is not None:
        stored = textured_sky(model, moment, of=of)
        if view.kept is not None and view.camera is None:
            view.kept[name] = stored
    note = "background: one picture, shown as it is at every time"
    return dataclasses.replace(stored, notes=(note,))
