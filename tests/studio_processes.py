"""Drawing processes for tests: one takes its time, one dies, one hangs."""

from __future__ import annotations

import os
import time
from multiprocessing.connection import Connection
from typing import Any

from refcloud.studio import worker
from refcloud.studio.recipe import Kept
from refcloud.studio.worker import Job, Worker

FOREVER = 60.0  # seconds; a job that is stopped takes much less


def slow(job: Job, kept: Kept) -> dict[str, Any]:
    """Take long where the slice says so, in steps of Python."""
    end = time.monotonic() + FOREVER * job.slice
    while time.monotonic() < end:
        time.sleep(0.001)
    return {"drawn": job.number}


def work_slowly(pipe: Connection) -> None:
    worker.draw = slow
    Worker(pipe).run()


def die(pipe: Connection) -> None:
    job = pipe.recv()
    if job.coarse:
        os._exit(9)
    pipe.send((job.number, {"drawn": job.number}))
    pipe.recv()


def hang(pipe: Connection) -> None:
    """Answer coarse jobs; never another, whatever is asked."""
    while True:
        job = pipe.recv()
        if isinstance(job, Job) and job.coarse:
            pipe.send((job.number, {"drawn": job.number}))
