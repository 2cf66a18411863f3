"""A surface drawn over what lies behind it, by a shader that is called for all pixels.

The shader is a function from places to light and opacity, as a fragment shader is one
from a fragment's attributes to its colour. It is called once, with every pixel that the
surface shows in. Fog goes over each object by its own distance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked, complaint
from refcloud.conventions import Array, Colour, Shape
from refcloud.sky.fog import Density, FogForm, fog_factor
from refcloud.sky.places import Places


@dataclass(frozen=True)
class Fog:
    """Fog before every object.

    Attributes
    ----------
    density
        How much a unit of length holds; 0 is none.
    color
        Linear RGB; None is what lies behind each pixel, so that far clouds melt into
        their sky, as air makes them.
    form
        "exponential", or "printed" as the document has it (E29).
    """

    density: Density = 0.0
    color: Colour | None = field(default_factory=lambda: np.array([0.58, 0.70, 0.83]))
    form: FogForm = "exponential"

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def shaded(
    behind: Annotated[Array, Shape("H", "W", 3)],
    places: Places,
    shader: Callable,
    *,
    fog: Fog | None = None,
) -> Array:
    """Draw a surface over a picture.

    Formula: opacity (f light + (1 - f) fog) + (1 - opacity) behind

    Parameters
    ----------
    behind
        What is seen through it and beside it, linear RGB, shape (H, W, 3).
    places
        What the picture sees of the surface, N pixels.
    shader
        Called with the places; gives light, shape (N,) or (N, 3), and opacity, (N,).
    fog
        Before the surface; None for none.

    Returns
    -------
    Linear RGB, shape (H, W, 3); a new array.

    Raises
    ------
    ValueError
        The picture has another size than the places, or the shader gives other shapes.

    Source: document S, section 5.1 (V06, F12).

    Examples
    --------
    >>> from refcloud.camera import Camera
    >>> from refcloud.sky import Plane, places
    >>> up = places(Camera([0, 0, 0], [0, 1, 0], width=1, height=1), Plane())
    >>> shaded(np.zeros((1, 1, 3)), up, lambda p: (np.ones(1), np.full(1, 0.25)))
    array([[[0.25, 0.25, 0.25]]])
    """
    if behind.shape[:2] != places.seen.shape:
        size = (*places.seen.shape, 3)
        expected = f"shape {size}, that of the places"
        raise ValueError(complaint("behind", expected, f"shape {behind.shape}"))
    light, opacity = (np.asarray(part, np.float64) for part in shader(places))
    count = len(places.distance)
    if light.shape not in ((count,), (count, 3)) or opacity.shape != (count,):
        expected = f"light of shape ({count},) or ({count}, 3), opacity of ({count},)"
        raise ValueError(
            complaint("shader", expected, f"{light.shape} and {opacity.shape}")
        )
    if light.ndim == 1:
        light = np.repeat(light[:, None], 3, axis=1)
    over = behind.copy()
    share, back = opacity[:, None], over[places.seen]
    if fog is not None and (fog.density > 0.0 or fog.form == "printed"):
        f = fog_factor(places.distance, density=fog.density, form=fog.form)[:, None]
        light = f * light + (1.0 - f) * (back if fog.color is None else fog.color)
    over[places.seen] = share * light + (1.0 - share) * back
    return over
