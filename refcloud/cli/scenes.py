"""``refcloud list``: the named scenes and figures, and what they show."""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.cli.outputs import say
from refcloud.cli.parser import Command
from refcloud.figure import figures
from refcloud.scenes import SCENES

ABOUT = "List the scenes that refcloud render draws, and the figures beside them."


def run(words: Sequence[str]) -> int:
    """Print a line for each scene, then one for each figure that is no scene."""
    Command("list", ABOUT).parse(words)
    drawn = {name: f for name, f in figures().items() if name not in SCENES}
    width = max(map(len, (*SCENES, *drawn)))
    for name, scene in sorted(SCENES.items()):
        say(f"{name:{width}}  {scene.title}")
    for name, figure in drawn.items():
        what = f"document {figure.document}, {figure.number}: {figure.title}"
        say(f"{name:{width}}  {what} (refcloud figure {name})")
    return 0
