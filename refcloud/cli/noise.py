"""``refcloud noise``: a picture of one kind of noise."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from typing import cast, get_args

from refcloud.cli.docstrings import summary
from refcloud.cli.options import options_of
from refcloud.cli.outputs import OVER, ready, report
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.noise_pictures import Kind, noise_picture
from refcloud.refusal import complaint

ABOUT = summary(noise_picture)
OPTIONS = options_of(noise_picture, without=("kind",))
SUFFIXES = (".png", ".npy")
KINDS = get_args(Kind)
OTHER_NAMES = {"perlin": "gradient", "worley": "worley_f1"}  # what many call them


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "noise",
        ABOUT,
        output="name of the picture (.png or .npy); by default KIND-VIEW.png" + OVER,
    )
    made.argument("KIND", "which noise: " + ", ".join(KINDS))
    made.group("the noise", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Draw a kind of noise; its codes are 255 times its values."""
    given = command().parse(words)
    (kind,) = given.arguments
    if kind not in KINDS:
        near = (
            [OTHER_NAMES[kind]]
            if kind in OTHER_NAMES
            else get_close_matches(kind, KINDS, 1)
        )
        advice = f"did you mean {near[0]}?" if near else ""
        expected = "one of " + ", ".join(KINDS)
        raise ValueError(complaint("KIND", expected, repr(kind[:60]), advice))
    chosen = given.of(OPTIONS)
    path = ready(given.named(f"{kind}-{chosen.get('view', 'slice')}.png"), SUFFIXES)
    stages = Stages()
    with stages.stage("draw"):
        picture = noise_picture(cast(Kind, kind), **chosen)
    with stages.stage("save"):
        picture.save(path, tone="none", dither=False)
    report(picture.notes, picture.skipped, stages.line(), path)
    return 0
