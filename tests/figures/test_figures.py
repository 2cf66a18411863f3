"""Figures: all that the documents number are there, one by one and on one page."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from refcloud import figure, figure_pages
from refcloud.camera import project
from refcloud.figure import Figure, figure_of, figures, find_figure
from refcloud.figure_pages import Made, draw_all, draw_figure, page
from refcloud.image import Picture, load_picture
from refcloud.scene import SCENES, View
from refcloud.scenes import man_net, man_passes

SMALL = View(64, 48)
PLOTS = ("man-02", "man-03", "man-05", "man-06", "man-07", "man-11", "man-12")


def test_every_figure_of_paper_m_is_there() -> None:
    every = figures()
    numbers = {f"man-{k:02}": f"figure {k}" for k in range(1, 15)}
    found = {name: f.number for name, f in every.items() if f.document == "M"}
    assert found == numbers


def test_scenes_of_the_documents_are_figures_by_themselves() -> None:
    every = figures()
    for name, scene in SCENES.items():
        if name.split("-")[0] in figure.DOCUMENTS:
            assert every[name].title in scene.title
    assert "cumulus" not in every
    assert list(every) == sorted(
        every, key=lambda n: (list(figure.DOCUMENTS).index(n.split("-")[0]), n)
    )
    lit = figure_of(SCENES["demand-lit"])
    assert (lit.document, lit.number, lit.title) == ("D", "", "the cloud, lit")


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
    (note,) = find_figure("man-06").draw(SMALL).notes
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
    (note,) = find_figure("man-11").draw(SMALL).notes
    assert note.startswith(f"pass 1: {len(balls)} balls, the darkest gets 0.")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Leave three figures, two of them tiny and made up."""
    grey = Picture(np.full((4, 6, 3), 0.5), notes=("a <note>",))
    made_up = {
        name: Figure(name, "figure 1", "grey & plain", lambda view: grey)
        for name in ("man-98", "demand-99")
    }
    every = {**made_up, "man-05": find_figure("man-05")}
    monkeypatch.setattr(figure, "figures", lambda: every)
    monkeypatch.setattr("refcloud.cli.figure.figures", lambda: every)
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
        assert f'src="{row.name}.png"' in text
        assert row.command in text
    assert "grey &amp; plain (document M, figure 1; quick)" in text
    assert "a &lt;note&gt;" in text
    # The page needs nothing from elsewhere.
    assert "http" not in text
    assert "<script" not in text
    assert load_picture(tmp_path / "all" / "man-05.png").linear.shape == (240, 320, 3)


def test_processes_draw_the_same_files(tmp_path: Path) -> None:
    names = ["man-05", "demand-sky"]
    draw_all(names, "quick", tmp_path / "one")
    draw_all(names, "quick", tmp_path / "two", jobs=2)
    for name in names:
        files = [tmp_path / folder / f"{name}.png" for folder in ("one", "two")]
        assert files[0].read_bytes() == files[1].read_bytes()


def test_a_page_tells_what_was_skipped() -> None:
    skip = figure_pages.Skipped("eye", "balls off screen", 3, 9)
    text = page([Made("man-05", "final", 1.5, (skip,), ("noted",))])
    assert "1.50 s, made by <code>refcloud figure man-05 --final</code>" in text
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
    assert [(view.width, view.height) for view in sizes] == [(320, 240), (1024, 768)]
