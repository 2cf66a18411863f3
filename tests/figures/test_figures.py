"""Figures: all that the documents number are there, one by one and on one page."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import numpy as np
import pytest

from refcloud import figure, figure_pages
from refcloud.camera import project
from refcloud.figure import Figure, figure_of, figures, find_figure
from refcloud.figure_pages import Made, draw_all, draw_figure, page
from refcloud.image import Picture, load_picture
from refcloud.plain import simplex as plain_simplex
from refcloud.scene import SCENES, View
from refcloud.scenes import man_net, man_passes, shader_diagrams

SMALL = View(64, 48)
PLOTS = (
    *("man-02", "man-03", "man-05", "man-06", "man-07", "man-11", "man-12"),
    *("shader-01", "shader-02"),
)
# Every picture that the documents show (inventory: G-M, G-S, G-D, G-C), and its figure.
SHOWN = {
    "M": {f"figure {k}": f"man-{k:02}" for k in range(1, 15)},
    "S": {
        "raw random image": "shader-raw",
        "figure 1": "shader-01",
        "figure 2": "shader-02",
        "appendix A": "shader-a",
        "appendix B, by its caption": "shader-b",
        "appendix B, by section 5.1": "shader-lit",
        "appendix B, by section 5.2": "shader-volume",
        "appendix C": "shader-c",
        "appendix D": "shader-d",
        "appendix E": "shader-e",
    },
    "D": {
        "2-D Worley": "demand-worley",
        "2-D Worley, inverted": "demand-worley-inverted",
        "cells and points": "demand-cells",
        "the rejected Perlin noise": "demand-perlin",
        "box frame and walls": "demand-box",
        "the wrong try on the faces": "demand-faces",
        "the quad": "demand-quad",
        "lit": "demand-lit",
        "plain and gradient background": "demand-background",
    },
    "C": {
        "the noise map": "simple-noise",
        "smoothed": "simple-smoothed",
        "interpolated": "simple-interpolated",
        "octaves": "simple-octaves",
        "the exponential filter": "simple-filtered",
        "the scrolled quad": "simple-quad",
    },
}


def test_every_figure_of_paper_m_is_there() -> None:
    every = figures()
    numbers = {f"man-{k:02}": f"figure {k}" for k in range(1, 15)}
    found = {name: f.number for name, f in every.items() if f.document == "M"}
    assert found == numbers


def test_scenes_of_the_documents_are_figures_by_themselves() -> None:
    every = figures()
    for name, scene in SCENES.items():
        if name.split("-")[0] in figure.DOCUMENTS:
            assert scene.title.endswith(every[name].title)
    assert "cumulus" not in every
    assert list(every) == sorted(
        every, key=lambda n: (list(figure.DOCUMENTS).index(n.split("-")[0]), n)
    )
    lit = figure_of(SCENES["demand-lit"])
    assert (lit.document, lit.number, lit.title) == ("D", "", "the cloud, lit")


@pytest.mark.parametrize(
    ("letter", "what"), [(a, b) for a, some in SHOWN.items() for b in some]
)
def test_every_picture_of_the_documents_is_a_figure(letter: str, what: str) -> None:
    found = find_figure(SHOWN[letter][what])
    assert found.document == letter
    if re.match(r"figure|appendix .$", what):
        assert found.number == what


def test_e37_appendix_b_is_three_pictures_each_with_its_place() -> None:
    numbers = [find_figure(f"shader-{k}").number for k in ("b", "lit", "volume")]
    assert numbers == [
        "appendix B",
        "section 5.1, of appendix B",
        "section 5.2, of appendix B",
    ]


def test_an_unknown_figure_is_refused() -> None:
    with pytest.raises(ValueError, match=r"NAME: expected one of man-01, .*'man'"):
        find_figure("man")


@pytest.mark.parametrize("name", PLOTS)
def test_plots_are_drawn_at_any_size_and_take_no_eye(name: str, monkeypatch) -> None:
    monkeypatch.setattr(man_net, "CENTRES", 30)
    monkeypatch.setattr(man_net.man, "cloud_map", man_net.small_cloud)
    for width, height in ((64, 48), (40, 90), (90, 30)):
        light = find_figure(name).draw(View(width, height)).linear
        assert light.shape == (height, width, 3)
        # Something is drawn, and it leaves paper.
        assert light.min() < 0.7
        assert light.max() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="look: expected none"):
        find_figure(name).draw(View(64, 48, look="man"))


def test_the_net_says_what_its_neurons_say() -> None:
    grid = man_net.small_cloud()
    net = man_net.approximate(grid, count=6, method="man", overlap=2.0)
    point, density = man_net.asked_voxel(grid, net)
    away = np.sqrt(np.square(net.centers - point).sum(axis=1))
    says = man_net.profile(np.square(away / net.radii), net.kernel)
    total = float(net.densities @ says)
    note, where = find_figure("man-06").draw(SMALL).notes
    assert "the heaviest neuron" in where
    numbers = [float(v) for v in re.findall(r"\d\.\d{3}", note)]
    np.testing.assert_allclose(numbers, [total, density], atol=5e-4)


def test_the_first_pass_shows_real_readback_areas() -> None:
    balls = man_passes.cloud()
    seen = man_passes.light_view(balls, man_passes.DIRECTION, man_passes.SIDE)
    camera, centers = man_passes.light_camera(
        balls, man_passes.DIRECTION, man_passes.SIDE
    )
    x, _, _, scale = project(camera, centers)
    np.testing.assert_array_equal(seen.x, x)
    np.testing.assert_array_equal(seen.radius, balls.radii * scale)
    note, said = find_figure("man-11").draw(SMALL).notes
    assert note.startswith(f"pass 1: {len(balls)} balls, the darkest gets 0.")
    assert said.startswith("tau is 2 for each ball; the paper's 8")


def test_the_numbers_of_balls_stand_apart() -> None:
    crowd = np.array([[0.0, 0.0], [0.0, 0.0], [3.0, 1.0], [90.0, 5.0]])
    apart = man_passes._apart(crowd)
    away = np.sqrt(np.square(apart[:, None] - apart).sum(-1)) + 99.0 * np.eye(4)
    assert away.min() > 0.99 * man_passes.NUMBER
    np.testing.assert_array_equal(apart[3], crowd[3])


@pytest.mark.parametrize("place", [[0.98, 0.6], [-1.3, 2.2], [0.1, 0.4, -0.7]])
def test_figure_1_shows_the_corners_of_the_noise(place: list[float]) -> None:
    found, lattice = shader_diagrams.corners_of(np.array(place))
    plain = plain_simplex.corners(place)
    np.testing.assert_array_equal(lattice, [cell for cell, _ in plain])
    offsets = [away for _, away in plain]
    np.testing.assert_allclose(np.array(place) - found, offsets, atol=1e-12)


def test_figure_2_ends_with_the_light_of_the_march() -> None:
    note, _ = find_figure("shader-02").draw(SMALL).notes
    steps, T = re.match(r"(\d+) samples .* (0\.\d+) of", note).groups()
    assert int(steps) == shader_diagrams.LAYER.steps
    assert 0.0 < float(T) < 0.5


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Leave three figures, two of them tiny and made up."""
    grey = Picture(np.full((4, 6, 3), 0.5), notes=("a <note>",))
    made_up = {
        name: Figure(name, "figure 1", "grey & plain", lambda view: grey)
        for name in ("man-98", "demand-99")
    }
    every = {**made_up, "man-05": find_figure("man-05")}
    # The command's module first: imported later, it would keep the made-up ones.
    monkeypatch.setattr("refcloud.cli.figure.figures", lambda: every)
    monkeypatch.setattr(figure, "figures", lambda: every)
    return list(every)


