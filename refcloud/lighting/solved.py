"""Balls lit by a solved field: splats that show every order of scattering."""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Vector
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look, LookName, named
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium
from refcloud.refusal import complaint
from refcloud.transport import ScatteredLight, sun_depths
from refcloud.transport.scattering import harmonics_toward, source_terms


@checked
def lit_by_solution(
    balls: Metaballs,
    light: ScatteredLight,
    *,
    eye: Vector | None = None,
    look: Look | LookName = "cumulus",
) -> LitMetaballs:
    """Light balls from the solved field of the cloud map that they stand for.

    Formula: light = E T'_sun albedo sigma / sigma', ambient = J(center, toward the
    eye); the medium is the scaled one, in which the forward peak is unscattered

    Parameters
    ----------
    balls
        The cloud; `approximate` made it of the map, say.
    light
        Of `refcloud.transport.scattered_light`, with sigma_t and albedo as numbers.
    eye
        Where the light is seen from, shape (3,); None takes the mean over directions.
    look
        Rules that the second pass draws by.

    Returns
    -------
    The lit balls, for `eyeward`.

    Raises
    ------
    ValueError
        The light's medium is coloured, or the look has one optical depth for all balls.

    Source: an extension of paper M, eq 27 (L04).
    """
    rules = named(look)
    medium = light.medium
    if np.ndim(medium.sigma_t) or np.ndim(medium.albedo):
        expected = "light in a medium whose sigma_t and albedo are numbers"
        raise ValueError(complaint("light", expected, "RGB"))
    if rules.tau is not None:
        expected = "a look whose depths are the balls' own"
        raise ValueError(complaint("look", expected, f"tau {rules.tau:g} for all"))
    # 1. Sunlight at each centre, in the scaled medium.
    sigma = float(light.sigma_t[0])
    places = ((balls.centers - light.grid.lower) / cell_size(light.grid) - 0.5).T
    kept = float(medium.sigma_t_rgb[0]) / sigma if sigma > 0.0 else 1.0
    reaching = np.empty((len(light.suns), len(balls.radii), 3))
    for s, sun in enumerate(light.suns):
        columns = np.asarray(sun_depths(light.grid, sun.direction).density)
        T = np.exp(-sigma * clamped_trilinear(columns, *places))
        colour = sun.irradiance * medium.albedo_rgb * kept
        reaching[s] = T[:, None] * colour
    # 2. What was scattered more often, as the eye sees it.
    box = (light.upper - light.lower) / np.array(light.shape[::-1])
    places = ((balls.centers - light.lower) / box - 0.5).T
    ambient = np.zeros((len(balls.radii), 3))
    terms = source_terms(light)[0]
    if eye is None:
        weights = np.zeros((len(balls.radii), len(terms)))
        weights[:, 0] = 0.5 / np.sqrt(np.pi)  # the first harmonic is a constant
    else:
        toward = eye - balls.centers
        length = np.sqrt(np.square(toward).sum(axis=1, keepdims=True))
        toward = np.divide(toward, length, out=np.zeros_like(toward), where=length > 0)
        weights = harmonics_toward(light, toward, 0)
    for c, (_, case, factor) in enumerate(light.channels):
        table = np.ascontiguousarray(np.moveaxis(terms[:, case], 0, -1))
        J = (clamped_trilinear(table, *places) * weights).sum(axis=1)
        ambient[:, c] = factor * np.maximum(J, 0.0)
    scaled = Medium(sigma, 1.0, medium.g, medium.phase)
    return LitMetaballs(balls, light.suns, reaching, ambient, scaled, rules)
