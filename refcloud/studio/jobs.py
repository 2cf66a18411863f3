"""The queue before the drawing process: a page's new request overtakes its old one."""

from __future__ import annotations

import dataclasses
import multiprocessing
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from refcloud.processes import deaf
from refcloud.refusal import complaint
from refcloud.studio.worker import Job, work

PATIENCE = 2.0  # seconds until a job that does not stop is ended with its process
LOOK = 0.01  # seconds between two looks at whether the running job is still wanted
MOST_PAGES = 16  # that wait at once
OVERTAKEN = {"overtaken": True}


class Ticket:
    """One page's wait for one answer."""

    def __init__(self, page: str, job: Job) -> None:
        self.page = page
        self.job = job
        self.answer: dict[str, Any] = {}
        self.done = threading.Event()
        self.wanted = True

    def end(self, answer: dict[str, Any]) -> None:
        """Hand the answer over."""
        self.answer = answer
        self.done.set()


class Jobs:
    """A queue that holds at most one waiting request of each page.

    Parameters
    ----------
    target
        What the drawing process runs.
    """

    def __init__(self, target: Callable[[Connection], None] = work) -> None:
        self._target = target
        self._changed = threading.Condition()
        self._waiting: OrderedDict[str, Ticket] = OrderedDict()
        self._running: Ticket | None = None
        self._number = 0
        self._closed = False
        self._process, self._pipe = self._start()
        self.started = 1  # processes, the first included
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _start(self) -> tuple[Any, Connection]:
        # A fresh interpreter: no thread or lock of this process is copied.
        context = multiprocessing.get_context("spawn")
        here, there = context.Pipe()
        process = context.Process(
            target=self._target, args=(there,), name="refcloud studio", daemon=True
        )
        with deaf():
            process.start()
        there.close()
        return process, here

    def ask(self, page: str, job: Job) -> dict[str, Any]:
        """Queue a job of a page, and wait for what came of it.

        Parameters
        ----------
        page
            Which page asks: its earlier requests are overtaken, no other's.
        job
            What it asks for; it gets its number here.

        Returns
        -------
        The worker's answer, or that it was overtaken.

        Raises
        ------
        ValueError
            Too many pages wait.
        """
        with self._changed:
            self._number += 1
            ticket = Ticket(page, dataclasses.replace(job, number=self._number))
            self._overtake(page)
            if len(self._waiting) >= MOST_PAGES:
                got = f"{len(self._waiting)} that wait"
                expected = f"at most {MOST_PAGES} pages"
                raise ValueError(complaint("studio", expected, got, "close some"))
            self._waiting[page] = ticket
            self._changed.notify_all()
        ticket.done.wait()
        return ticket.answer

    def stop(self, page: str) -> None:
        """Let go of what a page waits for."""
        with self._changed:
            self._overtake(page)

    def _overtake(self, page: str) -> None:
        old = self._waiting.pop(page, None)
        if old is not None:
            old.end(OVERTAKEN)
        if self._running is not None and self._running.page == page:
            self._running.wanted = False
            self._changed.notify_all()

    def close(self) -> None:
        """End the process and let go of everybody."""
        with self._changed:
            self._closed = True
            for ticket in self._waiting.values():
                ticket.end(OVERTAKEN)
            self._waiting.clear()
            if self._running is not None:
                self._running.wanted = False
            self._changed.notify_all()
        self._thread.join(2.0 * PATIENCE)
        self._end_process()

    def _end_process(self) -> None:
        self._process.kill()
        self._process.join()
        self._pipe.close()

    def _serve(self) -> None:
        """Hand job after job to the process."""
        while True:
            with self._changed:
                while not self._waiting and not self._closed:
                    self._changed.wait()
                if self._closed:
                    return
                _, ticket = self._waiting.popitem(last=False)
                self._running = ticket
            answer = self._drawn(ticket)
            with self._changed:
                self._running = None
            ticket.end(answer if ticket.wanted else OVERTAKEN)

    def _drawn(self, ticket: Ticket) -> dict[str, Any]:
        """Wait for the process; stop it where the page has lost interest."""
        asked = None
        try:
            self._pipe.send(ticket.job)
            while True:
                if self._pipe.poll(LOOK):
                    _, answer = self._pipe.recv()
                    return answer
                if ticket.wanted:
                    continue
                if asked is None:
                    asked = time.monotonic()
                    self._pipe.send(ticket.job.number)
                elif time.monotonic() - asked > PATIENCE:
                    self._restart()
                    return OVERTAKEN
        except (EOFError, OSError):
            self._restart()
            got = "an end of its process, perhaps for want of memory"
            advice = "choose a smaller picture, larger voxels or fewer balls"
            return {"error": complaint("drawing", "a picture", got, advice)}

    def _restart(self) -> None:
        self._end_process()
        if not self._closed:
            self._process, self._pipe = self._start()
            self.started += 1