def test_all_figures_make_a_page(few: list[str], tmp_path: Path) -> None:
    told: list[int] = []
    rows = draw_all(few, "quick", tmp_path / "all", tell=told.append)
    assert [row.name for row in rows] == few
    assert told == [1, 2, 3]
    names = {path.name for path in (tmp_path / "all").iterdir()}
    assert names == {"index.html", *(f"{name}.png" for name in few)}
    text = (tmp_path / "all" / "index.html").read_text("utf-8")
    for row in rows:
        bits = base64.b64encode((tmp_path / f"all/{row.name}.png").read_bytes())
        assert f'src="data:image/png;base64,{bits.decode()}"' in text
        assert row.command in text
        assert f"{row.seconds:.2f} s, {row.cpu:.2f} s of computing" in text
    assert "grey &amp; plain (document M, figure 1; quick)" in text
    assert "a &lt;note&gt;" in text
    # The page needs nothing from elsewhere.
    assert "http" not in text
    assert "<script" not in text
    # Plots are so large that their words can be read.
    assert load_picture(tmp_path / "all" / "man-05.png").linear.shape == (480, 640, 3)


@pytest.mark.slow
def test_processes_draw_the_same_files(tmp_path: Path) -> None:
    names = ["man-05", "demand-sky"]
    draw_all(names, "quick", tmp_path / "one")
    draw_all(names, "quick", tmp_path / "two", jobs=2)
    for name in names:
        files = [tmp_path / folder / f"{name}.png" for folder in ("one", "two")]
        assert files[0].read_bytes() == files[1].read_bytes()


def test_a_page_tells_what_was_skipped(tmp_path: Path) -> None:
    skip = figure_pages.Skipped("eye", "balls off screen", 3, 9)
    Picture(np.ones((2, 2, 3))).save(tmp_path / "man-05.png")
    text = page([Made("man-05", "final", 1.5, (skip,), ("noted",), 1.25)], tmp_path)
    assert "1.50 s, 1.25 s of computing" in text
    assert "<code>refcloud figure man-05 --final</code>" in text
    assert "3 of 9 balls off screen skipped" in text
    assert "noted" in text


def test_a_figure_is_drawn_by_its_setting(few, tmp_path: Path, monkeypatch) -> None:
    sizes = []
    monkeypatch.setattr(
        figure,
        "figures",
        lambda: {"man-98": Figure("man-98", "", "t", lambda view: sizes.append(view))},
    )
    for quality in ("quick", "final"):
        with pytest.raises(AttributeError):  # it drew nothing that could be saved
            draw_figure("man-98", quality, tmp_path / "a.png")
    assert [(view.width, view.height) for view in sizes] == [(640, 480), (1024, 768)]
    lit = figure_of(SCENES["demand-lit"])
    assert figure_pages.size_of(lit, "quick") == (320, 240)
    assert figure_pages.size_of(lit, "final") == (1024, 768)
