"""A new request overtakes the old one, and nothing that a job does stops the queue."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import studio_processes

from refcloud.studio import Jobs, jobs
from refcloud.studio.recipe import Kept
from refcloud.studio.worker import Job, StoppedError, Worker, draw

QUICK, LONG = 0.0, 1.0
PLAIN = Job(0, "noise", {}, 8, 6, False, "picture", QUICK)


def job(share: float = QUICK, *, coarse: bool = False) -> Job:
    return Job(0, "cloud", {}, 8, 6, coarse, "picture", share)


class Asked:
    """A request that waits in a thread of its own."""

    def __init__(self, queue: Jobs, page: str, what: Job) -> None:
        self.answer: dict[str, Any] | None = None
        self.thread = threading.Thread(target=self._ask, args=(queue, page, what))
        self.thread.start()

    def _ask(self, queue: Jobs, page: str, what: Job) -> None:
        self.answer = queue.ask(page, what)

    def ended(self) -> dict[str, Any]:
        self.thread.join(30.0)
        assert self.answer is not None, "it still waits"
        return self.answer


@pytest.fixture
def queue_of() -> Iterator[Callable[..., Jobs]]:
    made: list[Jobs] = []

    def queue_of(target: Any) -> Jobs:
        made.append(Jobs(target))
        return made[-1]

    yield queue_of
    for each in made:
        each.close()


@pytest.fixture(scope="module")
def slow_queue() -> Iterator[Jobs]:
    """One queue whose jobs take as long as they are told, for several tests."""
    queue = Jobs(studio_processes.work_slowly)
    yield queue
    queue.close()


def running(queue: Jobs) -> None:
    """Wait until a job runs."""
    for _ in range(3000):
        with queue._changed:
            if queue._running is not None and not queue._waiting:
                return
        threading.Event().wait(0.01)
    raise AssertionError("no job began")


def test_a_new_request_overtakes_the_running_and_the_waiting_one(slow_queue) -> None:
    queue = slow_queue
    assert "drawn" in queue.ask("a", job())
    first = Asked(queue, "a", job(LONG))
    running(queue)
    second = Asked(queue, "a", job(LONG))
    third = Asked(queue, "a", job())
    assert "drawn" in third.ended(), "long before the first would have ended"
    assert first.ended() == second.ended() == jobs.OVERTAKEN
    assert queue.started == 1, "the process was not ended: what it keeps is still there"


def test_pages_do_not_overtake_each_other(slow_queue) -> None:
    queue = slow_queue
    first = Asked(queue, "a", job(0.01))
    running(queue)
    others = [Asked(queue, page, job()) for page in "bcd"]
    assert all("drawn" in each.ended() for each in (first, *others))


def test_stop_lets_go(slow_queue) -> None:
    queue = slow_queue
    first = Asked(queue, "a", job(LONG))
    running(queue)
    queue.stop("another")
    queue.stop("a")
    assert first.ended() == jobs.OVERTAKEN
    assert "drawn" in queue.ask("a", job())


def test_a_process_that_ends_is_started_again(queue_of) -> None:
    queue = queue_of(studio_processes.die)
    answer = queue.ask("a", job(coarse=True))
    assert answer["error"].startswith("drawing: expected a picture, got an end")
    assert "drawn" in queue.ask("a", job())
    assert queue.started == 2


def test_a_job_that_does_not_stop_is_ended_with_its_process(
    queue_of, monkeypatch
) -> None:
    monkeypatch.setattr(jobs, "PATIENCE", 0.1)
    queue = queue_of(studio_processes.hang)
    first = Asked(queue, "a", job())
    running(queue)
    assert "drawn" in queue.ask("a", job(coarse=True))
    assert first.ended() == jobs.OVERTAKEN
    assert queue.started == 2


def test_too_many_pages_are_refused(slow_queue, monkeypatch) -> None:
    monkeypatch.setattr(jobs, "MOST_PAGES", 1)
    queue = slow_queue
    first = Asked(queue, "a", job(LONG))
    running(queue)
    second = Asked(queue, "b", job())
    while "b" not in queue._waiting:
        threading.Event().wait(0.01)
    with pytest.raises(ValueError, match="studio: expected at most 1 pages"):
        queue.ask("c", job())
    queue.stop("a")
    first.ended()
    assert "drawn" in second.ended()


def test_closing_lets_everybody_go(queue_of) -> None:
    queue = queue_of(studio_processes.work_slowly)
    first = Asked(queue, "a", job(LONG))
    running(queue)
    second = Asked(queue, "b", job())
    while "b" not in queue._waiting:
        threading.Event().wait(0.01)
    queue.close()
    assert first.ended() == second.ended() == jobs.OVERTAKEN


def test_late_signals_stop_nothing() -> None:
    worker = Worker.__new__(Worker)
    worker.current, worker.stopped = None, 7
    worker._interrupted(2, None)
    worker.current = 8
    worker._interrupted(2, None)
    worker.current = 7
    with pytest.raises(StoppedError):
        worker._interrupted(2, None)


@pytest.mark.parametrize(
    ("noise", "line"),
    [
        ({"kind": "pink"}, "noise.kind: expected one of"),
        ({"size": 1024, "view": "channels"}, "noise.size: expected panels of"),
        ({"size": 700, "octaves": 8, "view": "octaves"}, "noise.size: expected"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(noise, line) -> None:
    answer = draw(dataclasses.replace(PLAIN, values={"noise": noise}), Kept())
    assert answer["error"].startswith(line)


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        (MemoryError(), "memory: expected what fits"),
        (FloatingPointError("overflow"), "arithmetic: expected numbers that stay"),
        (ValueError("a\nb"), "a b"),
        (KeyError("x"), "defect: KeyError"),
    ],
)
def test_every_failure_is_one_line(wrong, line, monkeypatch) -> None:
    def fail(*_: object) -> None:
        raise wrong

    monkeypatch.setattr("refcloud.studio.worker.shown", fail)
    answer = draw(PLAIN, Kept())
    assert answer["error"].startswith(line)
    assert "\n" not in answer["error"]
