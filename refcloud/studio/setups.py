"""What the page can show: each choice with its parameters and its recipe."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.camera import Camera, refuse_large
from refcloud.image import Picture
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.studio.knobs import Group, described, group_of, plain, taken
from refcloud.studio.recipe import Call, Recipe

# A page does not show more; the command line draws larger pictures.
MOST_WIDE, MOST_HIGH = 2048, 1536
TOLERANCE = 1.0 / 255.0
ROUGH = 8.0 / 255.0  # tolerance of a coarse frame

Values = Mapping[str, dict[str, Any] | None]


@dataclass(frozen=True)
class Frame:
    """The size of one picture, and whether there is time for it."""

    width: int
    height: int
    coarse: bool = False


@dataclass(frozen=True)
class Setup:
    """One choice of the page.

    Attributes
    ----------
    name, title
        As the address and the list have it.
    groups
        Its parameters.
    recipe
        Makes the recipe from their values.
    views
        Names of the intermediate views that it has, beside the picture.
    kind
        Under which heading the list has it.
    """

    name: str
    title: str
    groups: tuple[Group, ...]
    recipe: Callable[[Values, Frame], Recipe]
    views: tuple[str, ...] = ()
    kind: str = "build one"

    def described(self) -> dict[str, Any]:
        """Describe it to the page."""
        return {
            "name": self.name,
            "title": self.title,
            "kind": self.kind,
            "views": list(self.views),
            "groups": [described(group) for group in self.groups],
        }

    def taken(self, given: Any) -> Values:
        """Check the values of all blocks; a block that is missing starts as it does."""
        if not isinstance(given, dict):
            raise TypeError(complaint("values", "blocks by name", type(given).__name__))
        keys = [group.key for group in self.groups]
        for key in given:
            if key not in keys:
                expected = "one of " + ", ".join(keys)
                raise ValueError(complaint("values", expected, repr(str(key)[:60])))
        return {
            group.key: taken(group, given[group.key] if group.key in given else {})
            if group.key in given or group.on
            else None
            for group in self.groups
        }

    def started(self) -> dict[str, Any]:
        """Give the starting values as JSON knows them."""
        return {
            group.key: {name: plain(v) for name, v in group.started().items()}
            for group in self.groups
            if group.on
        }


def frame_of(width: int, height: int, *, coarse: bool = False) -> Frame:
    """Make a frame of a size that the page may ask for.

    Raises
    ------
    ValueError
        It is larger.
    """
    if not (0 < width <= MOST_WIDE and 0 < height <= MOST_HIGH):
        expected = f"1 x 1 to {MOST_WIDE} x {MOST_HIGH} pixels"
        advice = "larger pictures are drawn by refcloud render"
        raise ValueError(complaint("size", expected, f"{width} x {height}", advice))
    refuse_large(width, height)
    return Frame(width, height, coarse)


def differing(
    group: Group, values: Mapping[str, Any], *, without: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Pick the values that are not the library's defaults."""
    return {
        option.name: values[option.name]
        for option in group.options
        if option.name not in without and not _same(values[option.name], option.default)
    }


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.shape(a) == np.shape(b) and bool(np.all(np.asarray(a) == b))
    return type(a) is type(b) and a == b


# Blocks that several choices share.
def camera_group(start: Mapping[str, Any], **how: Any) -> Group:
    """Give the block of the eye."""
    return group_of(
        "camera", "Camera", Camera, without=("width", "height"), start=start, **how
    )


def sun_group(sun: Sun, **how: Any) -> Group:
    """Give the block of the sun."""
    start = {"direction": sun.direction.round(4), "irradiance": sun.irradiance.round(4)}
    return group_of("sun", "Light", Sun, start=start, **how)


def second_sun() -> Group:
    """Give the block of a second sun, off at first."""
    start = {"direction": np.array([0.7, 0.2, -0.6]), "irradiance": np.full(3, 6.0)}
    return group_of(
        "second_sun", "Second light", Sun, start=start, may_be_off=True, on=False
    )


def medium_group(medium: Medium, **how: Any) -> Group:
    """Give the block of the medium."""
    start = {name: getattr(medium, name) for name in ("sigma_t", "albedo", "g")}
    start["phase"] = medium.phase
    return group_of("medium", "What the cloud is made of", Medium, start=start, **how)


FILE = group_of("file", "The picture's file", Picture.codes)


def camera_call(groups: Mapping[str, Group], values: Values, frame: Frame) -> Call:
    """Write the camera."""
    return written_as("rc.Camera", Camera, groups, values, "camera").but(
        width=frame.width, height=frame.height
    )


def suns_of(groups: Mapping[str, Group], values: Values) -> tuple[Call, ...]:
    """Write the suns that are on."""
    return tuple(
        written_as("rc.Sun", Sun, groups, values, key)
        for key in ("sun", "second_sun")
        if values.get(key) is not None
    )


def written_as(
    text: str,
    kind: Callable[..., Any],
    groups: Mapping[str, Group],
    values: Values,
    key: str,
) -> Call:
    """Write a dataclass from a block's values."""
    return Call(text, kind, (), differing(groups[key], values[key] or {}))


def by_key(groups: tuple[Group, ...]) -> dict[str, Group]:
    """Give blocks by their keys."""
    return {group.key: group for group in groups}


def saving(values: Values) -> dict[str, Any]:
    """Give what the picture's file is written with."""
    return differing(FILE, values["file"] or {})
