"""How marched densities mix with colour: three sliders that are off by default."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from refcloud.checking import check_fields
from refcloud.conventions import Range
from refcloud.optics.media import Share

Factor = Annotated[float, Range(0.0, 1e3)]


@dataclass(frozen=True)
class Mixing:
    """Three factors on the light that have no counterpart in physics.

    Document D has three unnamed sliders; it follows a shader by S. Lague that has these
    three (E38). With the defaults energy is kept.

    Attributes
    ----------
    light_absorption_toward_sun
        Factor on the optical depth between a point and the sun.
    light_absorption_through_cloud
        Factor on the optical depth between a point and the eye.
    darkness_threshold
        Share of the sun's light that reaches every point, however deep.
    """

    light_absorption_toward_sun: Factor = 1.0
    light_absorption_through_cloud: Factor = 1.0
    darkness_threshold: Share = 0.0

    def __post_init__(self) -> None:
        check_fields(self)


PHYSICAL = Mixing()
