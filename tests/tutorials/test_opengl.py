"""The stored picture of OpenGL is what OpenGL draws."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import lesson
import page
import pytest

from refcloud import gl
from refcloud.image import compare_codes, read_png


@pytest.mark.gl
def test_the_stored_panel_is_what_opengl_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if importlib.util.find_spec("moderngl") is None:
        pytest.skip('needs moderngl: pip install -e ".[test,gl]"')
    try:
        gl.context()
    except ValueError as missing:
        pytest.skip(str(missing))
    # Without its stored picture the quick run draws by OpenGL.
    monkeypatch.setattr(lesson, "PICTURES", tmp_path)
    path = next(path for path in page.tutorials() if path.name.startswith("16"))
    out = tmp_path / "out"
    out.mkdir()
    page.draw(path, out, "--quick")
    new, old = (read_png(folder / "16-same.png") for folder in (out, page.QUICK))
    width = (old.shape[1] - 2 * 4) // 3
    panel = slice(width + 4, 2 * width + 4)
    # Drivers round differently: one code.
    found = compare_codes(old[:, panel], new[:, panel], fraction=1.0)
    assert found.same, found
