"""Metaballs: a cloud map as a few hundred balls of density."""

from refcloud.metaballs.balls import Metaballs, voxel_balls
from refcloud.metaballs.field import field, field_grid
from refcloud.metaballs.integrals import axis_depth, integral, normalisation
from refcloud.metaballs.kernels import (
    chord,
    gaussian,
    printed_wyvill,
    profile,
    wyvill,
)

__all__ = [
    "Metaballs",
    "axis_depth",
    "chord",
    "field",
    "field_grid",
    "gaussian",
    "integral",
    "normalisation",
    "printed_wyvill",
    "profile",
    "voxel_balls",
    "wyvill",
]
