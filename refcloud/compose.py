"""Drawing clouds, one over the other, before a background."""

from __future__ import annotations

import dataclasses
import importlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from refcloud.camera import AnyCamera, Camera, axes, project
from refcloud.checking import complaint
from refcloud.conventions import Array, Backend, Observer, Skipped
from refcloud.extremes import refuse_bright
from refcloud.image import Picture
from refcloud.lighting import (
    Haze,
    LitMetaballs,
    Look,
    eyeward,
    lit_by_solution,
    solved_light,
    sunward,
)
from refcloud.lighting.hidden import touches
from refcloud.lighting.solved import Lights
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.raster.meeting import (
    Reached,
    most_together,
    reached_by_discs,
    together,
)
from refcloud.raster.tile_lists import Discs
from refcloud.sky import Sky, clear_sky
from refcloud.transport import ScatteredLight
from refcloud.transport.plans import GradeName, Plan
from refcloud.transport.scattering import report_of

# Share of the tolerance that pass 1 gets; pass 2 has more to save, and gets what pass 1
# does not use: where balls take turns that is all. Light that a named plan solves is
# off by its precision alone.
LIGHT, KNOWN_LIGHT = 0.25, 1.0 / 16.0
FAR = 1e6  # widths of a cloud: from there all of it is seen along one direction
WHITE = "displayed white"  # the unit of errors of a picture


def passes_of(
    backend: Backend,
) -> tuple[Callable[..., Any], Callable[..., Any], tuple[str, ...]]:
    """Give the two passes of a backend, and what the picture is to say about it.

    Raises
    ------
    ValueError
        There is no moderngl or no OpenGL.
    """
    if backend == "numpy":
        return sunward, eyeward, ()
    # By name, since nothing in refcloud depends on the optional room.
    gl = importlib.import_module("refcloud.gl")
    return gl.sunward, gl.eyeward, (f"backend: OpenGL, {gl.renderer()}, float32",)


@dataclass(frozen=True)
class Layer:
    """One cloud of a composed picture: its balls and what they are made of.

    Where the balls' light is known already, `lit` brings it, and pass 1 is left out.
    With scattering "multiple" their light is solved (`solved_light`, by `plan` if one
    is named), or it was solved before.
    """

    balls: Metaballs
    medium: Medium
    look: Look
    haze: Haze | None = None
    lit: LitMetaballs | None = None
    scattering: Literal["single", "multiple"] | Lights = "single"
    plan: Plan | GradeName | None = None


def draw_layers(
    layers: Sequence[Layer],
    camera: AnyCamera,
    suns: tuple[Sun, ...],
    background: Any,
    *,
    tolerance: float = 0.0,
    seed: int = 0,
    observe: Observer | None = None,
    backend: Backend = "numpy",
    kept: dict[Any, Any] | None = None,
) -> Picture:
    """Draw clouds one over the other, the farthest first; each is lit by itself.

    Parameters
    ----------
    layers
        The clouds, farthest first; they cast no shadows on each other.
    camera
        The eye.
    suns
        The lights.
    background
        As `render`.
    tolerance
        Largest error of a channel; the layers that meet in a pixel share it.
    seed, observe, backend
        As `render`.
    kept
        Each layer's light by its number: what an earlier call put there is taken again
        where it still holds, the rest is put there.

    Returns
    -------
    The picture.
    """
    light_pass, eye_pass, notes = passes_of(backend)
    seconds: dict[str, float] = {}
    clock = Clock(seconds)
    behind = painted(background, camera, suns)
    clock.stop("sky")
    reached = [reached_by(layer.balls, camera) for layer in layers]
    sets = together(reached) if layers else np.zeros((0, 0), bool)
    known = all(one.plan is not None for one in layers)
    of_light = KNOWN_LIGHT if known else LIGHT
    skipped: list[list[Skipped]] = []
    solved: list[ScatteredLight] = []
    rgba = np.zeros((camera.height, camera.width, 4))
    if behind is not None:
        rgba[..., :3], rgba[..., 3] = behind, 1.0
    kept = {} if kept is None else kept
    for number, layer in enumerate(layers):
        share = tolerance / most_together(sets)
        lit, left = layer.lit, (1.0 - of_light) * share
        if not touches(layer.balls, camera):
            skipped.append(_unseen(layer, suns))
            continue
        if layer.scattering != "single":
            lit, lights = solved_layer(layer, suns, camera, of_light * share, observe)
            solved += lights
        if lit is None:
            lit = light_pass(
                layer.balls,
                suns,
                medium=layer.medium,
                look=layer.look,
                tolerance=of_light * share,
                earlier=kept.get(number),
                observe=observe,
            )
            kept.setdefault(number, lit)
        if backend == "numpy" and layer.scattering == "single" and len(layers) == 1:
            # Every error is told, whether light was carried here or brought.
            used = sum(r.bound for r in lit.skipped if r.unit == WHITE)
            left = max(left, share - used)
        clock.stop("light")
        drawn, rows = eye_pass(
            lit,
            camera,
            background=None if behind is None else rgba[..., :3],
            haze=layer.haze,
            tolerance=left,
            seed=seed,
            observe=observe,
        )
        # Before nothing, this layer covers the ones behind it (eq 28).
        rgba = drawn if behind is not None else drawn + (1.0 - drawn[..., 3:]) * rgba
        skipped.append([*lit.skipped, *rows])
        clock.stop("eye")
    alpha = None if behind is not None else np.clip(rgba[..., 3], 0.0, 1.0)
    reused = sum(layer.lit is not None for layer in layers)
    if layers and not any(layer.look.erosion for layer in layers):
        notes = (*notes, *idle_seed(seed))
    if reused:
        notes = (*notes, f"light: reused for {reused} of {len(layers)} clouds")
    if solved:
        notes = (*notes, f"scattered light: {report_of(solved)}")
    return Picture(rgba[..., :3], alpha, merged(skipped, sets), seconds, notes)


