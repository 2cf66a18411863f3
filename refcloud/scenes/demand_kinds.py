"""What the clouds in document D's box are made from, as files say it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from refcloud.checking import check_fields
from refcloud.conventions import Array, Positive, Range, Seed, Shape, Vector
from refcloud.lighting import Octaves
from refcloud.optics import Medium, Sun


@dataclass(frozen=True)
class Lumps:
    """The cloud in the box: what `refcloud.cloudmap.box_cloud` takes.

    Attributes
    ----------
    cell
        Between the points of the Worley noise.
    seed
        Which points.
    threshold
        Noise below it is empty.
    edge
        How far from each wall density is taken away, as shares of the box's halves.
    """

    cell: Annotated[float, Positive]
    seed: Seed
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)]
    edge: Annotated[Array, Shape(3), Range(0.0, 1.0)]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Boxed:
    """A cloud in its box.

    Attributes
    ----------
    lower, upper
        The box by its rear left lower and front right upper corner.
    cloud
        What stands in it.
    eye, target, fov_y
        The camera; of a picture 4 to 3.
    sun, medium
        What the cloud is lit by and made of.
    light
        How light is scattered in it.
    shone
        Whether a sun shines at all; by Beer's law alone every place shines by itself.
    frame
        What of the box is drawn.
    """

    lower: Vector
    upper: Vector
    cloud: Lumps
    eye: Vector
    target: Vector
    fov_y: Annotated[float, Range(0.01, 3.1, "radians")]
    sun: Sun
    medium: Medium
    light: Octaves
    shone: bool
    frame: Literal["walls", "lines", "none"]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Faces:
    """The wrong try: a texture on a box, by what `worley_smooth_texture` takes."""

    lower: Vector
    upper: Vector
    size: Annotated[int, Range(4, 256, "texels")]
    cells: Annotated[int, Range(1, 64)]
    seed: Seed
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)]

    def __post_init__(self) -> None:
        check_fields(self)
