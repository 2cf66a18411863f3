"""Light and matter: suns, media, phase functions, extinction, and guards on gain."""

from refcloud.optics.extinction import (
    ALBEDO_MAN2003,
    PHASE_MAN2003,
    TAU_MAN2003,
    beer_lambert,
    coupling_man2003,
    largest_steady_tau,
    scattered_man2003,
    scattered_split,
)
from refcloud.optics.media import Medium, Sun
from refcloud.optics.phase import (
    henyey_greenstein,
    isotropic,
    phase,
    rayleigh,
    rayleigh_man2003,
)

__all__ = [
    "ALBEDO_MAN2003",
    "PHASE_MAN2003",
    "TAU_MAN2003",
    "Medium",
    "Sun",
    "beer_lambert",
    "coupling_man2003",
    "henyey_greenstein",
    "isotropic",
    "largest_steady_tau",
    "phase",
    "rayleigh",
    "rayleigh_man2003",
    "scattered_man2003",
    "scattered_split",
]
