"""Intermediate views: what stands between noise and picture, made visible (T02)."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.camera import project
from refcloud.cloudmap import cell_size
from refcloud.image import Picture, difference_picture, largest_difference
from refcloud.lighting.lightview import LightView, light_view
from refcloud.lighting.order import depth_order
from refcloud.studio.box import step_of
from refcloud.studio.colours import SIDE, enlarged, greys, heat, ranked
from refcloud.studio.counts import balls_per_pixel, discs, steps_per_pixel
from refcloud.studio.recipe import Call, Kept, Recipe, cooked, evaluated
from refcloud.studio.setups import Frame, Setup, Values

RINGS = 40  # areas that are shown; all of them would cover each other
MOST_WIDE = 320  # of pictures that are counted or compared sample by sample
GAIN = 10.0  # of the picture of the error
FRONT_SHARE = 0.9  # of the tolerance that rays behind opaque fronts get


@dataclass(frozen=True, eq=False)
class Shown:
    """A view: codes of shape (H, W, 3), and a sentence that says what it shows."""

    codes: Any
    caption: str
    picture: Picture | None = None


@dataclass(frozen=True, eq=False)
class Request:
    """What is asked for: a choice, its values, a size, and where a slice lies."""

    setup: Setup
    values: Values
    frame: Frame
    view: str
    slice: float = 0.5

    def recipe(self) -> Recipe:
        """Write the recipe."""
        return self.setup.recipe(self.values, self.frame)


def shown(request: Request, kept: Kept) -> Shown:
    """Make what a request asks for.

    Parameters
    ----------
    request
        A picture, or one of the choice's views.
    kept
        Results of earlier stages.

    Returns
    -------
    The codes and a caption.
    """
    if request.view != "picture":
        return VIEWS[request.view](request, kept)
    recipe = request.recipe()
    results = cooked(recipe, kept, coarse=request.frame.coarse)
    picture = results[recipe.stages[-1].name]
    return Shown(_rgb(picture.codes(**recipe.saving)), "", picture)


def _rgb(codes: Any) -> Any:
    """Lay what lets something through over a grey, as pages show it."""
    if codes.shape[2] == 3:
        return codes
    cover = codes[..., 3:] / 255.0
    return (codes[..., :3] * cover + 128.0 * (1.0 - cover)).astype(np.uint8)


def _watched(request: Request, kept: Kept, until: str, end: str) -> tuple[Any, dict]:
    """Run the stages up to one, and catch the first intermediate named so."""
    seen: dict[str, Any] = {}

    def watch(name: str, value: Any) -> None:
        if name.endswith(end):
            seen[name] = value

    recipe = request.recipe()
    results = cooked(
        recipe, kept, coarse=request.frame.coarse, observe=watch, until=until
    )
    return (next(reversed(seen.values())) if seen else None), results


def _slice(request: Request, kept: Kept, name: str) -> Shown:
    """Cut one level of z out of a cloud map's noise or density."""
    caught, results = _watched(request, kept, "cloud", name)
    values = results["cloud"].density if caught is None else caught
    index = round(request.slice * (len(values) - 1))
    level = values[index][::-1]  # y points up
    low = -1.0 if name == "noise" else 0.0
    high = 1.0 if name == "noise" else float(values.max(initial=0.0)) or 1.0
    grey = np.clip((level - low) / (high - low), 0.0, 1.0)
    text = f"{name}, slice {index + 1} of {len(values)} along z;"
    text += f" black is {low:g}, white is {high:.3g}"
    return Shown(enlarged(np.repeat(greys(grey)[..., None], 3, axis=2)), text)


def _light_buffer(request: Request, kept: Kept) -> Shown:
    """Show what is left of the first light behind all balls."""
    buffer, _ = _watched(request, kept, "lit", "sun 0 buffer")
    if buffer is None:
        return _nothing("no light is carried through balls here")
    codes = greys(np.clip(buffer.pixels[..., :3], 0.0, 1.0))
    text = "the light's own view, pass 1: white is light that passed all balls"
    return Shown(enlarged(codes), f"{text}; {codes.shape[0]} pixels wide")


