"""Scenes that are not splatted clouds: each is a kind of its own, with its parameters.

A kind's parameters are one frozen dataclass with annotated fields; some are dataclasses
themselves (a sun, a medium, a cover), or rows of them. A file names the kind and gives
what it changes: what it leaves out stays as the scene of that name has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from refcloud.checking import complaint
from refcloud.image import Picture
from refcloud.scene import Model, Motion, Own, Scene, Use, View, enter


def nothing_yet(of: Any) -> Model:
    """Make no clouds before the picture is asked for."""
    return Model({})


def nothing_own(of: Any, model: Model | None, view: View) -> Own:
    """Take no suns, medium or look."""
    return Own()


def sun_alone(of: Any, model: Model | None, view: View) -> Own:
    """Take suns, and have one in the parameters."""
    return Own((of.sun,))


def told(draw: Callable[..., Picture], of: Any, model: Model, view: View) -> Picture:
    """Call a drawing that takes its parameters by the name `of`."""
    return draw(model, view, of=of)


@dataclass(frozen=True)
class Kind:
    """One way to draw, and the parameters that the scene of its name has.

    Attributes
    ----------
    name, title
        Of that scene.
    own
        Its parameters: a frozen dataclass with annotated fields.
    draw
        Draws a picture, from parameters, clouds and a view.
    motion
        Says, from parameters, what can move.
    model
        Makes the clouds, from parameters.
    uses
        As of `Scene`.
    brings
        Gives what the scene is drawn with, from parameters, clouds and a view.
    """

    name: str
    title: str
    own: Any
    draw: Callable[[Any, Model, View], Picture]
    motion: Callable[[Any], Motion]
    model: Callable[[Any], Model] = nothing_yet
    uses: tuple[Use, ...] = ()
    brings: Callable[[Any, Model | None, View], Own] = nothing_own

    def scene(self, name: str, title: str, of: Any) -> Scene:
        """Make a scene of this kind with parameters `of`."""
        model, draw = partial(self.model, of), partial(self.draw, of)
        brings = partial(self.brings, of)
        return Scene(name, title, model, draw, self.motion(of), self.uses, brings)


@dataclass(frozen=True)
class Changed:
    """A scene as a file says it: a kind, and its parameters."""

    name: str
    title: str
    kind: str
    of: Any


# Names to kinds; each file of refcloud/scenes enters its own.
KINDS: dict[str, Kind] = {}


def enter_kind(kind: Kind) -> Scene:
    """Enter a kind into the table, and its scene into that of scenes."""
    KINDS[kind.name] = kind
    return enter(kind.scene(kind.name, kind.title, kind.own))


def find_kind(name: str) -> Kind:
    """Look a kind up, and name all of them where there is none of that name."""
    if name not in KINDS:
        known = ", ".join(KINDS)
        raise ValueError(complaint("kind", f"one of {known}", repr(name[:60])))
    return KINDS[name]


def declared_kind(name: str) -> Changed:
    """Give a named scene as a file would say it."""
    kind = find_kind(name)
    return Changed(kind.name, kind.title, kind.name, kind.own)
