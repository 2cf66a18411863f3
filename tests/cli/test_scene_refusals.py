"""What a scene's file asks for and cannot be drawn is refused by file and key."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import contents

HEAD = 'format = "refcloud.scene"\nversion = 1\n'
BAD = {
    HEAD + 'kind = "cumulus"\n[parameters]\nfield_voxel = 0.001': (
        "parameters.field_voxel: expected a grid of at most "
    ),
    HEAD + "[[cloud]]\n[[cloud]]\n[cloud.shape]\nvoxel = 0.001": (
        "cloud[1].shape.voxel: expected a grid of at most "
    ),
    HEAD + "[[cloud]]\nair = 1e-300": "cloud[0].air: expected sizes of at least ",
    HEAD + "[[cloud]]\nat = [1e60, 0, 0]": "cloud[0].at: expected places",
    HEAD + "[[cloud]]\n[cloud.balls]\ncount = 4\ntolerance = 0.1": "cloud[0].balls.",
}


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
@pytest.mark.parametrize(
    "command", ["render a.toml", "animate a.toml --frames 2 --turn-eye 9 -o a"]
)
def test_file_and_key_are_named(command: str, text: str, run, here: Path) -> None:
    small = "\n[cloud.shape]\ndiameters = [9, 8, 8]"
    Path("a.toml").write_text(text.replace("[[cloud]]\n[[", f"[[cloud]]{small}\n[["))
    before = contents(here)
    ended = run(*command.split(), "--width", 16, "--height", 12)
    assert ended.status == 2
    assert ended.err.startswith(f"refcloud: a.toml: {BAD[text]}"), ended.err
    assert ended.err.count("\n") == 1
    assert contents(here) == before
