"""The picture is the literal loop's, whatever the rules, the eye and the medium."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import LOOKS, MEDIUM, SUNS
from twins.lighting import (
    clouds,
    colours,
    looks,
    media,
    scattered_balls,
    seeds,
    suns_of,
)

from refcloud.camera import Camera, OrthographicCamera
from refcloud.lighting import Haze, eyeward, eyeward_literal, sunward

# Weights of the light field go down to OWN, which magnifies rounding by 1000: worst
# seen 1.6e-13 of the brightest in 2000 scenes.
CLOSE = 1e-12
hazes = st.none() | st.builds(Haze, colours, st.floats(1.0, 50.0))
eyes = st.sampled_from(
    [
        Camera([0.5, 1.0, 7.0], [0, 0, 0], width=40, height=30),
        Camera([0.1, 0.2, 1.0], [0, 0, 0], width=33, height=20),  # among the balls
        OrthographicCamera([1, 1, 5], [0, 0, 0], height_of_view=4, width=35, height=18),
    ]
)


def differ(lit, camera, background, haze, seed) -> float:
    how = {"background": background, "haze": haze, "seed": seed}
    expected = eyeward_literal(lit, camera, **how)
    found, _ = eyeward(lit, camera, **how)
    return float(np.abs(found - expected).max() / max(1.0, np.abs(expected).max()))


@settings(max_examples=40)
@given(clouds(12), suns_of(), media, looks, eyes, hazes, seeds, st.booleans())
def test_it_is_the_literal_loop(
    balls, suns, medium, look, camera, haze, seed, solid
) -> None:
    lit = sunward(balls, suns, medium=medium, look=look)
    shape = camera.height, camera.width, 3
    behind = np.linspace(0.0, 1.0, np.prod(shape)).reshape(shape) if solid else None
    assert differ(lit, camera, behind, haze, seed) <= CLOSE


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
@pytest.mark.parametrize("kernel", ["wyvill", "gaussian"])
def test_so_are_long_lists(look, kernel) -> None:
    balls = scattered_balls(4, 200, kernel)
    rules = dataclasses.replace(look, tau=None)
    camera = Camera([0.5, 1.0, 7.0], [0, 0, 0], width=60, height=45)
    lit = sunward(balls, SUNS, medium=MEDIUM, look=rules)
    assert differ(lit, camera, None, None, 3) <= CLOSE
