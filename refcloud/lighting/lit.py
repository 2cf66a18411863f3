"""Balls together with the light that reaches them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated

from refcloud.checking import check_fields
from refcloud.conventions import Array, Range, Shape, Skipped
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.ends import refuse_extreme
from refcloud.lighting.gain import gain_of
from refcloud.lighting.look import Look
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun


@dataclass(frozen=True)
class LitMetaballs:
    """Balls and the light that reaches them, ready for any eye.

    Attributes
    ----------
    balls
        The cloud, N balls.
    suns
        The S suns.
    light
        Irradiance that reaches each ball from each sun, before the phase function
        (E26), shape (S, N, 3).
    ambient
        Radiance of sky and ground that reaches each ball, before the albedo, shape
        (N, 3).
    medium
        What the cloud is made of.
    look
        The rules that carried the light.
    skipped
        What a tolerance left out in carrying it.
    glow
        Radiance that each sun's light adds after it was scattered before, toward the
        eye that it was solved for, shape (S, N, 3); None for none.
    """

    balls: Metaballs
    suns: tuple[Sun, ...]
    light: Annotated[Array, Shape("S", "N", 3), Range(0.0, unit="radiance sr")]
    ambient: Annotated[Array, Shape("N", 3), Range(0.0, unit="radiance")]
    medium: Medium
    look: Look
    skipped: tuple[Skipped, ...] = ()
    glow: Annotated[Array, Shape("S", "N", 3), Range(0.0, unit="radiance")] | None = (
        None
    )

    def __post_init__(self) -> None:
        check_fields(self)
        expected = (len(self.suns), len(self.balls.radii))
        if self.light.shape[:2] != expected or len(self.ambient) != expected[1]:
            raise ValueError(
                f"light: expected shape {(*expected, 3)} for these suns and balls,"
                f" got {self.light.shape} with ambient of shape {self.ambient.shape}"
            )
        if self.glow is not None and self.glow.shape != self.light.shape:
            raise ValueError(
                f"glow: expected shape {self.light.shape}, that of light,"
                f" got {self.glow.shape}"
            )
        refuse_extreme(self.balls, self.suns, self.medium)

    # What no eye changes is computed for the first one and kept for all others (L15).

    @functools.cached_property
    def gain(self) -> Array:
        """What the scattering rule puts on top of albedo times phase, shape (N, 3)."""
        return gain_of(self.balls, self.medium, self.look)

    @functools.cached_property
    def scattered(self) -> Array:
        """Each sun's light times albedo and gain, to be shared out, shape (S, N, 3).

        In memory channel by channel, as `ball_colours` goes on with it.
        """
        share = self.medium.albedo_rgb[:, None] * self.gain.T
        return (self.light.transpose(0, 2, 1) * share).transpose(0, 2, 1)

    @functools.cached_property
    def reflected(self) -> Array:
        """The ambient light times albedo, shape (N, 3), channel by channel."""
        return (self.medium.albedo_rgb[:, None] * self.ambient.T).T

    @functools.cached_property
    def depths(self) -> dict[float, Array]:
        """Each ball's optical depth on its axis, shape (N,), by extinction."""
        extinctions = dict.fromkeys(self.medium.sigma_t_rgb.tolist())
        return {s: ball_depths(self.balls, s, self.look) for s in extinctions}
