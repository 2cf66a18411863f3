"""Processes that work for this one, and end with it."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess


@contextmanager
def deaf() -> Iterator[None]:
    """Start a process inside: it ignores Ctrl-C from its first moment, as it inherits.

    What it does about interrupts itself comes after its imports, a third of a second
    later; until then Ctrl-C would print its traceback.
    """
    before = signal.getsignal(signal.SIGINT)
    main = threading.current_thread() is threading.main_thread()
    if before is None or not main:  # it cannot be set, or not set back
        yield
        return
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class _Process(SpawnProcess):
    """A fresh process that ignores Ctrl-C."""

    def start(self) -> None:
        with deaf():
            super().start()


class _Context(SpawnContext):
    """Where the executor takes its processes from."""

    Process = _Process


@contextmanager
def workers(count: int) -> Iterator[Executor]:
    """Give an executor of fresh processes: none inherits threads or locks.

    Parameters
    ----------
    count
        How many processes.

    Returns
    -------
    The executor. It waits for what is at work where the block ends or fails; where it
    is interrupted, or nobody asks for the rest, its processes are ended at once.
    """
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        count,
        mp_context=_Context(),
        initializer=_ignore_interrupts,
    )
    try:
        yield pool
    except (KeyboardInterrupt, GeneratorExit):
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _ignore_interrupts() -> None:
    """Leave Ctrl-C to the process that asked for the work, where none inherits that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
