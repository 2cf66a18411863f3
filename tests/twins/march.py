"""The march room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import refcloud.march as array
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.plain import chords
from refcloud.plain import march as plain
from twins import Draw, twin
from twins.cloudmap import grids, places

WITHOUT: dict[str, str] = {}

ROUNDED = "worst seen 3.2e-15 in 600 examples, times 20: tens of products round apart"
SAME_POINTS = "worst seen 1.9e-15 in 600 examples, times 20: the same points"

ways = st.tuples(*[st.sampled_from([0.0, 1.0, -1.0]) | st.floats(-1.0, 1.0)] * 3)
colours = st.tuples(*[st.floats(0.0, 3.0)] * 3)
shares = st.floats(0.0, 1.0)
numbers_or_colours = st.floats(0.0, 6.0) | st.tuples(*[st.floats(0.0, 6.0)] * 3)


@st.composite
def directions(draw: st.DrawFn) -> tuple[float, float, float]:
    """Draw a direction that is plainly one; along axes and planes too."""
    way = draw(ways)
    assume(max(map(abs, way)) > 0.1)
    # What is nearly parallel may cut a plane on either side.
    return tuple(0.0 if abs(v) < 1e-3 else v for v in way)


@st.composite
def suns(draw: st.DrawFn) -> Sun:
    return Sun(np.array(draw(directions())), np.array(draw(colours)))


@st.composite
def media(draw: st.DrawFn) -> Medium:
    return Medium(
        draw(numbers_or_colours),
        draw(shares | st.tuples(shares, shares, shares)),
        draw(st.floats(-0.9, 0.9)),
        draw(st.sampled_from(["hg", "rayleigh", "isotropic"])),
    )


@st.composite
def mixings(draw: st.DrawFn) -> array.Mixing:
    factors = st.floats(0.01, 3.0) | st.just(0.0)
    return array.Mixing(draw(factors), draw(factors), draw(shares))


def plain_cloud(grid) -> plain.Cloud:
    return plain.Cloud(grid.density.tolist(), tuple(grid.lower), tuple(grid.upper))


def plain_sun(sun: Sun) -> plain.Sun:
    return plain.Sun(tuple(sun.direction.tolist()), sun.irradiance.tolist())


def plain_medium(medium: Medium) -> plain.Medium:
    sigma_t, albedo = medium.sigma_t_rgb.tolist(), medium.albedo_rgb.tolist()
    return plain.Medium(sigma_t, albedo, medium.g, medium.phase)


def plain_mixing(mixing: array.Mixing) -> plain.Mixing:
    return plain.Mixing(*vars(mixing).values())


def by_channel(radiance, transmittance) -> np.ndarray:
    """Put both results into one array, (2, 3)."""
    return np.stack([radiance, np.broadcast_to(transmittance.T, (3,))])


def some_ray(draw: Draw, grid) -> tuple[np.ndarray, tuple[float, float, float]]:
    """Draw a ray through a place in or near the box, from before it, or from it on."""
    share = np.array(draw(st.tuples(*[st.floats(-0.1, 1.1)] * 3)))
    way, back = draw(directions()), draw(st.just(0.0) | st.floats(-1.0, 5.0))
    place = grid.lower + share * (grid.upper - grid.lower)
    return place - back * np.array(way), way


@twin(array.ray_box, plain.ray_box, tolerance=0.0, why="the same quotients")
def ray_box(draw: Draw):
    lower = draw(places)
    upper = np.add(lower, draw(st.tuples(*[st.floats(0.1, 4.0)] * 3)))
    on_face = st.sampled_from([*lower, *upper.tolist()])
    way, back = np.array(draw(directions())), draw(st.just(0.0) | st.floats(-1.0, 5.0))
    inside = lower + np.array(draw(st.tuples(*[st.floats(-0.1, 1.1)] * 3))) * (
        upper - lower
    )
    place = np.array(draw(st.tuples(*[st.just(v) | on_face for v in inside])))
    origin, way = tuple((place - back * way).tolist()), tuple(way.tolist())
    actual = array.ray_box(origin, [way], lower=lower, upper=upper)
    expected = plain.ray_box(origin, way, lower, tuple(upper.tolist()))
    return np.ravel(actual), expected


@twin(
    array.sources,
    plain.sources,
    tolerance=5e-14,
    why="worst seen 4e-15: at |g| = 0.9 a last bit of the cosine counts 15 times",
)
def sources(draw: Draw):
    sun, medium, way = draw(suns()), draw(media()), np.array(draw(directions()))
    way /= np.sqrt(way @ way)
    actual = array.sources((sun,), medium, directions=way[None])
    expected = plain.sources(plain_sun(sun), plain_medium(medium), tuple(way.tolist()))
    return actual[0, 0], expected


@twin(array.segment_share, plain.segment_share, tolerance=5e-16, why="one function")
def segment_share(draw: Draw):
    tau = draw(st.lists(st.floats(0.0, 50.0) | st.floats(0.0, 1e-6), max_size=4))
    segment = draw(st.sampled_from(["beer", "euler"]))
    actual = array.segment_share(tau, segment)
    return actual, [plain.segment_share(t, segment) for t in tau]


@twin(
    array.sun_depth_by_steps,
    plain.sun_depth_by_steps,
    tolerance=6e-14,
    why=ROUNDED,
)
def sun_depth_by_steps(draw: Draw):
    grid, sun, rate = draw(grids()), draw(suns()), draw(st.integers(1, 5))
    share = np.array(draw(st.tuples(*[shares] * 3)))
    point = grid.lower + share * (grid.upper - grid.lower)
    actual = array.sun_depth_by_steps(
        grid, point[None], direction=sun.direction, sample_rate=rate
    )
    toward = tuple(sun.direction.tolist())
    cloud = plain_cloud(grid)
    expected = plain.sun_depth_by_steps(cloud, tuple(point.tolist()), toward, rate)
    return actual, [expected]


@twin(array.march_by_steps, plain.march_by_steps, tolerance=6e-14, why=ROUNDED)
def march_by_steps(draw: Draw):
    grid, medium, mixing = draw(grids()), draw(media()), draw(mixings())
    lights = draw(st.lists(suns(), max_size=2))
    origin, way = some_ray(draw, grid)
    how = {
        "sample_rate": draw(st.integers(1, 4)),
        "sun_sample_rate": draw(st.integers(1, 4)),
        "segment": draw(st.sampled_from(["beer", "euler"])),
    }
    actual = array.march_by_steps(
        grid, origin, way, suns=tuple(lights), medium=medium, mixing=mixing, **how
    )
    expected = plain.march_by_steps(
        plain_cloud(grid),
        tuple(origin.tolist()),
        way,
        [plain_sun(sun) for sun in lights],
        plain_medium(medium),
        mixing=plain_mixing(mixing),
        **how,
    )
    return by_channel(*actual), expected


@twin(array.integrate, plain.integrate, tolerance=4e-14, why=SAME_POINTS)
def integrate(draw: Draw):
    grid, medium, mixing = draw(grids()), draw(media()), draw(mixings())
    lights = draw(st.lists(suns(), max_size=2))
    origin, way = some_ray(draw, grid)
    light = {"background": draw(colours), "ambient": draw(colours)}
    actual = array.integrate(
        grid, origin, way, suns=tuple(lights), medium=medium, mixing=mixing, **light
    )
    expected = plain.integrate(
        plain_cloud(grid),
        tuple(origin.tolist()),
        way,
        [plain_sun(sun) for sun in lights],
        plain_medium(medium),
        mixing=plain_mixing(mixing),
        **light,
    )
    return by_channel(*actual), expected


@twin(
    array.ball_columns,
    chords.ball_columns,
    tolerance=1e-13,
    why="worst seen 4e-16 in 600 examples; Gaussian balls are held against their field",
)
def ball_columns(draw: Draw):
    sizes = st.floats(0.1, 3.0)
    balls = draw(st.lists(st.tuples(places, sizes, sizes), max_size=4))
    origin, way = draw(places), draw(directions())
    centers = np.reshape([ball[0] for ball in balls], (-1, 3))
    metaballs = Metaballs(centers, [b[1] for b in balls], [b[2] for b in balls])
    actual = array.ball_columns(metaballs, [origin], [way])
    return actual, [chords.ball_columns(balls, origin, way)]
