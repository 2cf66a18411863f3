"""What a declared scene is: clouds, eye, suns, medium, look and sky."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.checking import check_fields
from refcloud.conventions import Positive, Range, Vector
from refcloud.extremes import refuse_far, refuse_small
from refcloud.lighting import Look
from refcloud.optics import Medium, Sun
from refcloud.sky import Sky

# As far as coordinates go: a picture shows no more of a cloud that is scaled further.
Scale = Annotated[float, Range(1e-6, 1e6)]
FORMAT, VERSION = "refcloud.scene", 1


@dataclass(frozen=True)
class Placement:
    """Where a declared cloud stands.

    Attributes
    ----------
    at
        Its place, shape (3,), scene units.
    turn
        About the upright axis, radians.
    scale
        Factor on its size.
    air
        Distance over which its light falls to 1/e, scene units; None for clear air.
    prune
        Whether balls that add nothing are taken out.
    even
        Whether every ball has density 1, as in the paper's figures 8 to 10.
    """

    at: Vector = field(default_factory=lambda: np.zeros(3))
    turn: Annotated[float, Range(-7.0, 7.0, "radians")] = 0.0
    scale: Scale = 1.0
    air: Annotated[float, Positive] | None = None
    prune: bool = False
    even: bool = False

    def __post_init__(self) -> None:
        check_fields(self)
        refuse_far("at", self.at)
        if self.air is not None:
            refuse_small("air", self.air)


@dataclass(frozen=True)
class Cloud:
    """One declared cloud: its shape, its balls, its place, and what its look changes.

    `balls` is None for one ball to each voxel.
    """

    shape: Mapping[str, Any] = field(default_factory=dict)
    balls: Mapping[str, Any] | None = None
    place: Placement = field(default_factory=Placement)
    look: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Declaration:
    """A scene as a file says it; clouds stand in their order, the farthest first.

    Without a camera the last cloud is framed. With scattering "multiple" light of every
    order is solved.
    """

    name: str
    title: str
    clouds: tuple[Cloud, ...]
    camera: Mapping[str, Any] | None = None
    suns: tuple[Sun, ...] = ()
    medium: Medium | None = None
    look: Look = field(default_factory=Look)
    sky: Sky = field(default_factory=Sky)
    scattering: Literal["single", "multiple"] = "single"
