"""Whole pictures: what a tolerance asks, what comes out, and how long it takes.

Each named scene is drawn exactly and to each tolerance. Timed is the drawing: light,
march and picture, from clouds that are made already (marched scenes make theirs as they
are drawn). The error is the largest of a channel, in displayed white.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

from refcloud.bench.subject import MS, Subject, columns
from refcloud.bench.timing import Contender, Row
from refcloud.bench.tolerance_plot import ASKED, NAME, asked_figure, asked_of
from refcloud.compose import WHITE
from refcloud.conventions import Array, Skipped
from refcloud.image import Picture
from refcloud.scene import SCENES, Model, View

WIDTH, QUICK_WIDTH = 128, 16  # pixels; a quick look's
LARGE = 320  # pixels of width of whole scenes
# One scene of each kind that costs little: splats, a march, a sheet, triangles.
QUICK_SCENES = ("man-10", "demand-lit", "shader-particles", "shader-dome")
# Of light of every order, whose exact picture at 320 pixels takes a minute.
MOST = {"multiple": 80}
SCENE_ASKED = (1e-2, 1.0 / 255.0, 1e-3)
KINDS = ("proved", "certified", "measured")
# What the last drawing of a scene to a tolerance told.
TOLD: dict[tuple[str, float], tuple[Skipped, ...]] = {}


@functools.cache
def model_of(name: str) -> Model:
    """Make a scene's clouds once."""
    return SCENES[name].model()


def drawn(name: str, width: int, tolerance: float) -> Picture:
    """Draw a scene of 4 to 3 from clouds that are made already."""
    width = min(width, MOST.get(name, width))
    view = View(width, max(width * 3 // 4, 1), tolerance=tolerance)
    return SCENES[name].draw(model_of(name), view)


def linear(name: str, width: int, tolerance: float) -> Array:
    """Draw a scene's linear picture, and keep what its report tells of errors."""
    picture = drawn(name, width, tolerance)
    TOLD[name, tolerance] = tuple(r for r in picture.skipped if r.unit == WHITE)
    return picture.linear


def depends(name: str) -> bool:
    """Tell whether a tolerance can change a scene: its small picture tells stages."""
    return bool(drawn(name, QUICK_WIDTH, ASKED[0]).seconds)


def scenes_at(
    width: int, asked: Sequence[float], names: Sequence[str] | None = None
) -> list[Contender]:
    """List scenes at tolerances, each against its exact picture.

    Parameters
    ----------
    width
        Pixels of width.
    asked
        Tolerances.
    names
        Scenes; None for all that a tolerance has to do with.

    Returns
    -------
    The contenders: a task is a scene.
    """
    found = []
    for name in SCENES if names is None else names:
        if names is None and not depends(name):
            continue
        exact = functools.cache(functools.partial(linear, name, width, 0.0))
        ways: dict[str, Callable[[], Any]] = {
            NAME.format(tolerance): functools.partial(linear, name, width, tolerance)
            for tolerance in asked
        }
        ways["refcloud exact"] = functools.partial(linear, name, width, 0.0)
        found += [Contender(name, how, 1, work, exact) for how, work in ways.items()]
    return found


def tolerances(width: int) -> list[Contender]:
    """List every scene at every tolerance; in a quick look's size a few."""
    return scenes_at(width, ASKED, _names(width))


def whole_scenes(width: int) -> list[Contender]:
    """List every scene at three tolerances; in a quick look's size a few."""
    return scenes_at(width, SCENE_ASKED, _names(width))


def _names(width: int) -> Sequence[str] | None:
    return QUICK_SCENES if width == QUICK_WIDTH else None


def asked_and_measured(rows: Sequence[Row]) -> str:
    """Write a line for each scene and tolerance: what came out, and who vouches.

    Times are shares of the exact picture's; what is proved, certified and measured are
    the sums of the bounds that the picture's report gives.
    """
    exact = {r.task: r.timing.median for r in rows if asked_of(r) is None}
    head = ["scene", "asked", "error", "of asked", "time", *KINDS]
    lines = [head]
    for row in rows:
        asked = asked_of(row)
        if asked is None or row.error is None:
            continue
        bounds = dict.fromkeys(KINDS, 0.0)
        for saving in TOLD.get((row.task, asked), ()):
            bounds[saving.how] += saving.bound
        lines.append(
            [
                row.task,
                f"{asked:.2g}",
                f"{row.error:.1e}",
                f"{row.error / asked:.3f}",
                f"{row.timing.median / exact[row.task]:.2f}",
                *(f"{bound:.1e}" if bound else "-" for bound in bounds.values()),
            ]
        )
    return "\n".join(["", *columns(lines, 1)])


ABOUT = (
    "CPU time of drawing, medians; error: largest of a channel, in displayed white;"
    f" multiple {MOST['multiple']} pixels wide at most"
)
EXACT = "tolerance 0; of light scattered many times the finest solution on its grid"

TOLERANCE = Subject(
    name="tolerance",
    title="named scenes: tolerance asked against error measured, and time",
    about=ABOUT,
    lists=((tolerances, WIDTH, QUICK_WIDTH),),
    unit=MS,
    digits=2,
    reference=EXACT,
    summary=asked_and_measured,
    figure=asked_figure,
)
WHOLE_SCENES = Subject(
    name="scenes",
    title=f"whole scenes, {LARGE} pixels wide",
    about=ABOUT,
    lists=((whole_scenes, LARGE, QUICK_WIDTH),),
    unit=MS,
    digits=2,
    reference=EXACT,
)
