"""The tasks' golden pictures: students' own code, written from the page, gives them."""

from __future__ import annotations

import importlib.util
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from refcloud.cli import main
from refcloud.image import compare_codes, read_png, write_png
from refcloud.plain import image, noise

FOLDER = Path(__file__).parents[2] / "tutorials" / "exercises"
SPEC = importlib.util.spec_from_file_location("tasks", FOLDER / "tasks.py")
assert SPEC is not None
assert SPEC.loader is not None
tasks = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(tasks)
NAMES = sorted(tasks.TASKS)
PAGE = (FOLDER.parent / "teachers.md").read_text("utf-8")
MOST_BYTES = 100_000


@pytest.mark.parametrize("name", NAMES)
def test_the_library_draws_the_stored_picture(name: str) -> None:
    found = compare_codes(read_png(FOLDER / f"{name}.png"), tasks.TASKS[name]())
    assert found.same, found


def test_every_task_has_a_picture_and_a_description() -> None:
    assert {path.stem for path in FOLDER.glob("*.png")} == set(NAMES)
    assert sorted(re.findall(r"exercises/(\S+)\.png\)", PAGE)) == NAMES
    assert sum(path.stat().st_size for path in FOLDER.glob("*.png")) < MOST_BYTES


# What follows is written from the page alone, one pixel at a time.
def grey(v: float) -> list[int]:
    return [math.floor(255.0 * min(max(v, 0.0), 1.0) + 0.5)] * 3


def drawn(
    width: int, height: int, pixel: Callable[[int, int], Sequence[int]]
) -> np.ndarray:
    rows = [[pixel(i, j) for i in range(width)] for j in range(height)]
    return np.array(rows, np.uint8)


def g(x: int, y: int, z: int) -> float:
    m = x + 57 * y + 57 * 57 * z
    n = (m << 13) ^ m
    return 1.0 - ((n * (15731 * n * n + 789221) + 1376312589) & 0x7FFFFFFF) / 2**30


def cosine(a: float, b: float, t: float) -> float:
    F = (1.0 - math.cos(math.pi * t)) / 2.0
    return a * (1.0 - F) + b * F


def value(i: int, j: int) -> list[int]:
    x, y, z = (i + 0.5) / 12.0, (j + 0.5) / 12.0, 0.25
    a, b, c = math.floor(x), math.floor(y), math.floor(z)
    planes = []
    for dz in (0, 1):
        rows = [
            cosine(g(a, b + dy, c + dz), g(a + 1, b + dy, c + dz), x - a)
            for dy in (0, 1)
        ]
        planes.append(cosine(*rows, y - b))
    return grey((cosine(*planes, z - c) + 1.0) / 2.0)


def kernel(q: float) -> float:
    """Give Wyvill's kernel of (r / R)^2."""
    if q >= 1.0:
        return 0.0
    return 1.0 - 22 / 9 * q + 17 / 9 * q**2 - 4 / 9 * q**3


def footprint(q: float) -> float:
    s = math.sqrt(max(1.0 - q, 0.0))
    return (16 / 27 * s**5 + 128 / 315 * s**7) / (944 / 945)


def field(i: int, j: int) -> list[int]:
    x, y = -1.8 + 3.6 * (i + 0.5) / 96.0, 1.2 - 2.4 * (j + 0.5) / 64.0
    balls = (
        ((-0.7, 0.1, 0.0), 0.9, 1.0),
        ((0.5, -0.2, 0.3), 0.8, 0.8),
        ((0.6, 0.5, -0.2), 0.5, 0.6),
    )
    return grey(
        sum(d * kernel((math.dist((x, y, 0.0), c) / R) ** 2) for c, R, d in balls)
    )


def blended(i: int, j: int) -> list[int]:
    pixel = [0.2, 0.35, 0.6]
    for x, y, R, colour, tau in (
        (34, 36, 24, (0.95, 0.6, 0.35), 3.0),
        (50, 28, 22, (0.9, 0.9, 0.9), 2.0),
        (66, 38, 18, (0.35, 0.6, 0.9), 4.0),
    ):
        q = ((i + 0.5 - x) ** 2 + (j + 0.5 - y) ** 2) / R**2
        T = math.exp(-tau * footprint(q))
        pixel = [c * (1.0 - T) + T * v for c, v in zip(colour, pixel, strict=True)]
    return [grey(image.srgb_encode(v))[0] for v in pixel]


