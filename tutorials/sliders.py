"""A page with a slider for each parameter of a picture, served to this machine alone.

One request at a time, each checked before anything is drawn: the address must be this
server's own (so that no other page and no name that points here can ask), the path one
of two, the query short, and every value within its range.
"""

from __future__ import annotations

import io
import math
import socketserver
import time
import webbrowser
from collections.abc import Callable
from html import escape
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from lesson import Shown, sheet_of

from refcloud.cli.options import MISSING, Option, base_of, mark, options_of
from refcloud.cli.values import value_of
from refcloud.conventions import Range
from refcloud.image.png import encode_png
from refcloud.refusal import complaint

LOOPBACK = "127.0.0.1"
PATIENCE = 5.0  # seconds that a sender may take
MOST_QUERY = 2000  # letters
STEPS = 100  # of a slider of real numbers, at least
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline';"
    " img-src 'self' blob: data:; connect-src 'self'; frame-ancestors 'none'"
)


class RefusedError(Exception):
    """A request that is not served: its status, and one line that says why."""

    def __init__(self, status: int, line: str) -> None:
        super().__init__(line)
        self.status = status


class Server(HTTPServer):
    """Listens on 127.0.0.1, for one picture and its sliders.

    Parameters
    ----------
    picture
        The function that draws.
    title
        Of the page.
    port
        0 for any free one.
    """

    def __init__(
        self, picture: Callable[..., Shown], title: str, port: int = 0
    ) -> None:
        self.picture, self.title = picture, title
        self.options = {option.name: option for option in options_of(picture)}
        super().__init__((LOOPBACK, port), Handler)

    def server_bind(self) -> None:
        """Bind without asking any name server what this machine is called."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = LOOPBACK, self.server_address[1]

    @property
    def address(self) -> str:
        """What the browser is to open."""
        return f"http://{LOOPBACK}:{self.server_port}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a sender that went away."""


class Handler(BaseHTTPRequestHandler):
    """One request, checked and answered."""

    timeout = PATIENCE
    server: Server
    server_version, sys_version = "refcloud", ""

    def log_message(self, format: str, *args: object) -> None:
        """Keep the terminal free."""

    def do_GET(self) -> None:
        """Answer with the page or with a picture."""
        try:
            self._check_sender()
            if len(self.path) > MOST_QUERY:
                raise RefusedError(414, complaint("query", "a short one", "a long one"))
            parts = urlsplit(self.path)
            if parts.path == "/":
                self._send(200, "text/html; charset=utf-8", page(self.server).encode())
            elif parts.path == "/picture":
                self._draw(parts.query)
            else:
                raise RefusedError(404, complaint("path", "/ or /picture", "another"))
        except RefusedError as refusal:
            self._send(
                refusal.status, "text/plain; charset=utf-8", f"{refusal}".encode()
            )
        except (ValueError, TypeError, ArithmeticError) as refusal:
            self._send(400, "text/plain; charset=utf-8", f"{refusal}".encode())

    def _check_sender(self) -> None:
        own = [f"{host}:{self.server.server_port}" for host in (LOOPBACK, "localhost")]
        if (self.headers.get_all("Host") or []) not in [[host] for host in own]:
            raise RefusedError(403, complaint("Host", own[0], "another"))
        for origin in self.headers.get_all("Origin") or []:
            if origin not in [f"http://{host}" for host in own]:
                raise RefusedError(
                    403, complaint("Origin", f"http://{own[0]}", "another")
                )
        if self.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin"):
            raise RefusedError(
                403, complaint("Sec-Fetch-Site", "same-origin", "another")
            )

    def _draw(self, query: str) -> None:
        knobs = {}
        for name, text in parse_qsl(query, max_num_fields=len(self.server.options)):
            if name not in self.server.options:
                expected = "one of " + ", ".join(self.server.options)
                raise ValueError(complaint("query", expected, repr(name[:40])))
            option = self.server.options[name]
            knobs[name] = text == "true" if option.is_switch else value_of(option, text)
        start = time.perf_counter()
        sheet = sheet_of(self.server.picture(**knobs))
        seconds = f"{time.perf_counter() - start:.2f}"
        file = io.BytesIO()
        encode_png(sheet.codes, file)
        self._send(200, "image/png", file.getvalue(), seconds)

    def _send(self, status: int, kind: str, body: bytes, seconds: str = "") -> None:
        self.send_response(status)
        for name, value in (
            ("Content-Type", kind),
            ("Content-Length", str(len(body))),
            ("Cache-Control", "no-store"),
            ("Content-Security-Policy", POLICY),
            ("X-Content-Type-Options", "nosniff"),
            ("X-Seconds", seconds),
            ("Connection", "close"),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)


