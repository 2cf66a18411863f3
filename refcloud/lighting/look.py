"""Which rules carry the light from ball to ball: the paper's, or the extended ones."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields
from refcloud.conventions import WHOLE_SPHERE, Array, Colour, Range
from refcloud.optics import TAU_MAN2003
from refcloud.optics.media import Share

Side = Annotated[int, Range(1, 4096, "pixels")]
LookName = Literal["cumulus", "man"]

# The sky's and the ground's light on a cloud, by eye.
SKY_LIGHT = 0.75 * np.array([0.27, 0.40, 0.62])
GROUND_LIGHT = 0.75 * np.array([0.16, 0.18, 0.21])


@dataclass(frozen=True)
class Look:
    """The rules of the two passes.

    The defaults are the look "cumulus". `named` gives "man", the paper to the letter:
    every extension off.

    Attributes
    ----------
    scattering
        Light handed on by a ball: "man2003" is eq 26, kappa tau guarded; "split" does
        not change when a ball is split into thinner ones.
    transmittance
        "beer", exp(-tau w), or "linear", the paper's blend 1 - (1 - T) w (E25).
    footprint
        "chord", the integral along the line of sight, or "profile", the paper's map of
        eq 12 (E04).
    readback
        Mean over the ball's "disc", over the disc with "antialiased" edges, over its
        "square", or weighted by its "footprint" (E27).
    tau
        Optical depth of every ball on its axis; None takes it from the medium.
    forward
        k, share of the scattered light that goes on forward, for "split".
    solid_angle
        Omega of eq 26, steradian; the paper leaves it out, that is 1 (E22).
    gain
        What happens where eq 26 would make light: "hold" or "refuse" (E23).
    sky_light, ground_light
        Radiance from straight above and below, RGB; each is carried through the balls
        like a sun's light. Both zero is off.
    sky_forward
        k for these two.
    light_reach
        How far a ball's light counts in the field that gives pixels their colours, in
        radii; 0 gives each ball one flat colour.
    erosion
        Share of a footprint that world-anchored noise may take away; 0 is off.
    erosion_cell
        Coarsest cell of that noise, in median radii of the balls.
    erosion_depth
        Factor on the eye's optical depth that makes up for what erosion takes.
    relief
        Share of a sun's light that the noise may keep from a point by rising toward
        that sun; 0 is off.
    buffer
        Side of the sun's framebuffer, pixels.
    sky_buffer
        Side of the framebuffers of the light from above and below, pixels.
    """

    scattering: Literal["split", "man2003"] = "split"
    transmittance: Literal["beer", "linear"] = "beer"
    footprint: Literal["chord", "profile"] = "chord"
    readback: Literal["footprint", "disc", "square", "antialiased"] = "footprint"
    tau: Annotated[float, Range(0.0, 1e37)] | None = None
    forward: Share = 0.7
    solid_angle: Annotated[float, Range(0.0, WHOLE_SPHERE, "sr")] = 1.0
    gain: Literal["hold", "refuse"] = "hold"
    sky_light: Colour = field(default_factory=lambda: SKY_LIGHT)
    ground_light: Colour = field(default_factory=lambda: GROUND_LIGHT)
    sky_forward: Share = 0.8
    light_reach: Annotated[float, Range(0.0, 10.0, "radii")] = 1.15
    erosion: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.42
    erosion_cell: Annotated[float, Range(0.01, 100.0, "median radii")] = 0.7
    erosion_depth: Annotated[float, Range(0.0, 100.0)] = 1.6
    relief: Share = 0.57
    buffer: Side = 256
    sky_buffer: Side = 128

    def __post_init__(self) -> None:
        check_fields(self)


def named(look: Look | LookName) -> Look:
    """Give the rules that a name stands for.

    Parameters
    ----------
    look
        "cumulus" (the extensions), "man" (paper M to the letter), or the rules
        themselves.

    Returns
    -------
    The rules.

    Source: paper M, section 4; E22, E25 to E27.
    """
    if isinstance(look, Look):
        return look
    return Look() if look == "cumulus" else MAN


def _dark() -> Array:
    return np.zeros(3)


MAN = Look(
    scattering="man2003",
    transmittance="linear",
    footprint="profile",
    readback="disc",
    tau=TAU_MAN2003,
    sky_light=_dark(),
    ground_light=_dark(),
    light_reach=0.0,
    erosion=0.0,
    erosion_depth=1.0,
    relief=0.0,
)
