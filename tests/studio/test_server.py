"""The server: what it answers, whom it refuses, and that garbage does not shake it."""

from __future__ import annotations

import base64
import io
import json
import socket
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from refcloud.studio import Studio, setups

GIVEN = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
SIZE = {"width": 8, "height": 6, "page": "test"}
NOISE = {"setup": "noise", "values": {"noise": {"size": 8}}, **SIZE}


def test_the_page_is_whole_in_itself(ask) -> None:
    answer = ask("GET", "/")
    assert answer.status == 200
    text = answer.body.decode("utf-8")
    assert "<title>refcloud studio</title>" in text
    assert "http://" not in text
    assert "https://" not in text
    assert "//" not in text.replace("data:image/png;base64,", "").split("<script>")[0]
    policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert ask("HEAD", "/").body == b""


def test_choices_are_described(ask) -> None:
    found = ask("GET", "/api/setups").json
    assert [s["name"] for s in found["setups"]] == list(setups())


def test_a_picture_is_drawn(ask) -> None:
    found = ask("POST", "/api/render", NOISE).json
    with Image.open(io.BytesIO(base64.b64decode(found["picture"]))) as picture:
        assert picture.size == (8, 8) == (found["width"], found["height"])
    assert found["seconds"] > 0.0
    lit = {"setup": "demand-lit", **SIZE}
    found = ask("POST", "/api/render", lit).json
    assert (found["width"], found["height"]) == (8, 6)
    assert {row["what"] for row in found["skipped"]} >= {"samples between empty voxels"}
    assert set(found["stages"]) == {"generate", "march"}


def test_text_is_handed_out(ask) -> None:
    assert "noise_picture(" in ask("POST", "/api/python", NOISE).json["text"]
    saved = ask("POST", "/api/scene", NOISE).json
    assert saved["file"] == "noise.toml"
    opened = ask("POST", "/api/open", {"text": saved["text"]}).json
    assert opened["setup"] == "noise"
    assert opened["values"]["noise"]["size"] == 8
    assert ask("POST", "/api/stop", {"page": "test"}).json == {}


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "LOCALHOST"])
def test_its_own_names_are_served(host, ask, studio) -> None:
    own = f"{host}:{studio.server_port}"
    origin = {"Origin": f"http://{own}", "Sec-Fetch-Site": "same-origin"}
    assert ask("GET", "/", host=own).status == 200
    assert ask("POST", "/api/stop", {"page": "a"}, host=own, headers=origin).json == {}


@pytest.mark.parametrize(
    ("host", "headers"),
    [
        ("clouds.example", {}),
        ("127.0.0.1", {}),
        ("127.0.0.1:1", {}),
        ("", {}),
        (None, {"Origin": "http://clouds.example"}),
        (None, {"Origin": "null"}),
        (None, {"Origin": "https://127.0.0.1"}),
        (None, {"Sec-Fetch-Site": "cross-site"}),
        (None, {"Sec-Fetch-Site": "same-site"}),
    ],
)
def test_others_are_refused(host, headers, ask) -> None:
    for method, path, body in (
        ("GET", "/", None),
        ("GET", "/api/setups", None),
        ("POST", "/api/render", NOISE),
        ("POST", "/api/stop", {"page": "test"}),
    ):
        answer = ask(method, path, body, host=host, headers=headers)
        assert answer.status == 403
        assert ": expected " in answer.line


def test_it_listens_on_this_machine_alone(studio: Studio) -> None:
    assert studio.socket.getsockname()[0] == "127.0.0.1"


