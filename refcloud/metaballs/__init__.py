"""Metaballs: a cloud map as a few hundred balls of density."""

from refcloud.metaballs.approximate import approximate
from refcloud.metaballs.balls import Metaballs, voxel_balls
from refcloud.metaballs.direct import direct_metaballs
from refcloud.metaballs.errors import FitErrors, errors_of_fit
from refcloud.metaballs.field import field, field_grid
from refcloud.metaballs.file import load_metaballs, save_metaballs
from refcloud.metaballs.heights import gradient_descent, largest_eigenvalue
from refcloud.metaballs.integrals import axis_depth, integral, normalisation
from refcloud.metaballs.kernels import (
    chord,
    gaussian,
    printed_wyvill,
    profile,
    wyvill,
)
from refcloud.metaballs.kmeans import Clusters, adaptive_kmeans, lloyd
from refcloud.metaballs.levels import Levels, choose_level, levels_of_detail
from refcloud.metaballs.levels_file import load_levels, save_levels
from refcloud.metaballs.nonnegative import non_negative_least_squares
from refcloud.metaballs.orthogonal import orthogonal_least_squares
from refcloud.metaballs.placement import placed
from refcloud.metaballs.prune import prune
from refcloud.metaballs.sampled import sampled_map
from refcloud.metaballs.spread import rms_radii
from refcloud.metaballs.subtract import place_and_subtract
from refcloud.metaballs.weights import depth

__all__ = [
    "Clusters",
    "FitErrors",
    "Levels",
    "Metaballs",
    "adaptive_kmeans",
    "approximate",
    "axis_depth",
    "choose_level",
    "chord",
    "depth",
    "direct_metaballs",
    "errors_of_fit",
    "field",
    "field_grid",
    "gaussian",
    "gradient_descent",
    "integral",
    "largest_eigenvalue",
    "levels_of_detail",
    "lloyd",
    "load_levels",
    "load_metaballs",
    "non_negative_least_squares",
    "normalisation",
    "orthogonal_least_squares",
    "place_and_subtract",
    "placed",
    "printed_wyvill",
    "profile",
    "prune",
    "rms_radii",
    "sampled_map",
    "save_levels",
    "save_metaballs",
    "voxel_balls",
    "wyvill",
]
