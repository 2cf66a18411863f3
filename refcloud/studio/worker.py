"""The process that draws: one job at a time, which may be stopped in its middle.

Its main thread draws; a second one listens. When a job is to stop, the listener raises
a signal, whose handler runs in the main thread between two steps of Python: most calls
of numpy take milliseconds. Only a job that is named can be stopped: a signal that comes
late, or from the terminal, finds another job or none, and does nothing.
"""

from __future__ import annotations

import _thread
import base64
import contextlib
import io
import os
import queue
import signal
import threading
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from refcloud.conventions import Skipped
from refcloud.image import Picture
from refcloud.image.png import encode_png
from refcloud.refusal import complaint
from refcloud.studio.choices import find_setup
from refcloud.studio.recipe import Kept
from refcloud.studio.setups import frame_of
from refcloud.studio.views import Request, Shown, shown

AGAIN = 0.02  # seconds until a stop that was lost is tried again
MOST_MEMORY = 6 << 30  # bytes of addresses, where the system lets a process bound them


@dataclass(frozen=True)
class Job:
    """A number, and what the page asked for, checked."""

    number: int
    setup: str
    values: dict[str, Any]
    width: int
    height: int
    coarse: bool
    view: str
    slice: float


class StoppedError(BaseException):
    """The job was overtaken; no `except Exception` on the way keeps it."""


def draw(job: Job, kept: Kept) -> dict[str, Any]:
    """Do a job, and give what the page shows.

    Parameters
    ----------
    job
        What is asked for.
    kept
        Results of earlier stages.

    Returns
    -------
    The PNG file in base 64, its size, a caption, times, notes, and what was skipped; or
    an error of one line.
    """
    start = time.perf_counter()
    try:
        setup = find_setup(job.setup)
        frame = frame_of(job.width, job.height, coarse=job.coarse)
        request = Request(setup, setup.taken(job.values), frame, job.view, job.slice)
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            found = shown(request, kept)
        return _answer(found, time.perf_counter() - start)
    except MemoryError:
        got = "more than this machine has free"
        advice = "choose a smaller picture, larger voxels or fewer balls"
        return {"error": complaint("memory", "what fits", got, advice)}
    except ArithmeticError as error:
        expected, advice = "numbers that stay finite", "choose values nearer to those"
        return {"error": complaint("arithmetic", expected, f"{error}", advice)}
    except (ValueError, TypeError) as error:
        return {"error": " ".join(str(error).split())}
    except Exception as error:
        kind = type(error).__name__
        line = f"defect: {kind}: {error}; please report these settings"
        return {"error": " ".join(line.split())}


def _answer(found: Shown, seconds: float) -> dict[str, Any]:
    file = io.BytesIO()
    encode_png(found.codes, file)
    height, width, _ = found.codes.shape
    return {
        "picture": base64.b64encode(file.getvalue()).decode("ascii"),
        "width": width,
        "height": height,
        "caption": found.caption,
        "seconds": round(seconds, 4),
        **_told(found.picture),
    }


def _told(picture: Picture | None) -> dict[str, Any]:
    """Give what a picture knows of its making."""
    if picture is None:
        return {"stages": {}, "notes": [], "skipped": []}
    return {
        "stages": {name: round(t, 4) for name, t in picture.seconds.items()},
        "notes": list(picture.notes),
        "skipped": [_row(row) for row in picture.skipped],
    }


def _row(row: Skipped) -> dict[str, Any]:
    return {
        "stage": row.stage,
        "what": row.what,
        "skipped": row.skipped,
        "of": row.of,
        "bound": row.bound,
        "unit": row.unit,
    }


class Worker:
    """The loop of the process."""

    def __init__(self, pipe: Connection) -> None:
        self.pipe = pipe
        self.jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
        self.kept = Kept()
        self.current: int | None = None
        self.stopped: int | None = None

    def run(self) -> None:
        """Draw until the other side closes the pipe."""
        signal.signal(signal.SIGINT, self._interrupted)
        threading.Thread(target=self._listen, daemon=True).start()
        while True:
            job = self._next()
            try:
                self.current = job.number
                answer = draw(job, self.kept)
                self.current = None
            except StoppedError:
                answer = {"stopped": True}
                while self.current is not None:
                    with contextlib.suppress(StoppedError):  # raised a second time
                        self.current = None
            self.pipe.send((job.number, answer))

    def _next(self) -> Job:
        # A wait without an end would keep signals from being seen on some systems.
        while True:
            with contextlib.suppress(queue.Empty):
                return self.jobs.get(timeout=3600.0)

    def _interrupted(self, number: int, stack: object) -> None:
        if self.current is not None and self.current == self.stopped:
            self.stopped = None
            raise StoppedError

    def _listen(self) -> None:
        try:
            while True:
                message = self.pipe.recv()
                if isinstance(message, Job):
                    self.jobs.put(message)
                else:
                    self._stop(message)
        except (EOFError, OSError):
            os._exit(0)  # nobody is left who wants a picture

    def _stop(self, number: int) -> None:
        """Raise the signal until the job has ended, in one way or the other."""
        self.stopped = number
        while self.current == number:
            self.stopped = number
            _thread.interrupt_main()
            time.sleep(AGAIN)


def work(pipe: Connection) -> None:
    """Run the process: bounded in memory where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        most = MOST_MEMORY if hard == resource.RLIM_INFINITY else min(MOST_MEMORY, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    Worker(pipe).run()
