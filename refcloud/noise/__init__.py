"""Noise: points or a grid to values, from integer hashes to sums of octaves."""

from refcloud.noise.directions import gradient_set
from refcloud.noise.fbm import fbm, turbulence
from refcloud.noise.fbm_grid import fbm_grid, turbulence_grid
from refcloud.noise.fractal import octave_sum, octave_sum_grid
from refcloud.noise.gradient import gradient, gradient_derivative
from refcloud.noise.gradient_grid import gradient_grid
from refcloud.noise.hashing import elias2d, lattice_random, man2003, uniform
from refcloud.noise.interpolate import (
    catmull_rom,
    cosine,
    cubic,
    hermite,
    linear,
    quintic,
)
from refcloud.noise.lattice import smoothed
from refcloud.noise.mixing import lattice_bits, permutation_table
from refcloud.noise.octaves import octave_bound, octave_frame
from refcloud.noise.remap import remap
from refcloud.noise.sheet import cloud_sheet, exponential_filter, overlap_octaves
from refcloud.noise.sheet_map import sheet_map, wrap_halo, wrapped_bilinear
from refcloud.noise.simplex import simplex, simplex_derivative
from refcloud.noise.simplex_grid import simplex_grid
from refcloud.noise.smooth import smooth, smooth_grid
from refcloud.noise.value import value
from refcloud.noise.value_grid import value_grid
from refcloud.noise.weights import taps
from refcloud.noise.worley import worley
from refcloud.noise.worley_cells import worley_bound, worley_points
from refcloud.noise.worley_drawn import worley_drawn
from refcloud.noise.worley_grid import worley_grid
from refcloud.noise.worley_smooth import worley_smooth, worley_smooth_grid

__all__ = [
    "catmull_rom",
    "cloud_sheet",
    "cosine",
    "cubic",
    "elias2d",
    "exponential_filter",
    "fbm",
    "fbm_grid",
    "gradient",
    "gradient_derivative",
    "gradient_grid",
    "gradient_set",
    "hermite",
    "lattice_bits",
    "lattice_random",
    "linear",
    "man2003",
    "octave_bound",
    "octave_frame",
    "octave_sum",
    "octave_sum_grid",
    "overlap_octaves",
    "permutation_table",
    "quintic",
    "remap",
    "sheet_map",
    "simplex",
    "simplex_derivative",
    "simplex_grid",
    "smooth",
    "smooth_grid",
    "smoothed",
    "taps",
    "turbulence",
    "turbulence_grid",
    "uniform",
    "value",
    "value_grid",
    "worley",
    "worley_bound",
    "worley_drawn",
    "worley_grid",
    "worley_points",
    "worley_smooth",
    "worley_smooth_grid",
    "wrap_halo",
    "wrapped_bilinear",
]
