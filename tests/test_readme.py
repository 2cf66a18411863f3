"""The README names what exists, and its examples run."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import refcloud
import refcloud.lighting
import refcloud.metaballs
import refcloud.noise
import refcloud.raster
from refcloud import transport
from refcloud.bench.certificates import COUNTS
from refcloud.conventions import Known, Skipped
from refcloud.transport import scattering

README = (Path(__file__).parent.parent / "README.md").read_text("utf-8")
ROOMS = (
    refcloud,
    refcloud.noise,
    refcloud.cloudmap,
    refcloud.metaballs,
    refcloud.optics,
    refcloud.lighting,
)


def test_every_function_of_the_equations_exists() -> None:
    table = README.split("| stage |")[1].split("\n\n")[0]
    names = re.findall(r"`([A-Za-z_0-9.]+)", table)
    assert len(names) > 15
    for name in names:
        last = name.rsplit(".", 1)[-1]
        found = any(hasattr(room, last) for room in (*ROOMS, refcloud.raster))
        assert found, f"README: {name} does not exist"


def test_every_field_of_the_looks_exists() -> None:
    table = README.split("| | field of `Look` |")[1].split("\n\n")[0]
    cells = [line.split("|")[2] for line in table.splitlines()[2:]]
    names = [name for cell in cells for name in re.findall(r"`(\w+)`", cell)]
    assert len(names) > 8
    for name in names:
        assert name in refcloud.Look.__dataclass_fields__, name


def test_the_table_of_certificates_adds_up() -> None:
    table = README.split("| scenes | drawn |")[1].split("\n\n")[0]
    rows = [line.split("|")[1:-1] for line in table.splitlines()[2:]]
    assert {name.strip(): int(drawn) for name, drawn, *_ in rows} == COUNTS
    sums = [sum(int(row[k]) for row in rows) for k in (1, 2, 3)]
    told = re.search(r"Of (\d+) pictures, (\d+) of them .*?, (\d+) were off", README)
    assert told is not None
    assert [int(number) for number in told.groups()] == sums


def test_the_rows_of_the_report_are_as_a_picture_writes_them() -> None:
    part = README.split("## What the report says")[1].split("\n## ")[0]
    form = r"(\w+): (\d+) of (\d+) (.+) skipped, error at most ([\d.]+)"
    rows = re.findall(rf"^{form}(?: \((.+), (proved)\))?$", part, re.M)
    assert len(rows) == 4
    for stage, skipped, of, what, bound, unit, how in rows:
        row = Skipped(stage, what, int(skipped), int(of), float(bound), unit, how)
        assert str(row) in part.splitlines()
    for how in get_args(Known):
        assert how in part, how
    grid = refcloud.VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [1, 1, 1])
    medium = refcloud.Medium(2 * 9.05)
    light = transport.scattered_light(grid, refcloud.Sun([0, 1, 0]), medium=medium)
    note = scattering.report_of([light]).split("; ")[1].split(":")[0]
    assert f"{note}`" in part


def test_the_examples_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # Smaller than the reader's: the same calls on a small cloud and a small picture.
    monkeypatch.chdir(tmp_path)
    small = {"diameters": [20, 11, 11], "relief": 2, "cell": 3}
    generate, render = refcloud.generate, refcloud.render
    monkeypatch.setattr(refcloud, "generate", lambda **k: generate(**k, **small))
    monkeypatch.setattr(
        refcloud, "render", lambda *a, **k: render(*a, **k, width=64, height=48)
    )
    monkeypatch.setattr(
        refcloud,
        "approximate",
        lambda grid, count: refcloud.metaballs.approximate(grid, count=count // 20),
    )
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", README, re.DOTALL):
        exec(compile(block, "README.md", "exec"), names)
    assert {path.name for path in tmp_path.iterdir()} == {
        "cloud.png",
        "smooth.png",
        "beer.png",
    }
    assert "medium: sigma_t" in capsys.readouterr().out


def test_the_call_that_names_a_scene_s_parts_works() -> None:
    (call,) = re.findall(r"`(rc\.scenes\.own_of\(.*?\))`", README)
    own = eval(call, {"rc": refcloud})
    assert own.medium is not None
    assert None not in (own.suns, own.look, own.camera)
