"""The page in a real browser: load, drag, see the picture change, save.

Needs the driver (the extra ``browser``) and Chromium, of the system's packages.
"""

from __future__ import annotations

import io
import shutil
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
from PIL import Image

from refcloud.studio import Studio

try:
    from playwright.sync_api import expect, sync_playwright
except ImportError:
    sync_playwright = None

CHROMIUM = next(
    (
        p
        for n in ("chromium", "chromium-browser", "google-chrome")
        if (p := shutil.which(n))
    ),
    None,
)
WHY = "needs playwright, the extra `browser`" if sync_playwright is None else ""
WHY = WHY or ("needs Chromium" if CHROMIUM is None else "")
pytestmark = [pytest.mark.browser, pytest.mark.skipif(bool(WHY), reason=WHY)]

WAIT = 60_000.0  # milliseconds: a busy machine is no failure
FINE = "#picture[data-quality=fine]"
# Fast to draw: the tests are about the page.
LITTLE = "noise"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_playwright() as play:
        # Its sandbox cannot start for root, as in containers; the page is our own.
        browser = play.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


def is_wrong(message: Any) -> bool:
    """Tell an error of the page from a refusal, which the browser notes as well."""
    refused = "status of 400" in message.text
    return message.type == "error" and not refused


@pytest.fixture
def page(browser: Any, studio: Studio) -> Iterator[Any]:
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    page.set_default_timeout(WAIT)
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda m: is_wrong(m) and wrong.append(m.text))
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(studio.address)
    page.wait_for_selector("#picture[data-quality]")
    yield page
    context.close()
    assert not wrong
    own = (studio.address, "data:", "blob:")
    assert all(url.startswith(own) for url in asked), "nothing comes from elsewhere"


def chosen(page: Any, name: str) -> None:
    page.select_option("#setup", name)
    page.wait_for_selector(f"{FINE}[data-scene={name}]")


def serial(page: Any) -> int:
    return int(page.get_attribute("#picture", "data-serial"))


def shown(page: Any) -> bytes:
    return page.get_attribute("#picture", "src")


def changed_from(page: Any, old: str, quality: str) -> None:
    page.wait_for_selector(
        f"#picture[data-quality={quality}]:not([data-serial='{old}'])"
    )


def test_dragging_a_slider_changes_the_picture_before_it_is_let_go(page) -> None:
    chosen(page, LITTLE)
    before, number = shown(page), str(serial(page))
    slider = page.locator("#noise-cells")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    changed_from(page, number, "coarse")
    assert shown(page) != before
    expect(page.locator("#badge")).to_have_text("coarse")
    assert serial(page) > int(number)
    page.mouse.up()
    page.wait_for_selector(FINE)
    assert "for 384 " in page.inner_text("#time-of")
    expect(page.locator("#badge")).to_be_hidden()


def test_keys_alone_do_everything(page, tmp_path) -> None:
    chosen(page, "demand-lit")
    number = str(serial(page))
    page.locator("#stage").focus()
    page.keyboard.press("ArrowRight")
    changed_from(page, number, "fine")
    number = str(serial(page))
    page.locator("#stage").focus()
    page.keyboard.press("Shift+ArrowUp")
    changed_from(page, number, "fine")
    page.get_by_label("find a parameter").fill("albedo")
    field = page.get_by_label("albedo, typed")
    field.fill("0.5")
    number = str(serial(page))
    page.keyboard.press("Tab")
    changed_from(page, number, "fine")
    page.locator("#python").focus()
    page.keyboard.press("Enter")
    page.locator("#code-text", has_text="picture.save").wait_for()
    text = page.locator("#code-text").inner_text()
    assert "rc.render(\n    'demand-lit'" in text
    assert "albedo=0.5" in text
    page.keyboard.press("Escape")
    expect(page.locator("#code")).to_be_hidden()


def test_pictures_and_scenes_are_saved_and_opened(page, tmp_path) -> None:
    chosen(page, LITTLE)
    page.get_by_label("size, typed").fill("64")
    page.keyboard.press("Enter")
    page.locator("#time-of", has_text="for 64 ").wait_for()
    with page.expect_download() as saved:
        page.click("#save")
    assert saved.value.suggested_filename == "noise.png"
    with Image.open(saved.value.path()) as picture:
        assert picture.size == (64, 64)
    with page.expect_download() as saved:
        page.click("#toml")
    text = saved.value.path().read_text("utf-8")
    assert tomllib.loads(text)["noise"] == {"size": 64}
    page.click("#reset")
    page.locator("#time-of", has_text="for 384 ").wait_for()
    file = {"name": "a.toml", "mimeType": "text/plain", "buffer": text.encode()}
    page.set_input_files("#file", files=[file])
    page.locator("#time-of", has_text="for 64 ").wait_for()
    assert page.get_by_label("size, typed").input_value() == "64"


def test_refusals_are_shown(page) -> None:
    chosen(page, LITTLE)
    page.get_by_label("octaves, typed").fill("99")
    page.keyboard.press("Enter")
    trouble = page.locator("#trouble")
    trouble.wait_for()
    assert (
        "noise.octaves: expected a whole number in [1, 8], got 99"
        in trouble.inner_text()
    )
    page.get_by_label("octaves, typed").fill("2")
    page.keyboard.press("Enter")
    trouble.wait_for(state="hidden")


def test_views_are_shown(page) -> None:
    chosen(page, "box")
    page.select_option("#wide", "320")
    page.select_option("#view", "steps per pixel")
    page.locator("#caption", has_text="samples that meet cloud").wait_for()
    page.select_option("#view", "density slice")
    page.locator("#caption", has_text="density, slice").wait_for()
    expect(page.locator("#slice-row")).to_be_visible()


@pytest.mark.parametrize("name", ["box", "cumulus"])
def test_every_control_has_a_name_and_can_be_reached(name, page) -> None:
    page.select_option("#setup", name)
    closed = page.locator("details.group:not([open]) > summary")
    while closed.count():
        closed.first.click()
    controls = page.locator("input:not([type=file]), select, button, [tabindex='0']")
    handles = [each for each in controls.all() if each.is_visible()]
    assert len(handles) > 10
    unnamed = [
        each.get_attribute("id")
        for each in handles
        if not (
            each.get_attribute("aria-label")
            or each.inner_text().strip()
            or each.get_attribute("aria-describedby")
            or page.locator(f"label[for='{each.get_attribute('id')}']").count()
        )
    ]
    assert not unnamed
    assert all(each.get_attribute("tabindex") != "-1" for each in handles)


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080)])
def test_the_picture_has_the_most_room_and_nothing_runs_over(size, page) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    stage = page.locator("#stage").bounding_box()
    assert stage["width"] > 0.55 * size[0]
    assert stage["height"] > 0.55 * size[1]
    for place in ("header", "main", "aside"):
        box = page.locator(place).bounding_box()
        assert box["x"] >= 0.0
        assert box["x"] + box["width"] <= size[0] + 1.0
    assert Image.open(io.BytesIO(page.screenshot())).size == size
