"""Pass 2: light adds up, none comes from nothing, every eye sees a finite picture."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import (
    BACKDROP,
    BALLS,
    DARK,
    EXTENDED,
    EYE,
    LOOKS,
    MEDIUM,
    PAPER,
    SUNS,
    drawn,
)
from twins.lighting import clouds, looks, media, scattered_balls, seeds, suns_of

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.lighting import (
    Haze,
    Look,
    ball_colours,
    eyeward,
    light_field,
    sunward,
)
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.raster import transmittance
from refcloud.sky import Sky, clear_sky

ADDED = 1e-12  # of the brightest, for sums of a few dozen terms in another order
every_look = pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
some = settings(max_examples=25)


def same(actual: np.ndarray, expected: np.ndarray) -> None:
    scale = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=ADDED * scale)


@some
@given(clouds(5), suns_of(3), media, looks)
def test_lights_add_up(balls, suns, medium, look) -> None:
    rules = dataclasses.replace(look, **DARK)
    together = drawn(balls, suns, medium=medium, look=rules)
    apart = [drawn(balls, (sun,), medium=medium, look=rules) for sun in suns]
    same(together[..., :3], sum((one[..., :3] for one in apart), np.zeros((9, 12, 3))))
    # With light from the sky, which each picture has, all but one are subtracted.
    sky = drawn(balls, (), medium=medium, look=look)
    lit = [drawn(balls, (sun,), medium=medium, look=look) for sun in suns]
    expected = sky + sum((one - sky for one in lit), np.zeros((9, 12, 4)))
    same(drawn(balls, suns, medium=medium, look=look), expected)


@every_look
def test_two_half_suns_are_one(look: Look) -> None:
    whole = Sun([1, 2, 3], [9, 8, 7])
    half = Sun([1, 2, 3], [4.5, 4.0, 3.5])
    same(drawn(BALLS, (half, half), look=look), drawn(BALLS, (whole,), look=look))


@some
@given(clouds(5), media, looks)
def test_no_light_comes_from_nothing(balls, medium, look) -> None:
    rules = dataclasses.replace(look, **DARK)
    suns = (Sun([1, 2, 3], [0, 0, 0]),)
    picture = drawn(balls, suns, medium=medium, look=rules, background=BACKDROP)
    assert (picture[..., :3] >= 0.0).all()
    assert (picture[..., :3] <= BACKDROP + ADDED).all()


@some
@given(clouds(5), suns_of(), media, looks)
def test_nothing_shows_brighter_than_the_brightest(balls, suns, medium, look) -> None:
    lit = sunward(balls, suns, medium=medium, look=look)
    seen, _ = eyeward(lit, EYE, background=BACKDROP)
    brightest = ball_colours(lit, EYE).sum(axis=1).max(axis=0, initial=0.0)
    assert (seen[..., :3] <= np.maximum(BACKDROP, brightest) * (1.0 + ADDED)).all()


@every_look
@pytest.mark.parametrize("background", [None, BACKDROP], ids=["nothing", "backdrop"])
def test_an_empty_cloud_shows_the_background(look: Look, background) -> None:
    nothing = Metaballs(np.zeros((0, 3)), [], [])
    clear = dataclasses.replace(BALLS, densities=np.zeros(len(BALLS)))
    rules = dataclasses.replace(look, tau=None)
    for balls in (nothing, clear):
        picture = drawn(balls, SUNS, look=rules, background=background)
        if background is None:
            assert not picture.any()
        else:
            np.testing.assert_array_equal(picture[..., :3], BACKDROP)
            assert (picture[..., 3] == 1.0).all()


@some
@given(clouds(5), suns_of(), looks)
def test_a_picture_over_a_background_is_itself_and_what_shines_through(
    balls, suns, look
) -> None:
    alone = drawn(balls, suns, look=look)
    over = drawn(balls, suns, look=look, background=BACKDROP)
    alpha = alone[..., 3:]
    assert (alpha >= 0.0).all()
    assert (alpha <= 1.0 + ADDED).all()
    same(over[..., :3], alone[..., :3] + (1.0 - alpha) * BACKDROP)
    np.testing.assert_allclose(over[..., 3], 1.0, rtol=0.0, atol=ADDED)


@every_look
@settings(max_examples=20)
@given(st.permutations(range(len(BALLS))))
def test_the_order_of_the_input_never_shows(look: Look, order) -> None:
    mixed = Metaballs(BALLS.centers[order], BALLS.radii[order], BALLS.densities[order])
    haze = Haze([0.5, 0.6, 0.7], 30.0)
    for tolerance in (0.0, 0.2):
        how = {"look": look, "background": BACKDROP, "haze": haze}
        how["tolerance"] = tolerance
        np.testing.assert_array_equal(
            drawn(mixed, SUNS, **how), drawn(BALLS, SUNS, **how)
        )


def test_equal_balls_left_out_as_faint_are_the_same_in_any_order() -> None:
    spots = np.array([[x, y, 0.5 * x] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 1.0)])
    pictures = [
        drawn(Metaballs(c, np.ones(6), np.full(6, 0.05)), SUNS, tolerance=0.3)
        for c in (spots, spots[::-1], spots[[3, 0, 5, 1, 4, 2]])
    ]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    np.testing.assert_array_equal(pictures[0], pictures[2])


@some
@given(seeds, st.lists(st.floats(0.0, 4.0), min_size=3, max_size=3), looks)
def test_a_coloured_medium_is_three_grey_ones(seed, sigma_t, look) -> None:
    balls = scattered_balls(seed, 4)
    albedo = [0.9, 0.8, 0.7]
    how = {"look": look, "background": BACKDROP}
    coloured = drawn(balls, SUNS, medium=Medium(sigma_t, albedo), **how)
    for channel in range(3):
        grey = Medium(sigma_t[channel], albedo[channel])
        one = drawn(balls, SUNS, medium=grey, **how)
        same(coloured[..., channel], one[..., channel])


def test_alpha_of_a_coloured_medium_is_the_mean_of_its_channels() -> None:
    sigma_t = [0.2, 1.0, 3.0]
    alphas = [drawn(BALLS, (), medium=Medium(s))[..., 3] for s in sigma_t]
    coloured = drawn(BALLS, (), medium=Medium(sigma_t))
    same(coloured[..., 3], np.mean(alphas, axis=0))
    two = drawn(BALLS, (), medium=Medium([0.2, 3.0, 3.0]))
    same(two[..., 3], (alphas[0] + 2.0 * alphas[2]) / 3.0)


@some
@given(seeds, st.sampled_from(["beer", "linear"]), st.sampled_from([0.0, 0.3]))
def test_white_furnace(seed, transmittance_, erosion) -> None:
    # Where all scattered light goes on (k = 1) and none is lost (albedo 1), a sun
    # that no ball weakens lights isotropic balls to radiance 1; before a white
    # background nothing shows, whatever the footprints, the erosion and the field.
    # With k below 1, or in eq 26 whose g + T is below 1, a cloud is darker than that.
    rules = dataclasses.replace(
        EXTENDED, transmittance=transmittance_, erosion=erosion, relief=0.0, forward=1.0
    )
    rules = dataclasses.replace(rules, **DARK)
    balls, medium = scattered_balls(seed, 6), Medium(1.5, 1.0, phase="isotropic")
    white = np.ones((9, 12, 3))
    how = {"medium": medium, "background": white}
    furnace = drawn(balls, (Sun([1, 2, 3]),), look=rules, **how)
    np.testing.assert_allclose(furnace, 1.0, rtol=0.0, atol=ADDED)
    for darker in (
        dataclasses.replace(rules, forward=0.7),
        dataclasses.replace(PAPER, **DARK),
    ):
        picture = drawn(balls, (Sun([1, 2, 3]),), look=darker, **how)
        assert (picture[..., :3] <= 1.0 + ADDED).all()


@some
@given(seeds, st.sampled_from(["beer", "linear"]))
def test_white_furnace_of_the_sky(seed, transmittance_) -> None:
    # The same for the light from above and below, which together are 1.
    rules = dataclasses.replace(
        EXTENDED,
        transmittance=transmittance_,
        sky_forward=1.0,
        sky_light=np.full(3, 0.75),
        ground_light=np.full(3, 0.25),
    )
    picture = drawn(
        scattered_balls(seed, 6),
        (),
        medium=Medium(1.5),
        look=rules,
        background=np.ones((9, 12, 3)),
    )
    np.testing.assert_allclose(picture, 1.0, rtol=0.0, atol=ADDED)


def test_e25_the_corners_of_a_balls_square_stay_as_they_are() -> None:
    ball = Metaballs([[0, 0, 0]], [1.0], [1.0])
    camera = OrthographicCamera(
        [0, 0, 5], [0, 0, 0], height_of_view=2.0, width=8, height=8
    )
    white = np.ones((8, 8, 3))
    for look in LOOKS.values():
        rules = dataclasses.replace(look, **DARK)
        picture = drawn(ball, (), look=rules, camera=camera, background=white)
        # f_d = T over the whole square, as eq 28 has it, would darken these too.
        assert (picture[[0, 0, -1, -1], [0, -1, 0, -1]] == 1.0).all()
        assert picture[4, 4, 0] < 0.9


def test_e25_linear_modulation_against_beer() -> None:
    weight = np.linspace(0.0, 1.0, 100_001)
    for tau, gap in ((0.1, 0.0012), (1.0, 0.078), (8.0, 0.615)):
        laws = [transmittance(weight, tau, law=law) for law in ("linear", "beer")]
        found = (laws[0] - laws[1]).max()
        assert found == pytest.approx(gap, rel=0.05 if tau < 1.0 else 0.01)
    # And so in a picture: one ball of tau 8, white behind it, no light at all.
    ball, white = Metaballs([[0, 0, 0]], [1.0], [1.0]), np.ones((32, 32, 3))
    camera = OrthographicCamera(
        [0, 0, 5], [0, 0, 0], height_of_view=2.0, width=32, height=32
    )
    rules = [
        dataclasses.replace(PAPER, transmittance=law) for law in ("linear", "beer")
    ]
    linear, beer = (
        drawn(ball, (), look=rule, camera=camera, background=white)[..., 0]
        for rule in rules
    )
    assert (linear >= beer - 1e-15).all()
    assert (linear - beer).max() == pytest.approx(0.615, abs=0.01)


def test_e26_balls_are_seen_from_the_farthest_on() -> None:
    # Two opaque balls in line: only the nearer one shows, whoever is listed first.
    for z in ([2.0, -2.0], [-2.0, 2.0]):
        balls = Metaballs([[0, 0, z[0]], [0, 0, z[1]]], [1, 1], [1e3, 1e3])
        sun = Sun([0, 0, 1])
        rules = dataclasses.replace(PAPER, tau=None, scattering="split")
        camera = Camera([0, 0, 9], [0, 0, 0], width=1, height=1)
        lit = sunward(balls, (sun,), medium=MEDIUM, look=rules)
        marked = dataclasses.replace(
            lit,
            light=np.where(np.array(z)[:, None] > 0.0, [1.0, 0, 0], [0, 1.0, 0])[None],
        )
        seen: dict = {}
        picture, _ = eyeward(marked, camera, observe=seen.__setitem__)
        assert picture[0, 0, 0] > 0.0
        assert picture[0, 0, 1] < 1e-9
        near_to_far = np.array(z)[seen["eye order"]]
        assert near_to_far.tolist() == [2.0, -2.0]


@every_look
def test_e26_behind_the_last_ball_stands_the_background(look: Look) -> None:
    sun = (Sun([0, 0, 1]),)
    thin = dataclasses.replace(look, tau=None, **DARK)
    one = dataclasses.replace(scattered_balls(5, 1), densities=np.array([1e-9]))
    picture = drawn(one, sun, look=thin, background=BACKDROP)
    np.testing.assert_allclose(picture[..., :3], BACKDROP, rtol=0.0, atol=1e-6)


@every_look
def test_moving_only_the_eye_leaves_the_light_as_it_is(look: Look) -> None:
    # Nothing of pass 1 knows of a camera; one lit cloud serves any eye.
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=look)
    before = lit.light.tobytes(), lit.ambient.tobytes()
    pictures = [eyeward(lit, c)[0] for c in (EYE, Camera([7, 0, 0], [0, 0, 0]))]
    assert (lit.light.tobytes(), lit.ambient.tobytes()) == before
    np.testing.assert_array_equal(pictures[0], drawn(BALLS, SUNS, look=look))


@every_look
@settings(max_examples=25)
@given(seeds, st.floats(-6.0, 6.0), st.floats(-1.0, 1.0))
def test_balls_of_any_size_on_screen_give_finite_pictures(look, seed, power, aside):
    balls = scattered_balls(seed, 3)
    _, _, _, scale = project(EYE, balls.centers)
    sized = dataclasses.replace(
        balls,
        radii=np.array([1.0, 10.0**power, 3.0]) / scale,
        centers=balls.centers + np.array([aside, 0.0, 0.0]),
    )
    picture = drawn(sized, SUNS, look=look, background=BACKDROP)
    assert np.isfinite(picture).all()
    assert picture.min() >= 0.0


@every_look
@pytest.mark.parametrize(
    "center",
    [
        [0.5, 1.0, 7.0],  # the eye itself
        [0.5, 1.0, 7.0 - 1e-300],
        [0.5, 1.0, 7.0 + 1e-9],
        [0.5, 1.0, 6.9],
        [0.5, 1.0, 8.0],
        [90.0, 1.0, 7.0 - 1e-12],
        [0.0, 0.0, -1e9],
    ],
)
def test_balls_around_and_behind_the_eye(look: Look, center) -> None:
    balls = Metaballs([center, [0, 0, 0]], [1.5, 1.0], [1.0, 1.0])
    for camera in (EYE, OrthographicCamera(EYE.eye, EYE.target, width=9, height=9)):
        for tolerance in (0.0, 0.1):
            picture = drawn(balls, SUNS, look=look, camera=camera, tolerance=tolerance)
            assert np.isfinite(picture).all()


@pytest.mark.parametrize("distance", [0.0, 1e-6])
def test_a_ball_fades_as_the_eye_enters_it(distance: float) -> None:
    ball = Metaballs([[0, 0, 0]], [1.0], [1.0])
    camera = Camera([0, 0, distance], [0, 0, -1], width=4, height=4)
    picture = drawn(ball, SUNS, camera=camera, background=np.ones((4, 4, 3)))
    np.testing.assert_allclose(picture, 1.0, rtol=0.0, atol=1e-9)


@every_look
def test_a_cloud_far_out_shows_as_one_at_home(look: Look) -> None:
    # Noise is anchored in the world: without it the picture moves with the cloud.
    rules = dataclasses.replace(look, erosion=0.0, relief=0.0)
    away = np.full(3, 1e6)
    far = dataclasses.replace(BALLS, centers=BALLS.centers + away)
    camera = dataclasses.replace(EYE, eye=EYE.eye + away, target=EYE.target + away)
    moved = drawn(far, SUNS, look=rules, camera=camera, background=BACKDROP)
    home = drawn(BALLS, SUNS, look=rules, background=BACKDROP)
    # Places are known to 1e-10 there; weights fall by at most 100 per unit and pixel.
    np.testing.assert_allclose(moved, home, rtol=0.0, atol=1e-7)
    assert np.isfinite(drawn(far, SUNS, look=look, camera=camera)).all()


@every_look
def test_haze_of_any_length_is_between_the_ball_and_the_air(look: Look) -> None:
    ball = Metaballs([[0, 0, 0]], [1.0], [1e4])
    rules = dataclasses.replace(look, erosion=0.0, relief=0.0, light_reach=0.0)
    camera = Camera([0, 0, 10], [0, 0, 0], fov_y=0.01, width=1, height=1)
    color = np.array([0.2, 0.4, 0.6])
    clear = drawn(ball, SUNS, look=rules, camera=camera)[0, 0, :3]
    for length in (1e-3, 5.0, 10.0, 1e9):
        hazy = drawn(ball, SUNS, look=rules, camera=camera, haze=Haze(color, length))
        T, alpha = np.exp(-10.0 / length), hazy[0, 0, 3]
        expected = T * clear + (1.0 - T) * alpha * color
        np.testing.assert_allclose(hazy[0, 0, :3], expected, rtol=1e-12)


def test_a_background_of_another_size_is_refused() -> None:
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=PAPER)
    with pytest.raises(ValueError, match=r"^background: expected shape \(9, 12, 3\)"):
        eyeward(lit, EYE, background=np.ones((12, 9, 3)))


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Haze([0, 0, -1], 1.0), "color"),
        (lambda: Haze([0, 0, 0], 0.0), "length"),
        (lambda: Look(forward=1.1), "forward"),
        (lambda: Look(erosion=1.0), "erosion"),
        (lambda: Look(buffer=0), "buffer"),
        (lambda: Look(tau=1e38), "tau"),
        (lambda: Look(readback="round"), "readback"),
    ],
)
def test_refusals_name_the_field_in_one_line(make, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        make()


def test_radii_below_every_scale_end_in_an_answer() -> None:
    balls = Metaballs([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [5e-324, 5e-324], [1.0, 1.0])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        field = light_field(balls, np.ones((2, 1)))
    assert np.isfinite(field.sums).all()


def test_two_half_suns_glow_as_one() -> None:
    sky = Sky(glow=0.5)
    camera = Camera(np.zeros(3), np.array([0.0, 0.2, -1.0]), width=12, height=9)
    whole = Sun(np.array([0.1, 0.3, -1.0]))
    half = Sun(whole.direction, 0.5 * whole.irradiance)
    one = clear_sky(camera, sky, suns=(whole,))
    two = clear_sky(camera, sky, suns=(half, half))
    np.testing.assert_allclose(two, one, rtol=1e-14)
