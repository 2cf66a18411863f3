"""The scenes of splatted clouds as declarations, to be written as TOML and changed."""

from __future__ import annotations

import numpy as np

from refcloud.declared import Cloud, Declaration, Placement
from refcloud.lighting import named
from refcloud.scenes import cumulus, man
from refcloud.sky import Sky

OWN_EYE = {"eye": np.array(cumulus.EYE), "target": np.array(cumulus.TARGET)}
MAP = {
    "shape": "ellipsoid",
    "seed": man.SEED,
    "octaves": 4,
    "persistence": 0.5,
    "threshold": 0.1,
}


def small_clouds() -> tuple[Cloud, ...]:
    """Give the field of the scene ``cumulus``."""
    return tuple(
        Cloud(
            {"seed": seed, "voxel": cumulus.FIELD_VOXEL},
            {"count": cumulus.FIELD_COUNT, "method": "quick", "seed": seed},
            Placement(
                np.array([x, 0.0, z]),
                scale=scale,
                air=cumulus.FIELD_AIR,
                prune=True,
            ),
            cumulus.FIELD_BUFFERS,
        )
        for seed, x, z, scale in cumulus.FIELD
    )


def hero(air: float | None) -> Cloud:
    """Give the large cloud of the scene ``cumulus``."""
    place = Placement(turn=cumulus.TURN, air=air, prune=True)
    balls = {"count": cumulus.COUNT, "seed": cumulus.SEED}
    return Cloud({"seed": cumulus.SEED}, balls, place)


def fitted(count: int) -> Cloud:
    """Give the cloud of figures 8 to 10."""
    balls = {"count": count, "method": "man", "overlap": man.OVERLAP, "seed": man.SEED}
    return Cloud(MAP, balls, Placement(even=True))


FILES = {
    "cumulus": Declaration(
        "cumulus",
        "a cumulus over a field of small clouds",
        (*small_clouds(), hero(cumulus.HERO_AIR)),
        OWN_EYE,
        (cumulus.SUN,),
        cumulus.Medium(cumulus.SIGMA_T),
        sky=Sky(),
    ),
    "man-04": Declaration(
        "man-04",
        "figure 4: the cloud map",
        (Cloud(MAP),),
        None,
        (man.FRONT,),
        man.CLOUD_MEDIUM,
        named("man"),
    ),
    **{
        name: Declaration(
            name,
            f"figure {int(name[-2:])}: the map as {count} balls",
            (fitted(count),),
            None,
            (man.FRONT,),
            man.CLOUD_MEDIUM,
            named("man"),
        )
        for name, count in (("man-08", 1000), ("man-09", 100), ("man-10", 30))
    },
    **{
        name: Declaration(
            name,
            title,
            (hero(None),),
            OWN_EYE,
            (man.BEHIND,),
            medium,
            named("man"),
            man.EVENING,
        )
        for name, title, medium in (
            ("man-13", "figure 13: isotropic scattering", man.ISOTROPIC),
            ("man-14", "figure 14: anisotropic scattering", man.FORWARD),
        )
    },
}