BAD = [
    ("GET", "/nothing", None, 404, "path: expected"),
    ("GET", "/../page.html", None, 404, "path: expected"),
    ("GET", "/%2e%2e/server.py", None, 404, "path: expected"),
    ("GET", "/api/render", None, 405, "method: expected POST"),
    ("POST", "/", {}, 405, "method: expected GET"),
    ("POST", "/api/render", b"", 400, "body: expected a JSON object"),
    ("POST", "/api/render", b"\xff\xfe", 400, "body: expected a JSON object"),
    ("POST", "/api/render", b"[]", 400, "body: expected a JSON object"),
    ("POST", "/api/render", b"[" * 9999, 400, "body: expected at most 32 brackets"),
    ("POST", "/api/render", b'{"a": ' + b"9" * 9999 + b"}", 400, "body: expected"),
    ("POST", "/api/render", b" " * 300_000, 413, "body: expected at most"),
    ("POST", "/api/render", {}, 400, "scene: expected one of"),
    ("POST", "/api/render", {"setup": ["cloud"]}, 400, "scene: expected one of"),
    ("POST", "/api/render", {**NOISE, "width": 0}, 400, "width: expected"),
    ("POST", "/api/render", {**NOISE, "width": 1e9}, 400, "width: expected"),
    ("POST", "/api/render", {**NOISE, "height": 2000}, 400, "size: expected"),
    ("POST", "/api/render", {**NOISE, "width": None}, 400, "width: expected"),
    ("POST", "/api/render", {**NOISE, "coarse": 1}, 400, "coarse: expected"),
    ("POST", "/api/render", {**NOISE, "slice": 2}, 400, "slice: expected"),
    ("POST", "/api/render", {**NOISE, "view": "error"}, 400, "view: expected one of"),
    ("POST", "/api/render", {**NOISE, "page": "a" * 65}, 400, "page: expected"),
    ("POST", "/api/render", {**NOISE, "values": 3}, 400, "values: expected blocks"),
    ("POST", "/api/stop", {}, 400, "page: expected a text"),
    ("POST", "/api/open", {"text": 3}, 400, "text: expected a text"),
    ("POST", "/api/open", {"text": "["}, 400, "scene: expected a TOML file"),
]


@pytest.mark.parametrize(("method", "path", "body", "status", "line"), BAD)
def test_bad_requests_are_refused_in_one_line(
    method, path, body, status, line, ask
) -> None:
    answer = ask(method, path, body)
    assert (answer.status, answer.line[: len("refcloud studio: ")]) == (
        status,
        "refcloud studio: ",
    )
    assert answer.line.removeprefix("refcloud studio: ").startswith(line)


def test_other_kinds_of_body_are_refused(ask) -> None:
    kinds: list[tuple[dict[str, str], int]] = [
        ({"Content-Type": "text/plain"}, 415),
        ({"Content-Type": "application/x-www-form-urlencoded"}, 415),
        ({"Transfer-Encoding": "chunked"}, 411),
    ]
    for headers, status in kinds:
        answer = ask("POST", "/api/stop", b'{"page": "a"}', headers=headers)
        assert answer.status == status
        assert ": expected " in answer.line


def raw(studio: Studio, data: bytes) -> bytes:
    """Send bytes as they are, and read until the server closes."""
    with socket.create_connection(("127.0.0.1", studio.server_port), 30.0) as link:
        link.sendall(data)
        link.shutdown(socket.SHUT_WR)
        found = b""
        try:
            while part := link.recv(65536):
                found += part
        except ConnectionResetError:
            pass  # it had answered, and did not read the rest
        return found


def check_answer(answer: bytes, *, bare: bool = False) -> None:
    """An answer is none, or one with a status that is no defect; HEAD has no body."""
    if not answer:
        return
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1."), answer[:200]
    status = int(head.split()[1])
    assert status < 500 or status in (501, 505), answer[:300]
    assert b"Traceback" not in answer
    if status != 200 and not (bare and not body):
        assert body.startswith(b"refcloud studio: "), answer[:300]
        assert body.count(b"\n") == 1


