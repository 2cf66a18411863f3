"""What a figure of a document is, and the table of all of them.

Every scene whose name follows a document (``man-04``, ``demand-lit``) is a figure as it
is; plots and diagrams are entered beside them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

from refcloud.checking import complaint
from refcloud.image import Picture
from refcloud.scene import SCENES, Scene, View

# How a name begins, and the document's letter; as in refcloud/references.py.
DOCUMENTS = {"man": "M", "shader": "S", "demand": "D", "simple": "C"}


@dataclass(frozen=True)
class Figure:
    """One figure of a document.

    Attributes
    ----------
    name
        What the command line calls it: the document, then the number or what it shows.
    number
        What the document calls it, such as "figure 3".
    title
        What it shows.
    draw
        Draws it.
    """

    name: str
    number: str
    title: str
    draw: Callable[[View], Picture]

    @property
    def document(self) -> str:
        """Give the letter of its document."""
        return DOCUMENTS[self.name.split("-")[0]]


# Names to plots and diagrams; each file of refcloud/scenes enters its own.
DRAWINGS: dict[str, Figure] = {}


def enter_figure(figure: Figure) -> Figure:
    """Enter a plot or a diagram into the table, and give it back."""
    DRAWINGS[figure.name] = figure
    return figure


def figure_of(scene: Scene, number: str = "") -> Figure:
    """Make a figure of a scene; its title may begin with the document's number."""
    head, colon, rest = scene.title.partition(": ")
    if colon and head.startswith("document "):
        head = ""
    title = rest if colon else scene.title
    return Figure(scene.name, number or (head if colon else ""), title, Drawn(scene))


@dataclass(frozen=True)
class Drawn:
    """Draws a scene with the clouds that it makes."""

    scene: Scene

    def __call__(self, view: View) -> Picture:
        """Draw it; the clouds' own times and notes come first."""
        model = self.scene.model()
        picture = self.scene.draw(model, view)
        return dataclasses.replace(
            picture,
            skipped=model.skipped + picture.skipped,
            seconds={**model.seconds, **picture.seconds},
            notes=model.notes + picture.notes,
        )


def figures() -> dict[str, Figure]:
    """Give every figure by its name, in the order of documents and names."""
    drawn = {
        name: figure_of(scene)
        for name, scene in SCENES.items()
        if name.split("-")[0] in DOCUMENTS
    }
    every = {**drawn, **DRAWINGS}
    order = list(DOCUMENTS)
    names = sorted(every, key=lambda name: (order.index(name.split("-")[0]), name))
    return {name: every[name] for name in names}


def find_figure(name: str) -> Figure:
    """Look a figure up, and name all of them where there is none of that name."""
    every = figures()
    if name not in every:
        raise ValueError(complaint("NAME", f"one of {', '.join(every)}", repr(name)))
    return every[name]
