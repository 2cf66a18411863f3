"""One door to animations: any scene or cloud, in frames, to a file or a folder."""

from __future__ import annotations

import dataclasses
import time
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from refcloud.animation.clouds import as_scene
from refcloud.animation.job import (
    Job,
    Saving,
    cleared,
    frame_path,
    opened,
    places,
    signed,
)
from refcloud.animation.moves import Moves, closes, completed
from refcloud.animation.workers import drawn
from refcloud.camera import Camera, OrthographicCamera, refuse_large
from refcloud.checking import checked
from refcloud.choices import size_of
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import (
    Array,
    Backend,
    Colour,
    Observer,
    Range,
    Seed,
    Shape,
    Skipped,
    Tolerance,
)
from refcloud.image.animation import Rate, write_animation
from refcloud.image.encode import Exposure, Tone
from refcloud.image.png import write_png
from refcloud.lighting import Haze, Look
from refcloud.lighting.look import LookName
from refcloud.march import Mixing
from refcloud.march.multiple import Scattering
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.render import Method, Quality, Side
from refcloud.scene import Scene, View
from refcloud.sky import Sky

Count = Annotated[int, Range(1, 100_000)]
Jobs = Annotated[int, Range(1, 1024, "processes")]


@dataclass(frozen=True)
class Progress:
    """What `observe` gets as "frame": how far an animation is.

    Attributes
    ----------
    done, frames
        Frames on disk, of all.
    left
        Seconds that the rest will take, as the frames so far did.
    """

    done: int
    frames: int
    left: float


@dataclass(frozen=True)
class Animated:
    """What `animate` wrote.

    Attributes
    ----------
    path
        The animated file, or the folder of frames.
    frames, kept
        How many there are, and how many of them were there before.
    closed
        Whether the frame after the last would be the first.
    skipped
        What the frames that were drawn now left out, all together; each bound is that
        of the worst frame.
    notes
        What was chosen on the caller's behalf, a line each; of the first frame that was
        drawn now.
    seconds
        Time of each part: "frames", "file".
    """

    path: Path
    frames: int
    kept: int
    closed: bool
    skipped: tuple[Skipped, ...]
    notes: tuple[str, ...]
    seconds: dict[str, float]


@checked
def animate(
    cloud: Metaballs | VoxelGrid | Scene | str,
    path: str | Path,
    *,
    frames: Count,
    moves: Moves | None = None,
    fps: Rate = 24.0,
    executor: Executor | None = None,
    jobs: Jobs = 1,
    redraw: bool = False,
    camera: Camera | OrthographicCamera | None = None,
    width: Side | None = None,
    height: Side | None = None,
    suns: Sun | tuple[Sun, ...] | None = None,
    medium: Medium | None = None,
    look: Look | LookName | None = None,
    background: Sky
    | Literal["transparent"]
    | Colour
    | Annotated[Array, Shape("H", "W", 3), Range(0.0)]
    | None = None,
    haze: Haze | None = None,
    method: Method | None = None,
    scattering: Scattering = "single",
    ambient: Colour | None = None,
    mixing: Mixing | None = None,
    tolerance: Tolerance = 0.0,
    quality: Quality = "quick",
    seed: Seed = 0,
    exposure: Exposure = 1.0,
    tone: Tone = "shoulder",
    dither: bool = True,
    observe: Observer | None = None,
    backend: Backend = "numpy",
) -> Animated:
    """Animate a scene or a cloud.

    Formula: frame i is the picture at the share i / frames of every move where the
    moves end as they began, else at i / (frames - 1)

    Parameters
    ----------
    cloud
        A scene or its name, metaballs or a cloud map.
    path
        An animated file, by its end: .png or .apng, .gif, .webp; a name without one is
        a folder, where frame-0000.png, ... stay. Frames of an animated file lie in the
        folder NAME.frames until it is written. Frames that are there already, of the
        same job, are not drawn again.
    frames
        How many pictures.
    moves
        What turns, blows or goes by; None for a scene's own time, once through its
        period.
    fps
        Frames per second.
    executor
        Who draws the frames: any `concurrent.futures.Executor`, such as that of a Dask
        cluster (``Client.get_executor()``). None for processes of this machine.
    jobs
        How many processes draw at a time; 1 draws here, one frame after the other.
    redraw
        Whether frames in the folder, of this job or of another, are drawn anew.
    camera, width, height, suns, medium, look, background, haze, method, scattering
        As `render`; what moves starts there.
    ambient, mixing, tolerance, quality, seed, backend
        As `render`.
    exposure, tone, dither
        As `Picture.codes`.
    observe
        Called with "frame" and a `Progress` whenever a frame is on disk.

    Returns
    -------
    What was written.

    Raises
    ------
    ValueError
        The scene cannot move so; the format cannot hold the frames; the folder holds
        frames of another job.

    Source: documents S and C (N24, W14).
    """
    path = Path(path)
    own = {
        "background": background,
        "haze": haze,
        "method": method,
        "scattering": scattering,
        "ambient": ambient,
        "mixing": mixing,
    }
    width, height = size_of(width, height, quality, camera)
    refuse_large(width, height)
    view = View(
        width,
        height,
        camera,
        (suns,) if isinstance(suns, Sun) else suns,
        medium,
        look,
        tolerance,
        seed,
        None,
        backend,
    )
    scene, view, notes = as_scene(cloud, view, own)
    transparent = isinstance(background, str)
    folder, is_file = places(path, view, transparent)
    moves = completed(moves or Moves(), scene.motion, scene.name)
    closed = closes(moves, scene.motion)
    job = signed(
        Job(scene, view, moves, closed, frames, Saving(exposure, tone, dither))
    )
    # 1. Find what an earlier run left, and draw the rest.
    made = not folder.exists()
    start = time.perf_counter()
    kept = opened(folder, job, "path", redraw)
    held = set(kept)
    missing = [index for index in range(frames) if index not in held]
    rows: tuple[Skipped, ...] = ()
    try:
        for count, frame in enumerate(drawn(job, missing, executor, jobs), 1):
            write_png(frame_path(folder, frame.index), frame.codes)
            rows = _over_frames((*rows, *frame.skipped))
            if frame.index == missing[0]:
                notes += frame.notes
            if observe is not None:
                passed = time.perf_counter() - start
                left = passed / count * (len(missing) - count)
                observe("frame", Progress(len(kept) + count, frames, left))
    except BaseException:
        if made and not any(frame_path(folder, i).exists() for i in missing):
            cleared(folder, 0)  # refused before the first frame: leave nothing
        raise
    middle = time.perf_counter()
    # 2. Join them, and clear up what was only kept for that.
    if is_file:
        files = [frame_path(folder, index) for index in range(frames)]
        write_animation(path, files, fps=fps)
        cleared(folder, frames)
    seconds = {"frames": middle - start}
    if is_file:
        seconds["file"] = time.perf_counter() - middle
    return Animated(path, frames, len(kept), closed, rows, notes, seconds)


def _over_frames(rows: tuple[Skipped, ...]) -> tuple[Skipped, ...]:
    """Join the rows of all frames: counts add up, each frame has its own error."""
    joined: dict[tuple[str, str], Skipped] = {}
    for row in rows:
        old = joined.get(
            (row.stage, row.what), dataclasses.replace(row, skipped=0, of=0)
        )
        joined[row.stage, row.what] = dataclasses.replace(
            row,
            skipped=old.skipped + row.skipped,
            of=old.of + row.of,
            bound=max(old.bound, row.bound),
        )
    return tuple(joined.values())
