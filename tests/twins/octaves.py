"""Octaves of scattering, and clouds that shine, beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.lighting as array
from refcloud.noise import uniform
from refcloud.plain import octaves as plain
from twins import Draw, twin
from twins.camera import as_plain, drawn_camera
from twins.cloudmap import grids, plain_grid
from twins.noise import seeds

WITHOUT = {
    "refcloud.lighting.octave_march.octave_march": "composed of functions with rows"
}

share = st.floats(0.0, 1.0)
cosines = st.sampled_from([-1.0, 0.0, 1.0]) | st.floats(-1.0, 1.0)
means = st.floats(-0.95, 0.95)
depths = st.lists(st.floats(0.0, 50.0), min_size=1, max_size=4)
colours = st.tuples(*[st.floats(0.0, 2.0)] * 3)
PEAK = "worst seen 2e-14; lobes of peak 400 magnify the last bits of 1 - g c^n"


@st.composite
def models(draw: st.DrawFn) -> array.Octaves:
    return array.Octaves(
        draw(st.integers(1, 6)),
        *(draw(share) for _ in range(5)),
        sky_light=np.array(draw(colours)),
        ground_light=np.array(draw(colours)),
        sky_extinction=draw(share),
    )


def as_plain_model(octaves: array.Octaves) -> plain.Octaves:
    fields = (getattr(octaves, name) for name in plain.Octaves._fields)
    return plain.Octaves(*(np.asarray(value).tolist() for value in fields))


@twin(array.octave_lobe, plain.octave_lobe, tolerance=1e-12, why=PEAK)
def octave_lobe(draw: Draw):
    octaves, g, n = draw(models()), draw(means), draw(st.integers(0, 15))
    places = draw(st.lists(cosines, min_size=1, max_size=4))
    actual = array.octave_lobe(places, n, g=g, octaves=octaves)
    model = as_plain_model(octaves)
    return actual, [plain.octave_lobe(c, n, g, model) for c in places]


@twin(array.octave_source, plain.octave_source, tolerance=1e-12, why=PEAK)
def octave_source(draw: Draw):
    octaves, g, albedo, tau = draw(models()), draw(means), draw(share), draw(depths)
    places = [draw(cosines) for _ in tau]
    actual = array.octave_source(places, tau, g=g, albedo=albedo, octaves=octaves)
    model = as_plain_model(octaves)
    pairs = zip(places, tau, strict=True)
    return actual, [plain.octave_source(c, t, g, albedo, model) for c, t in pairs]


@twin(
    array.sky_source, plain.sky_source, tolerance=2e-15, why="the same steps: last bits"
)
def sky_source(draw: Draw):
    octaves, above = draw(models()), draw(depths)
    below = [draw(st.floats(0.0, 50.0)) for _ in above]
    actual = array.sky_source(above, below, octaves=octaves)
    model = as_plain_model(octaves)
    pairs = zip(above, below, strict=True)
    return actual, [plain.sky_source(a, b, model) for a, b in pairs]


@twin(
    array.march_shining,
    plain.march_shining,
    tolerance=1e-11,
    why="worst seen 5e-14; a last bit of a place 20 away moves it among cells of 0.1",
)
def march_shining(draw: Draw):
    camera, grid = drawn_camera(draw), draw(grids())
    numbers = np.arange(3 * grid.density.size)
    colors = uniform(numbers, seed=draw(seeds)).reshape(*grid.density.shape, 3)
    how = {
        "sigma_t": draw(st.floats(0.0, 3.0)),
        "step": draw(st.floats(0.1, 1.0)),
        "least": draw(st.sampled_from([0.0, 0.1])),
        "seed": draw(seeds),
    }
    light, T = array.march_shining(grid, colors, camera, **how)
    channels = [colors[..., channel].tolist() for channel in range(3)]
    density, lower, upper = plain_grid(grid)
    expected = [
        [
            plain.march_shining(
                density, channels, lower, upper, as_plain(camera), i, j, **how
            )
            for i in range(camera.width)
        ]
        for j in range(camera.height)
    ]
    return np.concatenate([light, T[..., None]], axis=-1), expected