def _readback(request: Request, kept: Kept) -> Shown:
    """Draw the areas over which the framebuffer is read back, over that buffer."""
    buffer, results = _watched(request, kept, "lit", "sun 0 buffer")
    view = _view_of_light(results["lit"], SIDE)
    if buffer is None or view is None:
        return _nothing("no light is carried through balls here")
    codes = enlarged(greys(np.clip(buffer.pixels[..., :3], 0.0, 1.0)), SIDE)
    codes = (codes * 0.6).astype(np.uint8)
    chosen = view.order[:: max(len(view.order) // RINGS, 1)]
    outer = discs(view.x[chosen], view.y[chosen], view.radius[chosen], SIDE, SIDE)
    colours = heat(np.linspace(0.4, 1.0, max(len(chosen), 1)))
    for k, (window, inside) in enumerate(outer):
        core = inside.copy()
        core[1:-1, 1:-1] &= inside[:-2, 1:-1] & inside[2:, 1:-1]
        core[1:-1, 1:-1] &= inside[1:-1, :-2] & inside[1:-1, 2:]
        core[[0, -1]], core[:, [0, -1]] = False, False
        codes[window][inside & ~core] = colours[min(k, len(colours) - 1)]
    text = f"areas that are read back for {len(chosen)} of {len(view.order)} balls,"
    return Shown(codes, f"{text} dark: near the light, bright: far from it")


def _order_of_light(request: Request, kept: Kept) -> Shown:
    """Colour balls by their turn in pass 1, as the light sees them."""
    results = cooked(request.recipe(), kept, coarse=request.frame.coarse, until="lit")
    view = _view_of_light(results["lit"], SIDE)
    if view is None:
        return _nothing("there is no light or no ball")
    codes = ranked(view.x, view.y, view.radius, view.order, SIDE, SIDE)
    text = "balls in the order of pass 1, seen from the light: dark first, bright last"
    return Shown(codes, text)


def _order_of_eye(request: Request, kept: Kept) -> Shown:
    """Colour balls by their turn in pass 2, as the eye sees them."""
    camera, results = _camera_and(request, kept, "balls")
    balls = results["balls"]
    x, y, depth, scale = project(camera, balls.centers)
    order = depth_order(balls, depth)
    size = camera.width, camera.height
    codes = ranked(x, y, balls.radii * scale, order, *size)
    return Shown(codes, "balls in the order of pass 2: bright far, first; dark near")


def _balls_per_pixel(request: Request, kept: Kept) -> Shown:
    camera, results = _camera_and(request, kept, "balls")
    counts = balls_per_pixel(results["balls"], camera)
    return _counted(counts, "balls that cover a pixel")


def _steps(request: Request, kept: Kept, skipped: bool) -> Shown:
    """Count samples along every pixel's ray."""
    request = _small(request)
    camera, results = _camera_and(request, kept, "cloud")
    cloud, quality = results["cloud"], request.values["quality"] or {}
    sigma_t = float(np.mean((request.values["medium"] or {})["sigma_t"]))
    step = 0.5 * float(cell_size(cloud).min())
    if "samples" in quality:
        step = step_of(cloud, quality["samples"])
    counts = steps_per_pixel(
        cloud,
        camera,
        sigma_t=sigma_t,
        step=step,
        least=FRONT_SHARE * quality["tolerance"],
    )
    what = "samples left out (empty, or behind an opaque front)" if skipped else ""
    return _counted(
        counts[skipped], what or f"samples that meet cloud, {step:.3g} apart"
    )


def _error(request: Request, kept: Kept) -> Shown:
    """Draw with the tolerance and exactly, and show ten times the difference."""
    request = _small(request)
    recipe = request.recipe()
    last = recipe.stages[-1].name
    begin = time.perf_counter()
    picture = cooked(recipe, kept)[last]
    middle = time.perf_counter()
    quality = {**(request.values["quality"] or {}), "tolerance": 0.0}
    values: Mapping[str, Any] = {**request.values, "quality": quality}
    exact = cooked(request.setup.recipe(values, request.frame), kept)[last]
    end = time.perf_counter()
    worst = largest_difference(picture.linear, exact.linear)
    codes = difference_picture(picture, exact, gain=GAIN).codes(
        tone="none", dither=False
    )
    tolerance = (request.values["quality"] or {})["tolerance"]
    text = f"{GAIN:g} times the difference from the exact picture; largest {worst:.2g},"
    text += f" tolerance {tolerance:.2g} of displayed white;"
    text += f" {middle - begin:.2f} s against {end - middle:.2f} s"
    return Shown(_rgb(codes), text, picture)


VIEWS: dict[str, Callable[[Request, Kept], Shown]] = {
    "noise slice": lambda r, k: _slice(r, k, "noise"),
    "density slice": lambda r, k: _slice(r, k, "density"),
    "light's buffer": _light_buffer,
    "readback areas": _readback,
    "order toward the light": _order_of_light,
    "order toward the eye": _order_of_eye,
    "balls per pixel": _balls_per_pixel,
    "steps per pixel": lambda r, k: _steps(r, k, False),
    "steps skipped per pixel": lambda r, k: _steps(r, k, True),
    "error": _error,
}


def _counted(counts: Any, what: str) -> Shown:
    most = int(counts.max(initial=0))
    text = f"{what}: dark none, bright {most}; mean {float(counts.mean()):.1f}"
    return Shown(heat(counts / max(most, 1)), text)


def _view_of_light(lit: Any, side: int) -> LightView | None:
    if not lit.suns or not len(lit.balls):
        return None
    return light_view(lit.balls, lit.suns[0].direction, side)


def _camera_and(request: Request, kept: Kept, until: str) -> tuple[Any, dict]:
    """Give the recipe's camera, and the stages up to one."""
    recipe = request.recipe()
    last = recipe.stages[-1].call
    calls = [*last.keywords.values(), *last.arguments]
    camera = next(c for c in calls if isinstance(c, Call) and c.text == "rc.Camera")
    results = cooked(recipe, kept, coarse=request.frame.coarse, until=until)
    return evaluated(camera, results), results


def _small(request: Request) -> Request:
    """Make a view that counts every sample smaller."""
    frame = request.frame
    share = min(MOST_WIDE / frame.width, MOST_WIDE / frame.height, 1.0)
    size = max(round(frame.width * share), 1), max(round(frame.height * share), 1)
    frame = dataclasses.replace(frame, width=size[0], height=size[1])
    return dataclasses.replace(request, frame=frame)


def _nothing(why: str) -> Shown:
    return Shown(np.full((240, 320, 3), 235, np.uint8), why)