def readback() -> np.ndarray:
    buffer = [[1.0] * 64 for _ in range(64)]
    for x, y, R in (
        *((32, 20, 12), (24, 30, 14), (40, 32, 14)),
        *((30, 40, 16), (42, 44, 10)),
    ):
        inside = [
            (i, j, ((i + 0.5 - x) ** 2 + (j + 0.5 - y) ** 2) / R**2)
            for j in range(64)
            for i in range(64)
        ]
        inside = [one for one in inside if one[2] <= 1.0]
        light = sum(buffer[j][i] for i, j, _ in inside) / len(inside)
        for i, j, q in inside:
            tau = 1.5 * footprint(q)
            added = light * (math.exp(-0.3 * tau) - math.exp(-tau))
            buffer[j][i] = added + math.exp(-tau) * buffer[j][i]
    return drawn(64, 64, lambda i, j: grey(buffer[j][i]))


def marched(i: int, j: int) -> list[int]:
    x, y = -1.2 + 2.4 * (i + 0.5) / 64.0, 1.2 - 2.4 * (j + 0.5) / 64.0
    light, T = 0.0, 1.0
    for step in range(64):
        z = 1.2 - (step + 0.5) * 0.0375
        tau = 4.0 * 0.0375 * kernel(x * x + y * y + z * z)
        if tau == 0.0:
            continue
        sun = sum(
            4.0 * 0.075 * kernel((x + (k + 0.5) * 0.075) ** 2 + y * y + z * z)
            for k in range(32)
        )
        light += T * math.exp(-sun) * (1.0 - math.exp(-tau))
        T *= math.exp(-tau)
    return grey(light)


STUDENTS: dict[str, Callable[[], np.ndarray]] = {
    "1-hash": lambda: drawn(64, 64, lambda i, j: grey((g(i, j, 0) + 1.0) / 2.0)),
    "2-value": lambda: drawn(96, 96, value),
    "5-field": lambda: drawn(96, 64, field),
    "6-blend": lambda: drawn(96, 64, blended),
    "7-readback": readback,
}


@pytest.mark.parametrize("name", STUDENTS)
def test_a_students_program_passes(name: str) -> None:
    found = compare_codes(read_png(FOLDER / f"{name}.png"), STUDENTS[name]())
    assert found.same, found


def test_a_students_march_passes_where_it_is_looked_at() -> None:
    golden = read_png(FOLDER / "8-march.png")
    for j in range(3, 64, 9):
        for i in range(2, 64, 7):
            assert abs(int(golden[j, i, 0]) - marched(i, j)[0]) <= 1


def test_noise_of_tasks_3_and_4_where_it_is_looked_at() -> None:
    three, four = (read_png(FOLDER / f"{n}.png") for n in ("3-octaves", "4-ellipsoid"))
    for j, i in ((0, 0), (5, 90), (40, 41), (77, 13)):
        at = ((i + 0.5) / 12.0, (j + 0.5) / 12.0, 0.25)
        assert three[j, i].tolist() == grey(noise.octave_sum(at, seed=None))
    for j, i in ((32, 48), (20, 30), (30, 35), (40, 60), (0, 0)):
        x, y = -32.0 + 64.0 * (i + 0.5) / 96.0, 64 / 3 * (1.0 - 2.0 * (j + 0.5) / 64.0)
        Q = 1.0 - (x / 30.0) ** 2 - (y / 17.0) ** 2
        v = noise.octave_sum((x / 16.0, y / 16.0, 0.0), seed=None) * Q
        assert four[j, i].tolist() == grey(v / 0.6 if Q >= 0.0 and v >= 0.1 else 0.0)


def test_the_command_of_the_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    golden = FOLDER / "6-blend.png"
    mine, shown = tmp_path / "mine.png", tmp_path / "difference.png"
    write_png(mine, STUDENTS["6-blend"]())
    assert main(["compare", str(mine), str(golden)]) == 0
    assert capsys.readouterr().out.startswith("same")
    wrong = STUDENTS["6-blend"]()
    wrong[10:14, 20:24] += 40
    write_png(mine, wrong)
    assert main(["compare", str(mine), str(golden), "-o", str(shown)]) == 1
    said = capsys.readouterr().out
    assert "different" in said
    assert "largest difference: 40 codes" in said
    assert "worst pixel: row 10, column 20" in said
    assert read_png(shown)[11, 21].min() > 0
    assert read_png(shown)[40, 40].max() == 0
    assert main(["compare", str(tmp_path / "none.png"), str(golden)]) == 2
