"""Savings of the two passes: balls, tiles, sweeps, buffers and lights."""

from __future__ import annotations

import contextlib
import dataclasses

import numpy as np
from small_scenes import BACKDROP, BALLS, DARK, EXTENDED, EYE, LOOKS, MEDIUM, SUNS
from twins.lighting import scattered_balls

from refcloud.camera import Camera
from refcloud.compose import Layer, draw_layers
from refcloud.lighting import LitMetaballs, ball_colours, eyeward, sunward
from refcloud.lighting.exact_places import ExactPlaces
from refcloud.lighting.seen import shading_of
from refcloud.metaballs import Metaballs
from refcloud.optics import Sun
from skipping import Found, proof, replaced

HOW = {"medium": MEDIUM, "look": EXTENDED}
EYEWARD = "refcloud.lighting.eyeward"
# Balls of one colour each: float32 and nodes serve them alone.
SMOOTH = dataclasses.replace(
    LOOKS["man"], transmittance="beer", scattering="split", tau=None
)
WIDE = Camera(EYE.eye, EYE.target, width=240, height=180)


def seen(lit: LitMetaballs, camera: Camera = EYE, tolerance: float = 0.0):
    back = np.full((camera.height, camera.width, 3), 0.4)
    return eyeward(lit, camera, background=back, tolerance=tolerance)


@proof("light", "suns without light")
def suns_without_light() -> Found:
    """A light of 1e-300 is carried, and changes no bit of a picture."""
    found = []
    for strength in (0.0, 1e-300):
        first = dataclasses.replace(SUNS[0], irradiance=np.full(3, strength))
        found.append(seen(sunward(BALLS, (first, SUNS[1]), **HOW)))
    return Found(found[0][0], found[1][0], found[0][1])


@proof("light", "lights of clouds off the picture")
def lights_of_clouds_off_the_picture() -> Found:
    away = dataclasses.replace(BALLS, centers=BALLS.centers + np.array([0, 0, 99.0]))
    layers = [Layer(cloud, MEDIUM, EXTENDED) for cloud in (away, BALLS)]
    how = EYE, SUNS, BACKDROP
    found = draw_layers(layers, *how)
    with replaced("refcloud.compose", touches=lambda balls, camera: True):
        whole = draw_layers(layers, *how)
    return Found(found.linear, whole.linear, found.skipped)


@proof("light", "lights that were carried before")
def lights_carried_before() -> Found:
    earlier = sunward(BALLS, SUNS, **HOW)
    suns = (SUNS[1], Sun([0, 1, 5]))
    again = sunward(BALLS, suns, earlier=earlier, **HOW)
    fresh = sunward(BALLS, suns, **HOW)
    return Found(again.light, fresh.light, again.skipped)


@proof("light", "sweeps over all balls")
def sweeps() -> Found:
    balls = scattered_balls(8, 60)
    exact, found = (sunward(balls, SUNS, tolerance=t, **HOW) for t in (0.0, 0.01))
    return Found(*(ball_colours(lit, EYE) for lit in (found, exact)), found.skipped)


@proof("light", "pixels of the lights' buffers", together=True)
def pixels_of_buffers() -> Found:
    balls = dataclasses.replace(scattered_balls(4, 12), radii=np.full(12, 1.5))
    how = {"medium": MEDIUM, "look": dataclasses.replace(EXTENDED, buffer=256, **DARK)}
    exact, found = (sunward(balls, SUNS, tolerance=t, **how) for t in (0.0, 0.5))
    return Found(*(ball_colours(lit, EYE) for lit in (found, exact)), found.skipped)


@proof("eye", "balls off the picture")
def balls_off_the_picture() -> Found:
    """Drawn all the same, those before the eye touch no pixel."""
    aside = np.array([[30.0, 0, 0], [0, 9.0, 2.0], [0, 0, 50.0]])
    balls = dataclasses.replace(
        BALLS,
        centers=np.vstack([BALLS.centers, aside]),
        radii=np.append(BALLS.radii, np.ones(3)),
        densities=np.append(BALLS.densities, np.ones(3)),
    )
    lit = sunward(balls, SUNS, **HOW)
    found, rows = seen(lit)

    def every(order, visible, tau, brightest, tolerance):
        return np.ones(len(order), bool), []

    with replaced(EYEWARD, without_faint=every):
        whole, _ = seen(lit)
    return Found(found, whole, rows)


