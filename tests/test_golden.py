"""Every scene of the table looks as its golden picture; nothing else is stored."""

from __future__ import annotations

import functools

import golden
import pytest
from golden_scenes import GOLDEN, SLOW

from refcloud.image import Picture

NAMES = [
    pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else [])
    for name in GOLDEN
]


@functools.cache
def drawn(name: str) -> Picture:
    return GOLDEN[name]()


@pytest.fixture
def regenerate(request: pytest.FixtureRequest) -> list[str]:
    return request.config.getoption("regenerate")


@pytest.mark.parametrize("name", NAMES)
def test_scene_looks_as_its_golden_picture(name: str, regenerate: list[str]) -> None:
    if name in regenerate:
        golden.regenerate(name, drawn(name))
        pytest.fail(f"{name} is renewed: say why in golden_images/index.toml")
    golden.check_picture(name, drawn(name))


@pytest.mark.parametrize("name", NAMES)
def test_scene_keeps_its_probes(name: str, regenerate: list[str]) -> None:
    if name in regenerate:
        pytest.skip("its probes are being renewed")
    golden.check_probes(name, drawn(name))


def test_every_picture_has_a_scene_and_a_reason(regenerate: list[str]) -> None:
    if regenerate:
        pytest.skip("pictures are being renewed")
    golden.check_folder(set(GOLDEN))
