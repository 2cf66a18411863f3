"""The lighting room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import refcloud.lighting as array
from refcloud.conventions import WHOLE_SPHERE
from refcloud.lighting import erosion, lightfield, shading
from refcloud.lighting.lightview import BORDER
from refcloud.lighting.seen import RISE
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from refcloud.plain import erosion as plain_erosion
from refcloud.plain import eyeward as plain_eyeward
from refcloud.plain import lighting as plain
from twins import Draw, twin
from twins.camera import as_plain, drawn_camera
from twins.optics import PHASES

WITHOUT = {
    "refcloud.lighting.look.named": "looks rules up; nothing is computed",
    "refcloud.lighting.solved.lit_by_solution": "reads a solved field at centres; held"
    " against it and against the march in tests/lighting/test_solved.py",
    "refcloud.lighting.solved_march.solved_march": "march_shining with other colors;"
    " tested in tests/lighting/test_solved_march.py",
    "refcloud.lighting.solved_march.block_means": "means of blocks; tested in"
    " tests/lighting/test_solved_march.py",
    "refcloud.lighting.solved.solved_light": "scattered_light of a sampled map, light"
    " by light; tested in tests/lighting/test_solved.py",
}

ROUNDED = "worst seen 1.1e-16 in 500 examples, times 10: the same few operations"
CARRIED = "worst seen 7.6e-16 in 1500 examples, times 13: balls in a chain"
MAGNIFIED = "worst seen 2.6e-14 in 1500 examples; weights go down to OWN"

seeds = st.integers(0, 2**63 - 1)
unit = st.floats(0.0, 1.0)
channels = st.floats(0.0, 2.0)
colours = st.tuples(channels, channels, channels)
grey_or_rgb = st.floats(0.0, 4.0) | st.tuples(*[st.floats(0.0, 4.0)] * 3)
FIXED = plain_eyeward.Fixed(
    soft=erosion.SOFT,
    front=shading.FRONT,
    rise=RISE,
    own=lightfield.OWN,
    spacing=lightfield.SPACING,
    most_nodes=lightfield.MOST_NODES,
)


def scattered_balls(seed: int, count: int, kernel: Any = "wyvill") -> Metaballs:
    """Give balls around the origin: hashed, since drawn ones have rims in line."""
    k = np.arange(count)
    thin = np.where(uniform(k, 5, seed=seed) < 0.2, 0.0, 1.0)
    return Metaballs(
        3.0 * uniform(k[:, None], np.arange(3), seed=seed) - 1.5,
        0.3 + 1.2 * uniform(k, 3, seed=seed),
        thin * 2.0 * uniform(k, 4, seed=seed),
        kernel,
    )


@st.composite
def clouds(draw: st.DrawFn, most: int = 4) -> Metaballs:
    count = draw(st.integers(0, most), label="balls")
    kernel = draw(st.sampled_from(["wyvill", "gaussian"]))
    return scattered_balls(draw(seeds), count, kernel)


@st.composite
def suns_of(draw: st.DrawFn, most: int = 2) -> tuple[Sun, ...]:
    """Draw suns in hashed directions, dark ones among them."""
    found = []
    for _ in range(draw(st.integers(0, most), label="suns")):
        way = uniform(np.arange(3), seed=draw(seeds)) - 0.5
        color = draw(st.just((0.0, 0.0, 0.0)) | colours)
        found.append(Sun(way, WHOLE_SPHERE * np.array(color)))
    return tuple(found)


media = st.builds(
    Medium,
    grey_or_rgb,
    unit | st.tuples(unit, unit, unit),
    st.floats(-0.9, 0.9),
    st.sampled_from(PHASES),
)
dark = st.just((0.0, 0.0, 0.0))
sides = st.integers(1, 6)
# Any rules at all, with buffers small enough for the literal loop.
looks = st.builds(
    array.Look,
    scattering=st.sampled_from(["split", "man2003"]),
    transmittance=st.sampled_from(["beer", "linear"]),
    footprint=st.sampled_from(["chord", "profile"]),
    readback=st.sampled_from(["footprint", "disc", "square", "antialiased"]),
    tau=st.none() | st.sampled_from([0.0, 0.5, 8.0, 30.0, 1e37]),
    forward=unit,
    solid_angle=st.sampled_from([0.0, 0.09, 1.0, 6.0]),
    gain=st.just("hold"),
    sky_light=dark | colours,
    ground_light=dark | colours,
    sky_forward=unit,
    light_reach=st.sampled_from([0.0, 0.7, 1.15]),
    erosion=st.sampled_from([0.0, 0.3, 0.9]),
    erosion_cell=st.floats(1.0, 8.0),
    erosion_depth=st.floats(0.5, 2.0),
    relief=st.sampled_from([0.0, 0.5, 1.0]),
    buffer=sides,
    sky_buffer=sides,
)


def rules_of(look: array.Look) -> plain.Rules:
    fields = {name: getattr(look, name) for name in plain.Rules._fields}
    lists = {k: v.tolist() for k, v in fields.items() if isinstance(v, np.ndarray)}
    return plain.Rules(**(fields | lists))


def listed(balls: Metaballs) -> list[tuple]:
    centers, radii, thick = balls.centers, balls.radii, balls.densities
    return list(zip(centers.tolist(), radii.tolist(), thick.tolist(), strict=True))


def lamps(suns: tuple[Sun, ...]) -> list[tuple]:
    return [(tuple(s.direction.tolist()), s.irradiance.tolist()) for s in suns]


def medium_of(medium: Medium) -> plain.Medium:
    rgb = medium.sigma_t_rgb.tolist(), medium.albedo_rgb.tolist()
    return plain.Medium(*rgb, medium.g, medium.phase)


def lit_of(lit: array.LitMetaballs) -> plain.Lit:
    return plain.Lit(
        listed(lit.balls),
        lit.balls.kernel,
        lamps(lit.suns),
        lit.light.tolist(),
        lit.ambient.tolist(),
        medium_of(lit.medium),
        rules_of(lit.look),
        None if lit.glow is None else lit.glow.tolist(),
    )


def drawn_lit(draw: Draw) -> array.LitMetaballs:
    """Draw balls with any light on them, carried or not."""
    balls, suns = draw(clouds()), draw(suns_of())
    k, s = np.arange(len(balls)), np.arange(len(suns))
    seed = draw(seeds)
    light = WHOLE_SPHERE * uniform(
        s[:, None, None], k[:, None], np.arange(3), seed=seed
    )
    ambient = uniform(9, k[:, None], np.arange(3), seed=seed)
    glow = 0.5 * light if draw(st.booleans()) else None
    how = draw(media), draw(looks)
    return array.LitMetaballs(balls, suns, light, ambient, *how, glow=glow)


@twin(array.depth_order, plain.depth_order, tolerance=0.0, why="the same order")
def depth_order(draw: Draw):
    place = st.tuples(*[st.integers(0, 1)] * 3)
    size = st.sampled_from([1.0, 2.0])
    balls = draw(st.lists(st.tuples(place, size, size), max_size=6))
    depths = [draw(st.sampled_from([-1.0, 0.0, 2.0])) for _ in balls]
    centers = np.reshape([b[0] for b in balls], (-1, 3)).astype(float)
    metaballs = Metaballs(centers, [b[1] for b in balls], [b[2] for b in balls])
    actual = array.depth_order(metaballs, np.array(depths))
    return actual, plain.depth_order(balls, depths)


@twin(array.eroded, plain_erosion.eroded, tolerance=1e-15, why=ROUNDED)
def eroded(draw: Draw):
    weight, noise = (
        draw(arrays(float, 5, elements=unit)),
        draw(arrays(float, 5, elements=unit)),
    )
    share = draw(st.floats(0.0, 1.0, exclude_max=True))
    pairs = zip(weight.tolist(), noise.tolist(), strict=True)
    expected = [
        plain_erosion.eroded(w, n, erosion=share, soft=erosion.SOFT) for w, n in pairs
    ]
    return array.eroded(weight, noise, erosion=share), expected


@twin(array.lit_share, plain_erosion.lit_share, tolerance=1e-15, why=ROUNDED)
def lit_share(draw: Draw):
    noise, ahead = (
        draw(arrays(float, 5, elements=unit)),
        draw(arrays(float, 5, elements=unit)),
    )
    relief = draw(unit)
    pairs = zip(noise.tolist(), ahead.tolist(), strict=True)
    expected = [plain_erosion.lit_share(n, a, relief=relief) for n, a in pairs]
    return array.lit_share(noise, ahead, relief=relief), expected


@twin(
    array.detail_grid,
    plain_erosion.detail_grid,
    tolerance=5e-14,
    why="octaves of noise, whose rows of the table allow as much",
)
def detail_grid(draw: Draw):
    seed, cell = draw(seeds), draw(st.floats(4.0, 8.0))
    lower = 20.0 * uniform(np.arange(3), 0, seed=seed) - 10.0
    upper = lower + 0.1 * uniform(np.arange(3), 1, seed=seed)
    how = {"cell": cell, "pixel": draw(st.sampled_from([0.0, 0.3, 3.0])), "seed": seed}
    table = array.detail_grid(lower, upper, **how)
    expected = plain_erosion.detail_grid(
        tuple(lower.tolist()),
        tuple(upper.tolist()),
        **how,
        octaves=erosion.OCTAVES,
        persistence=erosion.PERSISTENCE,
        nearly_all=erosion.NEARLY_ALL,
        samples=erosion.SAMPLES,
        most_cells=erosion.MOST_CELLS,
    )
    ends = np.concatenate([table.lower, table.upper])
    assert table.density.shape == np.shape(expected.values)
    np.testing.assert_allclose(ends, [*expected.lower, *expected.upper], rtol=1e-15)
    return table.density, expected.values


def drawn_field(draw: Draw) -> tuple[array.LightField, plain_eyeward.Field, int]:
    balls, width = draw(clouds(3)), draw(st.integers(1, 3))
    k = np.arange(len(balls))
    values = uniform(k[:, None], np.arange(width), seed=draw(seeds))
    reach = draw(st.sampled_from([0.7, 1.15]))
    actual = array.light_field(balls, values, reach=reach)
    expected = plain_eyeward.light_field(
        listed(balls),
        values.tolist(),
        kernel=balls.kernel,
        reach=reach,
        spacing=lightfield.SPACING,
        most_nodes=lightfield.MOST_NODES,
    )
    return actual, expected, width


@twin(array.light_field, plain_eyeward.light_field, tolerance=1e-14, why=CARRIED)
def light_field(draw: Draw):
    actual, expected, width = drawn_field(draw)
    table = np.array(expected.sums)
    # Without balls the list does not know how many values there are.
    return actual.sums, table if table.shape[-1] > 1 else np.zeros((1, 1, 1, width + 1))


@twin(array.field_value, plain_eyeward.field_value, tolerance=2e-13, why=MAGNIFIED)
def field_value(draw: Draw):
    actual, _, width = drawn_field(draw)
    seed = draw(seeds)
    own = uniform(np.arange(width), seed=seed)
    points = 8.0 * uniform(np.arange(4)[:, None], np.arange(3), seed=seed) - 4.0
    field = plain_eyeward.Field(
        actual.sums.tolist(), tuple(actual.lower.tolist()), actual.spacing
    )
    how = {"own": own.tolist(), "own_weight": lightfield.OWN}
    expected = [
        plain_eyeward.field_value(field, tuple(p), **how) for p in points.tolist()
    ]
    return array.field_value(actual, points, own=own), expected


@twin(array.sunward, plain.sunward, tolerance=1e-14, why=CARRIED)
def passed_sunward(draw: Draw):
    balls, suns, medium = draw(clouds()), draw(suns_of()), draw(media)
    look = draw(looks)
    lit = array.sunward(balls, suns, medium=medium, look=look)
    expected = plain.sunward(
        listed(balls),
        balls.kernel,
        lamps(suns),
        medium_of(medium),
        rules_of(look),
        BORDER,
    )
    flat = np.concatenate([np.ravel(expected.light), np.ravel(expected.ambient)])
    return np.concatenate([lit.light.ravel(), lit.ambient.ravel()]), flat


@twin(array.ball_colours, plain.ball_colours, tolerance=1e-14, why=CARRIED)
def ball_colours(draw: Draw):
    lit, camera = drawn_lit(draw), drawn_camera(draw)
    expected = [
        plain.ball_colours(lit_of(lit), k, as_plain(camera))
        for k in range(len(lit.balls))
    ]
    return array.ball_colours(lit, camera), np.reshape(
        expected, (-1, len(lit.suns) + 1, 3)
    )


def seen_both_ways(draw: Draw, array_form: Any):
    lit, camera = drawn_lit(draw), drawn_camera(draw)
    shape = camera.height, camera.width, 3
    background = draw(st.none() | arrays(float, shape, elements=channels))
    haze = draw(st.none() | st.builds(array.Haze, colours, st.floats(0.5, 50.0)))
    seen: dict[str, Any] = {}
    how: dict[str, Any] = {"background": background, "haze": haze}
    actual, _ = array.eyeward(lit, camera, **how, observe=seen.__setitem__)
    if array_form is array.eyeward_literal:
        actual = array_form(lit, camera, **how)
    detail = seen.get("detail")
    if detail is not None:
        ends = (tuple(end.tolist()) for end in (detail.lower, detail.upper))
        detail = plain_erosion.Detail(detail.density.tolist(), *ends)
    expected = plain_eyeward.eyeward(
        lit_of(lit),
        as_plain(camera),
        background=None if background is None else background.tolist(),
        haze=None if haze is None else (haze.color.tolist(), haze.length),
        detail=detail,
        fixed=FIXED,
    )
    return actual, expected


@twin(array.eyeward, plain_eyeward.eyeward, tolerance=2e-13, why=MAGNIFIED)
def passed_eyeward(draw: Draw):
    return seen_both_ways(draw, array.eyeward)


@twin(array.eyeward_literal, plain_eyeward.eyeward, tolerance=2e-13, why=MAGNIFIED)
def passed_eyeward_literal(draw: Draw):
    return seen_both_ways(draw, array.eyeward_literal)
