"""The parameters of document S's scenes, with their ranges; the scenes give values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from refcloud.checking import check_fields
from refcloud.conventions import Colour, Positive, Range, Seed
from refcloud.optics import Sun
from refcloud.sky import Cover, Displacement, Dome, FlatBase, Fog, Plane, Puff, Sphere

Octaves = Annotated[int, Range(1, 16)]
Cells = Annotated[float, Range(0.01, 1000.0, "cells")]
WholeCells = Annotated[int, Range(1, 512, "cells")]
Texels = Annotated[int, Range(16, 2048, "texels")]


@dataclass(frozen=True)
class Kept:
    """What checks its fields."""

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class PlaneSky(Kept):
    """Clouds on a plane: simplex noise of x, z and time."""

    surface: Plane
    cover: Cover
    fog: Fog
    seed: Seed
    octaves: Octaves


@dataclass(frozen=True)
class TwoCovers(Kept):
    """The same plane by the first try's cover, and by its own."""

    first: Cover
    sky: PlaneSky


@dataclass(frozen=True)
class SolidSky(Kept):
    """Clouds on a sphere: noise of three coordinates and time, cells per scene unit."""

    surface: Sphere
    cover: Cover
    seed: Seed
    octaves: Octaves
    cells: Cells
    period: WholeCells


@dataclass(frozen=True)
class DomeSky(Kept):
    """A texture of so many cells and texels on a half-sphere."""

    surface: Dome
    cover: Cover
    seed: Seed
    octaves: Octaves
    cells: WholeCells
    size: Texels


@dataclass(frozen=True)
class SphereSky(Kept):
    """A texture of so many cells and texels around a sphere, or in its space."""

    surface: Sphere
    cover: Cover
    seed: Seed
    octaves: Octaves
    cells: WholeCells
    size: Texels


@dataclass(frozen=True)
class LitLayer(Kept):
    """A layer with a flat base, its noise as a texture, its light and its air."""

    layer: FlatBase
    base: Plane
    seed: Seed
    octaves: Octaves
    cells: WholeCells
    size: Texels
    sun: Sun
    sky_light: Colour
    fog: Fog


@dataclass(frozen=True)
class TwoFogs(Kept):
    """Fog as printed and mended over one view of a ground, balls and a sky."""

    printed: Fog
    mended: Fog
    ground: Plane
    sky: Plane
    cover: Cover
    sun: Sun


@dataclass(frozen=True)
class NoiseBalls(Kept):
    """Four balls of noise: cells per radius, and texels around the wrapped ones."""

    seed: Seed
    cells: Cells
    size: Texels
    sun: Sun


@dataclass(frozen=True)
class LitPuff(Kept):
    """A puff and its light.

    Attributes
    ----------
    puff
        Its density.
    steps, step
        Samples toward the sun, and how far apart.
    sigma_t, opacity
        Extinction on that way, and toward the eye.
    smoke, shade
        Its colours in the sun and in the shade.
    sun
        The light.
    """

    puff: Puff
    steps: Annotated[int, Range(1, 1000)]
    step: Annotated[float, Positive]
    sigma_t: Annotated[float, Range(0.0, 1000.0, "1/scene unit")]
    opacity: Annotated[float, Range(0.0, 1000.0)]
    smoke: Colour
    shade: Colour
    sun: Sun


@dataclass(frozen=True)
class Bubble(Kept):
    """A distorted sphere, and the noise of its texture."""

    shape: Displacement
    cover: Cover
    color: Colour
    seed: Seed
    octaves: Octaves
    cells: Cells
    period: WholeCells
    sun: Sun


@dataclass(frozen=True)
class Raw(Kept):
    """The hash itself: which numbers, and how many squares along the longer side."""

    seed: Seed
    across: Annotated[int, Range(1, 4096)]
