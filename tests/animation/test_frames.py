"""Frames: loops close, interrupted jobs go on, the same bits whoever draws them."""

from __future__ import annotations

import dataclasses
import gc
import json
import os
import tracemalloc
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from small_animations import DRAWN, LOOPED, SEEN, STILL, small
from small_scenes import BALLS

import refcloud as rc
from refcloud import Moves, animate
from refcloud.animation import Progress
from refcloud.animation.frames import draw_frame
from refcloud.animation.job import Job, Saving, signed
from refcloud.animation.workers import drawn
from refcloud.declared import KINDS
from refcloud.image import read_png
from refcloud.scene import View
from refcloud.scenes import SCENES

ROUND = Moves(turn_eye=360.0)


def codes(folder: Path) -> list[np.ndarray]:
    return [read_png(path) for path in sorted(folder.glob("frame-*.png"))]


def test_a_loop_closes_without_a_jump(tmp_path: Path) -> None:
    made = animate(LOOPED, tmp_path / "a", **small(frames=8))
    assert made.closed
    frames = codes(tmp_path / "a")
    view = View(16, 12)

    def light(time: float) -> np.ndarray:
        return LOOPED.draw(LOOPED.model(), dataclasses.replace(view, time=time)).linear

    # Exactly the same at the end of the period as at its start: no frame shows twice.
    np.testing.assert_allclose(light(2.0), light(0.0), rtol=0.0, atol=1e-12)
    assert len({frame.tobytes() for frame in frames}) == 8
    # The step from the last frame to the first is one of the others' size.
    steps = [
        float(np.abs(b.astype(int) - a).mean())
        for a, b in zip(frames, [*frames[1:], frames[0]], strict=True)
    ]
    assert steps[-1] <= 1.5 * max(steps[:-1])


def test_wind_closes_after_the_repeat(tmp_path: Path) -> None:
    blown = Moves(time=[0, 2], wind=[2, 0, 0])
    assert animate(LOOPED, tmp_path / "a", moves=blown, **small()).closed
    half = Moves(time=[0, 2], wind=[1, 0, 0])
    assert not animate(LOOPED, tmp_path / "b", moves=half, **small()).closed


def test_an_open_way_shows_its_end(tmp_path: Path) -> None:
    made = animate(LOOPED, tmp_path / "a", moves=Moves(time=[0, 1]), **small())
    assert not made.closed
    end = LOOPED.draw(LOOPED.model(), View(16, 12, time=1.0))
    np.testing.assert_array_equal(codes(tmp_path / "a")[-1], end.codes())


def in_bytes(folder: Path) -> list[bytes]:
    return [frame.tobytes() for frame in codes(folder)]


class StopError(BaseException):
    pass


def stopping_after(count: int):
    def observe(name: str, progress: Progress) -> None:
        if progress.done == count:
            raise StopError

    return observe


@pytest.mark.parametrize("name", ["a", "a.png", "a.gif", "a.webp"])
def test_an_interrupted_job_goes_on(name: str, tmp_path: Path) -> None:
    whole = animate(LOOPED, tmp_path / f"whole-{name}", **small(frames=5))
    with pytest.raises(StopError):
        animate(LOOPED, tmp_path / name, observe=stopping_after(2), **small(frames=5))
    folder = tmp_path / ("a" if name == "a" else f"{name}.frames")
    assert len(codes(folder)) == 2
    assert not (tmp_path / name).is_file()
    DRAWN.clear()
    seen: list[Progress] = []
    made = animate(
        LOOPED,
        tmp_path / name,
        observe=lambda name, value: seen.append(value),
        **small(frames=5),
    )
    assert made.kept == 2
    assert DRAWN == [2.0 * i / 5 for i in (2, 3, 4)]
    assert [(p.done, p.frames) for p in seen] == [(3, 5), (4, 5), (5, 5)]
    assert seen[-1].left == 0.0
    if name == "a":
        assert in_bytes(folder) == in_bytes(whole.path)
        assert animate(LOOPED, folder, **small(frames=5)).kept == 5
    else:
        assert made.path.read_bytes() == whole.path.read_bytes()
        assert not folder.exists()


