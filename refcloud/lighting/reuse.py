"""Which light of an earlier first pass still holds: that of the same balls and rules.

The light that reaches a ball knows nothing of the eye. It changes where a ball, the
medium, a rule or the light itself does; anything else leaves it as it is (L15).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun


@dataclass(frozen=True)
class Kept:
    """What need not be carried again.

    Attributes
    ----------
    suns
        Numbers of suns, and theirs in the earlier pass.
    ambient
        Whether the light of sky and ground is the same.
    """

    suns: dict[int, int]
    ambient: bool

    @property
    def number(self) -> int:
        """Count the lights, sky and ground among them."""
        return len(self.suns) + 2 * self.ambient


def same_lights(
    earlier: LitMetaballs | None,
    balls: Metaballs,
    suns: tuple[Sun, ...],
    medium: Medium,
    look: Look,
) -> Kept:
    """Find the lights that an earlier pass carried through the same balls.

    Parameters
    ----------
    earlier
        Its result; None for none.
    balls, suns, medium, look
        Of the pass to come.

    Returns
    -------
    What holds; nothing where a ball, the medium or a rule changed. What only the eye
    sees of them, the phase function, does not count.
    """
    if earlier is None or not (
        earlier.glow is None  # what was solved was not carried
        and same(earlier.balls, balls, but=("skipped",))
        and same(earlier.medium, medium, but=("phase", "g"))
        and same(earlier.look, look)
    ):
        return Kept({}, False)
    pairs = {
        number: old
        for number, sun in enumerate(suns)
        for old, there in enumerate(earlier.suns)
        if same(sun, there)
    }
    return Kept(pairs, True)


def same(one: Any, other: Any, *, but: tuple[str, ...] = ()) -> bool:
    """Compare two values of one type field by field, arrays by their elements."""
    return one is other or all(
        np.array_equal(getattr(one, field.name), getattr(other, field.name))
        for field in dataclasses.fields(one)
        if field.name not in but
    )
