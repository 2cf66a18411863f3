"""One frame, drawn by whoever runs it: this process, another one, or a cluster.

A process keeps the scene's clouds, and the light that still holds, from one frame to
the next. Nothing kept changes a bit of a frame: any may be drawn alone, anywhere.
"""

from __future__ import annotations

import dataclasses
import threading
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from refcloud.animation.job import Job
from refcloud.animation.moves import moved, share_of
from refcloud.conventions import Skipped
from refcloud.image.encode import Codes
from refcloud.scene import Model, own_of


@dataclass(frozen=True)
class Frame:
    """One frame as codes, and what its making left out, chose and took."""

    index: int
    codes: Codes
    skipped: tuple[Skipped, ...]
    notes: tuple[str, ...]
    seconds: float


@dataclass
class Stage:
    """What one thread keeps between the frames of one job."""

    digest: str
    model: Model
    kept: dict[Any, Any] = field(default_factory=dict)


_HERE = threading.local()


def draw_frame(job: Job, index: int) -> Frame:
    """Draw one frame of a job.

    Parameters
    ----------
    job
        A signed one.
    index
        Which frame, from 0.

    Returns
    -------
    The frame; the same bits whoever draws it, and whatever was drawn before.
    """
    start = time.perf_counter()
    # What overflows is refused, in a worker as in the program itself.
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        stage = getattr(_HERE, "stage", None)
        if stage is None or stage.digest != job.digest:
            leave()
            stage = _HERE.stage = Stage(job.digest, job.scene.model())
        # Light holds while the suns stand still. A turning sun would leave that of the
        # sky, but which buffers a tolerance lets shrink depends on all lights at once.
        view = dataclasses.replace(
            job.view, kept=None if job.moves.turn_sun else stage.kept
        )
        if job.moves.turn_sun and view.suns is None:
            # The suns that the scene has for this look, medium and scattering.
            own = own_of(job.scene, view, stage.model)
            view = dataclasses.replace(view, suns=own.suns)
        share = share_of(index, job.frames, job.closed)
        view = moved(view, stage.model, job.scene.motion, job.moves, share)
        picture = job.scene.draw(stage.model, view)
        saving = job.saving
        codes = picture.codes(
            exposure=saving.exposure, tone=saving.tone, dither=saving.dither
        )
    skipped = (*stage.model.skipped, *picture.skipped)
    notes = (*stage.model.notes, *picture.notes)
    return Frame(index, codes, skipped, notes, time.perf_counter() - start)


def leave() -> None:
    """Let go of what this thread keeps."""
    _HERE.stage = None
