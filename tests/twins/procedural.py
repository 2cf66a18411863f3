"""Document S's noise as textures and shapes beside its plain twins."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

import refcloud.sky as array
from refcloud.plain import camera as plain_camera
from refcloud.plain import procedural as plain
from twins import Draw, twin
from twins.noise import seeds
from twins.skies import few, fields, noises, unit_places

SUMMED = "sums of octaves: worst seen some 1e-15"

times = st.none() | st.floats(-5.0, 5.0)


@twin(array.fractal_texture, plain.fractal_texture, tolerance=1e-13, why=SUMMED)
def fractal_texture(draw: Draw):
    size = draw(st.integers(1, 4))
    how = {
        "cells": draw(st.integers(1, 3)),
        "time": draw(times),
        "seed": draw(seeds),
        "octaves": draw(st.integers(1, 3)),
        "persistence": draw(st.floats(0.1, 1.0)),
    }
    return array.fractal_texture(size, **how)[0], plain.fractal_texture(size, **how)


@twin(array.fractal_volume, plain.fractal_volume, tolerance=1e-13, why=SUMMED)
def fractal_volume(draw: Draw):
    size, time = draw(st.integers(1, 2)), draw(times)
    how = {
        "cells": draw(st.integers(1, 3)),
        "time": time,
        "kind": draw(st.sampled_from(["simplex", "gradient"])),
        "seed": draw(seeds),
        "octaves": draw(st.integers(1, 2)),
        "persistence": 0.5,
    }
    return array.fractal_volume(size, **how)[0], plain.fractal_volume(size, **how)


@twin(array.puff_density, plain.puff_density, tolerance=1e-12, why=SUMMED)
def puff_density(draw: Draw):
    puff = array.Puff(
        radius=draw(st.floats(0.3, 2.0)),
        cell=draw(st.floats(0.1, 1.0)),
        distortion=draw(st.floats(0.0, 2.0)),
        softness=draw(st.floats(0.05, 2.0)),
        combine=draw(st.sampled_from(["distort", "multiply"])),
        octaves=draw(st.integers(1, 3)),
        seed=draw(seeds),
        period=draw(st.integers(1, 8)),
    )
    points, time = draw(few(unit_places, 2, 2)), draw(st.floats(-5.0, 5.0))
    named = fields(puff, plain.Puff)
    expected = [plain.puff_density(*p, named, time) for p in points.tolist()]
    return array.puff_density(points, puff, time=time), expected


@twin(array.displaced_sphere, plain.displaced_sphere, tolerance=1e-12, why=SUMMED)
def displaced_sphere(draw: Draw):
    way = st.tuples(noises, noises, noises).filter(lambda v: math.hypot(*v) > 0.1)
    ways = [plain_camera.unit(v) for v in draw(st.lists(way, min_size=1, max_size=2))]
    displacement = array.Displacement(
        draw(st.floats(0.0, 0.9)),
        draw(st.floats(0.1, 3.0)),
        draw(st.integers(1, 2)),
        draw(st.floats(0.0, 1.0)),
        draw(seeds),
    )
    time = draw(st.floats(-5.0, 5.0))
    named = fields(displacement, plain.Displacement)
    actual = array.displaced_sphere(np.array(ways), displacement, time=time)
    expected = [plain.displaced_sphere(w, named, time) for w in ways]
    return np.stack(actual, axis=1), expected
