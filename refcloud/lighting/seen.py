"""The balls as one eye sees them: place, size, depth and colour of each."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, axes, project
from refcloud.conventions import Array, Observer, Skipped
from refcloud.lighting.colours import Haze, ball_colours, clearness
from refcloud.lighting.erosion import detail_grid
from refcloud.lighting.hidden import Mask, on_screen
from refcloud.lighting.lightfield import light_field
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.order import depth_order
from refcloud.lighting.shading import FRONT, Ball, Shading
from refcloud.lighting.single_detail import single_detail
from refcloud.metaballs import Metaballs

RISE = 0.25  # of the noise's coarsest cell: the step toward a sun that shows its relief


@dataclass(frozen=True, eq=False)
class Seen:
    """What pass 2 knows of every ball.

    Attributes
    ----------
    lit, camera
        The balls and their light; the eye.
    x, y, radius
        In the picture, pixels, shape (N,); radius 0 behind the eye.
    scale
        Pixels per scene unit, shape (N,).
    tau
        Optical depth on the axis by colour channel, shape (3, N).
    colours
        RGB by sun, and ambient last, shape (N, S + 1, 3).
    clear
        Share of each ball's light that passes the air, shape (N,).
    air
        What the air shows where nothing passes it, RGB.
    order
        All balls from near to far.
    shown
        Those that touch the picture, shape (N,).
    """

    lit: LitMetaballs
    camera: AnyCamera
    x: Array
    y: Array
    radius: Array
    scale: Array
    tau: Array
    colours: Array
    clear: Array
    air: Array
    order: NDArray[np.intp]
    shown: Mask

    def ball(self, k: int, channel: int) -> Ball:
        """Give one ball as the literal loop draws it in one colour channel."""
        balls = self.lit.balls
        return Ball(
            float(self.x[k]),
            float(self.y[k]),
            float(self.radius[k]),
            float(self.tau[channel, k]),
            balls.centers[k],
            float(balls.radii[k]),
            self.colours[k],
            float(self.clear[k]),
            self.air * (1.0 - self.clear[k]),
        )

    def flat_colours(self) -> Array:
        """Give what each ball shows where it is opaque, all lights and the air, (N, 3).

        Only balls of one colour each show that; others vary over their footprints.
        """
        color = self.all_lights
        if (self.clear == 1.0).all():  # no air
            return color
        return color * self.clear[:, None] + self.air * (1.0 - self.clear)[:, None]

    def brightest(self) -> float:
        """Give the largest colour of any ball or of the air: no pixel passes it."""
        return max(float(self.all_lights.max(initial=0.0)), float(self.air.max()))

    @functools.cached_property
    def all_lights(self) -> Array:
        """What the ambient light and each sun show of every ball, summed, (N, 3)."""
        color = self.colours[:, -1]
        for s in range(self.colours.shape[1] - 1):
            color = color + self.colours[:, s]
        return color

    def channel_groups(self) -> list[list[int]]:
        """Group the channels of one extinction: a grey medium needs one pass (L12)."""
        groups: dict[float, list[int]] = {}
        for channel, sigma_t in enumerate(self.lit.medium.sigma_t_rgb.tolist()):
            groups.setdefault(sigma_t, []).append(channel)
        return list(groups.values())


def seen_by(
    lit: LitMetaballs, camera: AnyCamera, haze: Haze | None
) -> tuple[Seen, list[Skipped]]:
    """Look at lit balls through a camera, unchecked.

    Parameters
    ----------
    lit, camera, haze
        As `eyeward`.

    Returns
    -------
    What the eye sees, and the rows of the report.
    """
    balls = lit.balls
    x, y, depth, scale = project(camera, balls.centers)
    radius = balls.radii * scale
    shown, skipped = on_screen(x, y, radius, camera)
    dark = sum(1 for sun in lit.suns if not sun.irradiance.any())
    if dark:
        skipped.append(Skipped("light", "suns without light", dark, len(lit.suns)))
    fade = _fading(lit, depth)
    by_extinction = {
        s: tau * fade * lit.look.erosion_depth for s, tau in lit.depths.items()
    }
    return Seen(
        lit,
        camera,
        x,
        y,
        radius,
        scale,
        np.stack([by_extinction[s] for s in lit.medium.sigma_t_rgb.tolist()]),
        ball_colours(lit, camera),
        clearness(haze, balls.centers, camera),
        np.zeros(3) if haze is None else haze.color,
        depth_order(balls, depth),
        shown,
    ), skipped


def _fading(lit: LitMetaballs, depth: Array) -> Array:
    """Give what the eye counts of each ball's optical depth.

    A ball fades in as the eye leaves it, so that none pops at the near plane.
    """
    nearness = np.clip(depth / lit.balls.radii, 0.0, 1.0)
    return nearness * nearness * (3.0 - 2.0 * nearness)


def shading_of(
    seen: Seen, seed: int, observe: Observer | None, *, single: bool = False
) -> tuple[Shading, tuple[Skipped, ...]]:
    """Tabulate the light as a field, and the noise that erodes footprints.

    Parameters
    ----------
    seen
        Of `seen_by`; the balls in the picture count, drawn or not: the tables must not
        change with the tolerance.
    seed, observe
        As `eyeward`.
    single
        Whether the noise is for `SinglePlaces`.

    Returns
    -------
    What all balls share, and the rows of the report.
    """
    lit, look, shown = seen.lit, seen.lit.look, seen.shown
    balls, skipped = lit.balls, ()
    field = detail = rounded = None
    if look.light_reach > 0.0 and shown.any():
        values = seen.colours.reshape(len(seen.colours), -1)
        field = light_field(balls, values, reach=look.light_reach)
    cell, frame = look.erosion_cell, axes(seen.camera)
    toward = np.array([sun.direction for sun in lit.suns]).reshape(-1, 3)
    if look.erosion > 0.0 and shown.any():
        cell *= float(np.median(balls.radii))
        places = balls.centers[shown]
        reach = balls.radii[shown][:, None] + RISE * cell
        box = (places - reach).min(axis=0), (places + reach).max(axis=0)
        how = {"cell": cell, "pixel": 1.0 / float(seen.scale[shown].max())}
        if single:
            drawn = Metaballs(places, balls.radii[shown], balls.densities[shown])
            steps = toward * (RISE * cell)
            rounded = single_detail(
                *box, drawn, frame, steps, front=FRONT, seed=seed, **how
            )
            skipped = rounded.skipped
        if observe is not None or not single:
            detail = detail_grid(*box, seed=seed, **how)
            skipped = detail.skipped
        if observe is not None:
            observe("detail", detail)
    toward = toward * (RISE * cell)
    shading = Shading(frame, look, balls.kernel, detail, field, toward, rounded)
    return shading, skipped
