"""The figures of paper M that are pictures of clouds, as scenes.

Figure 4 is the cloud map, one ball per voxel. Figures 8 to 10 show clusters whose
densities the paper never fitted. Figures 13 and 14 differ in the phase function alone:
"constant 1", and a lobe strong enough to show the silver lining that the text
describes; eq 25, which the text names, brightens by 1.5 at most
(``refcloud.render("man-14", medium=Medium(1, 0.9))`` shows that).

All of them follow the paper's rules to the letter; ``look="cumulus"`` shows what the
extensions change.
"""

from __future__ import annotations

import numpy as np

from refcloud.cloudmap import VoxelGrid, generate
from refcloud.conventions import WHOLE_SPHERE
from refcloud.declared import Cloud, Declaration, Placement, scene_from
from refcloud.lighting import named
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.scene import enter
from refcloud.scenes import cumulus
from refcloud.sky import Sky

# Figure 4: Z = 4, s = 0.5, t = 0.1, d = 1; this seed gives 11,011 voxels.
SEED = 2
MAP = {
    "shape": "ellipsoid",
    "seed": SEED,
    "octaves": 4,
    "persistence": 0.5,
    "threshold": 0.1,
}
OVERLAP = 2.0  # u of figures 8 to 10
CLOUD_MEDIUM = Medium(1.0, ALBEDO_MAN2003)  # sigma_t is not used: every ball has tau 8
FRONT = Sun(np.array([-0.62, 0.62, 0.42]), np.full(3, 1.6 * WHOLE_SPHERE))

# Figures 13 and 14: the sun stands behind the cloud, just over its summit.
BEHIND = Sun(np.array([0.10, 0.36, -0.93]), np.full(3, 0.5 * WHOLE_SPHERE))
EVENING = Sky(
    zenith=np.array([0.02, 0.075, 0.26]),
    horizon=np.array([0.15, 0.29, 0.54]),
    haze=np.array([0.42, 0.52, 0.66]),
    glow=0.008,
)
ISOTROPIC = Medium(1.0, ALBEDO_MAN2003, phase="isotropic")
FORWARD = Medium(1.0, ALBEDO_MAN2003, g=0.5, phase="hg")


def cloud_map() -> VoxelGrid:
    """Generate the cloud of figure 4."""
    return generate(**MAP)


def fitted(count: int) -> Cloud:
    """Give the cloud of figures 8 to 10: phases 1 and 2, every density 1."""
    balls = {"count": count, "method": "man", "overlap": OVERLAP, "seed": SEED}
    return Cloud(MAP, balls, Placement(even=True))


def large() -> Cloud:
    """Give the large cloud of the scene ``cumulus``."""
    hero = cumulus.OWN.hero
    balls = {"count": cumulus.OWN.count, "seed": hero.seed}
    return Cloud({"seed": hero.seed}, balls, Placement(turn=hero.turn, prune=True))


def in_front(number: int, title: str, cloud: Cloud) -> Declaration:
    """Declare a cloud that is framed by itself, the sun in front."""
    name, title = f"man-{number:02}", f"figure {number}: {title}"
    lit = (FRONT,), CLOUD_MEDIUM, named("man")
    return Declaration(name, title, (cloud,), None, *lit)


def against(number: int, title: str, medium: Medium) -> Declaration:
    """Declare the large cloud against the sun."""
    name, title = f"man-{number:02}", f"figure {number}: {title} scattering"
    camera = {"eye": cumulus.OWN.eye, "target": cumulus.OWN.target}
    lit = (BEHIND,), medium, named("man"), EVENING
    return Declaration(name, title, (large(),), camera, *lit)


DECLARED = {
    declared.name: declared
    for declared in (
        in_front(4, "the cloud map", Cloud(MAP)),
        in_front(8, "the map as 1000 balls", fitted(1000)),
        in_front(9, "the map as 100 balls", fitted(100)),
        in_front(10, "the map as 30 balls", fitted(30)),
        against(13, "isotropic", ISOTROPIC),
        against(14, "anisotropic", FORWARD),
    )
}
for declared in DECLARED.values():
    enter(scene_from(declared))
