"""The one door: any cloud or a scene's name, any background, defaults that are told."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from small_scenes import BACKDROP, BALLS, EXTENDED, EYE, MEDIUM, PAPER, SUNS, drawn
from twins.lighting import scattered_balls, seeds

from refcloud import animate, scenes
from refcloud.camera import Camera, rays
from refcloud.choices import AMBIENT, SIZES, THICKNESS
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Skipped
from refcloud.lighting import Haze
from refcloud.lighting.depths import through_the_middle
from refcloud.march import Mixing, integrate
from refcloud.march_picture import ONCE
from refcloud.metaballs import Metaballs, voxel_balls
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.scene import SCENES, Model, Scene, View
from refcloud.sky import Sky, clear_sky

HOW = {"camera": EYE, "suns": SUNS, "medium": MEDIUM, "look": EXTENDED}
NOTHING = Metaballs(np.zeros((0, 3)), [], [])
GRID = VoxelGrid(np.ones((2, 2, 3)), [-1.5, -1, -1], [1.5, 1, 1])


def test_it_is_both_passes_over_the_background() -> None:
    picture = render(BALLS, background=BACKDROP, **HOW)
    expected = drawn(BALLS, SUNS, background=BACKDROP)
    np.testing.assert_array_equal(picture.linear, expected[..., :3])
    assert picture.alpha is None
    assert set(picture.seconds) == {"sky", "light", "eye"}


def test_the_default_sky_stands_behind() -> None:
    np.testing.assert_array_equal(render(NOTHING, **HOW).linear, clear_sky(EYE))
    own = Sky(zenith=np.array([1.0, 0.0, 0.0]), glow=0.01)
    painted = render(NOTHING, background=own, **HOW).linear
    np.testing.assert_array_equal(painted, clear_sky(EYE, own, suns=SUNS))


def test_one_colour_stands_behind() -> None:
    picture = render(NOTHING, background=[0.1, 0.2, 0.3], **HOW)
    assert (picture.linear == [0.1, 0.2, 0.3]).all()


def test_transparent_keeps_alpha_and_shows_any_background_later() -> None:
    clear = render(BALLS, background="transparent", **HOW)
    assert clear.alpha is not None
    assert 0.0 <= clear.alpha.min() < clear.alpha.max() <= 1.0
    over = clear.linear + (1.0 - clear.alpha[..., None]) * BACKDROP
    solid = render(BALLS, background=BACKDROP, **HOW).linear
    np.testing.assert_allclose(over, solid, rtol=0.0, atol=1e-12)
    assert not render(NOTHING, background="transparent", **HOW).alpha.any()


@settings(max_examples=20)
@given(seeds, seeds)
def test_layers_without_a_background_cover_each_other(one, two) -> None:
    layers = [
        Layer(scattered_balls(seed, 3), MEDIUM, look, Haze([0.4, 0.5, 0.6], 20.0))
        for seed, look in ((one, EXTENDED), (two, PAPER))
    ]
    clear = draw_layers(layers, EYE, SUNS, "transparent")
    solid = draw_layers(layers, EYE, SUNS, BACKDROP)
    assert clear.alpha is not None
    over = clear.linear + (1.0 - clear.alpha[..., None]) * BACKDROP
    np.testing.assert_allclose(over, solid.linear, rtol=0.0, atol=1e-12)


@settings(max_examples=20)
@given(seeds, st.floats(1e-3, 0.3))
def test_layers_share_the_tolerance(seed, tolerance) -> None:
    layers = [Layer(scattered_balls(seed ^ i, 5), MEDIUM, EXTENDED) for i in range(3)]
    exact, found = (
        draw_layers(layers, EYE, SUNS, BACKDROP, tolerance=t) for t in (0.0, tolerance)
    )
    assert np.abs(exact.linear - found.linear).max() <= tolerance + 1e-12
    assert sum(row.bound for row in found.skipped if row.stage == "eye") <= tolerance


def test_rows_of_layers_that_say_the_same_are_added_up() -> None:
    away = dataclasses.replace(BALLS, centers=BALLS.centers + np.array([0, 0, 99.0]))
    layers = [Layer(away, MEDIUM, PAPER)] * 2
    picture = draw_layers(layers, EYE, SUNS, BACKDROP)
    count = len(BALLS)
    assert picture.skipped == (
        Skipped("light", "lights of clouds off the picture", 4 + 4, 4 + 4),
        Skipped("eye", "balls off the picture", 2 * count, 2 * count),
    )


def test_a_cloud_map_may_be_splatted_as_its_voxels() -> None:
    picture = render(GRID, background=BACKDROP, method="splat", **HOW)
    balls = render(voxel_balls(GRID), background=BACKDROP, **HOW)
    np.testing.assert_array_equal(picture.linear, balls.linear)
    assert picture.notes[0] == "drawn as one ball per occupied voxel: 12 balls"
    assert balls.notes == ()


def test_every_default_is_told() -> None:
    picture = render(BALLS, width=8, height=6, look=EXTENDED)
    medium, camera = picture.notes
    assert medium.startswith("medium: sigma_t ")
    assert f"optical depth {THICKNESS:g}" in medium
    assert camera.startswith("camera: eye ")
    paper = render(BALLS, width=8, height=6, look=PAPER)
    assert paper.notes[0] == "medium: tau 8 for every ball, albedo 0.9"
    assert "empty" in render(NOTHING, width=8, height=6).notes[0]


@settings(max_examples=20)
@given(seeds, st.floats(0.01, 100.0))
def test_the_default_medium_is_as_thick_as_it_says(seed, factor) -> None:
    balls = scattered_balls(seed, 6)
    sized = dataclasses.replace(
        balls,
        centers=factor * balls.centers,
        radii=factor * balls.radii,
        densities=balls.densities + 0.1,
    )
    note = render(sized, width=2, height=2, look=EXTENDED).notes[0]
    sigma_t = float(note.split()[2].rstrip(","))
    assume(through_the_middle(sized, 1.0) > 0.0)
    # The note gives four digits.
    assert through_the_middle(sized, sigma_t) == pytest.approx(THICKNESS, rel=1e-3)


@pytest.mark.parametrize("size", [(8, 6), (5, 9)])
def test_without_a_camera_the_cloud_is_framed_at_the_size(size) -> None:
    width, height = size
    seen: dict = {}
    picture = render(
        BALLS, width=width, height=height, look=PAPER, observe=seen.__setitem__
    )
    assert picture.linear.shape == (height, width, 3)
    assert len(seen["eye order"]) == len(BALLS), "every ball is on the picture"


def test_an_own_camera_brings_its_size() -> None:
    assert render(BALLS, **HOW).linear.shape == (EYE.height, EYE.width, 3)


def test_the_same_call_gives_the_same_bits_and_another_seed_others() -> None:
    one, two, other = (render(BALLS, seed=s, **HOW).linear for s in (0, 0, 1))
    np.testing.assert_array_equal(one, two)
    assert (one != other).any()


def test_no_sun_is_another_picture_than_the_default_one() -> None:
    how = HOW | {"background": [0, 0, 0], "look": PAPER}
    assert not render(BALLS, **(how | {"suns": ()})).linear.any()
    assert render(BALLS, **(how | {"suns": None})).linear.any()


def test_every_intermediate_can_be_watched() -> None:
    seen: list[str] = []
    render(BALLS, observe=lambda name, value: seen.append(name), **HOW)
    lights = ("sun 0", "sun 1", "sky", "ground")
    each = [f"{light} {what}" for light in lights for what in ("order", "buffer")]
    assert seen == [*each, "detail", "eye order"]


def test_skipped_rows_reach_the_picture() -> None:
    suns = (Sun([0, 1, 0], [0, 0, 0]), SUNS[0])
    picture = render(BALLS, **(HOW | {"suns": suns}))
    assert Skipped("light", "suns without light", 1, 2) in picture.skipped


def test_a_scene_hands_on_what_it_made_and_chose(monkeypatch) -> None:
    views: list[View] = []
    row = Skipped("noise", "octaves", 1, 4, 0.1)

    def draw(model: Model, view: View):
        views.append(view)
        picture = render(model.clouds["cloud"], camera=EYE, medium=MEDIUM, look=PAPER)
        return dataclasses.replace(picture, notes=("drawn",))

    model = Model({"cloud": BALLS}, ("made",), (row,), {"generate": 0.5})
    scene = Scene("test", "a test", lambda: model, draw, uses=("seed",))
    monkeypatch.setitem(SCENES, "test", scene)
    picture = render("test", quality="quick", tolerance=0.1, seed=3, look="man")
    assert picture.notes == ("made", "drawn")
    assert picture.skipped[0] == row
    assert picture.seconds["generate"] == 0.5
    (view,) = views
    assert (view.width, view.height) == SIZES["quick"]
    assert (view.tolerance, view.seed, view.look) == (0.1, 3, "man")
    render("test", width=7)
    # One side alone takes the other with it.
    assert views[1].width == 7
    aspect = SIZES["final"][0] / SIZES["final"][1]
    assert views[1].height == pytest.approx(7 / aspect, abs=0.5)
    render("test", camera=EYE, suns=SUNS, medium=MEDIUM)
    assert (views[2].camera, views[2].suns, views[2].medium) == (EYE, SUNS, MEDIUM)


def test_a_real_scene_comes_in_any_size() -> None:
    assert "man-10" in scenes.SCENES
    picture = render("man-10", width=16, height=12, look=PAPER)
    assert picture.linear.shape == (12, 16, 3)
    assert picture.notes == ("cloud: 30 balls, densities not fitted",)


def test_an_unknown_scene_is_refused_with_all_names() -> None:
    with pytest.raises(ValueError, match=r"^scene: expected one of [^\n]*$") as caught:
        render("no-such")
    text = str(caught.value)
    assert all(name in text for name in SCENES)
    assert "'no-such'" in text


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: render("cumulus", background=[0, 0, 0]), "background: expected none"),
        (
            lambda: render("cumulus", haze=Haze([0, 0, 0], 1.0)),
            "haze: expected none",
        ),
        (
            lambda: render("cumulus", width=10**6, height=10**6),
            "width: expected at most",
        ),
        (lambda: render(BALLS, width=10**6, height=10**6), "width: expected at most"),
        (lambda: render(BALLS, width=0), "width: expected"),
        (
            lambda: render(BALLS, background=np.ones((9, 9, 3)), **HOW),
            "background: exp",
        ),
        (lambda: render(BALLS, background=[-1, 0, 0], **HOW), "background: expected"),
        (lambda: render(BALLS, background="stars", **HOW), "background: expected"),
        (lambda: render(BALLS, look="foam"), "look: expected a Look or one of"),
        (lambda: render(BALLS, tolerance=2.0), "tolerance: expected"),
        (lambda: render(BALLS, quality="best"), "quality: expected"),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()


def test_what_is_no_cloud_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^cloud: expected [^\n]*$"):
        render(3.0)


def test_a_camera_far_off_sees_only_the_background() -> None:
    away = Camera([1e6, 0, 0], [2e6, 0, 0], width=4, height=3)
    picture = render(BALLS, **(HOW | {"camera": away}), background=[0.2, 0.2, 0.2])
    assert (picture.linear == 0.2).all()


MARCHED = {"camera": EYE, "suns": SUNS, "medium": MEDIUM}


def test_a_cloud_map_is_marched_over_the_background() -> None:
    picture = render(GRID, background=BACKDROP, **MARCHED)
    L, _ = integrate(
        GRID,
        *rays(EYE),
        suns=SUNS,
        medium=MEDIUM,
        ambient=AMBIENT,
        background=BACKDROP,
    )
    np.testing.assert_allclose(picture.linear, L, rtol=1e-13)
    assert picture.notes == (ONCE,)
    assert picture.alpha is None
    clear = render(GRID, background="transparent", **MARCHED)
    assert clear.alpha is not None
    over = clear.linear + (1.0 - clear.alpha[..., None]) * BACKDROP
    np.testing.assert_allclose(over, picture.linear, rtol=1e-12)


def test_a_marched_cloud_in_haze_and_in_colour() -> None:
    dark = {"ambient": [0, 0, 0], "background": "transparent"}
    clear = render(GRID, **dark, **MARCHED)
    haze = Haze([0.4, 0.5, 0.6], 20.0)
    hazy = render(GRID, haze=haze, **dark, **MARCHED)
    share = np.exp(-np.linalg.norm(EYE.eye) / 20.0)
    assert clear.alpha is not None
    air = (1.0 - share) * clear.alpha[..., None] * haze.color
    np.testing.assert_allclose(hazy.linear, share * clear.linear + air, rtol=1e-12)
    sigmas = [0.5, 1.5, 4.5]
    coloured = render(GRID, **dark, **(MARCHED | {"medium": Medium(sigmas, 0.9)}))
    for c, sigma_t in enumerate(sigmas):
        grey = render(GRID, **dark, **(MARCHED | {"medium": Medium(sigma_t, 0.9)}))
        # Other pieces are cut, so the quadrature's own error shows: 2.1e-5.
        np.testing.assert_allclose(
            coloured.linear[..., c], grey.linear[..., c], rtol=0.0, atol=5e-5
        )


def test_a_marched_cloud_is_framed_and_its_medium_chosen() -> None:
    inner = VoxelGrid(np.pad(GRID.density, 2), [-3.5, -3, -3], [3.5, 3, 3])
    picture = render(inner, width=8, height=6)
    medium, camera, once, steep = picture.notes
    assert "in one voxel" in steep
    assert "optical depth 16 in the middle" in medium
    assert camera == render(GRID, width=8, height=6).notes[1], "empty voxels count not"
    assert once == ONCE
    empty = VoxelGrid(np.zeros((2, 2, 2)), [-1, -1, -1], [1, 1, 1])
    nothing = render(empty, width=8, height=6, background=[0.1, 0.2, 0.3])
    assert (nothing.linear == [0.1, 0.2, 0.3]).all()


def test_voxels_too_coarse_for_their_depth_are_told() -> None:
    thick = Medium(1e4)
    notes = render(GRID, **(MARCHED | {"medium": thick})).notes
    assert any("optical depth 1e+04 in one voxel" in note for note in notes)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: render(GRID, look="man"), "look: expected none beside the method"),
        (
            lambda: render(BALLS, ambient=[1, 1, 1]),
            "ambient: expected none beside the method splat",
        ),
        (
            lambda: render(GRID, method="splat", mixing=Mixing()),
            "mixing: expected none beside the method splat",
        ),
        (lambda: render("man-10", method="march"), "method: expected none beside a"),
        (lambda: render(GRID, scattering="twice"), "scattering: expected one of"),
        (
            lambda: render(BALLS, scattering="multiple", look="man"),
            "look: expected a look whose depths",
        ),
        (
            lambda: render(
                BALLS, scattering="multiple", medium=Medium([1.0, 2.0, 3.0])
            ),
            "light: expected light in a medium",
        ),
        (
            lambda: render("demand-sky", scattering="multiple"),
            "scattering: expected none beside demand-sky, whose",
        ),
    ],
)
def test_what_a_method_has_no_use_for_is_refused(call, message) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()


USES = ("man-10", "demand-lit", "demand-cells", "shader-lit", "simple-sky")


@pytest.mark.parametrize("name", USES)
def test_scenes_refuse_a_scattering_that_they_have_no_use_for(name: str) -> None:
    with pytest.raises(ValueError, match=r"^(scattering|look): expected"):
        render(name, width=16, height=12, scattering="multiple")


@pytest.mark.parametrize("name", USES)
def test_a_seed_that_changes_nothing_is_said_to(name: str) -> None:
    one, other = (render(name, width=16, height=12, seed=k) for k in (0, 7))
    said = "seed 7: nothing here depends on it" in other.notes
    assert said <= np.array_equal(one.linear, other.linear)
    assert said == (name != "demand-lit")
    assert not any(note.startswith("seed") for note in one.notes)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: render(Metaballs([[1e60, 0, 0]], [1], [1])), "cloud: expected places"),
        (lambda: render(Metaballs([[0, 0, 0]], [1e-60], [1])), "cloud: expected sizes"),
        (
            lambda: render(Metaballs([[0, 0, 0]], [1e45], [1e200])),
            "cloud: expected an optical depth",
        ),
        (
            lambda: render(BALLS, **(HOW | {"suns": Sun([0, 1, 0], [1e250, 0, 0])})),
            "suns: expected light of at most 1e",
        ),
        (
            lambda: render(BALLS, **HOW, background=[1e250, 0, 0]),
            "background: expected light",
        ),
        (
            lambda: render(BALLS, **(HOW | {"medium": Medium(1e300)})),
            "sigma_t: expected an optical depth",
        ),
        (
            lambda: render(BALLS, camera=Camera([1e60, 0, 0], [0, 0, 0])),
            "camera: expected places",
        ),
        (lambda: render(VoxelGrid(np.ones((1, 1, 1)), [0] * 3, [1e-60] * 3)), "cloud:"),
        (
            lambda: integrate(
                GRID, [0, 0, 1e60], [[0, 0, 1.0]], suns=SUNS, medium=MEDIUM
            ),
            "origins: expected places",
        ),
        (lambda: Haze([1e250, 0, 0], 1.0), "color: expected light"),
    ],
)
def test_what_leaves_no_room_for_products_is_refused(call, message) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()


def test_the_default_sun_of_solved_light_leaves_clouds_their_shades() -> None:
    picture = render(BALLS, width=24, height=18, scattering="multiple", tolerance=0.05)
    assert any(note.startswith("sun: irradiance 6.28 6.03") for note in picture.notes)
    # Of the cloud's pixels, a hundredth at most would clip.
    assert (picture.codes().max(axis=2) == 255).mean() < 0.01


@pytest.mark.parametrize("cloud", [BALLS, GRID, "man-10"])
@pytest.mark.parametrize(
    "size", [{"width": 8}, {"height": 7}, {"width": 8, "height": 7}]
)
def test_a_size_beside_a_camera_is_the_camera_s_or_refused(cloud, size) -> None:
    camera = dataclasses.replace(EYE, width=9, height=6)
    name = next(iter(size))
    line = f"^{name}: expected none beside a camera, or its .*, got {size[name]}; make"
    with pytest.raises(ValueError, match=line):
        render(cloud, camera=camera, **size)
    with pytest.raises(ValueError, match=line):
        animate(cloud, "a.png", frames=2, camera=camera, **size)
    own = {name: getattr(camera, name) for name in size}
    alone, same = (render(cloud, camera=camera, **how) for how in ({}, own))
    np.testing.assert_array_equal(alone.linear, same.linear)