def idle_seed(seed: int) -> tuple[str, ...]:
    """Say that a seed changes nothing, since no noise erodes a footprint."""
    return (f"seed {seed}: nothing here depends on it",) if seed else ()


def _unseen(layer: Layer, suns: tuple[Sun, ...]) -> list[Skipped]:
    """Report a cloud of which no ball touches the picture: neither pass is run."""
    if not len(layer.balls):
        return []
    count, rows = len(layer.balls), []
    if layer.lit is None:
        lights = len(suns) + 2  # sky and ground
        what = "lights of clouds off the picture"
        rows.append(Skipped("light", what, lights, lights))
    return [*rows, Skipped("eye", "balls off the picture", count, count)]


def solved_layer(
    layer: Layer,
    suns: tuple[Sun, ...],
    camera: AnyCamera,
    tolerance: float,
    observe: Observer | None,
) -> tuple[LitMetaballs, tuple[ScatteredLight, ...]]:
    """Solve a layer's light, or take what was solved, and light the balls by it."""
    lights = layer.scattering
    if isinstance(lights, str):
        how = {"plan": layer.plan, "tolerance": tolerance}
        lights = solved_light(
            layer.balls, suns, medium=layer.medium, look=layer.look, **how
        )
    if observe is not None:
        observe("scattered light", lights)
    eye = camera.eye
    if not isinstance(camera, Camera):
        around = np.concatenate([layer.balls.centers, camera.target[None]])
        width = max(float(np.ptp(around, axis=0).max()), 1.0)
        eye = camera.target + FAR * width * axes(camera)[2]
    lit = lit_by_solution(layer.balls, lights, eye=eye, look=layer.look)
    return lit, lights if isinstance(lights, tuple) else (lights,)


def reached_by(balls: Metaballs, camera: AnyCamera) -> Reached:
    """Tell which tiles of a picture balls may show in."""
    x, y, _, scale = project(camera, balls.centers)
    radius = balls.radii * scale
    some = radius > 0.0
    discs = Discs(x[some], y[some], radius[some])
    return reached_by_discs(discs, camera.width, camera.height)


def merged(layers: Sequence[Sequence[Skipped]], sets: Reached) -> tuple[Skipped, ...]:
    """Join the rows of several layers that say the same.

    Errors of the picture add up over the layers that meet in a pixel, at most; those
    of a stage's own result stay with it.

    Parameters
    ----------
    layers
        The rows of each.
    sets
        Which layers meet, of `together`.
    """
    found: dict[tuple[str, str], Skipped] = {}
    bounds: dict[tuple[str, str], Array] = {}
    for number, rows in enumerate(layers):
        for row in rows:
            key = row.stage, row.what
            old = found.get(key)
            theirs = bounds.setdefault(key, np.zeros(len(layers)))
            theirs[number] += row.bound
            if old is not None:
                skipped, of = old.skipped + row.skipped, old.of + row.of
                most = max(old.bound, row.bound)
                row = dataclasses.replace(row, skipped=skipped, of=of, bound=most)
            found[key] = row
    for key, row in found.items():
        if row.unit == WHITE:
            bound = float((sets @ bounds[key]).max(initial=0.0))
            found[key] = dataclasses.replace(row, bound=bound)
    return tuple(found.values())


class Clock:
    """Adds the time since the last stop to a stage."""

    def __init__(self, seconds: dict[str, float]) -> None:
        self.seconds = seconds
        self.since = time.perf_counter()

    def stop(self, stage: str) -> None:
        """Add the time since the last stop."""
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self.since
        self.since = now


def painted(background: Any, camera: AnyCamera, suns: tuple[Sun, ...]) -> Array | None:
    """Give what stands behind the clouds, (H, W, 3), or None for nothing."""
    if isinstance(background, str):
        return None
    if isinstance(background, Sky):
        return clear_sky(camera, background, suns=suns)
    shape = (camera.height, camera.width, 3)
    background = np.asarray(background)
    if background.shape not in (shape, (3,)):
        expected = f"shape {shape}, that of the picture"
        raise ValueError(complaint("background", expected, f"shape {background.shape}"))
    refuse_bright("background", background)
    return np.broadcast_to(background, shape)
