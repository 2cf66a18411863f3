"""The ends of scenes: lengths and lights whose products all stay numbers.

A picture needs cubes of lengths, squares of their quotients, and products of a few
lights. Beyond these ends, far from any unit of length or light, float64 has no room
for them; a scene there is refused by name.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from refcloud.refusal import complaint

LONGEST, SHORTEST = 1e50, 1e-50  # scene units: (longest / shortest)^3 = 1e300
BRIGHTEST = 1e200  # radiance: a hundred of them, each a narrow lobe's peak of 1e30
DEEPEST = 1e300  # optical depth of one ball


def refuse_far(name: str, places: ArrayLike) -> None:
    """Refuse places too far from the origin.

    Parameters
    ----------
    name
        What the refusal calls them.
    places
        Coordinates or lengths, any shape, scene units.

    Raises
    ------
    ValueError
        One is beyond `LONGEST`.
    """
    largest = float(np.abs(places).max(initial=0.0))
    if not largest <= LONGEST:
        expected = f"places and lengths of at most {LONGEST:g} scene units"
        advice = "choose another unit of length"
        raise ValueError(complaint(name, expected, f"{largest:.4g}", advice))


def refuse_small(name: str, sizes: ArrayLike) -> None:
    """Refuse sizes too small beside the largest allowed.

    Parameters
    ----------
    name
        What the refusal calls them.
    sizes
        Above 0, any shape, scene units.

    Raises
    ------
    ValueError
        One is below `SHORTEST`.
    """
    least = float(np.min(sizes, initial=np.inf))
    if not least >= SHORTEST:
        expected = f"sizes of at least {SHORTEST:g} scene units"
        advice = "choose another unit of length"
        raise ValueError(complaint(name, expected, f"{least:.4g}", advice))


def refuse_bright(name: str, light: ArrayLike) -> None:
    """Refuse light too bright to be added up.

    Parameters
    ----------
    name
        What the refusal calls it.
    light
        At least 0, any shape, radiance.

    Raises
    ------
    ValueError
        A channel is beyond `BRIGHTEST`.
    """
    most = float(np.max(light, initial=0.0))
    if not most <= BRIGHTEST:
        expected = f"light of at most {BRIGHTEST:g} times white"
        raise ValueError(complaint(name, expected, f"{most:.4g}", "choose less light"))


def refuse_deep(name: str, sigma_t: float, columns: ArrayLike) -> None:
    """Refuse optical depths of single balls that are no longer numbers.

    Parameters
    ----------
    name
        What the refusal calls the extinction.
    sigma_t
        Extinction at density 1, 1 / scene unit.
    columns
        Density times radius of each ball, any shape; infinite ones are too deep.

    Raises
    ------
    ValueError
        One is beyond `DEEPEST`.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        most = float(sigma_t * np.max(columns, initial=0.0))
    if not most <= DEEPEST:
        expected = f"an optical depth of at most {DEEPEST:g} in a ball"
        raise ValueError(complaint(name, expected, "more", "lower sigma_t"))