@proof("eye", "balls too faint to show", rounding=1e-12)  # nearer ones end a sum sooner
def balls_too_faint() -> Found:
    densities = np.where(np.arange(8) < 5, 1e-4, 1.0)
    balls = dataclasses.replace(scattered_balls(3, 8), densities=densities)
    lit = sunward(balls, SUNS, **HOW)
    found, rows = seen(lit, tolerance=0.05)
    with replaced(EYEWARD, FAINT=0.0):
        whole, _ = seen(lit, tolerance=0.05)
    return Found(found, whole, rows)


def wide_smooth_balls() -> LitMetaballs:
    balls = scattered_balls(2, 60)
    wide = dataclasses.replace(balls, radii=3.0 * balls.radii)
    return sunward(wide, SUNS, medium=MEDIUM, look=SMOOTH)


TILES = "refcloud.lighting.certified_tiles"
SPARSE = "refcloud.lighting.sparse_tiles"


def off(*names: str) -> contextlib.ExitStack:
    """Switch ways to draw tiles off, by their least numbers."""
    places = {"LEAST_RISE": "refcloud.raster.between", "LEAST_NODES": SPARSE}
    stack = contextlib.ExitStack()
    for name in names:
        stack.enter_context(replaced(places.get(name, TILES), **{name: np.inf}))
    return stack


def with_and_without(name: str, *others: str) -> Found:
    """Draw tiles of wide balls with one way on, and with it off; others are off."""
    with off(*others):
        found, rows = seen(wide_smooth_balls(), WIDE, 0.02)
        with off(name):
            whole, _ = seen(wide_smooth_balls(), WIDE, 0.02)
    return Found(found, whole, rows)


@proof("eye", "tiles in double precision")
def tiles_in_double_precision() -> Found:
    return with_and_without("LEAST_FLOAT32", "LEAST_NODES", "LEAST_RISE")


@proof("eye", "pixels between nodes of smooth tiles")
def pixels_between_nodes() -> Found:
    return with_and_without("LEAST_NODES", "LEAST_RISE")


@proof("eye", "pixels between samples of smooth tiles")
def pixels_between_samples() -> Found:
    return with_and_without("LEAST_RISE", "LEAST_NODES")


@proof("eye", "tiles of shaded balls in double precision")
def shaded_tiles_in_double_precision() -> Found:
    lit = sunward(scattered_balls(2, 60), SUNS, **HOW)
    found, rows = seen(lit, WIDE, 0.01)

    def exact(one, shading):  # the table of exact places is another one
        return ExactPlaces(one, shading_of(one, 0, None)[0])

    with replaced("refcloud.lighting.proved_tiles", SinglePlaces=exact):
        whole, _ = seen(lit, WIDE, 0.01)
    return Found(found, whole, rows)


# Tiles draw in another order.
@proof("eye", "pixels of balls' tiles behind opaque ones", rounding=1e-12)
def balls_behind_opaque_ones() -> Found:
    small = scattered_balls(3, 40)
    balls = Metaballs(
        np.vstack([[0, 0, 2], small.centers * 0.2 - [0.0, 0.0, 3.0]]),
        np.append(2.0, np.full(40, 0.3)),
        np.append(2.5, np.ones(40)),  # lets 5e-4 through on its axis
    )
    look = dataclasses.replace(EXTENDED, tau=None, transmittance="beer")
    lit = sunward(balls, SUNS, medium=MEDIUM, look=look)
    camera = Camera(EYE.eye, EYE.target, width=96, height=72)
    found, rows = seen(lit, camera, 0.01)
    whole, _ = seen(lit, camera)
    return Found(found, whole, rows)
