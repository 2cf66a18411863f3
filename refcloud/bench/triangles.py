"""The triangle benchmark: textured meshes against a loop, scalar Python and OpenGL.

Ratios are to the loop over triangles, which draws one at a time with numpy on its box
of pixels. Errors are the mean difference from the exact picture: at silhouettes a
texture differs at single pixels, however good a rasteriser is.
"""

from __future__ import annotations

import functools
import importlib.util
from collections.abc import Callable
from typing import Any

from refcloud.bench import triangles_scene as scene
from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.bench.triangles_loop import loop_over_triangles, scalar
from refcloud.conventions import Array
from refcloud.raster import draw_triangles

TOLERANCE = 1.0 / 255.0
# Numbers of triangles, and those of a quick look.
COUNTS = {100: 40, 10_000: 100, 100_000: 200}
LOOPED, SCALAR = 10_000, 10_000  # the most that loops are given


def drawn(name: str, count: int, filter: str, depth: bool, tolerance: float) -> Array:
    """Draw a scene with refcloud."""
    mesh, camera, cull = scene.scene(name, count)
    buffer = scene.cleared(depth)  # one for all: what is kept of a picture is a copy
    draw_triangles(
        buffer,
        camera,
        mesh,
        scene.textured(filter),
        state=scene.state(depth),
        cull=cull,
        tolerance=tolerance,
        **scene.DEPTHS,
    )
    return buffer.pixels


def contenders(name: str, count: int, filter: str = "LINEAR") -> list[Contender]:
    """List the ways to draw a mesh.

    Parameters
    ----------
    name
        "sphere", "dome" or "displaced".
    count
        Of triangles, about.
    filter
        Of texels that are smaller than pixels.

    Returns
    -------
    The contenders; the loop over triangles is the rival, where there is one.
    """
    words = "" if filter == "LINEAR" else " mipmap"
    task = f"{name} {count}{words}"
    exact = functools.partial(drawn, name, count, filter, True, 0.0)
    reference = functools.cache(lambda: exact().copy())
    listed: list[tuple[str, Callable[[], Any]]] = [
        ("refcloud float64, exact", exact),
        (
            f"refcloud tolerance={TOLERANCE:.2g}",
            functools.partial(drawn, name, count, filter, True, TOLERANCE),
        ),
    ]
    if name == "dome":  # one layer: nothing hides anything
        listed.append(
            (
                f"refcloud tolerance={TOLERANCE:.2g}, no depth",
                functools.partial(drawn, name, count, filter, False, TOLERANCE),
            )
        )
    rival = "loop over triangles, numpy"
    if count <= LOOPED and filter == "LINEAR":
        listed.append((rival, functools.partial(loop_over_triangles, name, count)))
    if name == "sphere" and count <= SCALAR and filter == "LINEAR":
        listed.append(("scalar Python, whole", functools.partial(scalar, name, count)))
    peers: list[tuple[str, Callable[[], Any]]] = []
    if importlib.util.find_spec("moderngl") is not None:
        opengl = importlib.import_module("refcloud.bench.triangles_gl")
        peers = opengl.ways(name, count, filter)
    return [
        Contender(
            task,
            what,
            1,
            work,
            reference,
            what == rival,
            scene.mean_difference,
            peer=(what, work) in peers,
        )
        for what, work in [*listed, *peers]
    ]


def _maker(name: str, filter: str) -> Callable[[int], list[Contender]]:
    return functools.partial(contenders, name, filter=filter)


def _lists() -> tuple[tuple[Callable[[int], list[Contender]], int, int], ...]:
    every = [
        (_maker(name, "LINEAR"), count, quick)
        for name in ("sphere", "dome", "displaced")
        for count, quick in COUNTS.items()
    ]
    mipmaps = [
        (_maker(name, "LINEAR_MIPMAP_LINEAR"), 10_000, COUNTS[10_000])
        for name in ("sphere", "dome")
    ]
    return (*every, *mipmaps)


TRIANGLES = Subject(
    name="triangles",
    title="textured triangles: refcloud, a loop over them, OpenGL",
    about=(
        f"CPU time per frame of {scene.WIDTH}x{scene.HEIGHT}, cleared and textured with"
        " 512x512 RGBA texels, medians; error: mean difference from the exact picture"
    ),
    lists=_lists(),
    peers=("moderngl",),
    unit=MS,
    reference="float64 at tolerance 0, 1e-12 from its plain twin",
)
