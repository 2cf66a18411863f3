"""``refcloud list``: the named scenes and what they show."""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.cli.outputs import say
from refcloud.cli.parser import Command
from refcloud.scenes import SCENES

ABOUT = "List the named scenes that refcloud render draws."


def run(words: Sequence[str]) -> int:
    """Print a line for each scene."""
    Command("list", ABOUT).parse(words)
    width = max(len(name) for name in SCENES)
    for name, scene in sorted(SCENES.items()):
        say(f"{name:{width}}  {scene.title}")
    return 0
