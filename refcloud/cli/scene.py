"""``refcloud scene``: a named scene as a TOML file, to be changed and rendered."""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.cli.outputs import ready, say
from refcloud.cli.parser import Command
from refcloud.declared import save_scene
from refcloud.refusal import complaint
from refcloud.scenes.as_files import FILES

ABOUT = "Write a named scene as a TOML file, to be changed and rendered."
SUFFIXES = (".toml",)


def command() -> Command:
    """Give the command's argument."""
    made = Command("scene", ABOUT, output="name of the file; by default NAME.toml")
    made.argument("NAME", "which scene: " + ", ".join(FILES))
    return made


def run(words: Sequence[str]) -> int:
    """Write the scene's declaration."""
    given = command().parse(words)
    (name,) = given.arguments
    if name not in FILES:
        expected = "one of " + ", ".join(FILES)
        raise ValueError(complaint("NAME", expected, repr(name[:60])))
    path = ready(given.named(f"{name}.toml"), SUFFIXES)
    say(str(save_scene(path, FILES[name])))
    return 0
