"""The backend gl where there is no OpenGL: one line, before anything is made."""

from __future__ import annotations

import sys
import types
from pathlib import Path

import pytest

from refcloud import render
from refcloud.cli import main
from refcloud.gl import opengl
from refcloud.metaballs import Metaballs, save_metaballs
from refcloud.scene import SCENES, Scene

BALL = Metaballs([[0.0, 0.0, 0.0]], [1.0], [1.0])
NO_MODERNGL = r"backend: expected moderngl .*, got none; pip install \"\.\[gl\]\" in"
NO_OPENGL = "backend: expected OpenGL 3.3 .*, got libEGL.so.1 not loaded; install Mesa"


class _NoOpenGL(types.ModuleType):
    """moderngl on a machine without OpenGL: it raises plain exceptions."""

    asked: list[dict]

    def create_context(self, require: int, **how: object) -> None:
        self.asked.append(how)
        raise Exception("libEGL.so.1 not\nloaded")


def missing(monkeypatch: pytest.MonkeyPatch, module: types.ModuleType | None) -> None:
    # Whatever context is open stays so: the function without its memory is asked.
    monkeypatch.setattr(opengl, "opened", opengl.opened.__wrapped__)
    monkeypatch.setitem(sys.modules, "moderngl", module)


def without_opengl() -> _NoOpenGL:
    module = _NoOpenGL("moderngl")
    module.asked = []
    return module


def test_without_moderngl_one_line_says_what_to_install(monkeypatch) -> None:
    missing(monkeypatch, None)
    with pytest.raises(ValueError, match=NO_MODERNGL):
        render(BALL, backend="gl")


def test_without_opengl_one_line_says_why(monkeypatch) -> None:
    module = without_opengl()
    missing(monkeypatch, module)
    with pytest.raises(ValueError, match=NO_OPENGL):
        render(BALL, backend="gl")
    # EGL first, which needs no display; then the system's own way.
    assert module.asked == [
        {"standalone": True, "backend": "egl"},
        {"standalone": True},
    ]


def test_it_is_refused_before_a_scenes_clouds_are_made(monkeypatch) -> None:
    missing(monkeypatch, None)
    made = Scene("never", "", lambda: pytest.fail("made"), lambda model, view: None)  # type: ignore[arg-type,return-value]
    monkeypatch.setitem(SCENES, "never", made)
    with pytest.raises(ValueError, match=NO_MODERNGL):
        render("never", backend="gl")


def test_the_command_line_ends_with_2(monkeypatch, capsys, tmp_path: Path) -> None:
    missing(monkeypatch, None)
    monkeypatch.chdir(tmp_path)
    save_metaballs(BALL, "ball.npz")
    assert main(["render", "ball.npz", "--backend", "gl", "--width", "8"]) == 2
    printed = capsys.readouterr().err.splitlines()
    assert len([line for line in printed if line.startswith("refcloud: ")]) == 1
    assert "backend: expected moderngl" in printed[-1]
    assert not list(tmp_path.glob("*.png"))


def test_another_thread_is_refused(monkeypatch) -> None:
    # A context belongs to one thread; drawing from another would only fail unclearly.
    monkeypatch.setattr(opengl, "opened", lambda: (None, -1))
    with pytest.raises(
        ValueError, match="backend: expected the thread that first drew"
    ):
        render(BALL, backend="gl")


def test_another_backend_is_refused(capsys) -> None:
    with pytest.raises(ValueError, match="backend: expected one of 'numpy', 'gl', got"):
        render(BALL, backend="vulkan")  # type: ignore[arg-type]
    assert main(["render", "cumulus", "--backend", "vulkan"]) == 2
    assert "--backend: expected one of 'numpy', 'gl'" in capsys.readouterr().err
