"""Document S's skies: cloud textures on a plane, on spheres and on a half-sphere.

``shader-c`` is its appendix C, a plane with simplex noise of two coordinates and time;
``shader-b`` appendix B, a sphere with classic noise of three coordinates and time, its
sums of octaves evaluated where they are seen, as a shader does. ``shader-poles`` is the
sphere with a picture wrapped around it, and shows the pole that made the authors give
it up (F14); ``shader-volume`` the sphere with a texture in space (F15); ``shader-dome``
the half-sphere that they ended with, with an animated texture in the plane (F16).
``shader-cover`` sets opacity and light of one sign beside those of opposite signs
(V06, V07), and ``shader-background`` is the baseline, a picture that never moves (F18).

Every one can be drawn by rays or, with `way`, by triangles. Light and fog of document S
are in `refcloud.scenes.shader_light`, its objects in `refcloud.scenes.shader_objects`.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from functools import partial

from refcloud.camera import AnyCamera
from refcloud.conventions import Skipped
from refcloud.image import Picture
from refcloud.noise import fbm
from refcloud.noise.scattered import Numbers
from refcloud.raster import Texture, sample
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes.demand_plane import pair
from refcloud.scenes.shader_eyes import (
    NEVER,
    blown,
    in_single,
    kept_places,
    no_model,
    observed,
    outlook,
    painted,
    precision,
    refuse_unused,
    texels,
)
from refcloud.sky import (
    SAME_SIGN,
    Cover,
    Dome,
    Fog,
    Places,
    Plane,
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
FIRST_TRY = dataclasses.replace(SAME_SIGN, opacity_slope=6.0, light=0.35)
OVERHEAD = Plane(height=1.0, tile=0.75, reach=40.0)
AROUND, DOME = Sphere(radius=1.0), Dome(radius=10.0, tiles=2.0)
AIR = Fog(0.18, None)  # what is far melts into its sky
FLAT_SEED, SOLID_SEED, TEXTURE_SEED = 3, 1, 4
SOLID_CELLS, SOLID_PERIOD = 3.0, 8  # cells per radius; they repeat after so many
TEXTURE, TEXTURE_CELLS, OCTAVES = 512, 6, 6
VOLUME, VOLUME_CELLS = 96, 6
SOLID_REPEATS = SOLID_PERIOD / SOLID_CELLS
DOME_REPEATS = math.pi * DOME.radius / DOME.tiles  # along the half-sphere


def plane_eye(model: Model, view: View) -> AnyCamera:
    """Look up to the plane, the horizon in the picture."""
    return outlook(view, (0.0, 0.46, -1.0), 1.05)


def upward_eye(model: Model, view: View) -> AnyCamera:
    """Look up into a sphere or a half-sphere."""
    return outlook(view, (0.0, 0.75, -1.0), 1.25)


def pole_eye(model: Model, view: View) -> AnyCamera:
    """Look at the pole above."""
    return outlook(view, (0.0, 1.0, -0.55), 1.4)


def plane_sky(
    model: Model, view: View, *, cover: Cover = CLOUDS, way: Way = "rays"
) -> Picture:
    """Draw the plane: simplex noise of x, z and time, evaluated for every pixel."""

    def noise(at: Places) -> Numbers:
        moved = at.coordinates - blown(view)[[0, 2]] / OVERHEAD.tile
        return fbm(
            moved,
            kind="simplex",
            time=view.time,
            seed=FLAT_SEED,
            octaves=OCTAVES,
            dtype=precision(view),
        )

    return evaluated(view, plane_eye(model, view), OVERHEAD, noise, cover, way, AIR)


def solid_sky(model: Model, view: View, *, way: Way = "rays") -> Picture:
    """Draw the sphere: classic noise of three coordinates and time at every pixel."""

    def noise(at: Places) -> Numbers:
        return fbm(
            SOLID_CELLS * (at.points - blown(view)),
            kind="gradient",
            time=view.time,
            seed=SOLID_SEED,
            octaves=OCTAVES,
            period=SOLID_PERIOD,
            dtype=precision(view),
        )

    return evaluated(view, upward_eye(model, view), AROUND, noise, CLOUDS, way)


def volume_sky(model: Model, view: View, *, way: Way = "rays") -> Picture:
    """Draw the sphere with a texture in space, made anew for every time."""
    rows: list[Skipped] = []

    def noise(at: Places) -> Numbers:
        volume, left_out = fractal_volume(
            min(VOLUME, texels(view, 2 * VOLUME) // 2),
            cells=VOLUME_CELLS,
            time=view.time,
            seed=SOLID_SEED,
            octaves=OCTAVES,
            dtype=precision(view),
        )
        rows.extend(left_out)
        observed(view, "volume", volume)
        solid = Texture(volume[..., None], wrap="CLAMP_TO_EDGE")
        # The sphere fills the texture from side to side.
        return sample(solid, 0.5 + 0.5 * at.points)[:, 0]

    picture = evaluated(view, upward_eye(model, view), AROUND, noise, CLOUDS, way)
    return dataclasses.replace(picture, skipped=(*rows, *picture.skipped))


def textured_sky(
    model: Model, view: View, *, surface: Dome | Sphere = DOME, way: Way = "rays"
) -> Picture:
    """Draw a texture in the plane on the half-sphere, or wrapped around the sphere."""
    eye = upward_eye if isinstance(surface, Dome) else pole_eye
    rows: list[Skipped] = []

    def noise(at: Places) -> Numbers:
        texture, left_out = fractal_texture(
            texels(view, TEXTURE),
            cells=TEXTURE_CELLS,
            time=view.time,
            seed=TEXTURE_SEED,
            octaves=OCTAVES,
            dtype=precision(view),
        )
        rows.extend(left_out)
        observed(view, "texture", texture)
        scroll = blown(view)[[0, 2]] / DOME_REPEATS
        return looked_up(texture, at.coordinates - scroll)

    picture = evaluated(view, eye(model, view), surface, noise, CLOUDS, way)
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


def covers(model: Model, view: View) -> Picture:
    """Draw the plane with slopes of one sign, and with slopes of opposite signs."""
    return pair(
        dataclasses.replace(view, kept=None),
        partial(plane_sky, model, cover=FIRST_TRY),
        partial(plane_sky, model),
    )


def background(model: Model, view: View) -> Picture:
    """Give the picture of one moment, whatever the time: what most games show."""
    moment = dataclasses.replace(view, time=0.0, offset=None)
    name = "background", view.width, view.height
    stored = None if view.kept is None else view.kept.get(name)
    if stored is None or view.camera is not None:
        stored = textured_sky(model, moment)
        if view.kept is not None and view.camera is None:
            view.kept[name] = stored
    note = "background: one picture, shown as it is at every time"
    return dataclasses.replace(stored, notes=(note,))


ONCE = float(TEXTURE_CELLS)
ROLLING = (DOME_REPEATS, math.inf, DOME_REPEATS)
IN_PLACE = "in place"
for name, title, draw, motion in (
    (
        "b",
        "appendix B: a sphere with classic noise in four dimensions",
        solid_sky,
        Motion(
            upward_eye,
            turns=IN_PLACE,
            period=float(SOLID_PERIOD),
            repeats=(SOLID_REPEATS, SOLID_REPEATS, SOLID_REPEATS),
        ),
    ),
    (
        "c",
        "appendix C: a plane with simplex noise in three dimensions",
        plane_sky,
        Motion(plane_eye, turns=IN_PLACE, period=math.inf, repeats=NEVER),
    ),
    (
        "cover",
        "slopes of one sign, and of opposite signs",
        covers,
        Motion(period=math.inf, repeats=NEVER),
    ),
    (
        "dome",
        "a half-sphere with an animated texture",
        textured_sky,
        Motion(upward_eye, turns=IN_PLACE, period=ONCE, repeats=ROLLING),
    ),
    (
        "poles",
        "a sphere with a texture wrapped around it, pinched at its pole",
        partial(textured_sky, surface=Sphere()),
        Motion(pole_eye, turns=IN_PLACE, period=ONCE),
    ),
    (
        "volume",
        "a sphere with a texture in space",
        volume_sky,
        Motion(upward_eye, turns=IN_PLACE, period=math.inf),
    ),
    (
        "background",
        "the baseline, a picture that never moves",
        background,
        Motion(period=1.0),
    ),
):
    enter(Scene(f"shader-{name}", f"document S: {title}", no_model, draw, motion))