def test_a_frame_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch) -> None:
    replace = os.replace

    def failing(old, new) -> None:
        if Path(new).name == "frame-0001.png":
            raise StopError
        replace(old, new)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(StopError):
        animate(LOOPED, tmp_path / "a", **small())
    names = {path.name for path in (tmp_path / "a").iterdir()}
    assert names == {"job.json", "frame-0000.png"}


def test_a_damaged_frame_is_drawn_again(tmp_path: Path) -> None:
    animate(LOOPED, tmp_path / "a", **small())
    bad = tmp_path / "a" / "frame-0002.png"
    good = bad.read_bytes()
    bad.write_bytes(good[:-9])
    assert animate(LOOPED, tmp_path / "a", **small()).kept == 3
    assert bad.read_bytes() == good


CHANGES = [
    {"moves": Moves(time=[0, 4])},
    {"moves": Moves(wind=[2, 0, 0], time=[0, 2])},
    {"frames": 5},
    {"width": 17},
    {"tolerance": 1 / 255},
    {"seed": 1},
    {"exposure": 0.9},
    {"tone": "none"},
    {"dither": False},
]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
def test_frames_of_another_job_are_refused_or_redrawn(change, tmp_path: Path) -> None:
    path = tmp_path / "a"
    animate(LOOPED, path, **small())
    before = in_bytes(path)
    with pytest.raises(ValueError, match=r"path: expected .*other parameters; choose"):
        animate(LOOPED, path, **small(**change))
    assert in_bytes(path) == before
    made = animate(LOOPED, path, redraw=True, **small(**change))
    assert made.kept == 0
    assert len(codes(path)) == made.frames
    fresh = animate(LOOPED, tmp_path / "b", **small(**change))
    assert in_bytes(path) == [c.tobytes() for c in codes(fresh.path)]


def test_foreign_frames_without_a_job_are_refused(tmp_path: Path) -> None:
    animate(LOOPED, tmp_path / "a", **small())
    (tmp_path / "a" / "job.json").unlink()
    with pytest.raises(ValueError, match=r"path: expected .* to be empty, or"):
        animate(LOOPED, tmp_path / "a", **small())


def test_other_files_of_the_folder_stay(tmp_path: Path) -> None:
    folder = tmp_path / "a.png.frames"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    animate(LOOPED, tmp_path / "a.png", **small())
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]


def test_every_part_of_a_job_counts_for_its_digest() -> None:
    job = Job(SEEN, View(16, 12), ROUND, True, 4, Saving(1.0, "none", False))
    others = [
        dataclasses.replace(job, scene=STILL),
        dataclasses.replace(job, view=View(16, 12, medium=rc.Medium(1.0))),
        dataclasses.replace(job, view=View(16, 12, medium=rc.Medium([1.0, 1.0, 1.0]))),
        dataclasses.replace(job, view=View(16, 12, suns=(rc.Sun([0, 1, 0]),))),
        dataclasses.replace(job, moves=Moves(turn_eye=np.nextafter(360.0, 0.0))),
        dataclasses.replace(job, closed=False),
        dataclasses.replace(job, frames=5),
        dataclasses.replace(job, saving=Saving(1.0, "none", True)),
    ]
    digests = {signed(each).digest for each in (job, *others)}
    assert len(digests) == 1 + len(others)
    assert signed(job).digest in digests


def test_the_job_file_says_what_it_is(tmp_path: Path) -> None:
    animate(LOOPED, tmp_path / "a", **small())
    content = json.loads((tmp_path / "a" / "job.json").read_text())
    assert (content["format"], content["scene"], content["frames"]) == (
        "refcloud.frames",
        "looped",
        4,
    )


