"""A studio that is served in this process, and ways to ask it."""

from __future__ import annotations

import http.client
import json
import threading
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import pytest

from refcloud.studio import Studio


class Answered(NamedTuple):
    """What a server answered."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def line(self) -> str:
        """The one line of a refusal."""
        text = self.body.decode("utf-8")
        assert text.endswith("\n"), text[:200]
        assert text.count("\n") == 1, text[:200]
        return text[:-1]

    @property
    def json(self) -> Any:
        """What a page gets."""
        assert self.status == 200, self.body[:300]
        return json.loads(self.body)


@pytest.fixture(scope="session")
def studio() -> Iterator[Studio]:
    with Studio() as studio:
        thread = threading.Thread(target=studio.serve_forever, daemon=True)
        thread.start()
        yield studio
        studio.shutdown()
        thread.join()


@pytest.fixture
def ask(studio: Studio) -> Callable[..., Answered]:
    """Send one request; the headers of a page's own script unless others are given."""

    def ask(
        method: str,
        path: str,
        body: Any = None,
        *,
        headers: dict[str, str] | None = None,
        host: str | None = None,
    ) -> Answered:
        port = studio.server_port
        sent = body if isinstance(body, bytes) else json.dumps(body).encode()
        own = {"Host": f"127.0.0.1:{port}" if host is None else host}
        own["Content-Type"] = "application/json"
        link = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        try:
            link.request(
                method,
                path,
                body=None if body is None else sent,
                headers={**own, **(headers or {})},
            )
            answer = link.getresponse()
            return Answered(answer.status, dict(answer.getheaders()), answer.read())
        finally:
            link.close()

    return ask
