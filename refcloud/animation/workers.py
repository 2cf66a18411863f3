"""Frames by an executor: a few ahead of the writer, in any order, none lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    wait,
)

from refcloud.animation.frames import Frame, draw_frame, leave
from refcloud.animation.job import Job, size_of
from refcloud.processes import workers

HELD_BYTES = 1 << 27  # of finished frames that wait for the writer
LEAST_AHEAD, MOST_AHEAD = 4, 64  # frames that are asked for at one time
CODES = 4  # bytes of a pixel at most


def drawn(
    job: Job, missing: Sequence[int], executor: Executor | None, jobs: int
) -> Iterator[Frame]:
    """Draw the missing frames and hand each over as soon as it is there.

    Parameters
    ----------
    job
        A signed one.
    missing
        Numbers of frames.
    executor
        Who draws them; None for processes of this machine, or this one.
    jobs
        How many such processes; one is this process itself.

    Returns
    -------
    The frames, in the order in which they are ready.

    Raises
    ------
    ChildProcessError
        A worker ended without a word.
    """
    if executor is not None:
        yield from _by(executor, job, missing)
    elif jobs == 1 or len(missing) < 2:
        try:
            for index in missing:
                yield draw_frame(job, index)
        finally:
            leave()
    else:
        with workers(min(jobs, len(missing))) as pool:
            yield from _by(pool, job, missing)


def _by(executor: Executor, job: Job, missing: Sequence[int]) -> Iterator[Frame]:
    height, width = size_of(job.view)
    ahead = HELD_BYTES // (CODES * width * height)
    ahead = min(max(ahead, LEAST_AHEAD), MOST_AHEAD)
    left = iter(missing)
    waiting: set[Future[Frame]] = set()
    try:
        while True:
            for index in left:
                waiting.add(executor.submit(draw_frame, job, index))
                if len(waiting) >= ahead:
                    break
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
            done.clear()
    except BrokenExecutor as error:
        raise ChildProcessError(
            "frames: expected every worker to live, got one that ended, perhaps for"
            " lack of memory; the frames so far are kept, try fewer jobs"
        ) from error
    finally:
        for future in waiting:
            future.cancel()