class Backwards(Executor):
    """Runs everything that was asked for at once, in reverse."""

    def submit(self, fn, /, *args, **kwargs):
        future: Future = Future()
        self.waiting = [*getattr(self, "waiting", []), (future, fn, args)]
        if len(self.waiting) == 4:
            for future_, fn_, args_ in reversed(self.waiting):
                future_.set_result(fn_(*args_))
            self.waiting = []
        return future


SCENE = {"cloud": "man-10", "moves": ROUND, "tolerance": 1 / 255}


@pytest.mark.slow
def test_the_same_bits_whoever_draws(tmp_path: Path) -> None:
    animate(path=tmp_path / "here", **small(**SCENE))
    here = in_bytes(tmp_path / "here")
    animate(path=tmp_path / "processes", jobs=2, **small(**SCENE))
    with ThreadPoolExecutor(2) as threads:
        animate(path=tmp_path / "threads", executor=threads, **small(**SCENE))
    animate(path=tmp_path / "backwards", executor=Backwards(), **small(**SCENE))
    for how in ("processes", "threads", "backwards"):
        assert in_bytes(tmp_path / how) == here, how
    # Each frame is the picture of its own, drawn alone: nothing kept shows.
    scene = SCENES["man-10"]
    model = scene.model()
    assert scene.motion.eye is not None
    camera = scene.motion.eye(model, View(16, 12))
    way = camera.eye - camera.target
    quarter = np.array([way[2], way[1], -way[0]])
    eye = camera.target + quarter
    alone = rc.render(
        "man-10", camera=dataclasses.replace(camera, eye=eye), tolerance=1 / 255
    )
    off = np.abs(alone.codes().astype(int) - codes(tmp_path / "here")[1])
    assert off.max() <= 1, "cos 90 degrees is not exactly 0"


class Broken(Executor):
    """Draws two frames; then its workers are gone."""

    def submit(self, fn, /, *args, **kwargs):
        future: Future = Future()
        if args[1] < 2:
            future.set_result(fn(*args))
        else:
            future.set_exception(BrokenExecutor())
        return future


def test_a_worker_that_ends_is_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(ChildProcessError, match=r"got one that ended.*frames so far"):
        animate(LOOPED, tmp_path / "a", executor=Broken(), **small())
    assert len(codes(tmp_path / "a")) <= 2
    assert animate(LOOPED, tmp_path / "a", **small()).frames == 4


def test_a_refusal_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="look: expected none"):
        animate("demand-lit", tmp_path / "a.png", moves=ROUND, look="man", **small())
    assert list(tmp_path.iterdir()) == []


def test_only_a_few_frames_are_asked_for_ahead(tmp_path: Path) -> None:
    asked: list[int] = []

    class Counting(ThreadPoolExecutor):
        def submit(self, fn, /, *args, **kwargs):
            asked.append(args[1])
            return super().submit(fn, *args, **kwargs)

    view = View(16, 12)
    job = signed(
        Job(LOOPED, view, Moves(time=[0, 2]), True, 200, Saving(1, "none", False))
    )
    with Counting(1) as pool:
        frames = drawn(job, range(200), pool, 1)
        next(frames)
        assert len(asked) <= 64
        assert sum(1 for _ in frames) == 199
    assert sorted(asked) == list(range(200))


@pytest.mark.slow
def test_memory_does_not_grow_with_the_frames(tmp_path: Path) -> None:
    def collect(name: str, value: object) -> None:
        gc.collect(1)  # what waits for the collector is not kept

    def peak(frames: int, name: str) -> int:
        size = {"frames": frames, "width": 96, "height": 72}
        tracemalloc.start()
        animate(SEEN, tmp_path / name, moves=ROUND, observe=collect, **size)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(2, "warm.png")
    for suffix in ("png", "gif", "webp"):
        few, many = peak(4, f"few.{suffix}"), peak(44, f"many.{suffix}")
        # Seen: 0.1 MB. The codes of 40 more frames are 0.8 MB, their light 6.6 MB.
        assert many < few + 40 * 96 * 72 * 3 / 2, suffix


