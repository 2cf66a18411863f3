"""Scenes at the ends of every range: a finite picture, or a refusal in one line."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from refcloud.camera import Camera, OrthographicCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.image import Picture
from refcloud.lighting import Haze
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.sky import Sky

pytestmark = pytest.mark.stress

SIDES = {"width": 5, "height": 4}
ENDS = [
    5e-324,
    1e-300,
    1e-50,
    1e-12,
    1e-3,
    1.0,
    7.3,
    1e3,
    1e9,
    1e15,
    1e50,
    1e200,
    1e300,
]
POSITIVE = st.sampled_from(ENDS)
NUMBER = st.just(0.0) | POSITIVE
SIGNED = NUMBER | POSITIVE.map(lambda x: -x)
TAME = st.floats(-3.0, 3.0)
G = st.sampled_from([0.0, 0.7, -0.7, 1 - 1e-12, -(1 - 1e-12), 1 - 1e-16, 5e-324])
TOLERANCE = st.sampled_from([0.0, 1e-300, 1e-6, 1 / 255, 1.0])
# One coordinate in some is extreme: were all of them, none would be seen.
some = st.one_of(TAME, TAME, TAME, SIGNED)
vectors = st.lists(some, min_size=3, max_size=3)
colours = st.lists(NUMBER | st.floats(0.0, 2.0), min_size=3, max_size=3)
sizes = st.floats(0.1, 2.0) | POSITIVE
seldom = settings(
    max_examples=150, deadline=None, suppress_health_check=list(HealthCheck)
)


@st.composite
def balls(draw: st.DrawFn) -> Metaballs:
    count = draw(st.integers(0, 4))

    def many(each: st.SearchStrategy) -> list:
        return draw(st.lists(each, min_size=count, max_size=count))

    kernel = draw(st.sampled_from(["wyvill", "gaussian"]))
    centers = np.reshape(many(vectors), (count, 3))
    return Metaballs(centers, many(sizes), many(NUMBER | st.floats(0, 2)), kernel)


@st.composite
def grids(draw: st.DrawFn) -> VoxelGrid:
    shape = draw(st.tuples(*[st.integers(1, 4)] * 3))
    count = int(np.prod(shape))
    each = draw(st.sampled_from([st.sampled_from([0.0, 1.0]), NUMBER]))
    density = draw(st.lists(each, min_size=count, max_size=count))
    lower = np.array(draw(vectors))
    upper = lower + np.array(draw(st.lists(sizes, min_size=3, max_size=3)))
    return VoxelGrid(np.reshape(density, shape), lower, upper)


suns = st.lists(st.builds(Sun, vectors, colours), max_size=2).map(tuple)
media = st.builds(
    Medium,
    NUMBER | st.floats(0.0, 9.0) | colours,
    st.sampled_from([0.0, 0.9, 1.0, 5e-324, [1.0, 0.5, 0.0]]),
    G,
    st.sampled_from(["hg", "rayleigh", "isotropic"]),
)
cameras = st.builds(
    Camera,
    vectors | st.just([0.0, 0.0, 6.0]),
    vectors | st.just([0.0, 0.0, 0.0]),
    vectors | st.just([0.0, 1.0, 0.0]),
    st.sampled_from([1e-9, 1e-3, 0.5, 3.0, np.pi - 1e-9]),
    **{name: st.just(size) for name, size in SIDES.items()},
) | st.builds(
    OrthographicCamera,
    vectors,
    vectors,
    height_of_view=sizes,
    **{name: st.just(size) for name, size in SIDES.items()},
)
hazes = st.none() | st.builds(Haze, colours, sizes)
backgrounds = st.one_of(st.none(), st.just("transparent"), colours, st.builds(Sky))


def drawn_or_refused(data: st.DataObject, cloud: st.SearchStrategy, **more) -> None:
    """Draw the parts of a scene and its picture; refusals are one line each."""
    how = {
        "camera": st.none() | cameras,
        "suns": st.none() | suns,
        "medium": st.none() | media,
        "haze": hazes,
        "background": backgrounds,
        "tolerance": TOLERANCE,
        **more,
    }
    refusal = ""
    try:
        given = {name: data.draw(each, label=name) for name, each in how.items()}
        picture = render(data.draw(cloud, label="cloud"), **SIDES, **given)
    except (ValueError, TypeError) as error:
        refusal = str(error)
    if refusal:
        assert re.fullmatch(r"[\w. x,-]+: expected [^\n]+", refusal)
    else:
        fits(picture)


def fits(picture: Picture) -> None:
    """See that a picture holds light and nothing else."""
    assert picture.linear.shape == (4, 5, 3)
    assert np.isfinite(picture.linear).all()
    assert picture.linear.min() >= 0.0
    if picture.alpha is not None:
        assert 0.0 <= picture.alpha.min() <= picture.alpha.max() <= 1.0
    assert all(np.isfinite(row.bound) and row.bound >= 0 for row in picture.skipped)
    assert picture.codes().dtype == np.uint8


@seldom
@given(st.data())
def test_splats(data: st.DataObject) -> None:
    look = st.sampled_from(["cumulus", "man"])
    drawn_or_refused(data, balls(), look=look)


@seldom
@given(st.data())
def test_marched_balls(data: st.DataObject) -> None:
    drawn_or_refused(data, balls(), method=st.just("march"), ambient=colours)


@seldom
@given(st.data())
def test_marched_grids(data: st.DataObject) -> None:
    drawn_or_refused(data, grids(), ambient=st.none() | colours)


@seldom
@given(st.data())
def test_grids_splatted_as_voxels(data: st.DataObject) -> None:
    drawn_or_refused(data, grids(), method=st.just("splat"))


@seldom
@given(st.data())
def test_grids_with_every_order_of_scattering(data: st.DataObject) -> None:
    drawn_or_refused(data, grids(), scattering=st.just("multiple"))
