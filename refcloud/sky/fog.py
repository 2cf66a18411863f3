"""Fog by distance, on every object: as printed it thins with distance, mended it grows.

Document S prints f = e^-(fogDensity - zDistance). That is above 1 from zDistance =
fogDensity on and nearly 0 before the eye: near things drown and far ones are clear.
OpenGL's GL_EXP is e^-(density distance), and what the document describes.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Colour, Range, Shape

FogForm = Literal["exponential", "printed"]
Distances = Annotated[Array, Shape("..."), Range(0.0, unit="scene units")]
Density = Annotated[float, Range(0.0, 1e6, "1/scene unit")]


@checked
def fog_factor(
    distance: Distances, *, density: Density, form: FogForm = "exponential"
) -> Array:
    """Give the share of an object's own light that fog leaves.

    Formula: f = exp(-density distance), or exp(-(density - distance)), cut to [0, 1]

    Parameters
    ----------
    distance
        From the eye to the object, any shape.
    density
        How much fog a unit of length holds.
    form
        "exponential" is GL_EXP; "printed" is the document's, which grows with distance
        and takes density for a length.

    Returns
    -------
    In [0, 1], of the same shape: 1 is no fog.

    Source: document S, section 5.1 (F12); E29.

    Examples
    --------
    >>> fog_factor([0.0, 1.0], density=0.5).round(4)
    array([1.    , 0.6065])
    """
    if form == "printed":
        return np.exp(np.minimum(distance - density, 0.0))
    return np.exp(-density * distance)


@checked
def fogged(
    light: Annotated[Array, Shape("...", 3)],
    distance: Distances,
    *,
    density: Density,
    color: Colour,
    form: FogForm = "exponential",
) -> Array:
    """Mix the light of objects with that of the fog before them.

    Formula: f light + (1 - f) color

    Parameters
    ----------
    light
        Of the objects, linear RGB, shape (..., 3).
    distance
        From the eye, shape (...,).
    density
        How much fog a unit of length holds.
    color
        Of the fog, linear RGB.
    form
        As `fog_factor`.

    Returns
    -------
    Linear RGB, shape (..., 3).

    Raises
    ------
    ValueError
        There is not one distance for each colour.

    Source: document S, section 5.1 (F12); E29.

    Examples
    --------
    >>> fogged([[1.0, 0.0, 0.0]], [np.log(2.0)], density=1.0, color=[0, 0, 1])
    array([[0.5, 0. , 0.5]])
    """
    if distance.shape != light.shape[:-1]:
        raise ValueError(
            f"distance: expected shape {light.shape[:-1]}, one for each colour,"
            f" got shape {distance.shape}"
        )
    f = fog_factor(distance, density=density, form=form)[..., None]
    return f * light + (1.0 - f) * color
