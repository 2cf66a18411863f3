"""Smooth noise, remap and the Worley-smooth texture beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud import cloudmap
from refcloud.plain import smooth as plain
from twins import twin
from twins.noise import coordinates, seeds
from twins.worley import dimensions, drawn_places

ROUNDED = "worst seen 4.2e-16 in 1,500 examples, times 8: corners are summed otherwise"
FILLED = "worst seen 4.5e-16 in 1,500 examples, times 8"

numbers = st.floats(-100.0, 100.0)
cells = st.none() | st.integers(1, 9)
details = st.sampled_from(["smooth", "gradient"])
octaves = st.integers(1, 4)
smooth_ways = st.fixed_dictionaries(
    {
        "seed": seeds,
        "period": cells | st.just(2**31),
        "octaves": octaves | st.just(32),
        "normalize": st.sampled_from(["bound", "none", "source"]),
        "origins": st.sampled_from(["own", "shared"]),
    }
)
texture_ways = st.fixed_dictionaries(
    {"seed": seeds, "octaves": octaves, "detail": details}
)
line = st.lists(coordinates, min_size=1, max_size=2)


@twin(array.smooth, plain.smooth, tolerance=3.4e-15, why=ROUNDED)
def smooth(draw):
    places, how = drawn_places(draw, draw(dimensions)), draw(smooth_ways)
    expected = [plain.smooth(place, **how) for place in places]
    return array.smooth(np.array(places), **how), expected


@twin(array.smooth_grid, plain.smooth_grid, tolerance=3.4e-15, why=ROUNDED)
def smooth_grid(draw):
    axes, how = [draw(line) for _ in range(draw(dimensions))], draw(smooth_ways)
    return array.smooth_grid(*axes, **how), plain.smooth_grid(*axes, **how)


@twin(array.remap, plain.remap, tolerance=0.0, why="the same steps")
def remap(draw):
    value, l0, ln, hn = (draw(numbers) for _ in range(4))
    # A range of the width of a last bit has no line worth comparing.
    h0 = draw(st.just(l0) | numbers.filter(lambda h: abs(h - l0) > 1e-3))
    how = {"empty": "step" if l0 == h0 else draw(st.sampled_from(["step", "refuse"]))}
    actual = array.remap(value, l0, h0, ln, hn, **how)
    return actual, plain.remap(value, l0, h0, ln, hn, **how)


@twin(array.worley_smooth, plain.worley_smooth, tolerance=3.6e-15, why=FILLED)
def worley_smooth(draw):
    places = drawn_places(draw, draw(dimensions))
    how = draw(texture_ways) | {"period": draw(cells)}
    expected = [plain.worley_smooth(place, **how) for place in places]
    return array.worley_smooth(np.array(places), **how), expected


@twin(array.worley_smooth_grid, plain.worley_smooth_grid, tolerance=3.6e-15, why=FILLED)
def worley_smooth_grid(draw):
    axes = [draw(line) for _ in range(draw(dimensions))]
    how = draw(texture_ways) | {"period": draw(cells)}
    actual = array.worley_smooth_grid(*axes, **how)
    return actual, plain.worley_smooth_grid(*axes, **how)


@twin(
    cloudmap.worley_smooth_texture,
    plain.worley_smooth_texture,
    tolerance=3.6e-14,
    why="as the noise, divided by 1 - threshold, a tenth or more",
)
def worley_smooth_texture(draw):
    how = draw(texture_ways)
    how |= {"cells": draw(st.integers(1, 4)), "threshold": draw(st.floats(0.0, 0.9))}
    size = draw(st.sampled_from([1, 1, 1, 2]))
    actual = cloudmap.worley_smooth_texture(size, **how).density
    return actual, plain.worley_smooth_texture(size, **how)
