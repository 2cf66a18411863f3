"""``refcloud animate``: a cloud or a named scene in frames, as one file or a folder."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from refcloud.animation import Moves, Progress, animate
from refcloud.animation.job import folder_of, held
from refcloud.cli.clouds import find
from refcloud.cli.docstrings import summary
from refcloud.cli.options import Option, options_of
from refcloud.cli.outputs import OVER, ready, ready_folder, report
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.cli.render import (
    OPTIONS,
    SAVING,
    add_groups,
    chosen_of,
    prepared,
)
from refcloud.image.animation import SUFFIXES
from refcloud.refusal import complaint

ABOUT = summary(animate)
MOVES = options_of(Moves)
OWN = ("frames", "fps", "jobs", "redraw")
FRAMES = tuple(option for option in options_of(animate) if option.name in OWN)


def _smaller(option: Option) -> Option:
    """Give an option of pictures the default that it has for frames."""
    own = {mine.name: mine.default for mine in options_of(animate)}
    if option.name != "quality":
        return option
    return dataclasses.replace(option, default=own["quality"])


PICTURE = tuple(_smaller(option) for option in OPTIONS)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "animate",
        ABOUT,
        output="an animated file (.png, .apng, .gif or .webp), or a folder for the"
        " frames themselves; by default WHAT-animation.png" + OVER,
    )
    made.argument("WHAT", "a scene (see refcloud list), or a cloud's file, as render")
    made.group("the frames", "", FRAMES)
    made.group("what moves", "", MOVES)
    add_groups(made, PICTURE)
    return made


def run(words: Sequence[str]) -> int:
    """Animate a cloud and write its frames."""
    given = command().parse(words)
    what = given.arguments[0]
    find(what)
    name = Path(what).stem
    own, chosen = given.of(FRAMES), chosen_of(given)
    if "frames" not in own:
        raise ValueError(complaint("--frames", "how many pictures", "none"))
    path = Path(given.named(f"{name}-animation.png"))
    if path.suffix and not path.is_dir():
        ready(path, SUFFIXES, inputs=[what])
    else:
        ready_folder(path)
    stages = Stages()
    cloud, parts, notes = prepared(given, chosen, stages)

    def watch(name: str, value: Any) -> None:
        if isinstance(value, Progress):
            stages.count(value.done, value.frames, value.left)

    with stages.stage("frames"), _worded(), _going_on(path, own.get("redraw", False)):
        made = animate(
            cloud,
            path,
            moves=Moves(**given.of(MOVES)),
            **own,
            **parts,
            **chosen,
            **given.of(SAVING),
            observe=watch,
        )
    stages.seconds.pop("frames")
    stages.seconds.update(made.seconds)
    kept = f", {made.kept} of them kept from before" if made.kept else ""
    end = "the way closes" if made.closed else "the way does not close"
    notes.append(f"frames: {made.frames}{kept}; {end}")
    report([*notes, *made.notes], made.skipped, stages.line(), made.path)
    return 0


@contextmanager
def _going_on(path: Path, redraw: bool) -> Iterator[None]:
    """Let an interrupt say where the frames are, if any, and how to go on from them."""
    try:
        yield
    except KeyboardInterrupt as end:
        frames = folder_of(path)
        count = len(held(frames))
        if count:
            again = "the same command again" + (" without --redraw" if redraw else "")
            verb = "frame is" if count == 1 else "frames are"
            raise type(end)(
                f"{count} {verb} in {frames}, and {again} goes on from there"
            ) from None
        raise


@contextmanager
def _worded() -> Iterator[None]:
    """Name what can move as it is typed, where nothing or something else was asked."""
    try:
        yield
    except ValueError as refusal:
        text = str(refusal)
        if text.startswith("moves: ") or "what can move: " in text:
            for option in MOVES:
                text = re.sub(rf"\b{option.name}(?=[,)]|$)", option.flag, text)
        raise ValueError(text) from None
