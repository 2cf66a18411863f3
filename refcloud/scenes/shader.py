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
from collections.abc import Callable
from functools import partial

from refcloud.camera import AnyCamera
from refcloud.declared import Kind, enter_kind, told
from refcloud.image import Picture
from refcloud.noise import fbm
from refcloud.noise.scattered import Numbers
from refcloud.scene import Model, Motion, Own, View
from refcloud.scenes.demand_plane import pair
from refcloud.scenes.shader_eyes import (
    NEVER,
    blown,
    glow_alone,
    outlook,
    precision,
)
from refcloud.scenes.shader_kinds import (
    DomeSky,
    PlaneSky,
    SolidSky,
    SphereSky,
    TwoCovers,
)
from refcloud.scenes.shader_textures import (
    CLOUDS,
    DOME,
    VOLUME,
    WRAPPED,
    along,
    background,
    evaluated,
    pole_eye,
    textured_sky,
    upward_eye,
    volume_sky,
)
from refcloud.sky import (
    SAME_SIGN,
    Fog,
    Places,
    Plane,
    Sphere,
)
from refcloud.sky.places import Way

PLANE = PlaneSky(
    surface=Plane(height=1.0, tile=0.75, reach=40.0),
    cover=CLOUDS,
    fog=Fog(0.18, None),  # what is far melts into its sky
    seed=3,
    octaves=6,
)
COVERS = TwoCovers(dataclasses.replace(SAME_SIGN, opacity_slope=6.0, light=0.35), PLANE)
SOLID = SolidSky(Sphere(radius=1.0), CLOUDS, seed=1, octaves=6, cells=3.0, period=8)


def plane_eye(model: Model, view: View) -> AnyCamera:
    """Look up to the plane, the horizon in the picture."""
    return outlook(view, (0.0, 0.46, -1.0), 1.05)


def plane_sky(
    model: Model, view: View, *, of: PlaneSky = PLANE, way: Way = "rays"
) -> Picture:
    """Draw the plane: simplex noise of x, z and time, evaluated for every pixel."""

    def noise(at: Places) -> Numbers:
        moved = at.coordinates - blown(view)[[0, 2]] / of.surface.tile
        return fbm(
            moved,
            kind="simplex",
            time=view.time,
            seed=of.seed,
            octaves=of.octaves,
            dtype=precision(view),
        )

    eye = plane_eye(model, view)
    return evaluated(view, eye, of.surface, noise, of.cover, way, of.fog)


def solid_sky(
    model: Model, view: View, *, of: SolidSky = SOLID, way: Way = "rays"
) -> Picture:
    """Draw the sphere: classic noise of three coordinates and time at every pixel."""

    def noise(at: Places) -> Numbers:
        return fbm(
            of.cells * (at.points - blown(view)),
            kind="gradient",
            time=view.time,
            seed=of.seed,
            octaves=of.octaves,
            period=of.period,
            dtype=precision(view),
        )

    eye = upward_eye(model, view)
    return evaluated(view, eye, of.surface, noise, of.cover, way)


def covers(model: Model, view: View, *, of: TwoCovers = COVERS) -> Picture:
    """Draw the plane with slopes of one sign, and with slopes of opposite signs."""
    return pair(
        dataclasses.replace(view, kept=None),
        partial(plane_sky, model, of=dataclasses.replace(of.sky, cover=of.first)),
        partial(plane_sky, model, of=of.sky),
    )


IN_PLACE = "in place"


def solid_motion(of: SolidSky) -> Motion:
    """Turn the eye in a sphere whose noise repeats."""
    again = of.period / of.cells
    period = float(of.period)
    return Motion(
        upward_eye, turns=IN_PLACE, period=period, repeats=(again, again, again)
    )


def plane_motion(of: PlaneSky) -> Motion:
    """Turn the eye under a plane whose noise never repeats."""
    return Motion(plane_eye, turns=IN_PLACE, period=math.inf, repeats=NEVER)


def eye_and_glow(
    eye: Callable[[Model, View], AnyCamera],
    of: object,
    model: Model | None,
    view: View,
) -> Own:
    """Take suns, as `glow_alone`, and an eye that does not move."""
    return Own((), camera=eye(Model({}), view))


def covers_motion(of: TwoCovers) -> Motion:
    """Blow wind; two pictures have no eye of their own."""
    return Motion(period=math.inf, repeats=NEVER)


def dome_motion(of: DomeSky) -> Motion:
    """Turn the eye under a half-sphere whose texture rolls on."""
    rolling = (along(of), math.inf, along(of))
    period = float(of.cells)
    return Motion(upward_eye, turns=IN_PLACE, period=period, repeats=rolling)


def wrapped_motion(of: SphereSky) -> Motion:
    """Turn the eye that looks at the pole."""
    return Motion(pole_eye, turns=IN_PLACE, period=float(of.cells))


def volume_motion(of: SphereSky) -> Motion:
    """Turn the eye in a sphere whose noise in space never repeats."""
    return Motion(upward_eye, turns=IN_PLACE, period=math.inf)


def still(of: DomeSky) -> Motion:
    """Show the same at every time."""
    return Motion(period=1.0)


for name, title, own, draw, motion in (
    (
        "b",
        "appendix B: a sphere with classic noise in four dimensions",
        SOLID,
        solid_sky,
        solid_motion,
    ),
    (
        "c",
        "appendix C: a plane with simplex noise in three dimensions",
        PLANE,
        plane_sky,
        plane_motion,
    ),
    (
        "cover",
        "section 5.1: slopes of one sign, and of opposite signs",
        COVERS,
        covers,
        covers_motion,
    ),
    (
        "dome",
        "section 5.2: a half-sphere with an animated texture",
        DOME,
        textured_sky,
        dome_motion,
    ),
    (
        "poles",
        "section 5.2: a sphere with a texture around it, pinched at its pole",
        WRAPPED,
        textured_sky,
        wrapped_motion,
    ),
    (
        "volume",
        "section 5.2, of appendix B: a sphere with a texture in space",
        VOLUME,
        volume_sky,
        volume_motion,
    ),
    (
        "background",
        "section 1: the baseline, a picture that never moves",
        DOME,
        background,
        still,
    ),
):
    resting = {"cover": plane_eye, "background": upward_eye}.get(name)
    enter_kind(
        Kind(
            f"shader-{name}",
            f"document S: {title}",
            own,
            partial(told, draw),
            motion,
            brings=partial(eye_and_glow, resting) if resting else glow_alone,
        )
    )
