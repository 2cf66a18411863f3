"""The page of sliders in a real browser: load, move one, see the picture change.

Needs the driver (the extra ``browser``) and Chromium, of the system's packages.
"""

from __future__ import annotations

import shutil
import threading
from typing import Annotated, Literal

import numpy as np
import pytest
import sliders
from sheets import Sheet, grey

from refcloud.conventions import Range

try:
    from playwright.sync_api import expect, sync_playwright
except ImportError:
    sync_playwright = None

NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next((path for name in NAMES if (path := shutil.which(name))), None)
WHY = "needs playwright, the extra `browser`" if sync_playwright is None else ""
WHY = WHY or ("needs Chromium" if CHROMIUM is None else "")
pytestmark = [pytest.mark.browser, pytest.mark.skipif(bool(WHY), reason=WHY)]
WAIT = 60_000.0  # milliseconds: a busy machine is no failure


def square(
    *,
    level: Annotated[float, Range(0.0, 1.0)] = 0.5,
    way: Literal["up", "down"] = "up",
) -> Sheet:
    """Draw a square of one grey; a level of 0.52 is refused."""
    if abs(level - 0.52) < 1e-9:
        raise ValueError("level: expected another, got 0.52")
    return grey(np.full((8, 8), level))


def test_a_slider_moves_by_the_keyboard_and_the_picture_follows() -> None:
    wrong: list[str] = []
    with sliders.Server(square, "square") as server, sync_playwright() as play:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            # Its sandbox cannot start for root, as in containers; the page is our own.
            browser = play.chromium.launch(
                executable_path=CHROMIUM, args=["--no-sandbox"]
            )
            page = browser.new_page()
            page.set_default_timeout(WAIT)
            page.on("pageerror", lambda error: wrong.append(str(error)))
            page.goto(server.address)
            image, said = page.locator("img"), page.locator("p")
            expect(said).to_contain_text(" s", timeout=WAIT)
            first = image.get_attribute("src")
            page.locator("input[name=level]").press("ArrowRight")
            expect(image).not_to_have_attribute("src", first or "", timeout=WAIT)
            expect(page.locator("label", has_text="level")).to_contain_text("0.51")
            assert image.evaluate("i => i.naturalWidth") == 8
            page.locator("input[name=level]").press("ArrowRight")
            expect(said).to_contain_text("expected another", timeout=WAIT)
            browser.close()
        finally:
            server.shutdown()
            thread.join()
    assert not wrong
