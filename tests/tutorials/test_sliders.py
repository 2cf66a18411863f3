"""The page of sliders: this machine alone, two paths, every value within its range."""

from __future__ import annotations

import http.client
import io
import re
import threading
from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
import pytest
import sliders
from PIL import Image
from sheets import Sheet, grey

from refcloud.conventions import Range


def picture(
    *,
    level: Annotated[float, Range(0.0, 1.0)] = 0.5,
    count: Annotated[int, Range(1, 9)] = 4,
    way: Literal["up", "down"] = "up",
    bright: bool = False,
) -> Sheet:
    """Draw a square of one grey.

    Parameters
    ----------
    level
        How light <b>it</b> is.
    count
        Its edge.
    way
        Not used.
    bright
        Whether it is white.
    """
    return grey(np.full((count, count), 1.0 if bright else level))


@pytest.fixture
def port() -> Iterator[int]:
    with sliders.Server(picture, "a <title>") as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_port
        server.shutdown()
        thread.join()


def ask(port: int, path: str, **headers: str) -> tuple[int, bytes]:
    line = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    line.request("GET", path, headers=headers)
    answer = line.getresponse()
    body = answer.read()
    line.close()
    return answer.status, body


def test_the_page_has_a_control_for_each_parameter(port: int) -> None:
    status, body = ask(port, "/")
    text = body.decode()
    assert status == 200
    assert re.findall(r'<(?:input|select)[^>]* name="(\w+)"', text) == [
        *("level", "count", "way", "bright")
    ]
    assert 'min="0.0" max="1.0" step="0.01" value="0.5"' in text
    assert "a &lt;title&gt;" in text
    assert "<b>it" not in text


def test_a_picture_is_drawn_with_the_values(port: int) -> None:
    status, body = ask(port, "/picture?level=0.2&count=3&way=down&bright=false")
    assert status == 200
    codes = np.asarray(Image.open(io.BytesIO(body)))
    assert codes.shape == (3, 3, 3)
    assert (codes == 51).all()
    _, body = ask(port, "/picture?bright=true")
    assert (np.asarray(Image.open(io.BytesIO(body))) == 255).all()


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        ("/picture?level=2", {}, 400),
        ("/picture?level=nan", {}, 400),
        ("/picture?count=1e9", {}, 400),
        ("/picture?way=left", {}, 400),
        ("/picture?other=1", {}, 400),
        ("/picture?" + "level=0.1&" * 9, {}, 400),
        ("/picture?level=" + "1" * 3000, {}, 414),
        ("/../lesson.py", {}, 404),
        ("/", {"Host": "clouds.example"}, 403),
        ("/", {"Origin": "http://clouds.example"}, 403),
        ("/picture", {"Sec-Fetch-Site": "cross-site"}, 403),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(
    port: int, path: str, headers: dict[str, str], status: int
) -> None:
    found, body = ask(port, path, **headers)
    assert found == status
    assert body.count(b"\n") == 0
    assert b": expected" in body or b"field" in body
    assert ask(port, "/")[0] == 200, "and the server goes on"


def test_it_listens_on_this_machine_alone() -> None:
    with sliders.Server(picture, "title") as server:
        assert server.server_address[0] == "127.0.0.1"


@pytest.mark.parametrize(
    ("most", "step"), [(0.03, 0.02), (0.01, 0.01), (7.0, 5.0), (0.0099, 0.005)]
)
def test_steps_are_round(most: float, step: float) -> None:
    assert sliders.round_step(most) == step
