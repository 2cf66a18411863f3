"""Contenders timed in turn: CPU time of one process, medians and spread of rounds.

All contenders of a task run once in each round, so that what else the machine does
falls on all of them. CPU time counts every thread's, so none wins by using two.
"""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Contender:
    """One way to do a task.

    Attributes
    ----------
    task
        What is done; ratios are taken within a task.
    name
        Who does it and how.
    samples
        How many values one call gives.
    work
        The call; what it returns is compared with the reference's.
    reference
        What the result is compared with, None where its numbers are its own.
    rival
        Whether ratios of the task are taken to it.
    distance
        How far a result is from the reference's; None for the largest difference.
    peer
        Whether it is of another library, and takes part only where peers are asked for.
    """

    task: str
    name: str
    samples: int
    work: Callable[[], Any]
    reference: Callable[[], Any] | None = None
    rival: bool = False
    distance: Callable[[Any, Any], float] | None = None
    peer: bool = False


@dataclass(frozen=True)
class Timing:
    """CPU nanoseconds per sample: the median of the rounds, the least and the most."""

    median: float
    least: float
    most: float


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes
    ----------
    task, name
        As of the contender.
    timing
        Nanoseconds per sample.
    ratio
        How many times faster than the task's rival, None without one.
    error
        Distance from the reference, None without one.
    rms
        The root of the mean of its square, None without one.
    """

    task: str
    name: str
    timing: Timing
    ratio: float | None
    error: float | None
    rms: float | None = None


def timed(contenders: Sequence[Contender], rounds: int) -> list[Row]:
    """Run the contenders in turn, a round after a warming one that does not count."""
    spent: list[list[float]] = [[] for _ in contenders]
    for number in range(rounds + 1):
        for times, contender in zip(spent, contenders, strict=True):
            start = time.process_time_ns()
            contender.work()
            passed = time.process_time_ns() - start
            if number:
                times.append(passed / contender.samples)
    timings = [Timing(statistics.median(t), min(t), max(t)) for t in spent]
    rivals = {
        contender.task: timing.median
        for contender, timing in zip(contenders, timings, strict=True)
        if contender.rival
    }
    return [
        Row(c.task, c.name, t, _ratio(rivals.get(c.task), t), *_errors(c))
        for c, t in zip(contenders, timings, strict=True)
    ]


def _ratio(rival: float | None, timing: Timing) -> float | None:
    # A clock that is too coarse for a quick call gives no ratio.
    return rival / timing.median if rival is not None and timing.median > 0 else None


def _errors(contender: Contender) -> tuple[float | None, float | None]:
    if contender.reference is None:
        return None, None
    found, exact = np.asarray(contender.work()), np.asarray(contender.reference())
    if contender.distance is not None:
        return contender.distance(found, exact), None
    off = np.abs(found - exact)
    return float(off.max()), float(np.sqrt(np.mean(off * off)))


def machine(peers: Iterable[str] = ()) -> str:
    """Say where the figures are from: processor, system, and versions."""
    processor = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            names = [line for line in lines if line.startswith("model name")]
        processor = names[0].split(":")[1].strip() if names else processor
    except OSError:
        pass  # another system: its own name of the processor stands
    parts = [processor, platform.system(), f"Python {platform.python_version()}"]
    parts.append(f"numpy {np.__version__}")
    for peer in peers:
        try:
            parts.append(f"{peer} {metadata.version(peer)}")
        except metadata.PackageNotFoundError:
            parts.append(f"{peer} not installed")
    return ", ".join(parts)