def control(option: Option) -> str:
    """Write an option's slider, list of names, box, or field."""
    kind, name = option.kinds[0], escape(option.name)
    head = f"<label>{name} <output></output><small>{escape(option.text)}</small>"
    if option.choices:
        rows = "".join(
            f"<option{' selected' if c == option.default else ''}>{escape(c)}</option>"
            for c in option.choices
        )
        return f'{head}<select name="{name}">{rows}</select></label>'
    if option.is_switch:
        on = " checked" if option.default is True else ""
        return f'{head}<input type="checkbox" name="{name}"{on}></label>'
    limits = mark(kind, Range) or Range()
    low, high = limits.lower, limits.upper
    value = 0 if option.default in (MISSING, None) else option.default
    if not (math.isfinite(low) and math.isfinite(high)):
        return f'{head}<input type="number" name="{name}" value="{value}"></label>'
    step = 1 if base_of(kind) is int else round_step((high - low) / STEPS)
    low, high = low + step * limits.open_lower, high - step * limits.open_upper
    ends = f'min="{low}" max="{high}" step="{step}" value="{value}"'
    return f'{head}<input type="range" name="{name}" {ends}></label>'


def round_step(most: float) -> float:
    """Give the largest of 1, 2 and 5 times a power of ten that is not larger.

    Examples
    --------
    >>> round_step(0.03), round_step(0.01), round_step(7.0)
    (0.02, 0.01, 5.0)
    """
    power = math.floor(math.log10(most * (1.0 + 1e-9)))
    digit = max(d for d in (1, 2, 5) if d <= most * (1.0 + 1e-9) / 10.0**power)
    return float(f"{digit}e{power}")


def page(server: Server) -> str:
    """Write the page."""
    controls = "\n".join(control(option) for option in server.options.values())
    return PAGE.replace("TITLE", escape(server.title)).replace("CONTROLS", controls)


PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>TITLE</title>
<link rel="icon" href="data:,">
<style>body{font:18px system-ui,sans-serif;margin:2em;display:flex;gap:2em;
flex-wrap:wrap}label{display:block;margin:0 0 1em}input[type=range],select{
display:block;width:20em}img{width:40em;max-width:100%}main{max-width:40em}output{color:#456}small{display:block}</style>
<main><h1>TITLE</h1><img alt="the picture"><p role="status"></p></main>
<form>CONTROLS</form><script>
const form=document.querySelector('form'),img=document.querySelector('img'),
said=document.querySelector('p');let busy=false,again=false;
async function draw(){if(busy){again=true;return}busy=true;again=false;
const q=new URLSearchParams();for(const c of form.querySelectorAll(
'input,select')){const v=c.type=='checkbox'?c.checked:c.value;q.set(c.name,v);
c.parentNode.querySelector('output').textContent=c.type=='range'?v:''}
try{const r=await fetch('/picture?'+q);if(r.ok){const b=await r.blob();
URL.revokeObjectURL(img.src);img.src=URL.createObjectURL(b);
said.textContent=r.headers.get('X-Seconds')+' s'}else said.textContent=await r.text()}
catch(e){said.textContent='the tutorial has ended'}busy=false;if(again)draw()}
form.addEventListener('input',draw);form.addEventListener('submit',e=>e.preventDefault());
draw()</script></html>
"""


def serve(picture: Callable[..., Shown], title: str) -> None:
    """Open the page in the browser, and serve it until Ctrl-C."""
    with Server(picture, title) as server:
        print(f"{server.address} (Ctrl-C ends it)", flush=True)
        webbrowser.open(server.address)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()
