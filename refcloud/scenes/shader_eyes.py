"""What the scenes of document S share: eyes, the clear sky, places that are kept."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from refcloud.camera import AnyCamera, Camera
from refcloud.conventions import Array, Skipped
from refcloud.image import Picture
from refcloud.noise.scattered import Dtype
from refcloud.optics import Sun
from refcloud.refusal import complaint
from refcloud.scene import Model, Own, View
from refcloud.sky import Cover, Places, Sky, clear_sky, places
from refcloud.sky.places import Way
from refcloud.sky.surfaces import Surface

# Before the eye on the left, beyond the clouds that one looks up to.
SUN = Sun(np.array([-0.62, 0.55, -0.42]))
FRONT = Sun(np.array([-0.62, 0.62, 0.42]))  # for what is seen from outside
DAY = Sky()
FINENESS = 64  # cells along each side of a surface's mesh
# Noise in float32 differs from float64 by this much at the most (tests of the noise
# room: worst seen 1.7e-6), and is worth a tolerance from here on.
SINGLE, WORTH = 5e-6, 1e-3
NEVER = (math.inf, math.inf, math.inf)


def outlook(view: View, target: Sequence[float], fov_y: float) -> AnyCamera:
    """Give the view's own camera, or one that stands at the origin and looks up."""
    if view.camera is not None:
        return view.camera
    return Camera(
        np.zeros(3),
        np.array(target, np.float64),
        fov_y=fov_y,
        width=view.width,
        height=view.height,
    )


def refuse_unused(view: View, *more: str) -> None:
    """Refuse what a sky of textures has no use for."""
    for name in ("medium", "look", *more):
        if getattr(view, name) is not None:
            expected = "none beside a sky of textures"
            raise ValueError(complaint(name, expected, "one"))


def kept_places(
    view: View, camera: AnyCamera, surface: Surface, way: Way = "rays"
) -> Places:
    """Find the places of a surface, or take those of the picture before."""
    name = "places", type(surface).__name__
    earlier = None if view.kept is None else view.kept.get(name)
    found = places(camera, surface, way=way, fineness=FINENESS, earlier=earlier)
    if view.kept is not None:
        view.kept[name] = dataclasses.replace(found, skipped=())
    return found


def texels(view: View, most: int) -> int:
    """Choose the side of a texture: fine enough for the picture, at most so many."""
    return min(most, 1 << max(2 * view.width - 1, 63).bit_length())


def precision(view: View) -> Dtype:
    """Choose how precisely noise is summed."""
    return "float32" if view.tolerance >= WORTH else "float64"


def in_single(view: View, cover: Cover, count: int) -> tuple[Skipped, ...]:
    """Say what float32 noise can change in a picture."""
    if precision(view) == "float64":
        return ()
    brightest = cover.light + max(cover.light_slope, 0.0)
    steepest = cover.opacity_slope * brightest + abs(cover.light_slope)
    what = "values of noise, float32 instead of float64, of their last digits"
    return (Skipped("sky", what, count, count, steepest * SINGLE),)


def blown(view: View) -> Array:
    """Give how far the wind has carried things, shape (3,)."""
    return np.zeros(3) if view.offset is None else np.asarray(view.offset)


def painted(camera: AnyCamera, view: View) -> Array:
    """Paint the clear sky behind everything, with the suns that are given."""
    return clear_sky(camera, DAY, suns=() if view.suns is None else view.suns)


def sunless(camera: AnyCamera) -> Array:
    """Paint the clear sky of scenes whose sun, their own or given, lights alone."""
    return clear_sky(camera, DAY)


def glow_alone(of: object, model: Model | None, view: View) -> Own:
    """Take suns, which shine in the sky; it has none of its own."""
    return Own(())


def timed(
    draw: Callable[[], tuple[Array, Sequence[Skipped], Sequence[str]]],
) -> Picture:
    """Make a picture of light, what was skipped and notes, and time it as "sky"."""
    start = time.perf_counter()
    light, skipped, notes = draw()
    seconds = {"sky": time.perf_counter() - start}
    return Picture(light, None, tuple(skipped), seconds, tuple(notes))


def observed(view: View, name: str, value: object) -> None:
    """Hand an intermediate to whoever looks on."""
    if view.observe is not None:
        view.observe(name, value)


def no_model() -> Model:
    """Make nothing before: noise is evaluated where it is seen."""
    return Model({})
