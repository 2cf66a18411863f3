"""``refcloud studio``: a page in the browser with a slider for every parameter."""

from __future__ import annotations

import contextlib
import signal
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from refcloud.cli.options import options_of
from refcloud.cli.outputs import say
from refcloud.cli.parser import Command
from refcloud.conventions import Range
from refcloud.refusal import complaint

ABOUT = "Open a page in the browser with a slider for every parameter."


@dataclass(frozen=True)
class Page:
    """Where the page is served, and whether the browser opens it.

    Attributes
    ----------
    port
        Port on this machine, 127.0.0.1; 0 takes any that is free.
    browser
        Whether the browser is opened; the address is printed in any case.
    """

    port: Annotated[int, Range(0, 65535)] = 0
    browser: bool = True


OPTIONS = options_of(Page)


def command() -> Command:
    """Give the command's options."""
    made = Command("studio", ABOUT)
    made.group("the page", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Serve the page until it is interrupted."""
    given = command().parse(words)
    page = Page(**given.of(OPTIONS))
    # Imported here: only this command needs the server.
    from refcloud.studio import Studio

    try:
        studio = Studio(page.port)
    except OSError as error:
        advice = "choose another, or 0 for any that is free"
        expected = "a port that is free"
        got = f"{page.port} ({error.strerror})"
        raise ValueError(complaint("--port", expected, got, advice)) from None
    with studio, contextlib.suppress(KeyboardInterrupt):
        _end_with_terminal()
        say(studio.address)
        say("Ctrl-C ends it.")
        if page.browser:
            webbrowser.open(studio.address)
        studio.serve_forever()
    return 0


def _end_with_terminal() -> None:
    """Let a request to terminate end the server as Ctrl-C does."""

    def end(number: int, stack: object) -> None:
        raise KeyboardInterrupt

    with contextlib.suppress(ValueError):  # not in the main thread
        signal.signal(signal.SIGTERM, end)