def test_light_is_carried_once_while_only_the_eye_moves(monkeypatch, tmp_path) -> None:
    """L15: pass 1 is the sun's work; an eye that goes around does not repeat it."""
    carried: list[str] = []
    scene = SCENES["man-10"]

    def watched(model, view):
        def observe(name, value):
            if name.endswith(" order"):
                carried.append(name)

        return scene.draw(model, dataclasses.replace(view, observe=observe))

    noted = dataclasses.replace(scene, draw=watched)
    animate(noted, tmp_path / "a", moves=ROUND, **small())
    assert carried.count("sun 0 order") == 1
    carried.clear()
    animate(noted, tmp_path / "b", moves=Moves(turn_sun=360.0), **small())
    assert carried.count("sun 0 order") == 4


@pytest.fixture(scope="module")
def cloud() -> rc.VoxelGrid:
    return rc.generate(diameters=[20, 11, 11], cell=5, relief=2, voxel=2.5)


@pytest.mark.parametrize("how", [{}, {"scattering": "multiple"}, {"method": "splat"}])
def test_a_cloud_map_is_drawn_as_render_draws_it(how, cloud, tmp_path: Path) -> None:
    settings = small(tolerance=1 / 255, **how)
    animate(cloud, tmp_path / "a", moves=Moves(turn_eye=90.0), **settings)
    first, *_, last = codes(tmp_path / "a")
    size = {k: settings[k] for k in ("width", "height", "tolerance")}
    np.testing.assert_array_equal(first, rc.render(cloud, **size, **how).codes())
    # The last frame drawn before any other.
    how_else = {"moves": Moves(turn_eye=90.0), "executor": Backwards()}
    animate(cloud, tmp_path / "b", **how_else, **settings)
    np.testing.assert_array_equal(codes(tmp_path / "b")[-1], last)


def test_balls_are_drawn_as_render_draws_them(tmp_path: Path) -> None:
    animate(BALLS, tmp_path / "a", moves=Moves(wind=[0.2, 0, 0]), **small(look="man"))
    first = rc.render(BALLS, width=16, height=12, look="man")
    np.testing.assert_array_equal(codes(tmp_path / "a")[0], first.codes())


def test_frames_beside_a_scene_take_what_it_brings(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="background: expected none beside a scene"):
        animate(
            "man-10", tmp_path / "a", moves=ROUND, background="transparent", **small()
        )


def test_frame_is_drawn_within_strict_arithmetic() -> None:
    def wrong(model, view):
        return rc.Picture(np.full((12, 16, 3), np.float64(1e300) * np.ones(1) * 1e300))

    scene = dataclasses.replace(LOOPED, draw=wrong)
    job = signed(Job(scene, View(16, 12), Moves(), True, 1, Saving(1.0, "none", False)))
    with np.errstate(all="ignore"), pytest.raises(FloatingPointError):
        draw_frame(job, 0)


@pytest.mark.parametrize("look", [None, "man"])
def test_a_sun_begins_to_turn_where_and_as_it_shines_at_rest(look) -> None:
    """Light scattered once has another sun in this scene than solved light."""
    of = dataclasses.replace(rc.scenes.cumulus.OWN, count=20, field=())
    scene = KINDS["cumulus"].scene("cumulus", "", of)
    view = View(12, 9, look=look, tolerance=0.1)
    moves = Moves(turn_sun=40.0)
    saving = Saving(1.0, "none", False)
    job = signed(Job(scene, view, moves, False, 2, saving))
    rest = scene.draw(scene.model(), view).codes(tone="none", dither=False)
    assert np.array_equal(draw_frame(job, 0).codes, rest)
    assert not np.array_equal(draw_frame(job, 1).codes, rest)
