"""Who may ask, and how much: checks on a request before anything is done for it.

The server listens on this machine alone, but any page in the browser can send requests
there. So the address must be the server's own (a name that someone else's DNS points
here is refused), and what a browser says about the page that asks must be this one.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from email.message import Message
from typing import Any
from urllib.parse import urlsplit

from refcloud.refusal import complaint

HOSTS = ("127.0.0.1", "localhost")
MOST_BODY = 256 * 1024  # bytes; a page's settings are some 3 kB
MOST_DEPTH = 32  # of brackets within brackets
OWN_SITES = ("same-origin", "none")
JSON = "application/json"


class RefusedError(Exception):
    """A request that is not served: its status, and one line that says why."""

    def __init__(self, status: int, line: str) -> None:
        super().__init__(line)
        self.status = status
        self.line = line


def check_sender(headers: Message, port: int) -> None:
    """Refuse a request that does not come from this server's own page or a program.

    Parameters
    ----------
    headers
        Of the request.
    port
        Where the server listens.

    Raises
    ------
    RefusedError
        Another Host, Origin or site.
    """
    hosts = headers.get_all("Host") or []
    own = [f"{host}:{port}" for host in HOSTS]
    if len(hosts) != 1 or hosts[0].strip().lower() not in own:
        got = repr(", ".join(hosts)[:60])
        raise RefusedError(403, complaint("Host", own[0], got))
    for origin in headers.get_all("Origin") or []:
        if origin.strip().lower() not in [f"http://{host}" for host in own]:
            expected = f"http://{own[0]} or none"
            raise RefusedError(403, complaint("Origin", expected, repr(origin[:60])))
    for site in headers.get_all("Sec-Fetch-Site") or []:
        if site.strip().lower() not in OWN_SITES:
            raise RefusedError(
                403, complaint("Sec-Fetch-Site", "same-origin", repr(site[:60]))
            )


def path_of(target: str) -> str:
    """Give the path of a request's target.

    Raises
    ------
    RefusedError
        It is no path.
    """
    try:
        parts = urlsplit(target)
    except ValueError:
        raise RefusedError(400, complaint("path", "a path", "no address")) from None
    if parts.scheme or parts.netloc or not parts.path.startswith("/"):
        raise RefusedError(400, complaint("path", "a path", repr(target[:60])))
    return parts.path


def length_of(headers: Message) -> int:
    """Give the length of a body that may be read.

    Raises
    ------
    RefusedError
        It is not JSON, has no length, or is too long.
    """
    kind = headers.get_content_type()
    if kind != JSON:
        raise RefusedError(415, complaint("Content-Type", JSON, repr(kind[:60])))
    if headers.get("Transfer-Encoding"):
        raise RefusedError(411, complaint("body", "a Content-Length", "chunks"))
    texts = headers.get_all("Content-Length") or []
    if len(texts) != 1 or not (texts[0].isascii() and texts[0].isdigit()):
        got = repr(", ".join(texts)[:60]) if texts else "none"
        raise RefusedError(411, complaint("Content-Length", "a whole number", got))
    # Leading zeros aside, a number of more digits is too large, whatever it is.
    digits = texts[0].lstrip("0")
    length = int(digits or "0") if len(digits) < 12 else MOST_BODY + 1
    if length > MOST_BODY:
        expected = f"at most {MOST_BODY} bytes"
        raise RefusedError(413, complaint("body", expected, "more"))
    return length


def decoded(body: bytes) -> dict[str, Any]:
    """Read a body: one JSON object of modest depth.

    Raises
    ------
    RefusedError
        It is something else.
    """
    bad = RefusedError(400, complaint("body", "a JSON object", "something else"))
    # Counted before, since the reader calls itself for every bracket.
    if depth_of(body) > MOST_DEPTH:
        expected = f"at most {MOST_DEPTH} brackets within brackets"
        raise RefusedError(400, complaint("body", expected, "more"))
    try:
        found = json.loads(body.decode("utf-8"))
    except (ValueError, RecursionError):
        raise bad from None
    if not isinstance(found, dict):
        raise bad
    return found


def depth_of(body: bytes) -> int:
    """Count how deep brackets lie in each other at most, those in texts included."""
    depth = most = 0
    for sign in body:
        if sign in b"[{":
            depth += 1
            most = max(most, depth)
        elif sign in b"]}":
            depth -= 1
    return most


def text_in(body: Mapping[str, Any], name: str, most: int) -> str:
    """Take a text of a body.

    Raises
    ------
    ValueError
        It is missing, too long, or something else.
    """
    value = body.get(name)
    if not isinstance(value, str) or len(value) > most:
        expected = f"a text of at most {most} signs"
        got = "none" if value is None else "something else"
        raise ValueError(complaint(name, expected, got))
    return value
