"""What the studio saves as TOML, drawn by ``refcloud render``."""

from __future__ import annotations

import tomllib
from pathlib import Path

from refcloud.choices import size_of
from refcloud.cli.parser import Given
from refcloud.image import Picture
from refcloud.refusal import complaint
from refcloud.studio.recipe import Kept, cooked
from refcloud.studio.scene_file import FORMAT, scene_of
from refcloud.studio.setups import frame_of

MOST_BYTES = 256_000  # the page writes a few hundred
ALLOWED = {"--width", "--height", "--output"}


def is_studio_file(what: str) -> bool:
    """Tell whether a file says that the studio wrote it."""
    path = Path(what)
    if path.suffix != ".toml" or not path.is_file():
        return False
    if path.stat().st_size > MOST_BYTES:
        return False
    try:
        return tomllib.loads(path.read_text("utf-8-sig")).get("format") == FORMAT
    except (ValueError, RecursionError):
        return False  # the reader of scene files says what is wrong


def studio_picture(given: Given, what: str) -> tuple[Picture, dict]:
    """Draw a file of the studio, as large as typed; give its own way to be saved.

    Raises
    ------
    ValueError, TypeError
        A value does not fit, or an option beside the file is typed.
    """
    others = sorted(set(given.options) - ALLOWED)
    if others:
        expected = "none beside a file of the studio, which brings its own"
        raise ValueError(complaint(others[0], expected, "one"))
    setup, values = scene_of(Path(what).read_text("utf-8-sig"))
    width, height = (given.options.get(side) for side in ("--width", "--height"))
    size = size_of(width, height, "final")
    recipe = setup.recipe(values, frame_of(*size))
    picture = cooked(recipe, Kept())[recipe.stages[-1].name]
    return picture, dict(recipe.saving)
