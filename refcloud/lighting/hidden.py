"""Balls that are left out before anything is drawn: off the picture, or too faint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, project
from refcloud.conventions import Array, Skipped
from refcloud.metaballs import Metaballs

Mask = NDArray[np.bool_]


def on_screen(
    x: Array, y: Array, radius: Array, camera: AnyCamera
) -> tuple[Mask, list[Skipped]]:
    """Tell which balls touch the picture; the others change nothing.

    Parameters
    ----------
    x, y, radius
        Of the projected balls, shape (N,), pixels; radius 0 behind the eye.
    camera
        Its picture.

    Returns
    -------
    Shape (N,), and the rows of the report.
    """
    across = (x + radius > 0.0) & (x - radius < camera.width)
    down = (y + radius > 0.0) & (y - radius < camera.height)
    visible = (radius > 0.0) & across & down
    off = len(x) - int(visible.sum())
    return visible, [
        Skipped("eye", "balls off the picture", off, len(x))
    ] if off else []


def touches(balls: Metaballs, camera: AnyCamera) -> bool:
    """Tell whether any ball touches the picture: a cloud of others needs no light.

    Parameters
    ----------
    balls, camera
        The cloud, and the eye.
    """
    x, y, _, scale = project(camera, balls.centers)
    return bool(on_screen(x, y, balls.radii * scale, camera)[0].any())


def without_faint(
    order: NDArray[np.intp],
    visible: Mask,
    tau: Array,
    brightest: float,
    tolerance: float,
) -> tuple[Mask, list[Skipped]]:
    """Leave out the faintest balls while their total effect stays in the tolerance.

    Proved: every colour in the buffer and in the balls lies in [0, brightest], so a
    ball of opacity a changes no pixel by more than a times brightest, and the changes
    of several add up at most.

    Parameters
    ----------
    order
        All balls from near to far; of equally faint ones the nearest goes first.
    visible
        Balls still to be drawn, shape (N,).
    tau
        Optical depth on the axis, the largest of the channels, shape (N,).
    brightest
        Largest colour of balls, air and background, and at least an alpha of 1.
    tolerance
        Largest change of a channel.

    Returns
    -------
    Balls still to be drawn, and the rows of the report.
    """
    effect = -np.expm1(-tau) * brightest
    weak = visible & (effect <= tolerance)
    if not weak.any():
        return visible, []
    candidates = order[weak[order]]
    ranked = candidates[np.argsort(effect[candidates], kind="stable")]
    total = np.cumsum(effect[ranked])
    faint = ranked[total <= tolerance]
    if not len(faint):
        return visible, []
    kept = visible.copy()
    kept[faint] = False
    bound = float(total[len(faint) - 1])
    return kept, [
        Skipped("eye", "balls too faint to show", len(faint), len(tau), bound)
    ]
