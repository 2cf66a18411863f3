"""Stages of a command: their times, and a sign of life on stderr after a second."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any

PATIENCE = 1.0  # seconds: what takes less needs no sign of life
CLEAR = "\r\x1b[K"  # back to the line's start, and wipe it


class Stages:
    """Times the stages of one command and shows the one at work.

    A terminal gets one line that is rewritten each second and wiped at the end. A log
    gets a line after 1, 2, 4, 8, ... seconds of a stage.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._start = time.perf_counter()
        self._latest = ""

    def watch(self, name: str, value: Any) -> None:
        """Take note of an intermediate; the library's functions call this."""
        self._latest = f"{name} done"

    def count(self, done: int, of: int, left: float) -> None:
        """Take note of how many parts are done, and of the seconds that are left."""
        self._latest = f"{done} of {of}, {duration(left)} left"

    def part(self, done: int, of: int) -> None:
        """Take note of how many parts are done."""
        self._latest = f"{done} of {of}"

    @contextlib.contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside, with a sign of life where it takes long."""
        start = time.perf_counter()
        self._latest = ""
        done = threading.Event()
        signs = threading.Thread(target=self._show, args=(name, done), daemon=True)
        signs.start()
        try:
            yield
        finally:
            done.set()
            signs.join()
            self.seconds[name] = time.perf_counter() - start

    def _show(self, name: str, done: threading.Event) -> None:
        terminal = sys.stderr.isatty()
        passed, pause = 0.0, PATIENCE
        while not done.wait(pause):
            passed += pause
            pause = PATIENCE if terminal else passed
            latest = f", {self._latest}" if self._latest else ""
            line = f"refcloud: {name}, {passed:.0f} s{latest}"
            _write(CLEAR + line if terminal else line + "\n")
        if terminal and passed:
            _write(CLEAR)

    def line(self, within: Mapping[str, float] | None = None) -> str:
        """Say the time of each stage and of all together.

        A stage that reports its own parts is given as those.
        """
        parts = {**self.seconds, **(within or {})}
        each = ", ".join(f"{name} {t:.2f}" for name, t in parts.items())
        return f"seconds: {each}, total {time.perf_counter() - self._start:.2f}"


def duration(seconds: float) -> str:
    """Write a time in its two largest units.

    Examples
    --------
    >>> duration(9.6), duration(83.4), duration(25376 * 60)
    ('10 s', '1 min 23 s', '17 d 14 h')
    """
    left = round(seconds)
    parts = []
    for unit, size in (("d", 86400), ("h", 3600), ("min", 60), ("s", 1)):
        count, left = divmod(left, size)
        parts.append((count, unit))
    first = next((k for k, (count, _) in enumerate(parts) if count), len(parts) - 1)
    return " ".join(f"{count} {unit}" for count, unit in parts[first : first + 2])


def _write(text: str) -> None:
    # A closed stderr is no reason to stop the work.
    with contextlib.suppress(OSError, ValueError):
        sys.stderr.write(text)
        sys.stderr.flush()
