"""``refcloud scene``: a named scene as a TOML file, to be changed and rendered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from refcloud.cli.options import options_of
from refcloud.cli.outputs import ready, say
from refcloud.cli.parser import Command
from refcloud.declared import save_scene
from refcloud.refusal import complaint
from refcloud.scenes.as_files import FILES

ABOUT = "Write a named scene as a TOML file, to be changed and rendered."
SUFFIXES = (".toml",)


@dataclass(frozen=True)
class Writing:
    """How the file is written.

    Attributes
    ----------
    force
        Write over a file that is there.
    """

    force: bool = False


FORCE = options_of(Writing)


def command() -> Command:
    """Give the command's argument."""
    made = Command(
        "scene",
        ABOUT,
        output="name of the file; by default NAME.toml; a file of that name is kept,"
        " unless with --force",
    )
    made.group("the file", "", FORCE)
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
    if path.exists() and not given.of(FORCE).get("force", False):
        advice = "choose another name, or add --force to write over it"
        raise ValueError(complaint("--output", "a new file", f"{path}", advice))
    say(str(save_scene(path, FILES[name])))
    return 0
