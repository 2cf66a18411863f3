"""Balls lit by a solved field: splats that show every order of scattering."""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array, Tolerance, Vector
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look, LookName, named
from refcloud.lighting.reuse import same
from refcloud.metaballs import Metaballs, sampled_map
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.transport import ScatteredLight, scattered_light, sun_depths
from refcloud.transport.plans import GradeName, Plan
from refcloud.transport.scattering import harmonics_toward, source_terms

Lights = ScatteredLight | tuple[ScatteredLight, ...]


@checked
def solved_light(
    balls: Metaballs,
    suns: Sun | tuple[Sun, ...],
    *,
    medium: Medium,
    look: Look | LookName = "cumulus",
    plan: Plan | GradeName | None = None,
    tolerance: Tolerance = 0.0,
) -> tuple[ScatteredLight, ...]:
    """Solve the light that balls scatter, in the cloud map of their own density.

    Formula: `scattered_light` in `sampled_map`, for each sun by itself and for sky and
    ground of the look together

    Parameters
    ----------
    balls
        The cloud.
    suns
        The lights.
    medium
        What the cloud is made of, its sigma_t and albedo as numbers.
    look
        Brings the light of sky and ground.
    plan
        Of the solution; None chooses by the tolerance.
    tolerance
        Error of a ball's colour that is allowed, against the plan "finest" on the same
        map, which 0 chooses.

    Returns
    -------
    The lights, for `lit_by_solution`; for every eye.

    Raises
    ------
    ValueError
        As `lit_by_solution`.

    Source: an extension of paper M (multiple scattering, X09).
    """
    rules = named(look)
    refuse_unsolved(medium, rules)
    suns = (suns,) if isinstance(suns, Sun) else suns
    grid = sampled_map(balls)
    outside = bool(rules.sky_light.any() or rules.ground_light.any())
    share = tolerance / max(len(suns) + outside, 1)
    how = {"medium": medium, "plan": plan, "tolerance": share}
    lights = [scattered_light(grid, (sun,), **how) for sun in suns]
    if outside or not suns:
        sky, ground = rules.sky_light, rules.ground_light
        lights.append(scattered_light(grid, (), sky=sky, ground=ground, **how))
    return tuple(lights)


@checked
def lit_by_solution(
    balls: Metaballs,
    light: Lights,
    *,
    eye: Vector | None = None,
    look: Look | LookName = "cumulus",
) -> LitMetaballs:
    """Light balls from the solved field of the cloud map that they stand for.

    Formula: light = E T'_sun albedo sigma / sigma', glow and ambient = J(center, toward
    the eye); the medium is the scaled one, in which the forward peak is unscattered

    Parameters
    ----------
    balls
        The cloud; `approximate` made it of the map, say.
    light
        Of `solved_light` or of `refcloud.transport.scattered_light`, with sigma_t and
        albedo as numbers; several add up. What was solved for one sun alone goes with
        that sun, and the look's relief with it; anything else is ambient.
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
    lights = (light,) if isinstance(light, ScatteredLight) else light
    if not lights:
        raise ValueError(complaint("light", "at least one", "none"))
    medium = lights[0].medium
    refuse_unsolved(medium, rules)
    suns = tuple(sun for each in lights for sun in each.suns)
    sigma = float(lights[0].sigma_t[0])
    reaching, glow = np.zeros((2, len(suns), len(balls.radii), 3))
    ambient = np.zeros((len(balls.radii), 3))
    s = 0
    for each in lights:
        # 1. Sunlight at each centre, in the scaled medium.
        for k, sun in enumerate(each.suns):
            reaching[s + k] = _sunlight(balls, each, sun)
        # 2. What was scattered more often, as the eye sees it.
        J = _toward(balls, each, eye)
        if len(each.suns) == 1 and not (each.sky.any() or each.ground.any()):
            glow[s] = J
        else:
            ambient += J
        s += len(each.suns)
    scaled = Medium(sigma, 1.0, medium.g, medium.phase)
    return LitMetaballs(balls, suns, reaching, ambient, scaled, rules, glow=glow)


def brought_by(
    light: Lights, suns: tuple[Sun, ...] | None, medium: Medium | None
) -> tuple[tuple[Sun, ...], Medium]:
    """Take suns and medium of solved light; refuse others beside it."""
    lights = (light,) if isinstance(light, ScatteredLight) else light
    if not lights:
        raise ValueError(complaint("scattering", "at least one light", "none"))
    theirs = tuple(sun for each in lights for sun in each.suns)
    own = theirs if suns is None else suns
    same_suns = len(own) == len(theirs) and all(map(same, own, theirs))
    if not same_suns or not (medium is None or same(medium, lights[0].medium)):
        expected = "light that was solved for this medium and these suns"
        advice = 'leave those out, or say "multiple"'
        raise ValueError(complaint("scattering", expected, "that of others", advice))
    return theirs, lights[0].medium


def refuse_coloured(medium: Medium) -> None:
    """Refuse a medium by channel."""
    if np.ndim(medium.sigma_t) or np.ndim(medium.albedo):
        expected = "light in a medium whose sigma_t and albedo are numbers"
        advice = "march a cloud map, or leave scattering multiple out"
        raise ValueError(complaint("light", expected, "RGB", advice))


def refuse_unsolved(medium: Medium, look: Look) -> None:
    """Refuse what balls that are lit by a solution do not model."""
    refuse_coloured(medium)
    if look.tau is not None or look.scattering != "split":
        expected = 'a look whose depths are the balls\' own and scattering is "split"'
        advice = 'take the look "cumulus", or leave scattering multiple out'
        raise ValueError(complaint("look", expected, "another", advice))


def _sunlight(balls: Metaballs, light: ScatteredLight, sun: Sun) -> Array:
    """Give the irradiance that reaches each ball's centre, (N, 3)."""
    medium, sigma = light.medium, float(light.sigma_t[0])
    places = ((balls.centers - light.grid.lower) / cell_size(light.grid) - 0.5).T
    kept = float(medium.sigma_t_rgb[0]) / sigma if sigma > 0.0 else 1.0
    columns = np.asarray(sun_depths(light.grid, sun.direction).density)
    T = np.exp(-sigma * clamped_trilinear(columns, *places))
    return T[:, None] * (sun.irradiance * medium.albedo_rgb * kept)


def _toward(balls: Metaballs, light: ScatteredLight, eye: Array | None) -> Array:
    """Give the solved source at each ball's centre, toward the eye, (N, 3)."""
    box = (light.upper - light.lower) / np.array(light.shape[::-1])
    places = ((balls.centers - light.lower) / box - 0.5).T
    terms = source_terms(light)[0]
    if eye is None:
        weights = np.zeros((len(balls.radii), len(terms)))
        weights[:, 0] = 0.5 / np.sqrt(np.pi)  # the first harmonic is a constant
    else:
        toward = eye - balls.centers
        length = np.sqrt(np.square(toward).sum(axis=1, keepdims=True))
        toward = np.divide(toward, length, out=np.zeros_like(toward), where=length > 0)
        weights = harmonics_toward(light, toward, 0)
    found = np.zeros((len(balls.radii), 3))
    for c, (_, case, factor) in enumerate(light.channels):
        table = np.ascontiguousarray(np.moveaxis(terms[:, case], 0, -1))
        J = (clamped_trilinear(table, *places) * weights).sum(axis=1)
        found[:, c] = factor * np.maximum(J, 0.0)
    return found
