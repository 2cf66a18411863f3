"""``refcloud animate`` gives what `animate` gives, and goes on where it stopped."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import refcloud as rc
from refcloud.cli.progress import Stages

from .test_entry import ROOT, Terminal

SIZE = "--width 16 --height 12"


def test_every_option_goes_to_the_library(run, here: Path) -> None:
    line = (
        f"animate balls.npz --frames 3 --fps 5 --turn-sun 40 --sun-axis 0 0 1"
        f" --turn-eye -30 --time 0 2 --wind 0.1 0 0 {SIZE} --sun 1 1 0 --sigma-t 2"
        " --look man --tolerance 0 --exposure 0.5 --no-dither -o a.gif"
    )
    status, out, err = run(*line.split())
    assert (status, err) == (0, "")
    moves = rc.Moves(
        turn_sun=40.0,
        sun_axis=[0, 0, 1],
        turn_eye=-30.0,
        time=[0, 2],
        wind=[0.1, 0, 0],
    )
    rc.animate(
        rc.load_metaballs("balls.npz"),
        "b.gif",
        frames=3,
        fps=5.0,
        moves=moves,
        width=16,
        height=12,
        suns=rc.Sun([1, 1, 0], rc.choices.SUN.irradiance),
        medium=rc.Medium(2.0, 0.9),  # the albedo of the paper
        look="man",
        exposure=0.5,
        dither=False,
    )
    assert Path("a.gif").read_bytes() == Path("b.gif").read_bytes()
    lines = out.splitlines()
    assert lines[0] == "balls.npz: 2 balls"
    assert lines[1].endswith("albedo 0.9; no sigma_t counts")
    assert lines[2] == "frames: 3; the way does not close"
    assert re.fullmatch(r"seconds: load .*, frames .*, file .*, total .*", lines[-2])
    assert lines[-1] == "a.gif"


def test_a_scene_s_frames_are_kept(run, here: Path) -> None:
    line = f"animate man-10 --frames 2 --turn-eye 360 {SIZE} -o frames"
    assert "frames: 2; the way closes\n" in run(*line.split()).out
    Path("frames/frame-0001.png").unlink()
    ended = run(*line.split())
    assert "frames: 2, 1 of them kept from before; the way closes\n" in ended.out
    assert ended.out.splitlines()[-1] == "frames"
    other = run(*line.replace("360", "90").split())
    assert other.status == 2
    assert other.err == (
        "refcloud: --output: expected frames to be empty, or to hold frames of the same"
        " job, got frames that were drawn with other parameters; choose another name,"
        " or give --redraw to draw them anew\n"
    )
    again = run(*line.replace("360", "90 --redraw").split())
    assert "frames: 2; the way does not close\n" in again.out


def test_the_default_name_says_what_it_is(run, here: Path) -> None:
    run(*f"animate demand-perlin --frames 2 --time 0 1 {SIZE}".split())
    assert Path("demand-perlin-animation.png").is_file()
    assert not Path("demand-perlin-animation.png.frames").exists()


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_says_how_long_is_left(is_terminal, monkeypatch) -> None:
    screen = Terminal(is_terminal)
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr("refcloud.cli.progress.PATIENCE", 0.01)
    stages = Stages()
    with stages.stage("frames"):
        stages.count(3, 24, 83.4)
        while "frames" not in screen.text:
            time.sleep(0.001)
    assert "refcloud: frames, 0 s, 3 of 24, 1 min 23 s left" in screen.text


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_request_to_terminate_keeps_the_frames_and_ends_every_process(
    jobs: int, here: Path
) -> None:
    line = f"animate man-10 --frames 9999 --turn-eye 9 {SIZE} --jobs {jobs} -o a"
    with subprocess.Popen(
        [sys.executable, "-m", "refcloud", *line.split()],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        while process.poll() is None and not list(here.glob("a/frame-*.png")):
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate()
    assert (process.returncode, out) == (143, "")
    last = err.splitlines()[-1]
    found = re.fullmatch(
        r"refcloud: terminated; (\d+) frames? (is|are) in a, and the same command again"
        " goes on from there",
        last,
    )
    assert found, err
    assert len(list(here.glob("a/frame-*.png"))) == int(found[1])
    assert "leaked" not in err
    assert not list(here.glob("a/*.part"))
    end = time.monotonic() + 20.0  # the tracker of semaphores goes last
    while _any_lives(process.pid) and time.monotonic() < end:
        time.sleep(0.01)
    assert not _any_lives(process.pid)


def _any_lives(session: int) -> bool:
    try:
        os.killpg(session, 0)
    except ProcessLookupError:
        return False
    return True
