"""What the splat benchmark times on OpenGL draws the same picture as ours."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import splat_gl, splat_scene
from refcloud.lighting import eyeward

pytestmark = pytest.mark.gl

COUNT = 100


def test_every_contender_draws_the_scene() -> None:
    lit, camera = splat_scene.lit(COUNT), splat_scene.eye()
    expected, _ = eyeward(lit, camera)
    contenders = splat_gl.second_pass_with_opengl(COUNT, lambda: expected)
    assert [contender.name.split()[0] for contender in contenders] == [
        'backend="gl"',
        "moderngl",
        "moderngl",
    ]
    # Eight bits lose half a code in every layer of some dozens.
    for contender, most in zip(contenders, (1e-5, 1e-5, 0.1), strict=True):
        assert contender.task == "second pass N=100"
        found = np.asarray(contender.work())
        assert np.abs(found - expected).max() < most, contender.name
    (carried,) = splat_gl.first_pass_with_opengl(COUNT)
    scale = lit.light.max()
    assert np.abs(carried.work() - lit.light).max() < 1e-5 * scale


def test_without_opengl_nobody_takes_part(monkeypatch) -> None:
    def missing() -> None:
        raise ValueError("backend: expected OpenGL")

    monkeypatch.setattr("refcloud.gl.context", missing)
    assert splat_gl.second_pass_with_opengl(COUNT) == []
    assert splat_gl.first_pass_with_opengl(COUNT) == []
