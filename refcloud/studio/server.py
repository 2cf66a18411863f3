"""The studio's server: the page, its settings, and pictures; on this machine alone."""

from __future__ import annotations

import contextlib
import importlib.resources
import json
import socketserver
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Annotated, Any, cast

from refcloud.checking import check
from refcloud.conventions import Range
from refcloud.refusal import complaint
from refcloud.studio.choices import find_setup, setups
from refcloud.studio.guard import (
    RefusedError,
    check_sender,
    decoded,
    length_of,
    path_of,
    text_in,
)
from refcloud.studio.jobs import Jobs
from refcloud.studio.scene_file import as_json, scene_of, scene_text
from refcloud.studio.setups import MOST_HIGH, MOST_WIDE, Setup, Values, frame_of
from refcloud.studio.worker import Job

LOOPBACK = "127.0.0.1"
PATIENCE = 15.0  # seconds that a sender may take for its request
MOST_AT_ONCE = 48  # requests; a page has at most a few
MOST_NAME, MOST_SCENE = 64, 128 * 1024  # signs of a page's name, and of a TOML file
# The page takes nothing from elsewhere, and nobody may frame it.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline';"
    " img-src 'self' data: blob:; connect-src 'self'; frame-ancestors 'none';"
    " base-uri 'none'; form-action 'none'"
)


class Studio(ThreadingHTTPServer):
    """The server, with its queue of jobs.

    Parameters
    ----------
    port
        Where it listens on 127.0.0.1; 0 for any free one.
    jobs
        The queue; None for one with a process of its own.
    """

    daemon_threads = True
    # On Windows a second server could take over a port that is shared so.
    allow_reuse_address = False

    def __init__(self, port: int = 0, jobs: Jobs | None = None) -> None:
        self.jobs: Jobs | None = None  # a port that is taken starts no process
        super().__init__((LOOPBACK, port), Handler)
        self.jobs = jobs or Jobs()
        self.room = threading.BoundedSemaphore(MOST_AT_ONCE)

    @property
    def queue(self) -> Jobs:
        """Give the queue of a server that listens."""
        assert self.jobs is not None
        return self.jobs

    @property
    def address(self) -> str:
        """What the browser is to open."""
        return f"http://{LOOPBACK}:{self.server_port}/"

    def server_bind(self) -> None:
        """Bind without asking any name server what this machine is called."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = LOOPBACK, self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a sender that went away."""

    def server_close(self) -> None:
        """End the process too."""
        super().server_close()
        if self.jobs is not None:
            self.jobs.close()


class Handler(BaseHTTPRequestHandler):
    """One request: checked, answered, and never more than one line of trouble."""

    timeout = PATIENCE
    server_version = "refcloud"
    sys_version = ""

    @property
    def studio(self) -> Studio:
        """Give the server."""
        return cast(Studio, self.server)

    def log_message(self, format: str, *args: object) -> None:
        """Keep the terminal free."""

    def send_error(
        self, code: int, message: str | None = None, explain: str | None = None
    ) -> None:
        """Refuse in one line of plain text, whatever was wrong."""
        line = message or self.responses.get(code, ("refused", ""))[0]
        line = " ".join(f"refcloud studio: {line}".split())
        with contextlib.suppress(OSError):
            self.close_connection = True
            # Before a request line is understood there is no version to answer in.
            self.request_version = getattr(self, "request_version", "HTTP/1.0")
            if self.request_version == "HTTP/0.9":
                self.request_version = "HTTP/1.0"
            body = line.encode("utf-8", "backslashreplace") + b"\n"
            self._send(code, "text/plain; charset=utf-8", body)

    def do_GET(self) -> None:
        """Answer GET."""
        self._answer(GETS)

    def do_HEAD(self) -> None:
        """Answer HEAD: as GET, without the body."""
        self._answer(GETS)

    def do_POST(self) -> None:
        """Answer POST."""
        self._answer(POSTS)

    def _answer(self, table: dict[str, Any]) -> None:
        if not self.studio.room.acquire(blocking=False):
            self.send_error(503, complaint("studio", "fewer requests at once", "more"))
            return
        try:
            check_sender(self.headers, self.studio.server_port)
            path = path_of(self.path)
            if path not in table:
                self._refuse_path(path, table)
            table[path](self)
        except RefusedError as refusal:
            self.send_error(refusal.status, refusal.line)
        except (ValueError, TypeError) as refusal:
            self.send_error(400, str(refusal))
        except OSError:
            self.close_connection = True  # the sender went away, or took too long
        except Exception as error:
            kind = type(error).__name__
            self.send_error(500, f"defect: {kind}: {error}; please report it")
        finally:
            self.studio.room.release()

    def _refuse_path(self, path: str, table: dict[str, Any]) -> None:
        if path in GETS or path in POSTS:
            other = "POST" if table is GETS else "GET"
            raise RefusedError(405, complaint("method", other, self.command))
        raise RefusedError(404, complaint("path", "one of the page", repr(path[:60])))

    def body(self) -> dict[str, Any]:
        """Read the request's body.

        Raises
        ------
        RefusedError
            It is no JSON object of a modest size.
        """
        length = length_of(self.headers)
        data = self.rfile.read(length)
        if len(data) < length:
            raise RefusedError(400, complaint("body", f"{length} bytes", "fewer"))
        return decoded(data)

    def send_json(self, value: Any) -> None:
        """Answer with JSON."""
        self._send(200, "application/json", json.dumps(value).encode("ascii"))

    def send_page(self) -> None:
        """Answer with the page."""
        self._send(200, "text/html; charset=utf-8", page())

    def _send(self, status: int, kind: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)


