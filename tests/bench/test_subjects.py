"""Subjects of the benchmark: their errors are what closed forms and orders say."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest

from refcloud.bench import SUBJECTS, blend, interpolants, kernels, passes
from refcloud.bench.plot import HEIGHT, ROW, front, plot
from refcloud.bench.subject import Subject, run, table
from refcloud.bench.timing import Contender, Row, Timing, timed
from refcloud.cli import main
from refcloud.image import load_picture
from refcloud.noise.weights import Interpolant
from refcloud.raster import seen_through_layers


def errors_of(listed: list[Contender]) -> dict[tuple[str, str], float]:
    """Run each contender and measure its error, by task and name."""
    found = {}
    for row in timed(listed, rounds=1):
        assert row.error is not None, row.name
        found[row.task.strip(), row.name] = row.error
    assert len(found) == len(listed)
    return found


@pytest.mark.parametrize(
    ("name", "order"),
    [
        ("linear", 2),
        ("cosine", 1),
        ("cubic", 1),
        ("hermite", 1),
        ("quintic", 1),
        ("catmull_rom", 3),
    ],
)
def test_e13_smooth_is_not_accurate(name: Interpolant, order: int) -> None:
    """Orders of the forms: what halving the spacing divides the error by."""
    exact = interpolants.closed_form(4096)
    coarse, fine = (
        np.abs(interpolants.interpolated(name, n, 4096) - exact).max()
        for n in (64, 128)
    )
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.06)


def test_footprints_come_nearer_with_samples_and_texels() -> None:
    found = errors_of(kernels.footprints(500))
    for kernel in kernels.BOTH:
        task = f"{kernel} footprint"
        assert found[task, "closed form"] == 0.0
        sums = [found[task, f"sum of {n}"] for n in kernels.SAMPLES]
        # Midpoints: four times the samples, a sixteenth of the error at most.
        assert all(b < a / 12.0 for a, b in itertools.pairwise(sums))
        for kind in ("nearest", "linear"):
            read = [found[task, f"{n} texels, {kind}"] for n in kernels.TEXELS]
            assert all(b < a / 1.9 for a, b in itertools.pairwise(read))
        eight = found[task, "32 texels of 8 bits, linear"]
        assert abs(eight - found[task, "32 texels, linear"]) <= 0.5 / 255.0 + 1e-12
    # E04: the paper's map, the density in the plane, at b = 0.57.
    off = found["wyvill footprint", "the plane's density"]
    assert off == pytest.approx(0.065, abs=5e-4)


def test_formats_round_as_their_model_of_one_pixel_does() -> None:
    found = errors_of(blend.formats(2))
    assert len(found) == 9 * len(blend.QUICK_LAYERS)
    for layers in blend.QUICK_LAYERS:
        task = f"{layers} layers"
        assert found[task, "RGBA64F"] < 1e-15
        assert found[task, "RGBA32F, ideal"] < 1e-7
        assert found[task, "RGBA16F, ideal"] < found[task, "RGBA8, ideal"]
        alpha = 1.0 - blend.THROUGH ** (1.0 / layers)
        seen = seen_through_layers(alpha, layers, format="RGBA8")[-1]
        off = abs(seen - blend.THROUGH)
        assert found[task, "RGBA8, ideal"] == pytest.approx(off, abs=1e-12)


def test_light_comes_nearer_in_larger_buffers_and_with_more_sweeps() -> None:
    found = errors_of(passes.buffers(30) + passes.sweeps(30))
    for readback in passes.READBACKS:
        sides = [found[f"buffer, {readback}", f"refcloud side {s}"] for s in (32, 512)]
        assert sides[1] < 0.2 * sides[0]
    task = "sweeps, side 192"
    for share in passes.SWEPT:
        assert found[task, f"refcloud share off by {share:g}"] <= share
    assert found[task, "refcloud exact"] == 0.0


def test_pass_2_keeps_every_tolerance() -> None:
    contenders = passes.flat(20)
    assert len(contenders) == len(passes.TOLERANCES) + 1
    found = errors_of(contenders)
    for tolerance in passes.TOLERANCES:
        name = f"refcloud tolerance {tolerance:.2g}"
        assert found["pass 2, flat", name] <= tolerance


def test_fronts_hold_what_nothing_beats() -> None:
    places = [(3.0, 1.0), (1.0, 5.0), (2.0, 5.0), (2.0, 2.0), (4.0, 0.0), (5.0, 0.5)]
    assert front(places) == [(1.0, 5.0), (2.0, 2.0), (3.0, 1.0), (4.0, 0.0)]


def test_every_subject_says_what_it_measures_against_what() -> None:
    for name, subject in SUBJECTS.items():
        assert subject.name == name
        assert subject.title
        assert subject.reference, name
        assert subject.reference in table(subject, [row_of()])


def row_of() -> Row:
    """Time nothing, for a table."""
    (row,) = timed([Contender("task", "name", 1, lambda: 1.0, lambda: 1.0)], 1)
    return row


@pytest.mark.slow  # the stage that has matplotlib
def test_a_legend_of_many_has_four_columns_below_the_axis(tmp_path) -> None:
    pytest.importorskip("matplotlib", reason="needs matplotlib (extra: bench)")
    subject = Subject("s", "title", "about", ())
    heights = {}
    for tasks in (10, 40):
        rows = [
            Row(str(k), name, Timing(1.0 + k, 1.0, 50.0), None, error)
            for k in range(tasks)
            for name, error in (("one", 0.1), ("two", 0.0))
        ]
        found = load_picture(plot(subject, rows, tmp_path / "a.png"))
        heights[tasks] = found.linear.shape[0] - HEIGHT
    assert heights == {10: 7 * ROW, 40: 12 * ROW}


@pytest.mark.slow  # the stage that has matplotlib
def test_rows_for_machines_are_all_of_the_output(tmp_path, capsys) -> None:
    pytest.importorskip("matplotlib", reason="needs matplotlib (extra: bench)")
    name = str(tmp_path / "blend.png")
    assert main(["bench", "blend", "--quick", "--json", "--plot", name]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)
    assert name in err
    assert main(["bench", "blend", "--quick", "--plot", name]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == name


def test_peers_take_part_where_they_are_asked_for() -> None:
    def both(size: int) -> list[Contender]:
        return [
            Contender("t", "ours", 1, lambda: 1.0),
            Contender("t", "theirs", 1, lambda: 1.0, peer=True),
        ]

    subject = Subject("s", "title", "about", ((both, 2, 1),))
    assert [r.name for r in run(subject, quick=True)] == ["ours", "theirs"]
    assert [r.name for r in run(subject, quick=True, peers=False)] == ["ours"]
