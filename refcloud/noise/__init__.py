"""Noise: points or a grid to values, from integer hashes to sums of octaves."""

from refcloud.noise.fractal import (
    octave_bound,
    octave_frame,
    octave_sum,
    octave_sum_grid,
)
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
from refcloud.noise.value import value, value_grid
from refcloud.noise.weights import taps
from refcloud.noise.worley import worley
from refcloud.noise.worley_cells import worley_bound, worley_points
from refcloud.noise.worley_drawn import worley_drawn
from refcloud.noise.worley_grid import worley_grid

__all__ = [
    "catmull_rom",
    "cosine",
    "cubic",
    "elias2d",
    "hermite",
    "lattice_random",
    "linear",
    "man2003",
    "octave_bound",
    "octave_frame",
    "octave_sum",
    "octave_sum_grid",
    "quintic",
    "smoothed",
    "taps",
    "uniform",
    "value",
    "value_grid",
    "worley",
    "worley_bound",
    "worley_drawn",
    "worley_grid",
    "worley_points",
]
