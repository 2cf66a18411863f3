"""``refcloud compare``: whether two pictures pass for the same, and where not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from refcloud.cli.docstrings import summary
from refcloud.cli.options import options_of
from refcloud.cli.outputs import OVER, ready, report, say
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.image import (
    compare_codes,
    difference_picture,
    load_picture,
    read_png,
)
from refcloud.paths import refuse_path
from refcloud.refusal import complaint, counted

ABOUT = summary(compare_codes)
OPTIONS = options_of(compare_codes, without=("a", "b"))
SHOWING = options_of(difference_picture)
SUFFIXES = (".png", ".npy")
SAME, DIFFERENT = 0, 1
COLOURS, OPAQUE = 3, 255  # channels before the alpha, and its largest code


def command() -> Command:
    """Give the command's arguments and options."""
    made = Command(
        "compare",
        f"{ABOUT} Ends with status 0 if they do, 1 if not, 2 on bad input.",
        output="name of a picture of the difference (.png or .npy); by default none"
        + OVER,
    )
    made.argument("A", "a picture (.png, or .npy of linear light)")
    made.argument("B", "a picture of the same size")
    made.group("what passes", "", OPTIONS)
    made.group("the picture of the difference", "", SHOWING)
    return made


def run(words: Sequence[str]) -> int:
    """Compare two pictures and give the verdict as exit status."""
    given = command().parse(words)
    path, (first, second) = given.output, given.arguments
    if path is not None:
        path = ready(path, SUFFIXES, inputs=given.arguments)
    for name, file in (("A", first), ("B", second)):
        refuse_path(name, file)
        if Path(file).suffix.lower() not in SUFFIXES:
            expected = "a picture, by a name ending in " + " or ".join(SUFFIXES)
            raise ValueError(complaint(name, expected, repr(file[:60])))
    stages = Stages()
    with stages.stage("load"):
        a, b = codes_of(first), codes_of(second)
    notes: list[str] = []
    if a.shape[2] != b.shape[2]:
        # Only one of them has an alpha: without a meaning it is left out.
        a = _without_alpha(a, first, second, notes)
        b = _without_alpha(b, second, first, notes)
    if a.shape != b.shape:
        advice = "only pictures of one size are compared"
        raise ValueError(complaint(second, f"{_size(a)} as {first}", _size(b), advice))
    with stages.stage("compare"):
        found = compare_codes(a, b, **given.of(OPTIONS))
    if path is not None:
        with stages.stage("save"):
            shown = difference_picture(
                load_picture(first), load_picture(second), **given.of(SHOWING)
            )
            shown.save(path, tone="none", dither=False)
    say("same" if found.same else "different")
    notes += [
        f"largest difference: {counted(found.worst, 'code')}",
        f"pixels off: {100.0 * found.off_share:.4g} %",
    ]
    notes += [
        f"worst pixel: row {row}, column {column}, {counted(off, 'code')}"
        for row, column, off in found.worst_pixels
    ]
    report(notes, (), stages.line(), path)
    return SAME if found.same else DIFFERENT


def codes_of(path: str) -> np.ndarray:
    """Read a picture's codes; linear light is encoded plainly."""
    if Path(path).suffix.lower() == ".png":
        return read_png(path)
    return load_picture(path).codes(tone="none", dither=False)


def _without_alpha(
    codes: np.ndarray, path: str, other: str, notes: list[str]
) -> np.ndarray:
    """Leave out an opaque alpha, and say so; refuse one that lets light through."""
    if codes.shape[2] == COLOURS:
        return codes
    clear = int(np.count_nonzero(codes[..., COLOURS] < OPAQUE))
    if clear:
        expected = f"an opaque picture beside {other}, which has no alpha"
        verb = "is" if clear == 1 else "are"
        got = f"{counted(clear, 'pixel')} that {verb} not opaque"
        advice = "draw it before a background, or compare it with one that has an alpha"
        raise ValueError(complaint(path, expected, got, advice))
    notes.append(f"{path}: its alpha is opaque, and left out")
    return codes[..., :COLOURS]


def _size(codes: np.ndarray) -> str:
    height, width, channels = codes.shape
    return f"{width} x {height} pixels of {channels} channels"
