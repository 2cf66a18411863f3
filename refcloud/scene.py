"""What a named scene is, and the table of all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from refcloud.camera import AnyCamera
from refcloud.checking import checked, complaint
from refcloud.conventions import SIZES, Array, Backend, Observer, Skipped
from refcloud.image import Picture
from refcloud.lighting import Look
from refcloud.lighting.look import LookName
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun

Use = Literal["scattering", "seed"]


@dataclass(frozen=True)
class View:
    """How a scene is to be drawn; what is None the scene chooses itself.

    `time` is a coordinate of the scene's noise, in its own units; `offset` how far the
    wind has carried what it carries, shape (3,), scene units. `kept` is a store for
    what the next picture of the same scene may use again, with the same bits.
    """

    width: int
    height: int
    camera: AnyCamera | None = None
    suns: tuple[Sun, ...] | None = None
    medium: Medium | None = None
    look: Look | LookName | None = None
    tolerance: float = 0.0
    seed: int = 0
    observe: Observer | None = None
    backend: Backend = "numpy"
    scattering: Literal["single", "multiple"] | None = None
    time: float = 0.0
    offset: Array | None = None
    kept: dict[Any, Any] | None = None


@dataclass(frozen=True)
class Model:
    """The clouds of a scene, by name, and how they came about."""

    clouds: Mapping[str, Metaballs]
    notes: tuple[str, ...] = ()
    skipped: tuple[Skipped, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Motion:
    """What of a scene can move, and after how much of it the scene is the same again.

    Attributes
    ----------
    eye
        Gives the scene's own camera; None where there is no eye.
    suns
        The scene's own suns; none where no sun shines.
    turns
        Whether the eye goes "around" its target, or turns "in place".
    period
        Time after which the scene repeats itself; infinite where it never does, None
        where it knows no time.
    repeats
        Lengths along x, y and z after which wind brings the same again, for scenes that
        read ``view.offset``; None where wind carries the eye the other way.
    """

    eye: Callable[[Model, View], AnyCamera] | None = None
    suns: tuple[Sun, ...] = ()
    turns: Literal["around", "in place"] = "around"
    period: float | None = None
    repeats: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Own:
    """What a scene is drawn with where the view leaves the choice to it.

    What is None a scene does not take. A view with these very values gives the same
    picture as one without: who changes a single number starts from here.

    Attributes
    ----------
    suns
        Its suns; none where no sun shines unless one is given.
    medium, look
        What its clouds are made of, and the rules of light.
    scattering
        How often light is scattered, where a view may choose.
    open
        Fields of the medium that only the clouds can tell, when they are not made yet.
    camera
        Its eye; of `own_of`.
    """

    suns: tuple[Sun, ...] | None = None
    medium: Medium | None = None
    look: Look | None = None
    scattering: Literal["single", "multiple"] | None = None
    open: tuple[str, ...] = ()
    camera: AnyCamera | None = None


@dataclass(frozen=True)
class Scene:
    """A named scene: its clouds, and how they are drawn.

    Attributes
    ----------
    name, title
        What the command line calls it, and what it shows.
    model
        Makes the clouds.
    draw
        Draws them.
    motion
        What of it can move; by default nothing.
    uses
        Which of a view's choices change its picture; it is refused a scattering, and
        its picture says that a seed changes nothing, where they are not among them.
    brings
        Gives what it is drawn with, but for the eye, for clouds (None before they are
        made) and a view; None where the scene does not say.
    frames
        Whether its eye frames its clouds, which are made first.
    """

    name: str
    title: str
    model: Callable[[], Model]
    draw: Callable[[Model, View], Picture]
    motion: Motion = Motion()
    uses: tuple[Use, ...] = ()
    brings: Callable[[Model | None, View], Own] | None = None
    frames: bool = False


# Names to scenes; each file of refcloud/scenes enters its own.
SCENES: dict[str, Scene] = {}


def enter(scene: Scene) -> Scene:
    """Enter a scene into the table, and give it back."""
    SCENES[scene.name] = scene
    return scene


@checked
def own_of(
    scene: Scene | str, view: View | None = None, model: Model | None = None
) -> Own:
    """Give what a scene is drawn with, as far as it can be told.

    Parameters
    ----------
    scene
        Which, or its name.
    view
        What of it is chosen: parts that are not None count as they are. None is a view
        of the size that `render` gives a picture, with nothing chosen.
    model
        Its clouds; None while they are not made.

    Returns
    -------
    The scene's own camera, suns, medium and look; nothing where it does not say.

    Raises
    ------
    ValueError
        No scene has that name.

    Source: project, W03.

    Examples
    --------
    >>> import refcloud as rc
    >>> own = own_of("cumulus")
    >>> denser = replace(own.medium, sigma_t=3.0)  # for rc.render("cumulus", medium=...
    >>> denser.albedo
    0.97
    """
    scene = find_scene(scene) if isinstance(scene, str) else scene
    view = View(*SIZES["final"]) if view is None else view
    if scene.brings is None:
        return Own()
    bare = replace(view, camera=None)  # the scene's own eye, not the view's
    own = scene.brings(model, bare)
    eye = scene.motion.eye
    if eye is None or own.camera is not None or (scene.frames and model is None):
        return own
    return replace(own, camera=eye(model or Model({}), bare))


def find_scene(name: str) -> Scene:
    """Look a scene up, and name all of them where there is none of that name."""
    if name not in SCENES:
        known = ", ".join(sorted(SCENES))
        expected, advice = f"one of {known}", ""
        if name.endswith(".toml"):
            advice = "a file: refcloud.declared.scene_from(load_scene(name)) is a scene"
        elif name.endswith(".npz"):
            advice = "a file: load_voxels or load_metaballs gives what is rendered"
        raise ValueError(complaint("scene", expected, repr(name[:60]), advice))
    return SCENES[name]