def page() -> bytes:
    """Read the page from the package."""
    return (
        importlib.resources.files("refcloud.studio").joinpath("page.html").read_bytes()
    )


def _describe(handler: Handler) -> None:
    size = {"width": MOST_WIDE, "height": MOST_HIGH}
    every = [setup.described() for setup in setups().values()]
    handler.send_json({"setups": every, "most": size})


def _render(handler: Handler) -> None:
    """Check what is asked for, and wait for the picture."""
    body = handler.body()
    setup, _ = _settings(body)
    size = {side: _whole(body, side) for side in ("width", "height")}
    coarse, view = body.get("coarse", False), body.get("view", "picture")
    if not isinstance(coarse, bool):
        raise TypeError(complaint("coarse", "true or false", "something else"))
    if view not in ("picture", *setup.views):
        expected = "one of " + ", ".join(("picture", *setup.views))
        raise ValueError(complaint("view", expected, repr(view)[:60]))
    share = check("slice", body.get("slice", 0.5), SHARE)
    frame = frame_of(size["width"], size["height"], coarse=coarse)
    job = Job(
        0,
        setup.name,
        body["values"],
        frame.width,
        frame.height,
        coarse,
        view,
        share,
    )
    answer = handler.studio.queue.ask(text_in(body, "page", MOST_NAME), job)
    handler.send_json(answer)


def _settings(body: dict[str, Any]) -> tuple[Setup, Values]:
    setup = find_setup(body.get("setup"))
    body.setdefault("values", {})
    return setup, setup.taken(body["values"])


def _whole(body: dict[str, Any], name: str) -> int:
    return check(name, body.get(name), PIXELS)


def _stop(handler: Handler) -> None:
    handler.studio.queue.stop(text_in(handler.body(), "page", MOST_NAME))
    handler.send_json({})


def _python(handler: Handler) -> None:
    body = handler.body()
    setup, values = _settings(body)
    frame = frame_of(_whole(body, "width"), _whole(body, "height"))
    recipe = setup.recipe(values, frame)
    handler.send_json({"text": recipe.python(f"{setup.name}.png")})


def _save_scene(handler: Handler) -> None:
    setup, values = _settings(handler.body())
    handler.send_json({"text": scene_text(setup, values), "file": f"{setup.name}.toml"})


def _open_scene(handler: Handler) -> None:
    setup, values = scene_of(text_in(handler.body(), "text", MOST_SCENE))
    handler.send_json({"setup": setup.name, "values": as_json(values)})


SHARE = Annotated[float, Range(0.0, 1.0)]
PIXELS = Annotated[int, Range(1, max(MOST_WIDE, MOST_HIGH), "pixels")]
GETS = {"/": Handler.send_page, "/api/setups": _describe}
POSTS = {
    "/api/render": _render,
    "/api/stop": _stop,
    "/api/python": _python,
    "/api/scene": _save_scene,
    "/api/open": _open_scene,
}
