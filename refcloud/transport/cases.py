"""What must be solved apart: channels by their matter, and the mixtures of light."""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.optics import Medium, Sun

ROUNDED = 1e-12  # relative: mixtures nearer than this are one


def matters_of(medium: Medium) -> list[tuple[float, float, list[int]]]:
    """Sort channels by their matter: sigma_t, albedo, and which channels."""
    found: dict[tuple[float, float], list[int]] = {}
    for c in range(3):
        matter = float(medium.sigma_t_rgb[c]), float(medium.albedo_rgb[c])
        found.setdefault(matter, []).append(c)
    return [(*matter, channels) for matter, channels in found.items()]


def cases_of(
    medium: Medium, suns: tuple[Sun, ...], sky: Array, ground: Array
) -> tuple[list[tuple[float, float, Array]], tuple[tuple[int, int, float], ...]]:
    """Sort channels by their matter, and the light on it by its mixture.

    What differs by a factor alone is solved once: a grey cloud under one sun, whatever
    its colour, is one case.
    """
    kinds: list[tuple[float, float, list[Array]]] = []
    channels = []
    for c in range(3):
        matter = float(medium.sigma_t_rgb[c]), float(medium.albedo_rgb[c])
        colour = np.array([*(sun.irradiance[c] for sun in suns), sky[c], ground[c]])
        factor = float(colour.max(initial=0.0))
        mixture = colour / factor if factor > 0.0 else np.zeros_like(colour)
        kind = next((k for k, known in enumerate(kinds) if known[:2] == matter), None)
        if kind is None:
            kind = len(kinds)
            kinds.append((*matter, []))
        mixtures = kinds[kind][2]
        case = next(
            (k for k, known in enumerate(mixtures) if _same(known, mixture)), None
        )
        if case is None:
            case = len(mixtures)
            mixtures.append(mixture)
        channels.append((kind, case, factor))
    return [(s, a, np.array(m)) for s, a, m in kinds], tuple(channels)


def _same(a: Array, b: Array) -> bool:
    return bool(np.allclose(a, b, rtol=ROUNDED, atol=0.0))
