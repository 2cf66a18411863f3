"""A real OpenGL, or the reason why there is none."""

from __future__ import annotations

import importlib.util

import pytest

from refcloud import gl


@pytest.fixture(scope="session", autouse=True)
def opengl() -> None:
    """Open the context once; skip where moderngl or OpenGL is missing."""
    if importlib.util.find_spec("moderngl") is None:
        pytest.skip('needs moderngl: pip install -e ".[test,gl]"')
    try:
        gl.context()
    except ValueError as missing:
        pytest.skip(str(missing))


@pytest.fixture(scope="session")
def llvmpipe(opengl: None) -> str:
    """Give the renderer's name where it is the one whose rules are known to the bit."""
    name = gl.renderer()
    if "llvmpipe" not in name:
        pytest.skip(f"the rules to the bit are those of llvmpipe, this is {name}")
    return name