TEXT = st.text(st.characters(codec="latin-1", exclude_characters="\r\n"), max_size=40)
PATHS = st.one_of(
    st.sampled_from(["/", "/api/setups", "/api/render", "/api/stop", "/api/open"]),
    st.sampled_from(["*", "//x", "http://a/", "/\x00", "/?a=1", "/%zz", "http://[a/"]),
    TEXT.map(lambda text: "/" + text),
    TEXT,
)
METHODS = st.one_of(
    st.sampled_from(["GET", "POST", "HEAD", "PUT", "DELETE", "OPTIONS", "TRACE"]),
    st.text(st.characters(min_codepoint=33, max_codepoint=126), max_size=9),
)
VERSIONS = st.sampled_from(["HTTP/1.1", "HTTP/1.0", "HTTP/0.9", "HTTP/2.0", "X", ""])
NAMES = st.one_of(
    st.sampled_from(["Origin", "Content-Length", "Content-Type", "Transfer-Encoding"]),
    st.sampled_from(["Host", "Expect", "Sec-Fetch-Site", "Range", "Connection"]),
    TEXT,
)
VALUES = st.one_of(
    st.sampled_from(
        ["application/json", "0", "2", "-1", "9" * 30, "100-continue", "²"]
    ),
    TEXT,
)


@GIVEN
@given(METHODS, PATHS, VERSIONS, st.lists(st.tuples(NAMES, VALUES), max_size=4))
def test_garbage_around_a_request_does_not_shake_it(
    studio, method, path, version, headers
) -> None:
    lines = [f"{method} {path} {version}", f"Host: 127.0.0.1:{studio.server_port}"]
    lines += [f"{name}: {value}" for name, value in headers]
    request = "\r\n".join([*lines, "", ""]).encode("latin-1")
    check_answer(raw(studio, request + b"{}"), bare=method == "HEAD")


@GIVEN
@given(st.binary(max_size=200))
def test_bytes_do_not_shake_it(studio, data) -> None:
    check_answer(raw(studio, data))
    check_answer(raw(studio, data + b"\r\n\r\n"))


THINGS = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.text(max_size=9), inner, max_size=4)
    ),
    max_leaves=12,
)


@st.composite
def bodies(draw: st.DrawFn) -> dict[str, Any]:
    """Draw what looks like a page's request, with one or more parts wrong."""
    setup = setups()[draw(st.sampled_from(["cloud", "box", "noise", "cumulus"]))]
    body: dict[str, Any] = {"setup": setup.name, **SIZE, "view": "picture"}
    group = draw(st.sampled_from(setup.groups))
    option = draw(st.sampled_from(group.options))
    body["values"] = {group.key: {option.name: draw(THINGS)}}
    wrong = draw(st.sampled_from([*body, "slice", "coarse", "text", None]))
    if wrong is not None:
        body[wrong] = draw(THINGS)
    return body


@GIVEN
@given(bodies(), st.sampled_from(["python", "scene", "open", "stop"]))
def test_wrong_values_do_not_shake_it(ask, body, path) -> None:
    answer = ask("POST", f"/api/{path}", json.dumps(body).encode())
    assert answer.status in (200, 400)
    if answer.status == 400:
        assert ": expected " in answer.line


def test_it_still_draws_after_all_that(ask) -> None:
    assert ask("POST", "/api/render", NOISE).json["width"] == 8


def test_too_many_requests_at_once_are_refused(ask, studio, monkeypatch) -> None:
    class Full:
        def acquire(self, blocking: bool) -> bool:
            return False

    monkeypatch.setattr(studio, "room", Full())
    answer = ask("GET", "/")
    assert answer.status == 503
    assert ": expected fewer requests" in answer.line


def test_a_defect_is_one_line(ask, monkeypatch) -> None:
    def fail(name: object) -> None:
        raise KeyError("a\nb")

    monkeypatch.setattr("refcloud.studio.server.find_setup", fail)
    answer = ask("POST", "/api/python", NOISE)
    assert answer.status == 500
    assert answer.line.startswith("refcloud studio: defect: KeyError")
